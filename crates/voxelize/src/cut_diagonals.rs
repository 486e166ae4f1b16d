//! Links to the 20 neighbours that share only an edge or a corner: cut by the rule of the face links, the
//! crossings of each segment found in a hierarchy of the triangles.

use crate::axis_sweep::Crossing;
use crate::bvh::Bvh;
use crate::inside_rule::RunningWinding;
use crate::placed_surface::PlacedSurface;
use crate::triangle_geometry::area_vector;
use mser3d_shape::vector::{Vec3, dot, sub};
use mser3d_shape::{DIAGONALS, VoxelGrid};
use rayon::prelude::*;

impl PlacedSurface<'_> {
    /// The pairs of diagonal neighbours that the surface parts. Cost: 10 short segments for each voxel.
    pub fn cut_diagonals(&self, grid: &VoxelGrid) -> Vec<[u32; 2]> {
        let bvh = &Bvh::over(self.surface.triangles.len(), |triangle| self.surface.corners(triangle));
        let voxels: Vec<[u32; 3]> = grid.voxels().collect();
        let voxels = &voxels;
        let around = |u: usize| {
            let steps = if u.is_multiple_of(256) && self.stop.now() { &[][..] } else { &DIAGONALS[..] };
            steps.iter().filter_map(move |step| {
                let other: [u32; 3] = std::array::from_fn(|a| voxels[u][a].wrapping_add_signed(step[a]));
                let v = grid.index(other)?;
                self.parted(bvh, voxels[u], other).then_some([u as u32, v])
            })
        };
        (0..grid.len()).into_par_iter().with_min_len(256).flat_map_iter(around).collect()
    }

    /// Whether the surface parts two voxels inside.
    fn parted(&self, bvh: &Bvh, from: [u32; 3], to: [u32; 3]) -> bool {
        let voxel = from.map(|x| x as usize);
        let (p, q) = (self.lattice.centre(voxel), self.lattice.centre(to.map(|x| x as usize)));
        let mut crossings = Vec::new();
        bvh.visit_crossings(p, q, |t, entering| {
            let crossing = Crossing::new(0, t, entering);
            if self.parts(crossing) {
                crossings.push(crossing);
            }
        });
        if crossings.len() < 2 || self.any_two_part() {
            return crossings.len() >= 2;
        }
        // The winding numbers at p, from far outside.
        let mut state = RunningWinding::new(self.surface, self.rule);
        let outside = [p[0].min(0.0) - 3.0 * self.surface.reach, p[1], p[2]];
        bvh.visit_crossings(outside, p, |t, entering| {
            let crossing = Crossing::new(0, t, entering);
            if self.counts(crossing) {
                state.cross(crossing);
            }
        });
        let passed = crossings.iter().map(|&c| (self.place(c, p, q), c)).collect();
        self.leaves_between(&state, voxel, passed)
    }

    /// Where the segment from p to q, about a voxel long, passes through a triangle.
    fn place(&self, crossing: Crossing, p: Vec3, q: Vec3) -> f64 {
        let corners = self.surface.corners(crossing.triangle());
        let normal = area_vector(&corners);
        dot(normal, sub(corners[0], p)) / dot(normal, sub(q, p))
    }
}
