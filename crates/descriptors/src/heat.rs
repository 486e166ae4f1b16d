//! The heat kernel `H_t(u,v) = sum_i exp(-lambda_i t) phi_i(u) phi_i(v)` on vertices and edges (section 4.3).

use crate::{DescriptorError, TimeScale, spectral_sums, vertex_subset::VertexSubset};
use mser3d_shape::EigenbasisView;
use pulp::Arch;
use rayon::prelude::*;

/// The auto-diffusivity H_t(v,v) of every vertex: how much heat is still at v a time t after a unit of heat
/// was put there. High on protrusions, low where the shape is thick.
///
/// `t` in length^2 ([`TimeScale`] makes it); values in length^-3 in a volume, length^-2 on a surface.
/// n values. Cost: n times the number of modes with `exp(-lambda t) >= 1e-18`.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`] unless t is positive and finite, [`DescriptorError::EmptyBasis`].
pub fn auto_diffusivity<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    t: f64,
) -> Result<Vec<f64>, DescriptorError> {
    let basis = basis.into();
    let decay = decay(basis, t)?;
    Ok(spectral_sums::weighted_squares(basis, 0, &decay))
}

/// The [`auto_diffusivity`] at several times, in one pass over the eigenfunctions.
///
/// # Errors
/// As [`auto_diffusivity`].
pub fn auto_diffusivities<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    times: &[f64],
) -> Result<Vec<Vec<f64>>, DescriptorError> {
    let basis = basis.into();
    let rows = at_times(basis, times, VertexSubset::all(basis))?;
    let of_time = |time: usize| rows.iter().skip(time).step_by(times.len()).copied().collect();
    Ok((0..times.len()).into_par_iter().map(of_time).collect())
}

/// A row for each of some vertices: H_t(v,v) at each time.
pub(crate) fn at_times(
    basis: EigenbasisView<'_>,
    times: &[f64],
    vertices: VertexSubset<'_>,
) -> Result<Vec<f64>, DescriptorError> {
    let decays: Vec<Vec<f64>> = times.iter().map(|&t| decay(basis, t)).collect::<Result<_, _>>()?;
    let modes = decays.iter().map(Vec::len).max().unwrap_or(0);
    Ok(spectral_sums::for_each_row(
        basis,
        vertices,
        0..modes,
        times.len(),
        #[inline(always)]
        |phi, samples| {
            for (sample, decay) in samples.iter_mut().zip(&decays) {
                *sample = spectral_sums::sum(decay, |i| phi[i] * phi[i]);
            }
        },
    ))
}

/// The heat kernel H_t(u,v) on each edge, in the order of the edges.
///
/// With fewer than all eigenpairs it can come out zero or negative where u and v are far apart on the scale
/// of t: read such a value as "no heat gets there".
///
/// # Errors
/// [`DescriptorError::InvalidParameter`] unless t is positive and finite, [`DescriptorError::EmptyBasis`],
/// [`DescriptorError::IndexOutOfRange`].
pub fn heat_kernel<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    t: f64,
    edges: &[[u32; 2]],
) -> Result<Vec<f64>, DescriptorError> {
    let basis = basis.into();
    let decay = decay(basis, t)?;
    over_edges(
        basis,
        edges,
        &decay,
        #[inline(always)]
        |u, v| u * v,
    )
}

/// The paper's edge weight 1/H_t(u,v): low where heat passes easily.
///
/// A truncated heat kernel that is not positive means "least connected", so its weight is `+inf`, which
/// sorts last; a plain reciprocal would sort it first. Errors as for [`heat_kernel`].
pub fn inverse_heat_kernel<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    t: f64,
    edges: &[[u32; 2]],
) -> Result<Vec<f64>, DescriptorError> {
    let mut weights = heat_kernel(basis, t, edges)?;
    for h in &mut weights {
        *h = if *h > 0.0 { 1.0 / *h } else { f64::INFINITY };
    }
    Ok(weights)
}

/// The diffusion distance on each edge,
/// `d_t(u,v) = |H_t(u,.) - H_t(v,.)| = sqrt(sum_i exp(-2 lambda_i t) (phi_i(u) - phi_i(v))^2)`
/// (Coifman & Lafon 2006), in length^(-3/2) in a volume, length^-1 on a surface.
///
/// Errors as for [`heat_kernel`].
pub fn diffusion_distance<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    t: f64,
    edges: &[[u32; 2]],
) -> Result<Vec<f64>, DescriptorError> {
    let basis = basis.into();
    let decay = decay(basis, 2.0 * t)?;
    let mut values = over_edges(
        basis,
        edges,
        &decay,
        #[inline(always)]
        |u, v| (u - v) * (u - v),
    )?;
    values.iter_mut().for_each(|d| *d = d.sqrt());
    Ok(values)
}

/// The heat trace `sum_i exp(-lambda_i t)`, which is the integral of H_t(v,v) over the shape.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`] unless t is positive and finite, [`DescriptorError::EmptyBasis`].
pub fn heat_trace<'a>(basis: impl Into<EigenbasisView<'a>>, t: f64) -> Result<f64, DescriptorError> {
    Ok(decay(basis.into(), t)?.iter().sum())
}

/// `exp(-lambda_i t)` of the modes that count at time t, which are the first ones.
pub(crate) fn decay(basis: EigenbasisView<'_>, t: f64) -> Result<Vec<f64>, DescriptorError> {
    let t = TimeScale::Absolute(t).on(basis)?;
    spectral_sums::check(basis)?;
    let values = basis.eigenvalues();
    Ok(values[..spectral_sums::live_modes(values, t)].iter().map(|l| (-l * t).exp()).collect())
}

/// `sum_i decay_i term(phi_i(u), phi_i(v))` of each edge.
fn over_edges(
    basis: EigenbasisView<'_>,
    edges: &[[u32; 2]],
    decay: &[f64],
    term: impl Fn(f64, f64) -> f64 + Sync,
) -> Result<Vec<f64>, DescriptorError> {
    let vertices = basis.len();
    let stray = edges.iter().enumerate().find_map(|(number, edge)| {
        edge.iter().find(|&&v| v as usize >= vertices).map(|&index| (number, index))
    });
    if let Some((number, index)) = stray {
        return Err(DescriptorError::IndexOutOfRange { element: "edge", number, index, vertices });
    }
    const EDGES: usize = 1024;
    let arch = Arch::new();
    let mut values = vec![0.0; edges.len()];
    values.par_chunks_mut(EDGES).zip(edges.par_chunks(EDGES)).for_each(|(values, edges)| {
        let (mut at_u, mut at_v) = (Vec::new(), Vec::new());
        arch.dispatch(
            #[inline(always)]
            || {
                for (value, &[u, v]) in values.iter_mut().zip(edges) {
                    let u = basis.row(u as usize, 0..decay.len(), &mut at_u);
                    let v = basis.row(v as usize, 0..decay.len(), &mut at_v);
                    *value = spectral_sums::sum(decay, |i| term(u[i], v[i]));
                }
            },
        );
    });
    Ok(values)
}
