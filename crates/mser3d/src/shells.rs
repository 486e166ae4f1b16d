//! Connected parts of a mesh.

use mser3d_shape::vector::{cross, dot, sub};
use mser3d_shape::{DisjointSets, TriangleMesh};

use crate::Error;
use crate::weld::weld;

/// The connected part of the mesh that each vertex lies on, and how many there are. Equal positions are connected.
pub(crate) fn shells(mesh: &TriangleMesh) -> Result<(Vec<u32>, usize), Error> {
    let (welded, number) = weld(mesh)?;
    let mut sets = DisjointSets::new(welded.vertices().len());
    for &[a, b, c] in welded.triangles() {
        sets.union(a, b);
        sets.union(b, c);
    }
    let shells = number.iter().map(|&v| sets.find(v)).collect();
    Ok((shells, welded.vertices().len()))
}

/// Shells beyond which nobody asks which of them meet: a soup of triangles.
const MANY_SHELLS: usize = 500;

/// The part of a mesh's volume that lies in its largest body, roughly: shells whose boxes meet are one body.
pub(crate) fn largest_share(mesh: &TriangleMesh) -> f64 {
    let Ok((shells, count)) = shells(mesh) else { return 1.0 };
    let mut number = vec![usize::MAX; count];
    let mut boxes: Vec<([f64; 3], [f64; 3])> = Vec::new();
    let mut volumes = Vec::new();
    let origin = mesh.vertices().first().copied().unwrap_or_default();
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let slot = &mut number[shells[triangle[0] as usize] as usize];
        if *slot == usize::MAX {
            *slot = boxes.len();
            boxes.push(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]));
            volumes.push(0.0);
        }
        let (low, high) = &mut boxes[*slot];
        let corners = mesh.corners(t);
        for corner in corners {
            (0..3).for_each(|a| (low[a], high[a]) = (low[a].min(corner[a]), high[a].max(corner[a])));
        }
        let [a, b, c] = corners.map(|p| sub(p, origin));
        volumes[*slot] += dot(a, cross(b, c)) / 6.0;
    }
    if boxes.len() > MANY_SHELLS {
        return 1.0;
    }
    let mut sets = DisjointSets::new(boxes.len());
    for (i, (low, high)) in boxes.iter().enumerate() {
        for (j, (other_low, other_high)) in boxes.iter().enumerate().skip(i + 1) {
            if (0..3).all(|a| low[a] <= other_high[a] && other_low[a] <= high[a]) {
                sets.union(i as u32, j as u32);
            }
        }
    }
    let mut bodies = vec![0.0f64; boxes.len()];
    for (shell, volume) in volumes.iter().enumerate() {
        bodies[sets.find(shell as u32) as usize] += volume;
    }
    let total: f64 = bodies.iter().map(|v| v.abs()).sum();
    let most = bodies.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if total > 0.0 { most / total } else { 1.0 }
}
