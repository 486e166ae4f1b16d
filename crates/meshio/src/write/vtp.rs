use super::VertexAttributes;
use super::vtk::{Appended, FLOAT64, INT32, INT64, UINT8, VtkFile};
use crate::MeshIoError;
use mser3d_fileio::write_atomically;
use mser3d_shape::TriangleMesh;
use std::path::Path;

/// Writes a mesh as VTK's PolyData (`.vtp`), as ParaView opens it: every vertex in its order, the
/// triangles and, where given, point data `region`, `color` and `normal`.
///
/// # Errors
/// [`MeshIoError::File`], [`MeshIoError::Shape`] for attributes of another length.
pub fn write_vtp(path: &Path, mesh: &TriangleMesh, attributes: &VertexAttributes) -> Result<(), MeshIoError> {
    attributes.check(mesh)?;
    let (vertices, triangles) = (mesh.vertices(), mesh.triangles());
    let per_vertex = |kind, name, components| Appended {
        kind,
        name,
        components,
        rows: vertices.len() as u64,
        write: Box::new(|_| Ok(())),
    };
    let mut file = VtkFile::new("PolyData");
    file.line("<PolyData>");
    file.line(&format!(
        "<Piece NumberOfPoints=\"{}\" NumberOfPolys=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\">\n<PointData>",
        vertices.len(),
        triangles.len()
    ));
    if let Some(regions) = attributes.regions {
        file.array(Appended {
            write: Box::new(|out| regions.iter().try_for_each(|r| out.write_all(&r.to_le_bytes()))),
            ..per_vertex(INT32, "region", 1)
        });
    }
    if let Some(colors) = attributes.colors {
        file.array(Appended {
            write: Box::new(|out| out.write_all(colors.as_flattened())),
            ..per_vertex(UINT8, "color", 3)
        });
    }
    if let Some(normals) = attributes.normals {
        file.array(Appended {
            write: Box::new(|out| {
                normals.as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
            }),
            ..per_vertex(FLOAT64, "normal", 3)
        });
    }
    file.line("</PointData>\n<Points>");
    file.array(Appended {
        write: Box::new(|out| {
            vertices.as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
        }),
        ..per_vertex(FLOAT64, "points", 3)
    });
    file.line("</Points>\n<Polys>");
    let corners = triangles.as_flattened();
    file.array(Appended {
        kind: INT64,
        name: "connectivity",
        components: 1,
        rows: corners.len() as u64,
        write: Box::new(|out| corners.iter().try_for_each(|&v| out.write_all(&i64::from(v).to_le_bytes()))),
    });
    file.array(Appended {
        kind: INT64,
        name: "offsets",
        components: 1,
        rows: triangles.len() as u64,
        write: Box::new(|out| {
            (1..=triangles.len() as i64).try_for_each(|t| out.write_all(&(3 * t).to_le_bytes()))
        }),
    });
    file.line("</Polys>\n</Piece>");
    Ok(write_atomically(path, |out| file.write(out))?)
}
