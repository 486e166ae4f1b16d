/// What a run will take, roughly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Peak memory in bytes.
    pub memory: u64,
    /// Seconds of work on one core.
    pub seconds: f64,
}

/// What [`crate::detect`] will take on `elements` voxels or vertices with `eigenpairs` eigenpairs.
///
/// The spectrum decides: 9.5 n^(4/3) k^(2/3) stencil updates of 0.4 ns, 0.5 n k^2 ns of orthogonalization, and memory for
/// 2.5 k vectors and some. Within a factor of two of what was measured on a processor of 2025, from
/// 45 thousand to a million voxels.
pub fn estimate(elements: usize, eigenpairs: usize) -> Estimate {
    let (n, k) = (elements as f64, eigenpairs as f64);
    let updates = 9.5 * n.powf(4.0 / 3.0) * k.powf(2.0 / 3.0);
    Estimate {
        memory: (n * (8.0 * (2.6 * k + 60.0) + 200.0)) as u64,
        seconds: 0.2 + 0.4e-9 * updates + 0.5e-9 * n * k * k,
    }
}
