//! Functions that heat smooths, and functions that are as smooth as their values elsewhere allow.

use crate::conjugate_gradients::solve;
use crate::{LaplaceError, Operator};

/// Steps of the implicit Euler method.
const STEPS: usize = 16;

impl Operator {
    /// A function after heat has flowed for a time `t` (length^2): the solution of `M df/dt = -W f`, n values from n.
    ///
    /// Sixteen steps of the implicit Euler method, each a sparse linear system: a mode of eigenvalue lambda decays by
    /// `(1 + lambda t/16)^-16` in place of `exp(-lambda t)`, which differ by at most 0.017. No eigenpairs are
    /// needed, so none is missing, however short the time. The integral `sum_v m_v f(v)` stays what it is. In a volume, and on
    /// a surface whose cotangent weights are not negative, no value leaves the range of those given.
    ///
    /// Rows without mass keep their value. Time: a few hundred products with W, more for longer times.
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
    /// assert!((after[0] - after[1] - (1.0 + 2.0 * 0.5 / 16.0f64).powi(-16)).abs() < 1e-9);
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
        let step = t / STEPS as f64;
        // Any mass will do where there is no stiffness.
        let mass: Vec<f64> = self.mass().iter().map(|&m| if m > 0.0 { m } else { 1.0 }).collect();
        let diagonal: Vec<f64> =
            (0..n).map(|v| mass[v] + step * self.stiffness().get(v, v).copied().unwrap_or(0.0)).collect();
        let apply = |x: &[f64], y: &mut [f64]| {
            for (v, y) in y.iter_mut().enumerate() {
                *y = mass[v] * x[v] + step * self.row_times(v, x);
            }
        };
        // Constants don't change; without them the residual is that of what does.
        let mean = mean(&mass, values);
        let mut now: Vec<f64> = values.iter().map(|x| x - mean).collect();
        for _ in 0..STEPS {
            let b: Vec<f64> = now.iter().zip(&mass).map(|(x, m)| x * m).collect();
            solve(apply, &diagonal, &b, &mut now)?;
        }
        Ok(now.into_iter().map(|x| x + mean).collect())
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
    fn row_times(&self, row: usize, x: &[f64]) -> f64 {
        let Some(row) = self.stiffness().outer_view(row) else { return 0.0 };
        row.iter().map(|(column, value)| value * x[column]).sum()
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
