//! A solid on a grid, and what its user should know about it.

use crate::fitted_spacing::NOTABLE_ERROR;
use crate::grid_topology::{GridTopology, thin_voxels};
use crate::inside_rule::InsideRule;
use crate::inside_test::{InsideTest, Reason};
use crate::mesh_analysis::MeshAnalysis;
use crate::parameters::{Pitch, VoxelizeParameters};
use crate::surface::Surface;
use crate::warning::Warning;
use mser3d_shape::VoxelGrid;

/// A solid on a grid, and how it came about.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Voxelization {
    /// The solid: voxels whose centre is inside, linked to their neighbours unless the surface runs between
    /// them.
    pub grid: VoxelGrid,
    /// The inside test used; never [`InsideTest::Auto`].
    pub inside: InsideTest,
    /// Why this test was used.
    pub reason: Reason,
    /// The fraction of the inside voxels about which there is no doubt: 1 on closed surfaces.
    pub confidence: f64,
    /// Voxels that may be inside or outside: on lines with an odd number of crossings, where the three
    /// axes disagree, or where the winding number is within 0.2 of 1/2 or 3/2.
    pub ambiguous_voxels: usize,
    /// Linked components that were dropped because another is larger.
    pub dropped_components: usize,
    /// Voxels in them.
    pub dropped_voxels: usize,
    /// Links between face neighbours inside that the surface cuts, before components were dropped.
    pub cut_links: usize,
    /// Volume of the mesh, in length^3: what its surface covers, parts that it covers twice counted twice. `None`
    /// where it has no volume of its own: with holes, or where crossings are counted.
    pub mesh_volume: Option<f64>,
    /// Volume that is covered more than once, in length^3.
    pub overlap_volume: f64,
    /// Normals of the mesh's vertices, of any length: outwards, as shells were turned for the inside test. Empty where
    /// crossings are counted.
    pub vertex_normals: Vec<[f64; 3]>,
    /// Components, tunnels and cavities of `grid` under face links.
    pub topology: GridTopology,
    /// What the user should know, the most important first.
    pub warnings: Vec<Warning>,
    /// The mesh's Euler characteristic, where the solid's is expected to be half of it.
    pub(crate) mesh_euler: Option<i64>,
}

impl Voxelization {
    /// The same with only some of the components: `grid` is a restriction of this one's. Counts of what was dropped,
    /// topology and warnings are then those of the smaller solid.
    pub fn keep(mut self, grid: VoxelGrid, dropped_components: usize) -> Self {
        let inside = self.grid.len() + self.dropped_voxels;
        self.dropped_components += dropped_components;
        self.dropped_voxels = inside - grid.len();
        self.topology = GridTopology::of(&grid);
        self.grid = grid;
        self.warnings.retain(|warning| !is_of_solid(warning));
        let more = warnings_of_solid(&self, inside);
        self.warnings.extend(more);
        self
    }
}

/// The fraction of thin voxels that is worth a warning.
const THIN: f64 = 0.01;

/// The fraction of dropped or doubly covered voxels that is worth a warning: a tenth of the smallest usual
/// region.
const NOTABLE: f64 = 1e-3;

/// What there is to say about a solid; `inside` counts its voxels before components were dropped.
pub(crate) fn warnings(
    analysis: &MeshAnalysis,
    surface: &Surface,
    result: &Voxelization,
    inside: usize,
    rule: InsideRule,
    parameters: &VoxelizeParameters,
) -> Vec<Warning> {
    let mut list = Vec::new();
    let frame = result.grid.frame();
    let (low, high) = (frame.locate(surface.bounds.min), frame.locate(surface.bounds.max));
    if (0..3).any(|a| low[a] < 0.5 || high[a] > frame.dims()[a] as f64 - 0.5) {
        list.push(Warning::Clipped);
    }
    let finest = frame.spacing().into_iter().fold(f64::INFINITY, f64::min);
    // A change of the solid that was asked for changes its volume.
    let whole = list.is_empty() && parameters.morphology.is_none();
    if let Some(mesh) = result.mesh_volume.filter(|mesh| whole && *mesh > 0.0) {
        // Where overlaps are parted, neither of two covers is among the voxels inside.
        let missing = if rule == (InsideRule::Total { join: false }) { 2.0 } else { 1.0 };
        let voxels = inside as f64 * frame.voxel_volume() + missing * result.overlap_volume;
        if (voxels / mesh - 1.0).abs() >= NOTABLE_ERROR {
            list.push(Warning::Volume { voxels, mesh, advice: finest / 2.0 });
        }
    }
    let [x, y, z] = frame.spacing();
    let given = parameters.frame.is_some() || matches!(parameters.pitch, Pitch::Spacing(_));
    if !given && (x != y || y != z) {
        list.push(Warning::Fitted { spacing: frame.spacing() });
    }
    let counts = &analysis.counts;
    if counts.boundary > 0 {
        list.push(Warning::Open { boundary_edges: counts.boundary });
    }
    if analysis.turned > 0 {
        list.push(Warning::Flipped { triangles: analysis.turned });
    }
    if surface.inverted > 0 {
        list.push(Warning::Inverted { bodies: surface.inverted });
    }
    if !analysis.duplicates.is_empty() {
        let (triangles, dropped) = (analysis.duplicates.len(), analysis.dropped_duplicates);
        list.push(Warning::Duplicates { triangles, dropped });
    }
    if counts.non_manifold > 0 {
        list.push(Warning::NonManifold { edges: counts.non_manifold });
    }
    if analysis.welded {
        list.push(Warning::Merged);
    }
    let fraction = result.overlap_volume / (inside as f64 * frame.voxel_volume());
    if fraction > NOTABLE {
        list.push(Warning::Overlap { fraction });
    }
    list.extend(warnings_of_solid(result, inside));
    list
}

/// Whether a warning is one of [`warnings_of_solid`].
fn is_of_solid(warning: &Warning) -> bool {
    use Warning::{Ambiguous, Dropped, Thin, Topology};
    matches!(warning, Dropped { .. } | Ambiguous { .. } | Topology { .. } | Thin { .. })
}

/// What there is to say about the voxels that were kept, after all that concerns the mesh.
fn warnings_of_solid(result: &Voxelization, inside: usize) -> Vec<Warning> {
    let mut list = Vec::new();
    let fraction = result.dropped_voxels as f64 / inside as f64;
    if fraction > NOTABLE {
        let (components, voxels) = (result.dropped_components, result.dropped_voxels);
        list.push(Warning::Dropped { components, voxels, fraction });
    }
    if result.ambiguous_voxels > 0 {
        list.push(Warning::Ambiguous { voxels: result.ambiguous_voxels });
    }
    if let Some(mesh) = result.mesh_euler.filter(|&mesh| mesh != 2 * result.topology.euler_characteristic) {
        list.push(Warning::Topology { solid: result.topology.euler_characteristic, mesh });
    }
    let voxels = thin_voxels(&result.grid);
    let fraction = voxels as f64 / result.grid.len().max(1) as f64;
    if fraction > THIN {
        let finest = result.grid.frame().spacing().into_iter().fold(f64::INFINITY, f64::min);
        list.push(Warning::Thin { voxels, fraction, advice: finest / 2.0 });
    }
    list
}
