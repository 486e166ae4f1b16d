//! `eigenfunctions.npz`: the eigenpairs that regions were found with.

use std::path::Path;

use mser3d::Features;
use mser3d_fileio::{NpyArray, NpyValues, write_npz};
use mser3d_shape::{Domain, Eigenbasis, Functions, FunctionsView};

use crate::load::{Arrays, integers, numbers};
use crate::write::of_body;
use crate::{Checksums, Extra, Results, ResultsError};

/// The eigenpairs of one body, and where their values belong.
///
/// Rows are the body's elements: voxels of a solid, or distinct vertices of a surface.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Eigenfunctions {
    /// The eigenpairs.
    pub basis: Eigenbasis,
    /// The voxel of each row, ascending; of a surface, none.
    pub voxels: Vec<u32>,
    /// The row that each vertex of the mesh takes its values from: that of its nearest voxel. None for vertices of other
    /// bodies; empty where there is no mesh.
    pub row_of_vertex: Vec<Option<u32>>,
}

impl Eigenfunctions {
    /// Those of each body that was searched.
    pub fn of(features: &Features) -> Vec<Self> {
        let volume = features.shape.domain() == Domain::Volume;
        let of_body = |body: &mser3d::Body| Self {
            basis: body.basis.clone(),
            voxels: if volume { body.elements.clone() } else { Vec::new() },
            row_of_vertex: {
                let elements = features.shape.element_of_vertex().iter();
                elements.map(|element| element.and_then(|e| body.number_of(e))).collect()
            },
        };
        features.bodies.iter().map(of_body).collect()
    }

    /// Reads those of a result from its folder, and checks that they belong to it.
    ///
    /// # Errors
    /// [`ResultsError::NoEigenfunctions`] where there is no such file, [`ResultsError::Damaged`], [`ResultsError::Broken`],
    /// [`ResultsError::File`].
    pub fn load(folder: &Path, results: &Results) -> Result<Vec<Self>, ResultsError> {
        let name = Extra::Eigenfunctions.file_name();
        if !folder.join(name).is_file() {
            return Err(ResultsError::NoEigenfunctions { folder: folder.to_owned() });
        }
        Checksums::load(folder)?.check(folder, name)?;
        let mut arrays = Arrays::load(folder, name)?;
        (0..results.record.bodies.len()).map(|body| Self::read(&mut arrays, body, results)).collect()
    }

    fn read(arrays: &mut Arrays, body: usize, results: &Results) -> Result<Self, ResultsError> {
        let name = |what: &str| of_body(what, body);
        let eigenvalues = arrays.take(&name("eigenvalues"), numbers)?;
        if results.eigenvalues.get(body) != Some(&eigenvalues) {
            let reason = format!("array {} is not that of features.npz", name("eigenvalues"));
            return Err(arrays.broken(reason));
        }
        let functions = arrays.take(&name("eigenfunctions"), functions)?;
        let mass = arrays.take(&name("mass"), numbers)?;
        let rows = mass.len();
        arrays.length(
            &name("eigenfunctions"),
            functions.view().len(),
            rows.saturating_mul(eigenvalues.len()),
        )?;
        if functions.view().values().any(|x| !x.is_finite()) {
            let reason = format!("array {} holds a value that is not finite", name("eigenfunctions"));
            return Err(arrays.broken(reason));
        }
        let mut voxels = Vec::new();
        if let Some(grid) = &results.grid {
            voxels = arrays.indices(&name("voxels"), grid.len())?;
            arrays.length(&name("voxels"), voxels.len(), rows)?;
            if !voxels.is_sorted_by(|a, b| a < b) {
                return Err(arrays.broken(format!("array {} does not ascend", name("voxels"))));
            }
        }
        let mut row_of_vertex = Vec::new();
        if !results.mesh_of_voxels {
            let found = arrays.take(&name("vertex_row"), integers)?;
            arrays.length(&name("vertex_row"), found.len(), results.mesh.vertices().len())?;
            if let Some(row) = found.iter().find(|&&row| row < -1 || row >= rows as i64) {
                return Err(arrays.broken(format!("array {} names row {row} of {rows}", name("vertex_row"))));
            }
            row_of_vertex = found.into_iter().map(|row| u32::try_from(row).ok()).collect();
        }
        let basis = Eigenbasis::new(results.domain(), mass, eigenvalues, functions);
        let basis = basis.map_err(|error| arrays.broken(format!("body {body}: {error}")))?;
        Ok(Self { basis, voxels, row_of_vertex })
    }

    /// Where the rows of a body belong: the voxel of each row, and the row of each vertex.
    pub(crate) fn places(&self, body: usize) -> Vec<(String, NpyArray<'_>)> {
        let name = |what: &str| of_body(what, body);
        let mut arrays = Vec::new();
        if self.basis.domain() == Domain::Volume {
            arrays.push((name("voxels"), NpyArray::flat(&self.voxels[..])));
        }
        if !self.row_of_vertex.is_empty() {
            // In numpy -1 is handier for none.
            let row = |row: &Option<u32>| row.map_or(-1, |row| row as i32);
            let rows: Vec<i32> = self.row_of_vertex.iter().map(row).collect();
            arrays.push((name("vertex_row"), NpyArray::flat(rows)));
        }
        arrays
    }

    /// The rows of a region of these results, ascending. Rows of other bodies are left out.
    pub fn rows_of_region(&self, results: &Results, region: usize) -> Vec<u32> {
        if results.grid.is_some() {
            let row = |voxel: &u32| self.voxels.binary_search(voxel).ok().map(|row| row as u32);
            return results.region_voxels[region].iter().filter_map(row).collect();
        }
        let row = |&vertex: &u32| self.row_of_vertex.get(vertex as usize).copied().flatten();
        let mut rows: Vec<u32> = results.region_vertices[region].iter().filter_map(row).collect();
        rows.sort_unstable();
        rows.dedup();
        rows
    }
}

/// Writes those of each body.
pub(crate) fn write_eigenfunctions(bodies: &[Eigenfunctions], path: &Path) -> Result<(), ResultsError> {
    let mut arrays = Vec::new();
    for (number, body) in bodies.iter().enumerate() {
        let basis = &body.basis;
        let name = |what: &str| of_body(what, number);
        let shape = [basis.len(), basis.eigenvalues().len()];
        // Half the bytes of double precision: a solver's error is larger than the rounding.
        let functions = match basis.functions() {
            FunctionsView::Double(values) => values.iter().map(|&x| x as f32).collect::<Vec<_>>().into(),
            FunctionsView::Single(values) => NpyValues::from(values),
        };
        arrays.push((name("eigenvalues"), NpyArray::flat(basis.eigenvalues())));
        arrays.push((name("eigenfunctions"), NpyArray::new(&shape, functions)?));
        arrays.push((name("mass"), NpyArray::flat(basis.mass())));
        arrays.extend(body.places(number));
    }
    Ok(write_npz(path, &arrays)?)
}

/// Eigenfunctions in the precision of the file.
fn functions(values: NpyValues<'_>) -> Option<Functions> {
    match values {
        NpyValues::F64(values) => Some(values.into_owned().into()),
        NpyValues::F32(values) => Some(values.into_owned().into()),
        _ => None,
    }
}
