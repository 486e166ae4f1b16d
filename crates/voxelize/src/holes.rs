//! The winding number of open bodies: an integer that columns give, less that of the caps.

use crate::bvh::WindingTree;
use crate::coverage::UNCLEAR;
use crate::lattice::Lattice;
use crate::surface::Surface;
use mser3d_shape::BoundingBox;
use rayon::prelude::*;

/// Where the caps of open bodies matter, and what they add.
///
/// A body and its caps form a closed chain of integer winding number n, so the body alone has
/// `w = n - w(caps)`, exactly. The caps are few, and only near holes can they move w across 1/2: all
/// over a block of voxels where a bound certifies |w(caps)| < 1/2 - `UNCLEAR`, n decides.
pub(crate) struct HoleField {
    trees: Vec<(u32, f64, WindingTree)>,
    blocks: [usize; 3],
    marked: Vec<bool>,
}

/// Voxels along the edge of a block.
pub(crate) const BLOCK: usize = 8;

impl HoleField {
    /// `None` when every body is closed.
    pub fn new(surface: &Surface, lattice: &Lattice) -> Option<Self> {
        if surface.closed() {
            return None;
        }
        let mut corners = vec![Vec::new(); surface.bodies.len()];
        for t in 0..surface.triangles.len() {
            let body = surface.body_of(t);
            let info = &surface.bodies[body];
            if !info.closed && info.scattered == (t < surface.caps) {
                corners[body].push(surface.corners(t));
            }
        }
        let trees: Vec<(u32, f64, WindingTree)> = corners
            .into_iter()
            .enumerate()
            .filter(|(_, c)| !c.is_empty())
            .map(|(b, c)| {
                let sign = if surface.bodies[b].scattered { 1.0 } else { -1.0 };
                (b as u32, sign, WindingTree::over(c))
            })
            .collect();
        let blocks = lattice.dims.map(|n| n.div_ceil(BLOCK));
        let bound = 0.5 - UNCLEAR;
        let marked = (0..blocks.iter().product())
            .into_par_iter()
            .map(|i: usize| {
                let block = [i % blocks[0], i / blocks[0] % blocks[1], i / blocks[0] / blocks[1]];
                let target = BoundingBox {
                    min: std::array::from_fn(|a| lattice.centres[a][block[a] * BLOCK]),
                    max: std::array::from_fn(|a| {
                        lattice.centres[a][(block[a] * BLOCK + BLOCK - 1).min(lattice.dims[a] - 1)]
                    }),
                };
                !trees.iter().all(|(_, _, tree)| tree.is_below(bound / trees.len() as f64, &target))
            })
            .collect();
        Some(Self { trees, blocks, marked })
    }

    /// Whether the caps may matter at a voxel.
    #[inline]
    pub fn is_marked(&self, voxel: [usize; 3]) -> bool {
        let [i, j, k] = voxel.map(|x| x / BLOCK);
        self.marked[(k * self.blocks[1] + j) * self.blocks[0] + i]
    }

    /// What to add to the integer winding number of each open body at a point.
    pub fn corrections(&self, point: [f64; 3]) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.trees.iter().map(move |(body, sign, tree)| (*body, sign * tree.winding_number(point)))
    }
}
