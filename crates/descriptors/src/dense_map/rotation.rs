//! Which rotation carries the eigenfunctions of one shape to those of another.

use rayon::prelude::*;

/// Steps of the iteration. A singular value grows by half in each until it is near 1, so that those above 1e-10 of the
/// largest get there.
const STEPS: usize = 70;

/// The orthogonal matrix C (k x k) for which `from C` is nearest to `to`, in the sum of squares over the rows and their
/// partners: `maps` has that of each row of `from`, then that of each row of `to`.
pub(super) fn between(from: &[f64], to: &[f64], maps: &[Vec<u32>; 2], k: usize) -> Vec<f64> {
    let mut product = vec![0.0; k * k];
    let mut add = |from_row: usize, to_row: usize| {
        let (from, to) = (&from[from_row * k..][..k], &to[to_row * k..][..k]);
        for (sums, x) in product.chunks_exact_mut(k).zip(from) {
            sums.iter_mut().zip(to).for_each(|(sum, y)| *sum += x * y);
        }
    };
    maps[0].iter().enumerate().for_each(|(row, &partner)| add(row, partner as usize));
    maps[1].iter().enumerate().for_each(|(row, &partner)| add(partner as usize, row));
    nearest_rotation(product, k)
}

/// Rows times a matrix.
pub(super) fn apply(rows: &[f64], matrix: &[f64], k: usize) -> Vec<f64> {
    let of_row = |row: &[f64]| {
        let mut out = vec![0.0; k];
        for (x, matrix) in row.iter().zip(matrix.chunks_exact(k)) {
            out.iter_mut().zip(matrix).for_each(|(sum, y)| *sum += x * y);
        }
        out
    };
    rows.par_chunks_exact(k).flat_map_iter(of_row).collect()
}

/// The orthogonal factor U V' of U S V', by the iteration of Newton and Schulz, X (3 - X' X) / 2.
fn nearest_rotation(mut x: Vec<f64>, k: usize) -> Vec<f64> {
    let norm = x.iter().map(|v| v * v).sum::<f64>().sqrt();
    if norm <= 0.0 {
        return x;
    }
    x.iter_mut().for_each(|v| *v /= norm);
    for _ in 0..STEPS {
        let mut gram = vec![0.0; k * k];
        for row in x.chunks_exact(k) {
            for (sums, a) in gram.chunks_exact_mut(k).zip(row) {
                sums.iter_mut().zip(row).for_each(|(sum, b)| *sum -= 0.5 * a * b);
            }
        }
        (0..k).for_each(|i| gram[i * k + i] += 1.5);
        let next = apply(&x, &gram, k);
        let change = next.iter().zip(&x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        x = next;
        if change < 1e-12 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_with_a_reflection_is_found() {
        let (sin, cos) = 0.3f64.sin_cos();
        let turn = [cos, sin, sin, -cos];
        let rows = [1.0, 0.0, 0.0, 1e-3, 1.0, 2e-3];
        let turned = apply(&rows, &turn, 2);
        assert_eq!(turned[..2], [cos, sin]);
        let found = between(&rows, &turned, &[vec![0, 1, 2], vec![0, 1]], 2);
        assert!(found.iter().zip(&turn).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?}");
        assert_eq!(between(&[0.0; 2], &[0.0; 2], &[vec![0], vec![0]], 2), [0.0; 4]);
    }
}
