//! How to tell inside from outside: the tests, and which of them suits a mesh.

use crate::mesh_analysis::MeshAnalysis;
use std::fmt;

mser3d_shape::choice! {
    /// How to tell inside from outside.
    pub enum InsideTest("inside test") {
        /// What the mesh needs, as its diagnosis says
        ///
        /// See [`diagnose`](crate::diagnose).
        #[default]
        Auto = "auto",
        /// Crossings of rays along x, counted modulo 2: closed meshes only
        ///
        /// Needs no orientation. Every hole leaks a line of voxels, and bodies that overlap cancel.
        Parity = "parity",
        /// The same along x, y and z, and the majority
        Vote = "vote",
        /// The winding number: for open and overlapping meshes too
        ///
        /// Neighbouring triangles are given one orientation first. An exact integer on closed surfaces, the
        /// generalized winding number (Jacobson et al. 2013) where there are holes.
        Winding = "winding",
    }
}

/// Why an inside test was used. [`Display`](fmt::Display) makes a sentence of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub enum Reason {
    /// The user asked for it.
    Forced,
    /// The surface is closed and consistently oriented: winding numbers are integers, exact by
    /// counting crossings with their sign.
    Closed,
    /// The surface is closed, and consistently oriented after some triangles were turned over to agree with
    /// their neighbours.
    ClosedAfterTurning {
        /// Triangles turned over.
        turned: usize,
    },
    /// The surface has holes: the generalized winding number closes them.
    Open {
        /// Edges with one triangle.
        boundary_edges: usize,
        /// Triangles turned over to agree with their neighbours.
        turned: usize,
    },
    /// Parts of the surface have no consistent orientation, but every edge has an even number of triangles.
    OneSided {
        /// Components without orientation.
        components: usize,
    },
    /// Parts have no consistent orientation, and there are holes: the majority of three axes.
    OneSidedAndOpen {
        /// Components without orientation.
        components: usize,
        /// Edges with one triangle.
        boundary_edges: usize,
    },
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Forced => f.write_str("asked for"),
            Self::Closed => f.write_str("closed and consistently oriented: exact winding numbers"),
            Self::ClosedAfterTurning { turned } => {
                write!(f, "closed, and consistently oriented once {turned} triangles are turned over")
            }
            Self::Open { boundary_edges, turned: 0 } => {
                write!(f, "{boundary_edges} boundary edges: the winding number closes the holes")
            }
            Self::Open { boundary_edges, turned } => write!(
                f,
                "{boundary_edges} boundary edges and {turned} triangles to turn over: the winding number \
                 closes the holes"
            ),
            Self::OneSided { components } => {
                write!(f, "{components} components without a consistent orientation, but no holes: parity")
            }
            Self::OneSidedAndOpen { components, boundary_edges } => write!(
                f,
                "{components} components without a consistent orientation and {boundary_edges} boundary \
                 edges: parity along three axes, the majority decides"
            ),
        }
    }
}

/// The inside test for a mesh; never [`InsideTest::Auto`].
pub(crate) fn choose(asked: InsideTest, analysis: &MeshAnalysis) -> (InsideTest, Reason) {
    if asked != InsideTest::Auto {
        return (asked, Reason::Forced);
    }
    let counts = &analysis.counts;
    let (boundary_edges, turned) = (counts.boundary, analysis.turned);
    match (analysis.one_sided, counts.odd, counts.unbalanced) {
        (0, _, 0) if turned == 0 => (InsideTest::Winding, Reason::Closed),
        (0, _, 0) => (InsideTest::Winding, Reason::ClosedAfterTurning { turned }),
        (0, _, _) => (InsideTest::Winding, Reason::Open { boundary_edges, turned }),
        (components, 0, _) => (InsideTest::Parity, Reason::OneSided { components }),
        (components, _, _) => (InsideTest::Vote, Reason::OneSidedAndOpen { components, boundary_edges }),
    }
}
