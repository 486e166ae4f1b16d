//! Pages of other things than the figure: of a very fine mesh, and of a volume of grey values.

use std::collections::HashMap;

use mser3d::shape::TriangleMesh;
use mser3d::shape::vector::{add, scale};
use mser3d_results::msv::{MsvResults, MsvSearchParameters};
use mser3d_results::{Results, Up};
use mser3d_volumeio::{Affine, Volume};

/// The same results on a mesh of at least so many vertices: each triangle is cut into four until there are enough, and a new
/// vertex is like an end of its edge.
pub fn refined(results: &Results, least: usize) -> Result<Results, String> {
    let mut fine = results.clone();
    while fine.mesh.vertices().len() < least {
        let mut points = fine.mesh.vertices().to_vec();
        let mut like: Vec<u32> = (0..points.len() as u32).collect();
        let mut middles = HashMap::new();
        let mut triangles = Vec::with_capacity(4 * fine.mesh.triangles().len());
        for &[a, b, c] in fine.mesh.triangles() {
            let [x, y, z] = [(a, b), (b, c), (c, a)].map(|(u, v)| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    points.push(scale(add(points[u as usize], points[v as usize]), 0.5));
                    like.push(u);
                    points.len() as u32 - 1
                })
            });
            triangles.extend([[a, x, z], [b, y, x], [c, z, y], [x, y, z]]);
        }
        let inside: Vec<Vec<bool>> =
            fine.region_vertices.iter().map(|r| marks(r, fine.mesh.vertices().len())).collect();
        let of = |labels: &[i32]| like.iter().map(|&v| labels[v as usize]).collect::<Vec<i32>>();
        (fine.vertex_voxel, fine.vertex_part) = (of(&fine.vertex_voxel), of(&fine.vertex_part));
        fine.region_vertices = inside
            .iter()
            .map(|inside| (0u32..).zip(&like).filter(|(_, l)| inside[**l as usize]).map(|(v, _)| v).collect())
            .collect();
        fine.mesh = TriangleMesh::new(points, triangles).map_err(|e| e.to_string())?;
    }
    Ok(fine)
}

fn marks(members: &[u32], count: usize) -> Vec<bool> {
    let mut marks = vec![false; count];
    members.iter().for_each(|&v| marks[v as usize] = true);
    marks
}

/// The page of a volume with a dark ball and a bright one.
pub fn volume() -> Result<String, String> {
    let dims = [48, 40, 32];
    let value = |v: usize| {
        let p = [v % 48, v / 48 % 40, v / (48 * 40)];
        let in_ball =
            |c: [usize; 3], r: usize| (0..3).map(|a| p[a].abs_diff(c[a]).pow(2)).sum::<usize>() < r * r;
        if in_ball([14, 20, 16], 8) {
            40u8
        } else if in_ball([34, 20, 16], 6) {
            220
        } else {
            // Not all alike, so that something is seen.
            120 + (p[0] % 8) as u8
        }
    };
    let values: Vec<u8> = (0..dims.iter().product()).map(value).collect();
    let volume = Volume::new(dims, 1, Affine::default(), values).map_err(|e| e.to_string())?;
    let found =
        MsvResults::find(&volume, "balls.nii", &MsvSearchParameters::default()).map_err(|e| e.to_string())?;
    found.page("Two balls", Up::Y, Some(&volume)).map_err(|e| e.to_string())
}
