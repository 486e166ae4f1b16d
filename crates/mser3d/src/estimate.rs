use crate::{Input, Parameters};

/// What a run will take, roughly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Estimate {
    /// Voxels or vertices.
    pub elements: usize,
    /// Eigenpairs.
    pub eigenpairs: usize,
    /// Peak memory in bytes.
    pub memory_bytes: u64,
    /// Seconds of work on one core.
    pub seconds: f64,
}

impl Estimate {
    /// What [`Detector::detect`](crate::Detector::detect) will take on so many voxels or vertices.
    ///
    /// The spectrum decides: 9.5 n^(4/3) k^(2/3) stencil updates of 0.4 ns, 0.5 n k^2 ns of orthogonalization, and memory
    /// for 2.5 k vectors and some. Within a factor of two of what was measured on a processor of 2025, from
    /// 45 thousand to a million voxels.
    pub fn new(elements: usize, eigenpairs: usize) -> Self {
        let (n, k) = (elements as f64, eigenpairs as f64);
        let updates = 9.5 * n.powf(4.0 / 3.0) * k.powf(2.0 / 3.0);
        Self {
            elements,
            eigenpairs,
            memory_bytes: (n * (8.0 * (2.6 * k + 60.0) + 200.0)) as u64,
            seconds: 0.2 + 0.4e-9 * updates + 0.5e-9 * n * k * k,
        }
    }
}

impl Parameters {
    /// What a run with these parameters will take on an input; nothing is computed.
    pub fn estimate(&self, input: &Input) -> Estimate {
        let elements = input.expected_elements(self.voxelize.pitch);
        Estimate::new(elements, self.spectrum.eigenpairs.about(input.domain()))
    }
}
