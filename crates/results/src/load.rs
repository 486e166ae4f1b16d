use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use mser3d_fileio::{InputFile, NpyValues, NpzReader};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shape::{BitGrid, Domain, Frame, ShapeError, TriangleMesh, VoxelGrid};
use serde::Deserialize;

use crate::check::afford;
use crate::folder::recover;
use crate::msv::MSV_RECORD;
use crate::results::labels as labels_of;
use crate::write::of_body;
use crate::{Checksums, FORMAT, GridRecord, Record, Results, ResultsError, TreeArrays};

impl Results {
    /// Reads a folder that [`Results::write`] wrote, and checks that its files belong together.
    ///
    /// The grid comes back without the links that the voxelizer cut; trees are read if they are there. Each file is
    /// checked against `checksums.json`, if it is listed there, and all that it says is checked in any case.
    ///
    /// # Errors
    /// [`ResultsError::NotAResult`], [`ResultsError::OtherFormat`], [`ResultsError::Damaged`], [`ResultsError::Broken`],
    /// [`ResultsError::TooLarge`], [`ResultsError::Io`] or [`ResultsError::File`], naming the file.
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let (record, sums) = Record::load_checked(folder)?;
        sums.check_beside(folder, "features.npz", Results::FILES.record)?;
        let mut arrays = Arrays::load(folder, "features.npz")?;
        let regions = record.regions.len();
        let eigenvalues = record.bodies.iter().enumerate();
        let eigenvalues = eigenvalues.map(|(body, known)| {
            let name = of_body("eigenvalues", body);
            let values = arrays.finite(&name)?;
            arrays.length(&name, values.len(), known.spectrum.eigenpairs)?;
            match values.is_sorted() && values.first().is_none_or(|&least| least >= 0.0) {
                true => Ok(values),
                false => Err(arrays.broken(format!("array {name} is negative or does not ascend"))),
            }
        });
        let eigenvalues = eigenvalues.collect::<Result<_, _>>()?;
        let descriptors = arrays.finite("region_descriptor")?;
        let descriptor_width = descriptors.len().checked_div(regions).unwrap_or(0);
        arrays.length("region_descriptor", descriptors.len(), regions * descriptor_width)?;
        let cosines = arrays.finite("region_cosine")?;
        arrays.length("region_cosine", cosines.len(), regions * regions)?;
        let (mut grid, mut region_voxels) = (None, vec![Vec::new(); regions]);
        if record.domain == Domain::Volume {
            let Some(own) = &record.grid else {
                return Err(arrays.broken("regions.json has no grid for its voxels".into()));
            };
            let solid = arrays.grid(own)?;
            region_voxels = arrays.lists("region_voxels", regions, solid.len())?;
            arrays.innermost("voxel_region", solid.len(), &region_voxels)?;
            grid = Some(solid);
        }
        // A solid that was given as voxels has no mesh.
        let surface = folder.join("surface.ply");
        let has_mesh = grid.is_none() || surface.exists() || arrays.holds_vertices()?;
        let (mut mesh, mut region_vertices) = (TriangleMesh::new(Vec::new(), Vec::new())?, Vec::new());
        if has_mesh {
            sums.check_beside(folder, "surface.ply", Results::FILES.record)?;
            mesh = read_mesh(&surface, &ReadOptions::default())?.mesh;
            let vertices = mesh.vertices().len();
            region_vertices = arrays.lists("region_vertices", regions, vertices)?;
            arrays.innermost("vertex_region", vertices, &region_vertices)?;
        }
        let mut vertex_voxel = Vec::new();
        if let (true, Some(grid)) = (has_mesh, &grid) {
            vertex_voxel = arrays.labels("vertex_voxel", mesh.vertices().len(), grid.len())?;
        }
        let (mut vertex_part, mut voxel_part) = (Vec::new(), Vec::new());
        if let Some(parts) = &record.parts {
            if has_mesh {
                vertex_part = arrays.labels("vertex_part", mesh.vertices().len(), parts.len())?;
            }
            if let Some(grid) = &grid {
                voxel_part = arrays.labels("voxel_part", grid.len(), parts.len())?;
            }
        }
        let file_vertex = match arrays.has("file_vertex") {
            true => Some(arrays.indices("file_vertex", mesh.vertices().len())?),
            false => None,
        };
        let twins = record.regions.iter().map(|region| region.twin.map_or(-1, i64::from));
        if !arrays.take("region_twin", integers)?.into_iter().eq(twins) {
            return Err(arrays.broken("array region_twin is not that of regions.json".into()));
        }
        let sides = record.regions.iter().map(|region| region.side.unwrap_or(f64::NAN).to_bits());
        if !arrays.take("region_side", numbers)?.into_iter().map(f64::to_bits).eq(sides) {
            return Err(arrays.broken("array region_side is not that of regions.json".into()));
        }
        let elements = grid.as_ref().map_or(mesh.vertices().len(), VoxelGrid::len);
        let mut trees = Vec::new();
        for number in 0..record.trees.len() {
            if arrays.has(&format!("tree{number}_parent")) {
                trees.push(arrays.tree(number, elements)?);
            }
        }
        if trees.len() < record.trees.len() {
            trees.clear();
        }
        for (region, voxels) in record.regions.iter().zip(&region_voxels) {
            let vertices = region_vertices.get(region.id as usize).map_or(region.vertices, Vec::len);
            if region.voxels.is_some_and(|n| n != voxels.len()) || vertices != region.vertices {
                let reason = format!("region {} is not that of regions.json", region.id);
                return Err(arrays.broken(reason));
            }
        }
        let results = Self {
            record,
            mesh,
            mesh_of_voxels: false,
            file_vertex,
            grid,
            region_vertices,
            region_voxels,
            vertex_voxel,
            vertex_part,
            voxel_part,
            eigenvalues,
            descriptor_width,
            descriptors,
            cosines,
            trees,
            eigenfunctions: None,
        };
        if has_mesh { Ok(results) } else { results.with_voxel_surface() }
    }
}

impl Record {
    /// Reads `regions.json` of a folder, and nothing else.
    ///
    /// # Errors
    /// [`ResultsError::NotAResult`], [`ResultsError::OtherFormat`], [`ResultsError::Damaged`], [`ResultsError::Broken`],
    /// [`ResultsError::Io`].
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        Ok(Self::load_checked(folder)?.0)
    }

    /// The same with the checksums of the folder.
    pub(crate) fn load_checked(folder: &Path) -> Result<(Self, Checksums), ResultsError> {
        let path = folder.join(Results::FILES.record);
        recover(folder, Results::FILES.record)?;
        let text = InputFile::read_all(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound if folder.join(MSV_RECORD).is_file() => {
                ResultsError::GreyValueResult { folder: folder.to_owned() }
            }
            ErrorKind::NotFound | ErrorKind::NotADirectory => {
                ResultsError::NotAResult { folder: folder.to_owned() }
            }
            _ => ResultsError::Io { path: path.clone(), error },
        })?;
        let sums = Checksums::load(folder)?;
        sums.check_beside(folder, Results::FILES.record, "features.npz")?;
        let record: Self = parse(&path, &text, FORMAT)?;
        record.check().map_err(|reason| ResultsError::Broken { path, reason })?;
        Ok((record, sums))
    }
}

/// Parses a record if it is of the format that this version reads.
pub(crate) fn parse<T: for<'de> Deserialize<'de>>(
    path: &Path,
    text: &[u8],
    expected: u32,
) -> Result<T, ResultsError> {
    /// What records of all formats say.
    #[derive(Deserialize)]
    struct Head {
        #[serde(default)]
        mser3d: Option<String>,
        #[serde(default)]
        format: Option<u32>,
    }
    let broken = |e: serde_json::Error| ResultsError::Broken { path: path.to_owned(), reason: e.to_string() };
    // The format first: another one may lack anything else.
    let head: Head = serde_json::from_slice(text).map_err(broken)?;
    let found = head.format.unwrap_or(0);
    if found != expected {
        let version = head.mser3d.unwrap_or_else(|| "of unknown version".to_owned());
        return Err(ResultsError::OtherFormat { path: path.to_owned(), version, found, expected });
    }
    serde_json::from_slice(text).map_err(broken)
}

/// The arrays of a file.
pub(crate) struct Arrays {
    pub path: PathBuf,
    file: NpzReader,
}

impl Arrays {
    pub fn load(folder: &Path, name: &str) -> Result<Self, ResultsError> {
        let path = folder.join(name);
        Ok(Self { file: NpzReader::open(&path)?, path })
    }

    pub fn broken(&self, reason: String) -> ResultsError {
        ResultsError::Broken { path: self.path.clone(), reason }
    }

    /// Whether there is such an array.
    fn has(&self, name: &str) -> bool {
        self.file.names().any(|own| own == name)
    }

    /// Whether there was a mesh when the arrays were written.
    fn holds_vertices(&mut self) -> Result<bool, ResultsError> {
        Ok(self.file.read("vertex_region")?.is_some_and(|array| !array.values().is_empty()))
    }

    pub fn take<T>(
        &mut self,
        name: &str,
        convert: fn(NpyValues<'_>) -> Option<T>,
    ) -> Result<T, ResultsError> {
        let array = self.file.read(name)?.ok_or_else(|| self.broken(format!("there is no array {name}")))?;
        convert(array.into_values())
            .ok_or_else(|| self.broken(format!("array {name} holds values of another type")))
    }

    pub fn length(&self, name: &str, found: usize, expected: usize) -> Result<(), ResultsError> {
        if found == expected {
            return Ok(());
        }
        Err(self.broken(format!("array {name} has {found} values, but the other files need {expected}")))
    }

    /// Numbers that are numbers.
    fn finite(&mut self, name: &str) -> Result<Vec<f64>, ResultsError> {
        let values = self.take(name, numbers)?;
        match values.iter().all(|x| x.is_finite()) {
            true => Ok(values),
            false => Err(self.broken(format!("array {name} holds a value that is not finite"))),
        }
    }

    /// The innermost of these regions of each vertex or voxel, which other programs read.
    fn innermost(&mut self, name: &str, count: usize, regions: &[Vec<u32>]) -> Result<(), ResultsError> {
        let labels = self.labels(name, count, regions.len())?;
        match labels == labels_of(count, regions) {
            true => Ok(()),
            false => Err(self.broken(format!("array {name} does not fit the lists of the regions"))),
        }
    }

    /// Numbers below `count`.
    pub fn indices(&mut self, name: &str, count: usize) -> Result<Vec<u32>, ResultsError> {
        let values = self.take(name, integers)?;
        let checked = values.iter().map(|&v| u32::try_from(v).ok().filter(|&v| (v as usize) < count));
        let indices: Option<Vec<u32>> = checked.collect();
        indices.ok_or_else(|| self.broken(format!("array {name} names something beyond {count}")))
    }

    /// As many numbers of lists, or -1, below `lists`.
    fn labels(&mut self, name: &str, count: usize, lists: usize) -> Result<Vec<i32>, ResultsError> {
        let values = self.take(name, integers)?;
        self.length(name, values.len(), count)?;
        let checked =
            values.iter().map(|&v| i32::try_from(v).ok().filter(|&v| v >= -1 && i64::from(v) < lists as i64));
        let labels: Option<Vec<i32>> = checked.collect();
        labels.ok_or_else(|| self.broken(format!("array {name} names something beyond {lists}")))
    }

    /// Lists one after another, cut by `NAME_start`, each ascending.
    fn lists(&mut self, name: &str, lists: usize, count: usize) -> Result<Vec<Vec<u32>>, ResultsError> {
        let all = self.indices(name, count)?;
        let starts = self.indices(&format!("{name}_start"), all.len() + 1)?;
        self.length(&format!("{name}_start"), starts.len(), lists + 1)?;
        if (starts.first(), starts.last()) != (Some(&0), Some(&(all.len() as u32))) {
            return Err(self.broken(format!("array {name}_start does not cut all of {name}")));
        }
        let slice = |w: &[u32]| all.get(w[0] as usize..w[1] as usize).map(<[u32]>::to_vec);
        let cut: Option<Vec<Vec<u32>>> = starts.windows(2).map(slice).collect();
        let cut = cut.ok_or_else(|| self.broken(format!("array {name}_start does not ascend")))?;
        match cut.iter().all(|list| list.is_sorted_by(|a, b| a < b)) {
            true => Ok(cut),
            false => Err(self.broken(format!("array {name} does not ascend within a region"))),
        }
    }

    fn grid(&mut self, grid: &GridRecord) -> Result<VoxelGrid, ResultsError> {
        let index = self.indices("voxel_index", 1 << 24)?;
        let (index, rest) = index.as_chunks::<3>();
        let affine = self.take("grid_affine", numbers)?;
        if affine != grid.affine.matrix().as_flattened() || !rest.is_empty() {
            return Err(self.broken("the arrays of the grid are not those of regions.json".into()));
        }
        let dims = grid.dims;
        if let Some(v) = index.iter().find(|v| (0..3).any(|a| v[a] as usize >= dims[a])) {
            return Err(self.broken(format!("array voxel_index names voxel {v:?}, beyond {dims:?}")));
        }
        if index.is_empty() {
            return Err(self.broken("array voxel_index is empty".into()));
        }
        // A bit for each voxel of the box, and one for each of its links.
        let box_voxels = dims.iter().fold(1u128, |all, &n| all.saturating_mul(n as u128));
        afford(
            &self.path,
            format!("a grid of {} x {} x {} voxels", dims[0], dims[1], dims[2]),
            box_voxels / 2,
        )?;
        let fail = |error: ShapeError| self.broken(format!("the grid of its voxels is none: {error}"));
        let mut inside = BitGrid::empty(dims).map_err(fail)?;
        index.iter().for_each(|&v| inside.set(v, true));
        if !inside.ones().eq(index.iter().copied()) {
            return Err(self.broken("array voxel_index is not in the order of a grid, x fastest".into()));
        }
        let frame = Frame::placed(dims, &grid.affine).map_err(fail)?;
        VoxelGrid::solid(frame, inside).map_err(fail)
    }

    fn tree(&mut self, number: usize, elements: usize) -> Result<TreeArrays, ResultsError> {
        let name = |array: &str| format!("tree{number}_{array}");
        let parents = self.take(&name("parent"), integers)?;
        let altitudes = self.take(&name("altitude"), numbers)?;
        let volumes = self.take(&name("volume"), numbers)?;
        let entry = self.take(&name("entry"), integers)?;
        let nodes = parents.len() as i64;
        let node = |array: &str, n: i64| match u32::try_from(n) {
            Ok(number) if n < nodes => Ok(number),
            _ if n == -1 => Ok(u32::MAX),
            _ => Err(self.broken(format!("array {} names node {n} of {nodes}", name(array)))),
        };
        let entry = entry.into_iter().map(|n| node("entry", n)).collect::<Result<Vec<u32>, _>>()?;
        let parents = parents.into_iter().map(|n| node("parent", n)).collect::<Result<Vec<u32>, _>>()?;
        self.length(&name("altitude"), altitudes.len(), parents.len())?;
        self.length(&name("volume"), volumes.len(), parents.len())?;
        self.length(&name("entry"), entry.len(), elements)?;
        let tree = TreeArrays { parents, altitudes, volumes, entry };
        tree.check().map_err(|what| self.broken(format!("tree {number}: {what}")))?;
        Ok(tree)
    }
}

pub(crate) fn integers(values: NpyValues<'_>) -> Option<Vec<i64>> {
    match values {
        NpyValues::I32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        NpyValues::U32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        NpyValues::I64(v) => Some(v.into_owned()),
        _ => None,
    }
}

pub(crate) fn numbers(values: NpyValues<'_>) -> Option<Vec<f64>> {
    match values {
        NpyValues::F64(v) => Some(v.into_owned()),
        NpyValues::F32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        _ => None,
    }
}
