use std::fmt;

use mser3d_shape::Readable;

/// What the user of a voxelization should know.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Parts of the solid are covered more than once, more than a few voxels of it.
    Overlap {
        /// Volume covered more than once, over the volume of the solid.
        fraction: f64,
    },
    /// Components were dropped, more than a few voxels of them.
    Dropped {
        /// How many.
        components: usize,
        /// Voxels in them.
        voxels: usize,
        /// Fraction of all inside voxels.
        fraction: f64,
    },
    /// Some voxels may be inside or outside.
    Ambiguous {
        /// How many.
        voxels: usize,
    },
    /// The solid's topology is not that of the mesh: parts fused or were lost. Mostly these are fingers or
    /// ears that are a voxel thick or a voxel apart, but they can be limbs.
    Topology {
        /// Euler characteristic of the solid.
        solid: i64,
        /// Euler characteristic of the mesh; that of the solid it bounds is half of it.
        mesh: i64,
    },
    /// Parts of the solid are thinner than two voxels.
    Thin {
        /// Voxels in no cube of 2 x 2 x 2 linked voxels.
        voxels: usize,
        /// Fraction of all voxels.
        fraction: f64,
        /// A finer pitch, in the mesh's units.
        advice: f64,
    },
    /// The grid does not reach around the mesh.
    Clipped,
    /// The voxels' volume is not that of the mesh, by 3 % or more.
    Volume {
        /// Volume of the voxels, in length^3: before components are dropped, what is covered twice counted
        /// twice, as the mesh's volume counts it.
        voxels: f64,
        /// Volume of the mesh, in length^3.
        mesh: f64,
        /// A finer pitch, in the mesh's units.
        advice: f64,
    },
    /// The voxels are no cubes, because cubes would give thin, flat parts a wrong volume.
    Fitted {
        /// Lengths of a voxel along x, y and z, in the mesh's units.
        spacing: [f64; 3],
    },
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
            Self::Topology { solid, mesh } => write!(
                f,
                "the voxels don't hang together quite as the mesh does (Euler characteristic {solid} instead \
                 of {}), as where fingers or ears meet; regions much larger than that stay the same, and a \
                 finer pitch helps the others",
                *mesh as f64 / 2.0
            ),
            Self::Thin { voxels, fraction, advice } => write!(
                f,
                "{voxels} voxels ({:.2} %) lie in parts thinner than two voxels; a pitch of {:.4} would \
                 resolve them better",
                100.0 * fraction,
                Readable(*advice)
            ),
            Self::Volume { voxels, mesh, advice } => write!(
                f,
                "the voxels' volume is {voxels:.4e}, {:.1} % {} than the mesh's {mesh:.4e}: thin parts are not a \
                 whole number of voxels thick; a pitch of {:.4} or turning the mesh off the axes helps",
                100.0 * (voxels / mesh - 1.0).abs(),
                if voxels > mesh { "more" } else { "less" },
                Readable(*advice)
            ),
            Self::Fitted { spacing: [x, y, z] } => write!(
                f,
                "the voxels measure {:.4} x {:.4} x {:.4} instead of being cubes, so that thin, flat parts are \
                 a whole number of voxels thick",
                Readable(*x),
                Readable(*y),
                Readable(*z)
            ),
            Self::Clipped => f.write_str("the grid does not reach around the whole mesh"),
        }
    }
}
