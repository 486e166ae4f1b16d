//! Conjugate gradients with the diagonal as preconditioner, for the symmetric positive definite systems of this crate.

use crate::LaplaceError;

/// The residual, relative to the right-hand side, at which a solution is taken. Both are measured by the preconditioner.
/// (What is symmetric stays so at every step, whatever the residual.)
const TOLERANCE: f64 = 1e-9;

/// The residual that is taken when the iteration stops getting better: triangles as thin as rounding allows.
const ENOUGH: f64 = 1e-6;

/// Steps after which an iteration is given up.
const STEPS: usize = 20_000;

/// Solves `A x = b`, from the `x` that is given. `apply` sets its second argument to A times the first; the diagonal of
/// A is positive. Sums have a fixed order.
pub(crate) fn solve(
    apply: impl Fn(&[f64], &mut [f64]),
    diagonal: &[f64],
    b: &[f64],
    x: &mut [f64],
) -> Result<(), LaplaceError> {
    let n = b.len();
    let preconditioned = |r: &[f64]| -> Vec<f64> { r.iter().zip(diagonal).map(|(r, d)| r / d).collect() };
    let wanted = dot(b, &preconditioned(b));
    if wanted == 0.0 {
        x.fill(0.0);
        return Ok(());
    }
    if !wanted.is_finite() {
        return Err(LaplaceError::NotSolved { residual: f64::INFINITY });
    }
    let mut image = vec![0.0; n];
    apply(x, &mut image);
    let mut residual: Vec<f64> = b.iter().zip(&image).map(|(b, a)| b - a).collect();
    let mut z = preconditioned(&residual);
    let mut direction = z.clone();
    let mut square = dot(&residual, &z);
    for _ in 0..STEPS {
        if square <= TOLERANCE * TOLERANCE * wanted {
            return Ok(());
        }
        apply(&direction, &mut image);
        let curvature = dot(&direction, &image);
        if !(curvature > 0.0 && curvature.is_finite()) {
            break;
        }
        let step = square / curvature;
        for i in 0..n {
            x[i] += step * direction[i];
            residual[i] -= step * image[i];
            z[i] = residual[i] / diagonal[i];
        }
        let next = dot(&residual, &z);
        let turn = next / square;
        direction.iter_mut().zip(&z).for_each(|(d, z)| *d = z + turn * *d);
        square = next;
    }
    let relative = (square / wanted).sqrt();
    if relative <= ENOUGH { Ok(()) } else { Err(LaplaceError::NotSolved { residual: relative }) }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
