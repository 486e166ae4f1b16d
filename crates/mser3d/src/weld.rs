use std::collections::HashMap;

use mser3d_shape::{ShapeError, TriangleMesh};

/// The mesh with vertices at equal positions as one, numbered by first occurrence, and the welded vertex of each
/// vertex. -0.0 equals 0.0. Triangles stay, even those whose corners fall together: their edges still connect.
///
/// Files repeat vertices where texture or normals change, or for each triangle. As a surface such a mesh would fall
/// apart along its seams.
pub(crate) fn weld(mesh: &TriangleMesh) -> Result<(TriangleMesh, Vec<u32>), ShapeError> {
    let mut numbers: HashMap<[u64; 3], u32> = HashMap::with_capacity(mesh.vertices().len());
    let mut positions = Vec::new();
    let welded: Vec<u32> = mesh
        .vertices()
        .iter()
        .map(|&position| {
            *numbers.entry(position.map(|x| (x + 0.0).to_bits())).or_insert_with(|| {
                positions.push(position);
                positions.len() as u32 - 1
            })
        })
        .collect();
    if positions.len() == welded.len() {
        return Ok((mesh.clone(), welded));
    }
    let triangles = mesh.triangles().iter().map(|t| t.map(|v| welded[v as usize])).collect();
    Ok((TriangleMesh::new(positions, triangles)?, welded))
}
