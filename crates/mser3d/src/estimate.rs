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
/// The spectrum decides: 16 n^(4/3) k^(2/3) stencil updates of 0.5 ns, 20 n k^2 flops of 0.03 ns, and memory
/// for 2.5 k vectors and some. Within a factor of two of what was measured on a processor of 2025, from
/// 45 thousand to a million voxels.
pub fn estimate(elements: usize, eigenpairs: usize) -> Estimate {
    let (n, k) = (elements as f64, eigenpairs as f64);
    let updates = 16.0 * n.powf(4.0 / 3.0) * k.powf(2.0 / 3.0);
    let flops = 20.0 * n * k * k;
    Estimate {
        memory: (n * (8.0 * (2.6 * k + 60.0) + 200.0)) as u64,
        seconds: 0.2 + 0.5e-9 * updates + 0.03e-9 * flops,
    }
}
