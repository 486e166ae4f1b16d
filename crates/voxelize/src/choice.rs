//! Which method suits a mesh, and why.

use crate::analysis::Analysis;
use crate::parameters::Method;
use std::fmt;

/// Why a voxelization method was used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// The user asked for it.
    Forced,
    /// The surface is closed and consistently oriented: winding numbers are integers, exact by
    /// counting crossings with their sign.
    Closed,
    /// It is so after some triangles were turned over to agree with their neighbours.
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

/// The method for a mesh; never [`Method::Auto`].
pub(crate) fn choose(asked: Method, analysis: &Analysis) -> (Method, Reason) {
    if asked != Method::Auto {
        return (asked, Reason::Forced);
    }
    let counts = &analysis.counts;
    let (boundary_edges, turned) = (counts.boundary, analysis.turned);
    match (analysis.one_sided, counts.odd, counts.unbalanced) {
        (0, _, 0) if turned == 0 => (Method::Winding, Reason::Closed),
        (0, _, 0) => (Method::Winding, Reason::ClosedAfterTurning { turned }),
        (0, _, _) => (Method::Winding, Reason::Open { boundary_edges, turned }),
        (components, 0, _) => (Method::Parity, Reason::OneSided { components }),
        (components, _, _) => (Method::Vote, Reason::OneSidedAndOpen { components, boundary_edges }),
    }
}
