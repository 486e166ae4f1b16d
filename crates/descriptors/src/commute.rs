//! Commute time (eq. 6) and other powers of the eigenvalues.
use crate::{DescriptorError, spectral_sums};
use mser3d_shape::{Domain, EigenbasisView};

/// An eigenvalue counts as zero when it is at most this, in units of `1 / Eigenbasis::unit_time`.
///
/// Solvers return the zero eigenvalues as rounding noise, about 1e-11 in these units; the smallest true one
/// of a dumbbell whose two halves touch in a single voxel of a million is about 1e-2, that of a rod a
/// thousand times longer than thick about 1e-3.
pub const ZERO_EIGENVALUE: f64 = 1e-8;

/// How many eigenvalues are zero: one for each component of the shape.
pub fn zero_modes<'a>(basis: impl Into<EigenbasisView<'a>>) -> usize {
    let basis = basis.into();
    let bound = ZERO_EIGENVALUE / basis.unit_time();
    basis.eigenvalues().partition_point(|&l| l <= bound)
}

/// The commute-time weight of every vertex (eq. 6), which needs no time scale:
/// `sum_i lambda_i^(-3/2) phi_i(v)^2` in a volume (no unit: the same on a scaled copy),
/// `sum_i lambda_i^(-1/2) phi_i(v)^2` on a surface (length^-1).
///
/// The zero modes, one per component, are dropped: see [`zero_modes`]. n values; cost n k.
///
/// # Errors
/// [`DescriptorError::EmptyBasis`], [`DescriptorError::OnlyZeroModes`].
pub fn commute_time<'a>(basis: impl Into<EigenbasisView<'a>>) -> Result<Vec<f64>, DescriptorError> {
    let basis = basis.into();
    power_diffusivity(
        basis,
        match basis.domain() {
            Domain::Volume => -1.5,
            Domain::Surface => -0.5,
        },
    )
}

/// `sum_i lambda_i^p phi_i(v)^2` over the non-zero modes, for each vertex.
///
/// It does not change with the shape's scale when p is minus half the dimension (-3/2 in a volume, -1 on a
/// surface); p = -1 is the integral of H_t(v,v) over all times, without the constant mode.
///
/// # Errors
/// [`DescriptorError::EmptyBasis`], [`DescriptorError::OnlyZeroModes`], [`DescriptorError::InvalidParameter`]
/// when p is not finite.
pub fn power_diffusivity<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    p: f64,
) -> Result<Vec<f64>, DescriptorError> {
    let basis = basis.into();
    if !p.is_finite() {
        return Err(DescriptorError::parameter("the exponent of the eigenvalues", p, "finite"));
    }
    spectral_sums::check(basis)?;
    let (values, first) = (basis.eigenvalues(), zero_modes(basis));
    if first == values.len() {
        return Err(DescriptorError::OnlyZeroModes { eigenpairs: first });
    }
    let weights: Vec<f64> = values[first..].iter().map(|l| l.powf(p)).collect();
    Ok(spectral_sums::weighted_squares(basis, first, &weights))
}
