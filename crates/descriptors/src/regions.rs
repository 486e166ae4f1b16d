//! Descriptors of regions (eq. 11), and their means of eigenfunctions.
use crate::{DescriptorError, Descriptors, spectral_sums};
use mser3d_shape::Eigenbasis;
use pulp::Arch;
use rayon::prelude::*;

/// The descriptors of regions (eq. 11): the volume-weighted mean of the descriptors of their vertices,
/// `sum_v m_v d(v) / sum_v m_v`.
///
/// `mass` holds the volume or area of each vertex, n values; a region lists its vertices, each once.
/// `describe` computes descriptors of the vertices it is given, one a row. It is called once, with all
/// vertices that lie in a region, in ascending order. So a vertex of several regions is computed once, and
/// a vertex outside all regions never.
///
/// ```
/// use mser3d_descriptors::{SiHksParameters, region_descriptors, si_hks};
/// # use mser3d_shape::{Domain, Eigenbasis};
/// # let basis = Eigenbasis::new(Domain::Volume, vec![0.5; 2], vec![0.0, 4.0], vec![1., 1., 1., -1.])?;
/// let regions: Vec<Vec<u32>> = vec![vec![0, 1], vec![1]];
/// let params = SiHksParameters::default();
/// let rows = region_descriptors(&regions, basis.mass(), |vertices| si_hks(&basis, &params, Some(vertices)))?;
/// assert_eq!(rows.len(), 2);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`DescriptorError::IndexOutOfRange`], [`DescriptorError::EmptyRegion`] for a region of mass zero,
/// [`DescriptorError::SizeMismatch`] when `describe` returns another number of rows, and its own errors.
pub fn region_descriptors<R: AsRef<[u32]> + Sync>(
    regions: &[R],
    mass: &[f64],
    describe: impl FnOnce(&[u32]) -> Result<Descriptors, DescriptorError>,
) -> Result<Descriptors, DescriptorError> {
    const ABSENT: u32 = u32::MAX;
    let mut row_of = vec![ABSENT; mass.len()];
    for (number, region) in regions.iter().enumerate() {
        for &index in region.as_ref() {
            let Some(row) = row_of.get_mut(index as usize) else {
                let vertices = mass.len();
                return Err(DescriptorError::IndexOutOfRange { element: "region", number, index, vertices });
            };
            *row = 0;
        }
    }
    let mut vertices = Vec::new();
    for (vertex, row) in row_of.iter_mut().enumerate() {
        if *row != ABSENT {
            *row = vertices.len() as u32;
            vertices.push(vertex as u32);
        }
    }
    let rows = describe(&vertices)?;
    if rows.len() != vertices.len() {
        let (found, expected) = (rows.len(), vertices.len());
        return Err(DescriptorError::SizeMismatch { what: "descriptors of vertices", found, expected });
    }
    let mean = |(number, region): (usize, &R)| {
        let mut mean = vec![0.0; rows.width()];
        let mut total = 0.0;
        for &v in region.as_ref() {
            let m = mass[v as usize];
            total += m;
            for (sum, x) in mean.iter_mut().zip(rows.row(row_of[v as usize] as usize)) {
                *sum += m * x;
            }
        }
        if !(total > 0.0 && total.is_finite()) {
            return Err(DescriptorError::EmptyRegion { region: number });
        }
        mean.iter_mut().for_each(|sum| *sum /= total);
        Ok(mean)
    };
    let means: Vec<Vec<f64>> = regions.par_iter().enumerate().map(mean).collect::<Result<_, _>>()?;
    Descriptors::new(rows.width(), means.concat())
}

/// The mean of each eigenfunction over each region, weighted by volume: regions as vectors over the eigenfunctions.
///
/// Of a region without volume it is NaN.
pub fn region_means<R: AsRef<[u32]> + Sync>(basis: &Eigenbasis, regions: &[R]) -> Vec<Vec<f64>> {
    let arch = Arch::new();
    let mean = |region: &R| {
        let modes = basis.eigenvalues().len();
        let (mut sums, mut total, mut scratch) = (vec![0.0; modes], 0.0, Vec::new());
        arch.dispatch(
            #[inline(always)]
            || {
                for &vertex in region.as_ref() {
                    let m = basis.mass()[vertex as usize];
                    total += m;
                    let phi = basis.row(vertex as usize, 0..modes, &mut scratch);
                    spectral_sums::add_multiple(&mut sums, m, phi);
                }
            },
        );
        sums.iter_mut().for_each(|sum| *sum /= total);
        sums
    };
    regions.par_iter().map(mean).collect()
}
