//! Missing pieces of surface.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use mser3d_shape::vector::{norm, sub};
use mser3d_shape::{Graph, TriangleMesh};

use super::random::Random;
use super::transformed::Transformed;
use crate::EvaluationError;

/// `count` discs of a radius along the surface removed, about random places.
pub(super) fn holes(
    null: &TriangleMesh,
    count: usize,
    radius: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let graph = null.edge_graph();
    let places = SurfaceSampler::new(null);
    let mut gone = vec![false; null.vertices().len()];
    for _ in 0..count {
        let centre = places.vertex(random);
        for v in disc(null, &graph, centre, radius) {
            gone[v as usize] = true;
        }
    }
    Transformed::kept(null, |t| null.triangles()[t].iter().any(|&v| !gone[v as usize]))
}

/// The triangles around this share of the vertices removed.
pub(super) fn microholes(
    null: &TriangleMesh,
    share: f64,
    random: &mut Random,
) -> Result<Transformed, EvaluationError> {
    let gone: Vec<bool> = null.vertices().iter().map(|_| random.uniform() < share).collect();
    Transformed::kept(null, |t| !null.triangles()[t].iter().any(|&v| gone[v as usize]))
}

/// Random places on a surface, evenly by area, however unevenly it is triangulated.
pub(super) struct SurfaceSampler<'m> {
    mesh: &'m TriangleMesh,
    /// Area up to and with each triangle.
    areas: Vec<f64>,
}

impl<'m> SurfaceSampler<'m> {
    pub fn new(mesh: &'m TriangleMesh) -> Self {
        let sum = |so_far: &mut f64, t: usize| {
            *so_far += mesh.triangle_area(t);
            Some(*so_far)
        };
        Self { mesh, areas: (0..mesh.triangles().len()).scan(0.0, sum).collect() }
    }

    /// A corner of a random triangle.
    pub fn vertex(&self, random: &mut Random) -> u32 {
        let at = random.uniform() * self.areas.last().copied().unwrap_or(0.0);
        let triangle = self.areas.partition_point(|a| *a <= at).min(self.areas.len() - 1);
        self.mesh.triangles()[triangle][random.below(3)]
    }
}

/// The vertices within a radius along the edges.
pub(super) fn disc(mesh: &TriangleMesh, graph: &Graph, centre: u32, radius: f64) -> Vec<u32> {
    let mut queue = BinaryHeap::from([Reverse((0f64.to_bits(), centre))]);
    let mut reached = std::collections::BTreeSet::new();
    while let Some(Reverse((bits, at))) = queue.pop() {
        if !reached.insert(at) {
            continue;
        }
        for &next in graph.neighbours(at) {
            let edge = norm(sub(mesh.vertices()[at as usize], mesh.vertices()[next as usize]));
            let way = f64::from_bits(bits) + edge;
            if way <= radius && !reached.contains(&next) {
                queue.push(Reverse((way.to_bits(), next)));
            }
        }
    }
    reached.into_iter().collect()
}
