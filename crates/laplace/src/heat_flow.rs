//! Functions that heat smooths, and functions that are as smooth as their values elsewhere allow.

use crate::conjugate_gradients::solve;
use crate::{LaplaceError, Operator};

/// Steps of the implicit Euler method.
const STEPS: usize = 16;

/// What is left out of a series of Chebyshev polynomials.
const SMALLEST: f64 = 1e-11;

/// Most products with W for which a series of Chebyshev polynomials is worth while.
const MOST_PRODUCTS: usize = 2000;

impl Operator {
    /// A function after heat has flowed for a time `t` (length^2): `exp(-t M^-1 W) f`, n values from n.
    ///
    /// No eigenpairs are needed, so none is missing, however short the time. The exponential is a series of Chebyshev polynomials,
    /// exact to 1e-10 of the largest value. In a volume that takes about `15 sqrt(t) / h` products with W, for voxels of
    /// size h. Where it would take more than 2000, as on a surface with triangles very much smaller than others, it is sixteen steps of
    /// the implicit Euler method: a mode of eigenvalue lambda decays by `(1 + lambda t/16)^-16` in place of
    /// `exp(-lambda t)`, which differ by at most 0.017.
    ///
    /// The integral `sum_v m_v f(v)` stays what it is. In a volume, and on a surface whose cotangent weights are not
    /// negative, no value leaves the range of those given. Rows without mass keep their value.
    ///
    /// ```
    /// use mser3d_laplace::grid_laplacian;
    /// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
    ///
    /// let frame = Frame::new([2, 1, 1], [0.0; 3], [1.0; 3])?;
    /// let pair = grid_laplacian(&VoxelGrid::solid(frame, BitGrid::full([2, 1, 1])?)?);
    /// // The difference of two cells has the eigenvalue 2.
    /// let after = pair.heat_flow(&[1.0, 0.0], 0.5)?;
    /// assert!((after[0] + after[1] - 1.0).abs() < 1e-9);
    /// assert!((after[0] - after[1] - (-2.0 * 0.5f64).exp()).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`LaplaceError::WrongLength`]; [`LaplaceError::InvalidTime`] unless t is finite and not negative;
    /// [`LaplaceError::NotSolved`] where triangles are so thin that rounding errors take over.
    pub fn heat_flow(&self, values: &[f64], t: f64) -> Result<Vec<f64>, LaplaceError> {
        let n = self.len();
        if values.len() != n {
            return Err(LaplaceError::WrongLength { found: values.len(), expected: n });
        }
        if !(t.is_finite() && t >= 0.0) {
            return Err(LaplaceError::InvalidTime { time: t });
        }
        // Any mass will do where there is no stiffness.
        let mass: Vec<f64> = self.mass().iter().map(|&m| if m > 0.0 { m } else { 1.0 }).collect();
        // Constants don't change; without them errors are relative to what does.
        let mean = mean(&mass, values);
        let start: Vec<f64> = values.iter().map(|x| x - mean).collect();
        let bound = self.spectral_bound(&mass);
        let after = match chebyshev_coefficients(t * bound / 2.0) {
            Some(coefficients) => self.series(&mass, bound, &coefficients, start),
            None => self.implicit_steps(&mass, t / STEPS as f64, start)?,
        };
        if after.iter().any(|x| !x.is_finite()) {
            return Err(LaplaceError::NotSolved { residual: f64::INFINITY });
        }
        Ok(after.into_iter().map(|x| x + mean).collect())
    }

    /// An upper bound of the eigenvalues (Gershgorin), in length^-2; more than 0.
    fn spectral_bound(&self, mass: &[f64]) -> f64 {
        let row = |v: usize| -> f64 {
            self.stiffness().outer_view(v).iter().flat_map(|row| row.data()).map(|w| w.abs()).sum()
        };
        (0..self.len()).map(|v| row(v) / mass[v]).fold(f64::MIN_POSITIVE, f64::max)
    }

    /// `sum_k c_k T_k(2 M^-1 W / bound - 1) x`.
    fn series(&self, mass: &[f64], bound: f64, coefficients: &[f64], x: Vec<f64>) -> Vec<f64> {
        let shifted = |x: &[f64], v: usize| 2.0 / bound * self.row_times(v, x) / mass[v] - x[v];
        let mut sum: Vec<f64> = x.iter().map(|x| coefficients[0] * x).collect();
        let mut now: Vec<f64> = (0..x.len()).map(|v| shifted(&x, v)).collect();
        let mut before = x;
        for c in &coefficients[1..] {
            sum.iter_mut().zip(&now).for_each(|(sum, x)| *sum += c * x);
            for (v, before) in before.iter_mut().enumerate() {
                *before = 2.0 * shifted(&now, v) - *before;
            }
            std::mem::swap(&mut now, &mut before);
        }
        sum
    }

    /// `(M + step W)^-1 M`, sixteen times.
    fn implicit_steps(&self, mass: &[f64], step: f64, mut now: Vec<f64>) -> Result<Vec<f64>, LaplaceError> {
        let entry = |v: usize| self.stiffness().get(v, v).copied().unwrap_or(0.0);
        let diagonal: Vec<f64> = (0..now.len()).map(|v| mass[v] + step * entry(v)).collect();
        let apply = |x: &[f64], y: &mut [f64]| {
            for (v, y) in y.iter_mut().enumerate() {
                *y = mass[v] * x[v] + step * self.row_times(v, x);
            }
        };
        for _ in 0..STEPS {
            let b: Vec<f64> = now.iter().zip(mass).map(|(x, m)| x * m).collect();
            solve(apply, &diagonal, &b, &mut now)?;
        }
        Ok(now)
    }

    /// The harmonic function with these values where they are known: `(W f)(v) = 0` for all other v, that is, each other value is
    /// the weighted mean of its neighbours'. n values from n.
    ///
    /// In a volume no value leaves the range of those that are known. In a component where none is known, all values are
    /// the mean of those known elsewhere.
    ///
    /// # Errors
    /// [`LaplaceError::WrongLength`]; [`LaplaceError::NothingKnown`]; [`LaplaceError::NotSolved`].
    pub fn harmonic(&self, known: &[Option<f64>]) -> Result<Vec<f64>, LaplaceError> {
        let n = self.len();
        if known.len() != n {
            return Err(LaplaceError::WrongLength { found: known.len(), expected: n });
        }
        let given: Vec<f64> = known.iter().copied().flatten().collect();
        if given.is_empty() {
            return Err(LaplaceError::NothingKnown);
        }
        let mean = mean(&vec![1.0; given.len()], &given);
        let components = self.components();
        let mut reached = vec![false; components.len()];
        for (value, &label) in known.iter().zip(&components.labels) {
            reached[label as usize] |= value.is_some();
        }
        // Relative to the mean, which is what unreachable parts get.
        let fixed: Vec<Option<f64>> = (0..n)
            .map(|v| match known[v] {
                Some(value) => Some(value - mean),
                None => (!reached[components.labels[v] as usize]).then_some(0.0),
            })
            .collect();
        let mut b: Vec<f64> = fixed.iter().map(|value| value.unwrap_or(0.0)).collect();
        let free: Vec<bool> = fixed.iter().map(Option::is_none).collect();
        let pulls: Vec<f64> = (0..n).map(|v| if free[v] { -self.row_times(v, &b) } else { b[v] }).collect();
        let diagonal: Vec<f64> = (0..n)
            .map(|v| if free[v] { self.stiffness().get(v, v).copied().unwrap_or(0.0) } else { 1.0 })
            .map(|d| if d > 0.0 { d } else { 1.0 })
            .collect();
        // The known values are moved to the right-hand side, so that the matrix is symmetric.
        let apply = |x: &[f64], y: &mut [f64]| {
            for v in 0..n {
                y[v] = if free[v] { self.row_times_where(v, x, &free) } else { x[v] };
            }
        };
        solve(apply, &diagonal, &pulls, &mut b)?;
        Ok(b.iter().zip(known).map(|(x, known)| known.unwrap_or(x + mean)).collect())
    }

    /// A row of W times a vector.
    #[inline]
    fn row_times(&self, row: usize, x: &[f64]) -> f64 {
        let starts = self.stiffness().indptr();
        let range = starts.outer_inds_sz(row);
        let (columns, values) = (&self.stiffness().indices()[range.clone()], &self.stiffness().data()[range]);
        columns.iter().zip(values).map(|(&column, value)| value * x[column]).sum()
    }

    /// The same over some of the columns.
    fn row_times_where(&self, row: usize, x: &[f64], columns: &[bool]) -> f64 {
        let Some(row) = self.stiffness().outer_view(row) else { return 0.0 };
        row.iter().filter(|(column, _)| columns[*column]).map(|(column, value)| value * x[column]).sum()
    }
}

/// The mean of values with weights.
fn mean(weights: &[f64], values: &[f64]) -> f64 {
    let total: f64 = weights.iter().sum();
    weights.iter().zip(values).map(|(w, x)| w / total * x).sum()
}

/// The coefficients of `exp(-a (1 + x))` in Chebyshev polynomials, `(2 - [k = 0]) (-1)^k exp(-a) I_k(a)` with the modified
/// Bessel functions I_k; none if there are too many.
fn chebyshev_coefficients(a: f64) -> Option<Vec<f64>> {
    // I_k(a)/I_0(a) falls like exp(-k^2 / 2a), for small a faster.
    let count = (2.0 * a * -SMALLEST.ln()).sqrt().max(12.0) + 8.0;
    if count > MOST_PRODUCTS as f64 || a.is_nan() {
        return None;
    }
    let count = count.ceil() as usize;
    // Miller's recurrence, downwards from where they are next to nothing.
    let (mut after, mut now) = (0.0f64, 1e-300f64);
    let mut bessel = vec![0.0; count];
    let mut sum = 0.0;
    for k in (0..2 * count + 40).rev() {
        // now is I_(k + 1), after I_(k + 2).
        let next = after + 2.0 * (k + 1) as f64 / a.max(1e-12) * now;
        (after, now) = (now, next);
        if k < count {
            bessel[k] = now;
        }
        sum += if k == 0 { now } else { 2.0 * now };
        if now > 1e200 {
            let down = 1e-200;
            (after, now, sum) = (after * down, now * down, sum * down);
            bessel.iter_mut().for_each(|b| *b *= down);
        }
    }
    let signed = |(k, b): (usize, &f64)| {
        let size = if k == 0 { 1.0 } else { 2.0 };
        if k % 2 == 0 { size * b / sum } else { -size * b / sum }
    };
    Some(bessel.iter().enumerate().map(signed).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_is_the_exponential() {
        for a in [0.0, 1e-9, 0.01, 1.0, 17.0, 400.0, 30_000.0] {
            let coefficients = chebyshev_coefficients(a).unwrap();
            for x in [-1.0f64, -0.9999, -0.9, -0.3, 0.0, 0.5, 1.0] {
                let series: f64 =
                    coefficients.iter().enumerate().map(|(k, c)| c * (k as f64 * x.acos()).cos()).sum();
                let error = (series - (-a * (1.0 + x)).exp()).abs();
                assert!(error < 1e-10, "{error:e} at a = {a}, x = {x}");
            }
        }
        assert_eq!(chebyshev_coefficients(1e6), None);
        assert_eq!(chebyshev_coefficients(f64::INFINITY), None);
    }
}
