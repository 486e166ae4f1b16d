//! The scale-invariant heat kernel signature (eq. 9; Bronstein & Kokkinos 2010).

mod log_slope;

use crate::{DescriptorError, Descriptors, spectral_sums, vertex_subset::VertexSubset};
use log_slope::{BLOCK, SlopeTable};
use mser3d_shape::{Domain, EigenbasisView};
use rayon::prelude::*;
use realfft::RealFftPlanner;

/// Parameters of [`si_hks`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SiHksParameters {
    /// Volumes are scaled to this volume before `t = 2^tau` is taken. Default 45,000, the paper's number of
    /// voxels, so that t is in squared voxels there; the descriptor doesn't depend on the voxel size.
    pub reference_volume: f64,
    /// Surfaces are scaled to this area. Default 14,000: the area of a human body of 45,000 units of
    /// volume (14,100 to 14,200 on a rigged model), so that t means the same length in both methods.
    pub reference_area: f64,
    /// Instead of both: what one unit of t is, in length^2. Give all poses of a shape the unit of one of
    /// them ([`SiHksParameters::unit`]), and a pose that loses a part keeps its scales. Default `None`.
    pub unit: Option<f64>,
    /// First tau, the base-2 logarithm of the first t. Default 1.
    pub tau_start: f64,
    /// End of the range of tau, exclusive. Default 25.
    pub tau_end: f64,
    /// Samples for each doubling of t. Default 16.
    pub samples_per_octave: usize,
    /// How many frequencies of the Fourier transform are kept, the constant one included. Default 6.
    pub frequencies: usize,
}

impl Default for SiHksParameters {
    fn default() -> Self {
        Self {
            reference_volume: 45_000.0,
            reference_area: 14_000.0,
            unit: None,
            tau_start: 1.0,
            tau_end: 25.0,
            samples_per_octave: 16,
            frequencies: 6,
        }
    }
}

/// More samples than this are a mistake.
const MAX_SAMPLES: f64 = 65_536.0;

impl SiHksParameters {
    /// Whether all values are in range.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        let positive = [
            ("reference_volume", Some(self.reference_volume)),
            ("reference_area", Some(self.reference_area)),
            ("unit", self.unit),
        ];
        for (name, value) in positive {
            if let Some(value) = value
                && !(value.is_finite() && value > 0.0)
            {
                return Err(DescriptorError::parameter(name, value, "positive and finite"));
            }
        }
        for (name, value) in [("tau_start", self.tau_start), ("tau_end", self.tau_end)] {
            if !(-256.0..=256.0).contains(&value) {
                return Err(DescriptorError::parameter(name, value, "between -256 and 256"));
            }
        }
        let samples = (self.tau_end - self.tau_start) * self.samples_per_octave as f64;
        if !(2.0..=MAX_SAMPLES).contains(&samples) {
            let name = "(tau_end - tau_start) * samples_per_octave";
            return Err(DescriptorError::parameter(name, samples, "between 2 and 65536"));
        }
        let most = self.samples() / 2 + 1;
        if !(1..=most).contains(&self.frequencies) {
            let requirement = "at least 1 and at most half the number of samples, plus one";
            return Err(DescriptorError::parameter("frequencies", self.frequencies, requirement));
        }
        Ok(())
    }

    /// Number of samples of tau, 384 by default.
    pub fn samples(&self) -> usize {
        ((self.tau_end - self.tau_start) * self.samples_per_octave as f64).ceil() as usize
    }

    /// One unit of t on this shape, in length^2: `(V / reference_volume)^(2/3)` for a volume V,
    /// `A / reference_area` for a surface of area A, or the given [`SiHksParameters::unit`].
    pub fn unit<'a>(&self, basis: impl Into<EigenbasisView<'a>>) -> f64 {
        let basis = basis.into();
        self.unit.unwrap_or_else(|| match basis.domain() {
            Domain::Volume => (basis.measure() / self.reference_volume).powf(2.0 / 3.0),
            Domain::Surface => basis.measure() / self.reference_area,
        })
    }
}

/// The scale-invariant heat kernel signature (Bronstein & Kokkinos 2010), SI-vHKS in a volume and SI-HKS on
/// a surface: a row of [`SiHksParameters::frequencies`] values for each vertex.
///
/// Scaling a shape by s turns `log H_t(v,v)` over `tau = log2 t` into a shifted copy plus a constant. So
/// take its derivative, here the analytic one (eq. 9)
/// `d/dtau log H = -ln 2 * t * sum_i lambda_i exp(-lambda_i t) phi_i(v)^2 / sum_i exp(-lambda_i t) phi_i(v)^2`,
/// which loses the constant, sample it at `t = 2^tau`, and keep the modulus of its discrete Fourier
/// transform, which loses the shift. The zero mode is part of the sums, so H never underflows. At a vertex
/// where all eigenfunctions vanish (of a component without a zero mode in the basis) the signature is zero.
///
/// `vertices` lists the vertices to compute, one a row; `None` means all.
///
/// **Limits.** Invariance holds up to the ends of the sampled range of tau and the truncation of the
/// spectrum (0.5 to 5 % for factors of 0.5 to 2, with 100 modes); scaling to the reference volume first takes
/// even that away for copies of a whole shape. The number of eigenpairs changes the signature (by 18 %
/// between 100 and 200): compare shapes with the same number only.
///
/// **Cost.** For each vertex, two multiplications and additions for each pair of mode and sample with
/// `exp(-lambda t) >= 1e-18`, and one FFT.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], [`DescriptorError::EmptyBasis`], [`DescriptorError::IndexOutOfRange`].
pub fn si_hks<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    params: &SiHksParameters,
    vertices: Option<&[u32]>,
) -> Result<Descriptors, DescriptorError> {
    signatures(basis.into(), params, vertices)
}

/// [`si_hks`] of a view. Compiled here once, with its transform, and not in each crate that calls it.
fn signatures(
    basis: EigenbasisView<'_>,
    params: &SiHksParameters,
    vertices: Option<&[u32]>,
) -> Result<Descriptors, DescriptorError> {
    params.validate()?;
    spectral_sums::check(basis)?;
    let subset = VertexSubset::new(basis.len(), vertices)?;
    let (unit, samples, frequencies) = (params.unit(basis), params.samples(), params.frequencies);
    let step = 1.0 / params.samples_per_octave as f64;
    let times = (0..samples).map(|j| unit * (params.tau_start + j as f64 * step).exp2());
    let table = SlopeTable::new(basis.eigenvalues(), &times.collect::<Vec<_>>());
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(samples);

    let mut values = vec![0.0; subset.len() * frequencies];
    values.par_chunks_mut(BLOCK * frequencies).enumerate().for_each_init(
        || (vec![0.0; BLOCK * samples], fft.make_output_vec(), fft.make_scratch_vec()),
        |(slopes, transform, scratch), (block, rows)| {
            let first = block * BLOCK;
            let count = rows.len() / frequencies;
            table.slopes(basis, (first..first + count).map(|row| subset.vertex(row)), slopes);
            for (slope, row) in slopes.chunks_exact_mut(samples).zip(rows.chunks_exact_mut(frequencies)) {
                fft.process_with_scratch(slope, transform, scratch)
                    .expect("buffers were made by this transform");
                for (value, bin) in row.iter_mut().zip(transform.iter()) {
                    *value = bin.norm();
                }
            }
        },
    );
    Descriptors::new(frequencies, values)
}
