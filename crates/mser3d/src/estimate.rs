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
/// The spectrum decides: about 200 n^(4/3) k^(2/3) stencil updates of 0.4 ns and 40 n k^2 flops of
/// 0.05 ns, and memory for 2.6 k vectors. Good to a factor of two on a processor of the 2020s.
pub fn estimate(elements: usize, eigenpairs: usize) -> Estimate {
    let (n, k) = (elements as f64, eigenpairs as f64);
    let updates = 200.0 * n.powf(4.0 / 3.0) * k.powf(2.0 / 3.0);
    let flops = 40.0 * n * k * k;
    Estimate {
        memory: (n * (8.0 * (2.6 * k + 60.0) + 200.0)) as u64,
        seconds: 0.1 + 0.4e-9 * updates + 0.05e-9 * flops,
    }
}
