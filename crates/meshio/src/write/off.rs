use crate::MeshIoError;
use mser3d_fileio::write_atomically;
use mser3d_shape::TriangleMesh;
use std::io::Write;
use std::path::Path;

/// Writes a mesh as OFF: every vertex in its order, coordinates with as many digits as make them
/// exact.
///
/// # Errors
/// [`MeshIoError::File`].
pub fn write_off(path: &Path, mesh: &TriangleMesh) -> Result<(), MeshIoError> {
    write_atomically(path, |out| {
        writeln!(out, "OFF\n{} {} 0", mesh.vertices().len(), mesh.triangles().len())?;
        for [x, y, z] in mesh.vertices() {
            writeln!(out, "{x:?} {y:?} {z:?}")?;
        }
        mesh.triangles().iter().try_for_each(|[a, b, c]| writeln!(out, "3 {a} {b} {c}"))
    })?;
    Ok(())
}
