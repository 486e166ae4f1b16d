use super::VertexAttributes;
use crate::MeshIoError;
use mser3d_fileio::write_atomically;
use mser3d_shape::TriangleMesh;
use std::io::Write;
use std::path::Path;

/// Writes a mesh as little-endian binary PLY: every vertex in its order with properties `x y z`
/// (double) and, where given, `nx ny nz` (float), `red green blue` (uchar) and `region` (int); then
/// the triangles.
///
/// # Errors
/// [`MeshIoError::File`], [`MeshIoError::Shape`] for attributes of another length.
pub fn write_ply(path: &Path, mesh: &TriangleMesh, attributes: &VertexAttributes) -> Result<(), MeshIoError> {
    attributes.check(mesh)?;
    write_atomically(path, |out| {
        writeln!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}", mesh.vertices().len())?;
        out.write_all(b"property double x\nproperty double y\nproperty double z\n")?;
        if attributes.normals.is_some() {
            out.write_all(b"property float nx\nproperty float ny\nproperty float nz\n")?;
        }
        if attributes.colors.is_some() {
            out.write_all(b"property uchar red\nproperty uchar green\nproperty uchar blue\n")?;
        }
        if attributes.regions.is_some() {
            out.write_all(b"property int region\n")?;
        }
        writeln!(out, "element face {}", mesh.triangles().len())?;
        out.write_all(b"property list uchar int vertex_indices\nend_header\n")?;
        for (v, position) in mesh.vertices().iter().enumerate() {
            position.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
            if let Some(normals) = attributes.normals {
                normals[v].iter().try_for_each(|&x| out.write_all(&(x as f32).to_le_bytes()))?;
            }
            if let Some(colors) = attributes.colors {
                out.write_all(&colors[v])?;
            }
            if let Some(regions) = attributes.regions {
                out.write_all(&regions[v].to_le_bytes())?;
            }
        }
        for triangle in mesh.triangles() {
            out.write_all(&[3])?;
            triangle.iter().try_for_each(|v| out.write_all(&v.to_le_bytes()))?;
        }
        Ok(())
    })?;
    Ok(())
}
