use mser3d_shape::{Bytes, InvalidParameter};

/// Why there is no spectrum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SpectralError {
    /// A parameter out of its range.
    #[error(transparent)]
    InvalidParameter(#[from] InvalidParameter),
    /// More eigenpairs than the operator has.
    #[error(
        "{requested} eigenpairs asked of an operator that has only {available}; ask for fewer, or use a finer grid"
    )]
    TooManyEigenpairs {
        /// How many were asked for.
        requested: usize,
        /// Rows that take part.
        available: usize,
    },
    /// The work would not fit into memory.
    #[error(
        "{work} of {rows} rows need about {}, more than the limit of {}; \
         ask for fewer eigenpairs, use a coarser grid or raise the memory limit",
        Bytes(*needed), Bytes(*limit)
    )]
    TooMuchMemory {
        /// What would take so much: "100 eigenpairs".
        work: String,
        /// Rows of the operator.
        rows: usize,
        /// Estimate, in bytes.
        needed: u64,
        /// Limit, in bytes.
        limit: u64,
    },
    /// The iteration ended before all eigenpairs reached the tolerance.
    #[error(
        "{converged} of {wanted} eigenpairs converged in {restarts} restarts (worst relative residual {residual:.1e}, \
         wanted {tolerance:.1e}); allow more iterations, loosen the tolerance or ask for fewer eigenpairs"
    )]
    NotConverged {
        /// Eigenpairs that reached the tolerance.
        converged: usize,
        /// Eigenpairs asked for.
        wanted: usize,
        /// Restarts done.
        restarts: usize,
        /// The largest relative residual.
        residual: f64,
        /// The tolerance.
        tolerance: f64,
    },
    /// The operator has a negative eigenvalue.
    #[error(
        "the operator has a negative eigenvalue ({eigenvalue:.3e} or less), but must be positive semidefinite; \
         remesh a mesh with slivers, or add a multiple of the mass to a stiffness of your own"
    )]
    Indefinite {
        /// The smallest eigenvalue is this or less, in length^-2.
        eigenvalue: f64,
    },
    /// The factorization broke down: a pivot was too small, or memory ran out.
    #[error(
        "the factorization broke down at shift {shift:.3e}: memory ran out, or rounding errors grew too large \
         (is the mesh full of slivers? remesh it)"
    )]
    NotFactored {
        /// The shift that was subtracted.
        shift: f64,
    },
    /// A dense eigenproblem inside the iteration failed, or its result is not finite: only entries that
    /// overflow cause it.
    #[error("the eigenproblem overflows; rescale the shape so that its size is nearer to 1")]
    Overflow,
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
