use std::collections::BTreeMap;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use mser3d_fileio::{InputFile, NpyArray, NpyValues, read_npz};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shape::{BitGrid, Domain, Frame, TriangleMesh, VoxelGrid};
use serde::Deserialize;

use crate::msv::MSV_RECORD;
use crate::write::of_body;
use crate::{FORMAT, GridRecord, Record, Results, ResultsError, TreeArrays};

impl Results {
    /// Reads a folder that [`Results::write`] wrote, and checks that its files belong together.
    ///
    /// The grid comes back without the links that the voxelizer cut; trees are read if they are there.
    ///
    /// # Errors
    /// [`ResultsError::NotAResult`], [`ResultsError::OtherFormat`], [`ResultsError::Broken`],
    /// [`ResultsError::Io`] or [`ResultsError::File`], naming the file.
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let record = Record::load(folder)?;
        let path = folder.join("features.npz");
        let mut arrays = Arrays { arrays: read_npz(&path)?, path };
        let regions = record.regions.len();
        let eigenvalues =
            (0..record.bodies.len()).map(|body| arrays.take(&of_body("eigenvalues", body), numbers));
        let eigenvalues = eigenvalues.collect::<Result<_, _>>()?;
        let descriptors = arrays.take("region_descriptor", numbers)?;
        let descriptor_width = descriptors.len().checked_div(regions).unwrap_or(0);
        arrays.length("region_descriptor", descriptors.len(), regions * descriptor_width)?;
        let cosines = arrays.take("region_cosine", numbers)?;
        arrays.length("region_cosine", cosines.len(), regions * regions)?;
        let (mut grid, mut region_voxels) = (None, vec![Vec::new(); regions]);
        if record.domain == Domain::Volume {
            let Some(own) = &record.grid else {
                return Err(arrays.broken("regions.json has no grid for its voxels".into()));
            };
            let solid = arrays.grid(own)?;
            region_voxels = arrays.lists("region_voxels", regions, solid.len())?;
            grid = Some(solid);
        }
        // A solid that was given as voxels has no mesh.
        let surface = folder.join("surface.ply");
        let has_mesh = grid.is_none() || surface.exists() || arrays.holds_vertices();
        let (mut mesh, mut region_vertices) = (TriangleMesh::new(Vec::new(), Vec::new())?, Vec::new());
        if has_mesh {
            mesh = read_mesh(&surface, &ReadOptions::default())?.mesh;
            let vertices = mesh.vertices().len();
            let labels = arrays.take("vertex_region", integers)?;
            arrays.length("vertex_region", labels.len(), vertices)?;
            region_vertices = arrays.lists("region_vertices", regions, vertices)?;
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
        let file_vertex = match arrays.arrays.contains_key("file_vertex") {
            true => Some(arrays.indices("file_vertex", mesh.vertices().len())?),
            false => None,
        };
        let elements = grid.as_ref().map_or(mesh.vertices().len(), VoxelGrid::len);
        let mut trees = Vec::new();
        for number in 0..record.trees.len() {
            if arrays.arrays.contains_key(&format!("tree{number}_parent")) {
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
    /// [`ResultsError::NotAResult`], [`ResultsError::OtherFormat`], [`ResultsError::Broken`],
    /// [`ResultsError::Io`].
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let path = folder.join("regions.json");
        let text = InputFile::read_all(&path).map_err(|error| match error.kind() {
            ErrorKind::NotFound if folder.join(MSV_RECORD).is_file() => {
                ResultsError::GreyValueResult { folder: folder.to_owned() }
            }
            ErrorKind::NotFound | ErrorKind::NotADirectory => {
                ResultsError::NotAResult { folder: folder.to_owned() }
            }
            _ => ResultsError::Io { path: path.clone(), error },
        })?;
        let record: Self = parse(&path, &text, FORMAT)?;
        let trees = record.trees.len();
        let is_twin = |twin: u32, of: u32| {
            twin != of && record.regions.get(twin as usize).is_some_and(|region| region.twin == Some(of))
        };
        for (place, region) in record.regions.iter().enumerate() {
            let known = region.id as usize == place
                && region.parent.is_none_or(|p| p < region.id)
                && (region.tree as usize) < trees
                && region.twin.is_none_or(|twin| is_twin(twin, region.id));
            if !known {
                let reason =
                    format!("region {} names a parent, tree or twin that is none of its own", region.id);
                return Err(ResultsError::Broken { path, reason });
            }
        }
        let count = record.parts.as_ref().map_or(0, Vec::len);
        let beyond = |twin: &u32| *twin as usize >= count;
        for (place, part) in record.parts.iter().flatten().enumerate() {
            let strange = part.region.is_some_and(|region| region as usize >= record.regions.len());
            if part.id as usize != place || strange || part.twins.iter().any(beyond) {
                let reason = format!("part {} names a region or part that is not there", part.id);
                return Err(ResultsError::Broken { path, reason });
            }
        }
        Ok(record)
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
    pub arrays: BTreeMap<String, NpyArray<'static>>,
}

impl Arrays {
    pub fn broken(&self, reason: String) -> ResultsError {
        ResultsError::Broken { path: self.path.clone(), reason }
    }

    /// Whether there was a mesh when the arrays were written.
    fn holds_vertices(&self) -> bool {
        self.arrays.get("vertex_region").is_some_and(|array| !array.values().is_empty())
    }

    pub fn take<T>(
        &mut self,
        name: &str,
        convert: fn(&NpyValues<'_>) -> Option<Vec<T>>,
    ) -> Result<Vec<T>, ResultsError> {
        let array = self.arrays.remove(name);
        let array = array.ok_or_else(|| self.broken(format!("there is no array {name}")))?;
        convert(array.values())
            .ok_or_else(|| self.broken(format!("array {name} holds values of another type")))
    }

    pub fn length(&self, name: &str, found: usize, expected: usize) -> Result<(), ResultsError> {
        if found == expected {
            return Ok(());
        }
        Err(self.broken(format!("array {name} has {found} values, but the other files need {expected}")))
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

    /// Lists one after another, cut by `NAME_start`.
    fn lists(&mut self, name: &str, lists: usize, count: usize) -> Result<Vec<Vec<u32>>, ResultsError> {
        let all = self.indices(name, count)?;
        let starts = self.indices(&format!("{name}_start"), all.len() + 1)?;
        self.length(&format!("{name}_start"), starts.len(), lists + 1)?;
        let slice = |w: &[u32]| all.get(w[0] as usize..w[1] as usize).map(<[u32]>::to_vec);
        let cut: Option<Vec<Vec<u32>>> = starts.windows(2).map(slice).collect();
        cut.ok_or_else(|| self.broken(format!("array {name}_start does not ascend")))
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
        let mut inside = BitGrid::empty(dims)?;
        index.iter().for_each(|&v| inside.set(v, true));
        if !inside.ones().eq(index.iter().copied()) {
            return Err(self.broken("array voxel_index is not in the order of a grid, x fastest".into()));
        }
        Ok(VoxelGrid::solid(Frame::placed(dims, &grid.affine)?, inside)?)
    }

    fn tree(&mut self, number: usize, elements: usize) -> Result<TreeArrays, ResultsError> {
        let name = |array: &str| format!("tree{number}_{array}");
        let parents = self.take(&name("parent"), integers)?;
        let altitudes = self.take(&name("altitude"), numbers)?;
        let volumes = self.take(&name("volume"), numbers)?;
        let entry = self.take(&name("entry"), integers)?;
        if let Some(node) = entry.iter().find(|&&node| node >= parents.len() as i64) {
            return Err(self.broken(format!(
                "array {} names node {node}, beyond {}",
                name("entry"),
                parents.len()
            )));
        }
        let entry: Vec<u32> = entry.into_iter().map(|n| u32::try_from(n).unwrap_or(u32::MAX)).collect();
        self.length(&name("altitude"), altitudes.len(), parents.len())?;
        self.length(&name("volume"), volumes.len(), parents.len())?;
        self.length(&name("entry"), entry.len(), elements)?;
        let parents = parents.into_iter().map(|p| u32::try_from(p).unwrap_or(u32::MAX)).collect();
        Ok(TreeArrays { parents, altitudes, volumes, entry })
    }
}

pub(crate) fn integers(values: &NpyValues<'_>) -> Option<Vec<i64>> {
    match values {
        NpyValues::I32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        NpyValues::U32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        NpyValues::I64(v) => Some(v.to_vec()),
        _ => None,
    }
}

pub(crate) fn numbers(values: &NpyValues<'_>) -> Option<Vec<f64>> {
    match values {
        NpyValues::F64(v) => Some(v.to_vec()),
        NpyValues::F32(v) => Some(v.iter().map(|&x| x.into()).collect()),
        _ => None,
    }
}
