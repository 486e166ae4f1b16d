use crate::budget::Budget;
use crate::error::Fault;
use crate::vtk::{legacy, xml};
use crate::write::check_length;
use crate::{MeshFormat, MeshIoError, gltf, gmsh, gzip, medit, obj, off, ply, stl};
use mser3d_fileio::{ReadLimits, read_bytes_within};
use mser3d_shape::{InvalidParameter, TriangleMesh};
use std::path::Path;

/// What to read of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The glTF animation that poses the figure, by name or by number from 0; `None` for the pose
    /// that the file's nodes are in.
    pub animation: Option<String>,
    /// When in the animation, in seconds. Before the first key the figure holds still; a time after the last one is an error.
    /// Zero without an animation.
    pub time: f64,
    /// What reading may take, and where a file may lead.
    pub limits: ReadLimits,
}

impl ReadOptions {
    /// Checks the time, which needs an animation.
    ///
    /// # Errors
    /// [`MeshIoError::InvalidParameter`] for a time that is negative, not finite, or given without an
    /// animation.
    pub fn validate(&self) -> Result<(), MeshIoError> {
        if !(self.time.is_finite() && self.time >= 0.0) {
            return Err(InvalidParameter::new("time", self.time, "a number of seconds >= 0").into());
        }
        let fits = self.time == 0.0 || self.animation.is_some();
        let expected = "0 seconds without an animation; choose an animation too";
        Ok(InvalidParameter::unless(fits, "time", self.time, expected)?)
    }
}

/// A mesh and how it came out of its file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LoadedMesh {
    /// The mesh. Vertex i is the i-th vertex of the file, used by a face or not, but for glTF and STL.
    pub mesh: TriangleMesh,
    /// The file's format.
    pub format: MeshFormat,
    /// The mesh vertex of each vertex of the file, in formats that list a vertex once per triangle
    /// or primitive (glTF, STL): equal positions are one mesh vertex, numbered by first occurrence.
    /// `None` where the file's vertices are the mesh's.
    pub weld: Option<Vec<u32>>,
    /// Faces of more than three corners, which were cut into triangles.
    pub polygons: usize,
    /// What a user should know: faces that were left out, parts that were not read.
    pub notes: Vec<String>,
}

impl LoadedMesh {
    /// Values per mesh vertex as values per vertex of the file.
    ///
    /// # Errors
    /// [`MeshIoError::Shape`] when there is not one value for each mesh vertex.
    pub fn per_file_vertex<T: Clone>(&self, values: &[T]) -> Result<Vec<T>, MeshIoError> {
        check_length("vertex values", values.len(), self.mesh.vertices().len())?;
        Ok(match &self.weld {
            Some(weld) => weld.iter().map(|&v| values[v as usize].clone()).collect(),
            None => values.to_vec(),
        })
    }
}

/// What a parser makes of a file.
#[derive(Default)]
pub(crate) struct Parsed {
    pub vertices: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    pub weld: Option<Vec<u32>>,
    pub polygons: usize,
    pub notes: Vec<String>,
}

/// Reads the mesh of a file, in the format that its extension names and its contents confirm.
///
/// Cost: one pass over the file, which is held in memory; memory beyond that is proportional to the
/// file, whatever counts it declares. What may take more than the limits allow is refused before.
///
/// # Errors
/// Every [`MeshIoError`] but that of a refused write.
pub fn read_mesh(path: &Path, options: &ReadOptions) -> Result<LoadedMesh, MeshIoError> {
    let bytes = read_bytes_within(path, &options.limits, 1)?;
    read_mesh_from(MeshFormat::of(path, &bytes)?, &bytes, path, options)
}

/// Reads the mesh of a file's bytes. Buffers that a glTF file names are sought beside `path`, which
/// otherwise only serves messages. Bytes packed by gzip are unpacked.
///
/// # Errors
/// Every [`MeshIoError`] but that of a refused write.
pub fn read_mesh_from(
    format: MeshFormat,
    bytes: &[u8],
    path: &Path,
    options: &ReadOptions,
) -> Result<LoadedMesh, MeshIoError> {
    options.validate()?;
    let fault = |fault: Fault| fault.in_file(path);
    let budget = Budget::new(&options.limits);
    let bytes = &gzip::unpack(bytes, &budget).map_err(fault)?[..];
    if bytes.trim_ascii().is_empty() {
        return Err(fault(Fault::new("the file is empty; export or copy it again")));
    }
    if let (Some(wanted), false) = (&options.animation, matches!(format, MeshFormat::Gltf | MeshFormat::Glb))
    {
        let (path, wanted) = (path.to_path_buf(), wanted.clone());
        return Err(MeshIoError::NoAnimation { path, wanted, available: Vec::new() });
    }
    let text =
        !matches!(format, MeshFormat::Glb | MeshFormat::Stl) || !stl::is_binary(bytes, bytes.len() as u64);
    if text && (bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff")) {
        return Err(fault(Fault::unsupported(None, "the text is in UTF-16; save it in ASCII or UTF-8")));
    }
    let length = bytes.len() as u64;
    let parsing = length.saturating_mul(format.memory_per_byte());
    budget.take(parsing, || format!("it has {length} bytes")).map_err(fault)?;
    let parsed = match format {
        MeshFormat::Obj => obj::parse(bytes).map_err(fault)?,
        MeshFormat::Off => off::parse(bytes).map_err(fault)?,
        MeshFormat::Ply => ply::parse(bytes).map_err(fault)?,
        MeshFormat::Stl => stl::parse(bytes).map_err(fault)?,
        MeshFormat::Vtu => xml::parse(bytes, xml::DataSet::UnstructuredGrid, &budget).map_err(fault)?,
        MeshFormat::Vtp => xml::parse(bytes, xml::DataSet::PolyData, &budget).map_err(fault)?,
        MeshFormat::Vtk => legacy::parse(bytes).map_err(fault)?,
        MeshFormat::Msh => gmsh::parse(bytes).map_err(fault)?,
        MeshFormat::Medit => medit::parse(bytes).map_err(fault)?,
        MeshFormat::Gltf | MeshFormat::Glb => gltf::parse(format, bytes, path, options, &budget)?,
    };
    let Parsed { vertices, triangles, weld, polygons, notes } = parsed;
    // Where vertices come with their triangles, it is the triangles that are missing.
    if vertices.is_empty() && weld.is_none() {
        return Err(fault(Fault::new("the file has no vertices; export the mesh again")));
    }
    if triangles.is_empty() {
        return Err(fault(Fault::new(
            "the file has no faces (a point cloud or curves?); a surface of triangles or polygons is needed",
        )));
    }
    let mesh = TriangleMesh::new(vertices, triangles).map_err(|e| fault(Fault::new(e.to_string())))?;
    Ok(LoadedMesh { mesh, format, weld, polygons, notes })
}

/// A note about things that were counted, if there were any.
pub(crate) fn note(count: usize, what: &str) -> Option<String> {
    (count > 0).then(|| format!("{count} {what}"))
}
