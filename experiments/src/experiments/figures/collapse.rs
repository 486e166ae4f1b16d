//! A figure that collapses like cloth: its edges keep their lengths, its volume goes.

use std::error::Error;

use mser3d::shape::TriangleMesh;
use mser3d::shape::vector::{Vec3, cross, norm, sub};

/// How a collapse is computed.
#[derive(Clone, Copy, Debug)]
pub struct CollapseParameters {
    /// How far the surface is pushed in a step, as a share of the bounding box's diagonal.
    pub push: f64,
    /// Steps after which to give up.
    pub steps: usize,
    /// Sweeps over all edges after each step, each of which gives every edge its length once.
    pub sweeps: usize,
    /// Rounds in which pushes are averaged over neighbours, so that folds are wider than triangles.
    pub smoothing: usize,
}

impl Default for CollapseParameters {
    fn default() -> Self {
        Self { push: 2e-4, steps: 1000, sweeps: 60, smoothing: 10 }
    }
}

/// The mesh when its volume has fallen to each of these shares, which must fall too.
///
/// Front and back are pushed towards each other along z in small steps; after each the edges are given
/// their lengths again, one by one (position-based dynamics, Mueller et al. 2007, with rigid edges and no
/// inertia). The sides give way outwards, as those of an airbed do.
pub fn collapse(
    mesh: &TriangleMesh,
    shares: &[f64],
    parameters: &CollapseParameters,
) -> Result<Vec<TriangleMesh>, Box<dyn Error>> {
    let diagonal = mesh.bounding_box().ok_or("a mesh without vertices")?.diagonal();
    let graph = mesh.edge_graph();
    let edges: Vec<([usize; 2], f64)> = graph
        .edges()
        .map(|[a, b]| {
            ([a as usize, b as usize], norm(sub(mesh.vertices()[a as usize], mesh.vertices()[b as usize])))
        })
        .collect();
    let whole = mesh.signed_volume();
    let mut current = mesh.clone();
    let mut stages = Vec::new();
    for _ in 0..parameters.steps {
        let Some(share) = shares.get(stages.len()) else { break };
        if current.signed_volume() <= share * whole {
            stages.push(current.clone());
            continue;
        }
        let mut push: Vec<f64> = vertex_normals(&current).iter().map(|n| -n[2]).collect();
        for _ in 0..parameters.smoothing {
            push = (0..push.len())
                .map(|v| {
                    let around = graph.neighbours(v as u32);
                    let sum: f64 = around.iter().map(|&w| push[w as usize]).sum();
                    (push[v] + sum) / (1.0 + around.len() as f64)
                })
                .collect();
        }
        let step = parameters.push * diagonal;
        let mut places: Vec<Vec3> = current.vertices().to_vec();
        places.iter_mut().zip(&push).for_each(|(p, push)| p[2] += step * push);
        for sweep in 0..parameters.sweeps {
            // There and back, so that nothing drifts along the numbering.
            if sweep % 2 == 0 {
                edges.iter().for_each(|edge| restore(&mut places, edge));
            } else {
                edges.iter().rev().for_each(|edge| restore(&mut places, edge));
            }
        }
        current = mesh.with_vertices(places)?;
    }
    if stages.len() < shares.len() {
        let left = current.signed_volume() / whole;
        return Err(format!("after {} steps {left:.2} of the volume is left", parameters.steps).into());
    }
    Ok(stages)
}

/// Moves both ends of an edge until it has its length.
fn restore(places: &mut [Vec3], &([a, b], rest): &([usize; 2], f64)) {
    let along = sub(places[a], places[b]);
    let now = norm(along);
    if now > 0.0 {
        let move_by = 0.5 * (rest - now) / now;
        for axis in 0..3 {
            places[a][axis] += move_by * along[axis];
            places[b][axis] -= move_by * along[axis];
        }
    }
}

/// How much edges changed: the mean of |l' / l - 1| and the value that 95 % of the edges are below.
pub fn strain(before: &TriangleMesh, after: &TriangleMesh) -> (f64, f64) {
    let edge = |mesh: &TriangleMesh, [a, b]: [u32; 2]| {
        norm(sub(mesh.vertices()[a as usize], mesh.vertices()[b as usize]))
    };
    let graph = before.edge_graph();
    let mut changes: Vec<f64> =
        graph.edges().map(|e| (edge(after, e) / edge(before, e) - 1.0).abs()).collect();
    changes.sort_by(f64::total_cmp);
    let mean = changes.iter().sum::<f64>() / changes.len() as f64;
    (mean, changes[changes.len() * 95 / 100])
}

/// Unit normals, weighted by area; zero where there are no triangles.
fn vertex_normals(mesh: &TriangleMesh) -> Vec<Vec3> {
    let mut normals = vec![[0.0; 3]; mesh.vertices().len()];
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let [a, b, c] = mesh.corners(t);
        let n = cross(sub(b, a), sub(c, a));
        for &corner in triangle {
            (0..3).for_each(|i| normals[corner as usize][i] += n[i]);
        }
    }
    normals.iter().map(|n| n.map(|x| x / norm(*n).max(f64::MIN_POSITIVE))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_collapse_keeps_edges_and_area_and_loses_volume() {
        let figure = super::super::fixture_shapes::fixture("human_rest.off").unwrap();
        let stages = collapse(&figure, &[0.8], &CollapseParameters::default()).unwrap();
        let volume = stages[0].signed_volume() / figure.signed_volume();
        assert!((0.7..=0.8).contains(&volume), "{volume}");
        let (mean, most) = strain(&figure, &stages[0]);
        assert!(mean < 0.02 && most < 0.06, "{mean} {most}");
        assert!((stages[0].area() / figure.area() - 1.0).abs() < 0.03);
        assert!(collapse(&figure, &[-1.0], &CollapseParameters { steps: 3, ..Default::default() }).is_err());
    }
}
