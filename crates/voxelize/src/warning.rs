use crate::analysis::Analysis;
use crate::surface::Surface;
use crate::voxelization::Voxelization;
use std::fmt;

/// What the user of a voxelization should know.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// The mesh has holes.
    Open {
        /// Edges with one triangle.
        boundary_edges: usize,
    },
    /// Triangles were turned over to agree with their neighbours.
    Flipped {
        /// How many.
        triangles: usize,
    },
    /// Bodies that face inwards were read as facing outwards.
    Inverted {
        /// How many.
        bodies: usize,
    },
    /// Triangles that repeat another one's vertices.
    Duplicates {
        /// How many.
        triangles: usize,
        /// Whether they were left out.
        dropped: bool,
    },
    /// Edges with more than two triangles.
    NonManifold {
        /// How many.
        edges: usize,
    },
    /// Vertices were merged by position.
    Merged,
    /// Parts of the solid are covered more than once.
    Overlap {
        /// Volume covered more than once over the solid's.
        fraction: f64,
    },
    /// Components were dropped.
    Dropped {
        /// How many.
        components: usize,
        /// Voxels in them.
        voxels: usize,
        /// The part of all inside voxels.
        fraction: f64,
    },
    /// Some voxels could be called otherwise.
    Ambiguous {
        /// How many.
        voxels: usize,
    },
    /// The grid does not reach around the mesh.
    Clipped,
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open { boundary_edges } => {
                write!(f, "the mesh is open ({boundary_edges} boundary edges); the winding number closed it")
            }
            Self::Flipped { triangles } => {
                write!(f, "{triangles} triangles faced against their neighbours and were read turned over")
            }
            Self::Inverted { bodies } => {
                write!(f, "{bodies} bodies faced inwards and were read as facing outwards")
            }
            Self::Duplicates { triangles, dropped } => write!(
                f,
                "{triangles} triangles repeat others{}",
                if *dropped { " and were left out" } else { "" }
            ),
            Self::NonManifold { edges } => write!(f, "{edges} edges have more than two triangles"),
            Self::Merged => f.write_str("vertices at equal positions were read as one to close the surface"),
            Self::Overlap { fraction } => {
                write!(f, "{:.2} % of the solid is covered more than once", 100.0 * fraction)
            }
            Self::Dropped { components, voxels, fraction } => write!(
                f,
                "{components} smaller components with {voxels} voxels ({:.2} %) were dropped",
                100.0 * fraction
            ),
            Self::Ambiguous { voxels } => write!(f, "{voxels} voxels could be called otherwise"),
            Self::Clipped => f.write_str("the grid does not reach around the whole mesh"),
        }
    }
}

pub(crate) fn warnings(
    analysis: &Analysis,
    surface: &Surface,
    result: &Voxelization,
    inside: usize,
) -> Vec<Warning> {
    let mut list = Vec::new();
    let frame = result.grid.frame();
    let (low, high) = (frame.locate(surface.bounds.min), frame.locate(surface.bounds.max));
    if (0..3).any(|a| low[a] < 0.5 || high[a] > frame.dims()[a] as f64 - 0.5) {
        list.push(Warning::Clipped);
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
    if result.overlap_volume > 0.0 {
        let fraction = result.overlap_volume / (inside as f64 * frame.voxel_volume());
        list.push(Warning::Overlap { fraction });
    }
    if result.dropped_components > 0 {
        let fraction = result.dropped_voxels as f64 / inside as f64;
        let (components, voxels) = (result.dropped_components, result.dropped_voxels);
        list.push(Warning::Dropped { components, voxels, fraction });
    }
    if result.ambiguous_voxels > 0 {
        list.push(Warning::Ambiguous { voxels: result.ambiguous_voxels });
    }
    list
}
