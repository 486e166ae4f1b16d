//! The best approximations of eigenvectors in the span of some vectors.

use faer::Mat;
use rayon::prelude::*;

use super::level::{ROWS, rows};
use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::row::{Block, LANES, Lanes, Row};
use crate::small_dense::{orthonormal_combinations, small_eigen};

/// Rayleigh and Ritz: makes the columns of x M-orthonormal approximations of eigenvectors in their own span, and returns their eigenvalues,
/// ascending. `image(x, y)` sets y = W x of a block and leaves x as it is. Without masses all are 1; with them the constant is taken out
/// first.
///
/// 4 flops for each row and pair of columns, and one more with masses.
pub(super) fn rayleigh_ritz<R: Row>(
    x: &mut BlockMatrix<R>,
    mass: Option<&[f32]>,
    work: &mut BlockMatrix<R>,
    mut image: impl FnMut(&mut Block<R>, &mut Block<R>),
) -> Result<Vec<f64>, SpectralError> {
    let blocks = x.blocks().len();
    let columns = blocks * LANES;
    if let Some(mass) = mass {
        x.blocks_mut().iter_mut().for_each(|block| take_out_mean(block, mass));
    }
    let mut energies = Mat::<f64>::zeros(columns, columns);
    let mut products = Mat::<f64>::zeros(columns, columns);
    let enter = |target: &mut Mat<f64>, block: usize, part: &Mat<f64>| {
        for i in 0..part.nrows() {
            for j in 0..LANES {
                target[(i, block * LANES + j)] = part[(i, j)];
                target[(block * LANES + j, i)] = part[(i, j)];
            }
        }
    };
    for block in 0..blocks {
        let mut own = std::mem::take(&mut x.blocks_mut()[block]);
        image(&mut own, &mut work.blocks_mut()[0]);
        x.blocks_mut()[block] = own;
        enter(&mut energies, block, &x.gram(0..block + 1, work));
        if let Some(mass) = mass {
            let own = &x.blocks()[block];
            rows(
                &mut work.blocks_mut()[0],
                #[inline(always)]
                |row, y| *y = R::narrow(Lanes(own[row].wide().0.map(|x| x * f64::from(mass[row])))),
            );
            enter(&mut products, block, &x.gram(0..block + 1, work));
        }
    }
    if mass.is_none() {
        let upper = x.upper_gram(blocks);
        products = Mat::from_fn(columns, columns, |i, j| upper[(i.min(j), i.max(j))]);
    }
    let basis = orthonormal_combinations(&products).filter(|basis| basis.ncols() == columns);
    let basis = basis.ok_or(SpectralError::Overflow)?;
    let (values, vectors) =
        small_eigen(&(basis.transpose() * &energies * &basis)).ok_or(SpectralError::Overflow)?;
    x.rotate((&basis * &vectors).as_ref());
    Ok(values)
}

/// Makes the columns of a block orthogonal to the constant.
fn take_out_mean<R: Row>(block: &mut Block<R>, mass: &[f32]) {
    let weight = |row: usize| f64::from(mass[row]);
    let part = |(chunk, block): (usize, &[R])| {
        let mut sums = [0.0; LANES + 1];
        pulp::Arch::new().dispatch(
            #[inline(always)]
            || {
                let (mut sum, mut weights) = ([0.0; LANES], 0.0);
                for (i, x) in block.iter().enumerate() {
                    let (weight, x) = (weight(chunk * ROWS + i), x.wide().0);
                    (0..LANES).for_each(|l| sum[l] += weight * x[l]);
                    weights += weight;
                }
                sums[..LANES].copy_from_slice(&sum);
                sums[LANES] = weights;
            },
        );
        sums
    };
    let parts: Vec<[f64; LANES + 1]> = block.par_chunks(ROWS).enumerate().map(part).collect();
    let sums = parts.iter().fold([0.0; LANES + 1], |sums, part| std::array::from_fn(|l| sums[l] + part[l]));
    let mean: [f64; LANES] = std::array::from_fn(|l| sums[l] / sums[LANES]);
    rows(
        block,
        #[inline(always)]
        |_, row| {
            let x = row.wide().0;
            *row = R::narrow(Lanes(std::array::from_fn(|l| x[l] - mean[l])));
        },
    );
}
