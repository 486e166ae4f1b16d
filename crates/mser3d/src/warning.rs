use std::fmt;

use mser3d_shape::Domain;

/// What the user of a result should know of its input and how it was read.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// What the voxelizer found.
    Voxelize(mser3d_voxelize::Warning),
    /// Components were left out, because another is larger or they are too small.
    SmallerComponents {
        /// How many.
        components: usize,
        /// Voxels in them, or vertices of a surface.
        elements: usize,
        /// The part of the whole volume or area.
        fraction: f64,
        /// Those that are bodies, which [`Bodies::All`](crate::Bodies::All) would search: the voxels of each, the
        /// most first.
        bodies: Vec<usize>,
        /// Whether they are voxels or vertices.
        domain: Domain,
    },
    /// Vertices of a surface at equal positions were read as one.
    MergedVertices {
        /// How many repeat the position of another.
        vertices: usize,
    },
    /// The shape, or a body of it, falls into parts that heat does not pass between.
    Apart {
        /// How many parts, as far as the eigenpairs tell.
        parts: usize,
    },
    /// The reliability of regions was not measured.
    Unmeasured {
        /// Since the weight is a field, which deformed copies don't have; otherwise since they would take long.
        of_field: bool,
    },
    /// Regions hold no vertex of the mesh, which is coarser than they are.
    BetweenVertices {
        /// How many.
        regions: usize,
    },
    /// The shape, or the smallest of its bodies, is so small that it has fewer eigenpairs than are wanted.
    FewEigenpairs {
        /// How many are wanted.
        wanted: usize,
        /// How many it has.
        available: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Voxelize(warning) => warning.fmt(f),
            Self::SmallerComponents { components, elements, fraction, bodies, domain } => {
                let count = |n: usize, one: &'static str, more: &'static str| {
                    format!("{n} {}", if n == 1 { one } else { more })
                };
                let size = |n: usize| match domain {
                    Domain::Volume => count(n, "voxel", "voxels"),
                    Domain::Surface => count(n, "vertex", "vertices"),
                };
                let (what, were) = match (*components == bodies.len(), components) {
                    (true, 1) => ("body", "was"),
                    (true, _) => ("bodies", "were"),
                    (false, 1) => ("component", "was"),
                    (false, _) => ("components", "were"),
                };
                let percent = 100.0 * fraction;
                write!(
                    f,
                    "{components} smaller {what} with {} ({percent:.2} %) {were} dropped",
                    size(*elements)
                )?;
                let Some(&largest) = bodies.first() else { return Ok(()) };
                if *components > 1 {
                    let among = count(bodies.len(), "body", "bodies");
                    write!(f, ", among them {among} of up to {}", size(largest))?;
                }
                f.write_str("; --bodies all searches each body on its own, --bodies join all together")
            }
            Self::MergedVertices { vertices } => {
                write!(f, "{vertices} vertices repeat the position of another and were read as one with it")
            }
            Self::Apart { parts } => write!(
                f,
                "heat does not pass between {parts} parts of the shape, so that small ones are regions as a whole; \
                 --bodies largest or all searches bodies on their own"
            ),
            Self::Unmeasured { of_field: true } => {
                write!(
                    f,
                    "the reliability of regions is not known: deformed copies don't have the field of values"
                )
            }
            Self::Unmeasured { of_field: false } => write!(
                f,
                "the reliability of regions was not measured, since deformed copies of so large a shape would take \
                 long; --reliability 6 measures it"
            ),
            Self::BetweenVertices { regions } => {
                let (hold, are) =
                    if *regions == 1 { ("region holds", "it is") } else { ("regions hold", "they are") };
                write!(
                    f,
                    "{regions} {hold} no vertex of so coarse a mesh; {are} in the voxels only (--write fine-surface \
                     shows them on the surface)"
                )
            }
            Self::FewEigenpairs { wanted, available } => write!(
                f,
                "there are only {available} eigenpairs in so small a shape, not {wanted}; its descriptors compare \
                 only with those of shapes with --eigenpairs {available}"
            ),
        }
    }
}
