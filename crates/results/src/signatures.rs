//! `signatures.npz` and `fields.vti`: what is known of each voxel or vertex, for other programs.

use std::path::Path;

use mser3d::descriptors::Descriptors;
use mser3d::signatures;
use mser3d_fileio::{NpyArray, write_npz};
use mser3d_meshio::{VoxelField, VoxelValues, write_vti};

use crate::write::of_body;
use crate::{Eigenfunctions, Results, ResultsError};

/// Eigenfunctions in `fields.vti`. Those after them tell little to the eye, and each costs 8 bytes for every voxel of the box.
const SHOWN: usize = 12;

impl Results {
    fn signatures(&self, body: &Eigenfunctions) -> Result<Descriptors, ResultsError> {
        signatures(&body.basis, &self.record.parameters).map_err(|e| ResultsError::Signatures(Box::new(e)))
    }

    /// The signature of each element of each body, and where they belong, as for eigenfunctions.
    pub(crate) fn write_signatures(
        &self,
        bodies: &[Eigenfunctions],
        path: &Path,
    ) -> Result<(), ResultsError> {
        let mut arrays = Vec::new();
        for (number, body) in bodies.iter().enumerate() {
            let name = |what: &str| of_body(what, number);
            let rows = self.signatures(body)?;
            let shape = [rows.len(), rows.width()];
            arrays.push((name("signature"), NpyArray::new(&shape, rows.values().to_vec())?));
            arrays.extend(body.places(number));
        }
        Ok(write_npz(path, &arrays)?)
    }

    /// The first eigenfunctions and the signature of each voxel.
    pub(crate) fn write_fields(&self, bodies: &[Eigenfunctions], path: &Path) -> Result<(), ResultsError> {
        let Some(grid) = &self.grid else {
            let reason = "the regions were found on a surface, there are no voxels; write signatures";
            return Err(ResultsError::Export { path: path.to_owned(), reason });
        };
        let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
        for body in bodies {
            let rows = self.signatures(body)?;
            let modes = body.basis.eigenvalues().len().min(SHOWN);
            let names = (0..modes).map(|i| format!("eigenfunction_{i}"));
            let names = names.chain((0..rows.width()).map(|i| format!("signature_{i}")));
            for (place, name) in names.enumerate() {
                if !columns.iter().any(|(known, _)| *known == name) {
                    // Voxels of bodies that were not searched have no value.
                    columns.push((name.clone(), vec![f64::NAN; grid.len()]));
                }
                let Some((_, values)) = columns.iter_mut().find(|(known, _)| *known == name) else {
                    continue;
                };
                let mut scratch = Vec::new();
                for (row, &voxel) in body.voxels.iter().enumerate() {
                    values[voxel as usize] = match place.checked_sub(modes) {
                        None => body.basis.row(row, place..place + 1, &mut scratch)[0],
                        Some(number) => rows.row(row)[number],
                    };
                }
            }
        }
        let fields: Vec<VoxelField<'_>> = columns
            .iter()
            .map(|(name, values)| VoxelField { name, values: VoxelValues::Numbers(values) })
            .collect();
        Ok(write_vti(path, grid, &fields)?)
    }
}
