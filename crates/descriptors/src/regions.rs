//! Descriptors of regions (eq. 11), and their means of eigenfunctions.
use std::borrow::Cow;

use crate::{DescriptorError, Descriptors, spectral_sums};
use mser3d_shape::Eigenbasis;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// The descriptors of regions (eq. 11): the volume-weighted mean of the descriptors of their vertices,
/// `sum_v m_v d(v) / sum_v m_v`.
///
/// `mass` holds the volume or area of each vertex, n values; a region lists its vertices, each once.
/// `describe` computes descriptors of the vertices it is given, one a row. It is called with some thousand at a time,
/// at least once, and all in all with those that lie in a region, in ascending order. So a vertex of several regions is
/// computed once, a vertex outside all regions never, and no table of all is made. What `describe` fails with ends the work.
///
/// Sums go by ascending vertices, in whatever order a region lists them.
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
pub fn region_descriptors<R: AsRef<[u32]> + Sync, E: From<DescriptorError>>(
    regions: &[R],
    mass: &[f64],
    mut describe: impl FnMut(&[u32]) -> Result<Descriptors, E>,
) -> Result<Descriptors, E> {
    let mut covered = vec![false; mass.len()];
    for (number, region) in regions.iter().enumerate() {
        for &index in region.as_ref() {
            let Some(covered) = covered.get_mut(index as usize) else {
                let vertices = mass.len();
                return Err(
                    DescriptorError::IndexOutOfRange { element: "region", number, index, vertices }.into()
                );
            };
            *covered = true;
        }
    }
    let members: Vec<Cow<[u32]>> = regions.iter().map(|region| ascending(region.as_ref())).collect();
    let mut sums: Vec<Sum> = members.iter().map(|members| Sum::over(members)).collect();
    let mut vertices = (0u32..).zip(&covered).filter(|(_, covered)| **covered).map(|(vertex, _)| vertex);
    let mut block: Vec<u32> = vertices.by_ref().take(BLOCK).collect();
    let mut width = None;
    while width.is_none() || !block.is_empty() {
        let rows = describe(&block)?;
        let expected = (block.len(), width.unwrap_or(rows.width()));
        for (what, found, expected) in [
            ("descriptors of vertices", rows.len(), expected.0),
            ("numbers of a descriptor", rows.width(), expected.1),
        ] {
            if found != expected {
                return Err(DescriptorError::SizeMismatch { what, found, expected }.into());
            }
        }
        width = Some(rows.width());
        sums.par_iter_mut().for_each(|sum| sum.add(&block, &rows, mass));
        block.clear();
        block.extend(vertices.by_ref().take(BLOCK));
    }
    let means: Vec<Vec<f64>> =
        sums.into_iter().enumerate().map(|(region, sum)| sum.mean(region)).collect::<Result<_, _>>()?;
    Ok(Descriptors::new(width.unwrap_or(1), means.concat())?)
}

/// Vertices that are described at a time: some tens of milliseconds.
const BLOCK: usize = 1 << 14;

fn ascending(vertices: &[u32]) -> Cow<'_, [u32]> {
    if vertices.is_sorted() {
        return Cow::Borrowed(vertices);
    }
    let mut sorted = vertices.to_vec();
    sorted.sort_unstable();
    Cow::Owned(sorted)
}

/// A sum over the vertices of a region.
struct Sum<'r> {
    /// Those that are not in it yet.
    left: &'r [u32],
    mass: f64,
    values: Vec<f64>,
}

impl<'r> Sum<'r> {
    fn over(vertices: &'r [u32]) -> Self {
        Self { left: vertices, mass: 0.0, values: Vec::new() }
    }

    /// Adds those of a block, with a row for each of its vertices.
    fn add(&mut self, block: &[u32], rows: &Descriptors, mass: &[f64]) {
        self.values.resize(rows.width(), 0.0);
        let Some(last) = block.last() else { return };
        let (here, left) = self.left.split_at(self.left.partition_point(|vertex| vertex <= last));
        let mut row = 0;
        for &vertex in here {
            while block[row] != vertex {
                row += 1;
            }
            let m = mass[vertex as usize];
            self.mass += m;
            self.values.iter_mut().zip(rows.row(row)).for_each(|(sum, x)| *sum += m * x);
        }
        self.left = left;
    }

    fn mean(self, region: usize) -> Result<Vec<f64>, DescriptorError> {
        if !(self.mass > 0.0 && self.mass.is_finite()) {
            return Err(DescriptorError::EmptyRegion { region });
        }
        Ok(self.values.into_iter().map(|sum| sum / self.mass).collect())
    }
}

/// The mean of each eigenfunction over each region, weighted by volume: regions as vectors over the eigenfunctions.
///
/// Of a region without volume it is NaN.
pub fn region_means<R: AsRef<[u32]> + Sync>(basis: &Eigenbasis, regions: &[R]) -> Vec<Vec<f64>> {
    let arch = Arch::new();
    let mean = |region: &R| arch.dispatch(RegionMeans { basis, region: region.as_ref() });
    regions.par_iter().map(mean).collect()
}

/// The mean of each eigenfunction over a region, for the widest vectors.
struct RegionMeans<'a> {
    basis: &'a Eigenbasis,
    region: &'a [u32],
}

impl WithSimd for RegionMeans<'_> {
    type Output = Vec<f64>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<f64> {
        let modes = self.basis.eigenvalues().len();
        let (mut sums, mut total, mut scratch) = (vec![0.0; modes], 0.0, Vec::new());
        for &vertex in self.region {
            let m = self.basis.mass()[vertex as usize];
            total += m;
            let phi = self.basis.row(vertex as usize, 0..modes, &mut scratch);
            spectral_sums::add_multiple(&mut sums, m, phi);
        }
        sums.iter_mut().for_each(|sum| *sum /= total);
        sums
    }
}
