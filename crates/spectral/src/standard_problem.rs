//! From the generalized problem to a standard one, and back.

use mser3d_laplace::Operator;
use mser3d_shape::{Domain, Eigenbasis};

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::kernels::{Block, LANES, Lanes};
use crate::null_space::NullSpace;

/// An eigenvalue below minus this, relative to the bound of the spectrum, is negative and no rounding error.
pub(crate) const NEGATIVE: f64 = 1e-10;

/// `W phi = lambda M phi` as the standard problem `A x = lambda x`, `A = M^(-1/2) W M^(-1/2)`,
/// `x = M^(1/2) phi`, over the rows that have mass.
pub(crate) struct StandardProblem {
    /// The row of the operator that each row of A is.
    pub active: Vec<u32>,
    /// M^(1/2) of each row.
    pub root_mass: Vec<f64>,
    /// A by rows (it is symmetric): start of each row, columns ascending with the diagonal among them, values.
    pub starts: Vec<usize>,
    pub columns: Vec<usize>,
    pub values: Vec<f64>,
    pub null_space: NullSpace,
    /// V^(-2/3) of a volume, 1/A of a surface: the unit in which eigenvalues are small numbers.
    pub unit_eigenvalue: f64,
    /// 3 of a volume, 2 of a surface.
    pub dimension: u32,
    /// No eigenvalue lies below this if A is positive semidefinite: 0, or more by Gershgorin's circles.
    pub lower_bound: f64,
}

/// `V^(-2/3)` of a volume, `1/A` of a surface.
pub(crate) fn unit_eigenvalue(domain: Domain, measure: f64) -> f64 {
    measure.powf(-2.0 / f64::from(domain.dimension()))
}

impl StandardProblem {
    pub fn new(operator: &Operator) -> Self {
        let n = operator.len();
        let active: Vec<u32> = (0..n as u32).filter(|&v| operator.mass()[v as usize] > 0.0).collect();
        let mut position = vec![usize::MAX; n];
        for (at, &v) in active.iter().enumerate() {
            position[v as usize] = at;
        }
        let root_mass: Vec<f64> = active.iter().map(|&v| operator.mass()[v as usize].sqrt()).collect();
        let (mut starts, mut columns, mut values) = (vec![0], Vec::new(), Vec::new());
        let mut lower_bound = f64::INFINITY;
        for (at, &v) in active.iter().enumerate() {
            let entries = operator.stiffness().outer_view(v as usize);
            let entries = entries.iter().flat_map(|row| row.iter()).map(|(u, &w)| (position[u], w));
            let (mut diagonal, mut rest) = (None, 0.0);
            for (u, w) in entries.filter(|&(u, _)| u != usize::MAX) {
                let value = w / (root_mass[at] * root_mass[u]);
                if u > at && diagonal.is_none() {
                    // A shift needs a place, in a row of zeros too.
                    diagonal = Some(0.0);
                    columns.push(at);
                    values.push(0.0);
                }
                match u == at {
                    true => diagonal = Some(value),
                    false => rest += value.abs(),
                }
                columns.push(u);
                values.push(value);
            }
            if diagonal.is_none() {
                columns.push(at);
                values.push(0.0);
            }
            lower_bound = f64::min(lower_bound, diagonal.unwrap_or(0.0) - rest);
            starts.push(columns.len());
        }
        let parts = operator.components();
        let labels: Vec<u32> = active.iter().map(|&v| parts.labels[v as usize]).collect();
        let mut sums_to_zero = vec![true; parts.len()];
        for (row, &label) in parts.labels.iter().enumerate() {
            sums_to_zero[label as usize] &= operator.sums_to_zero(row);
        }
        let null_space = NullSpace::new(&labels, &root_mass, |label| sums_to_zero[label as usize]);
        if null_space.len() > 0 || !lower_bound.is_finite() {
            lower_bound = 0.0;
        }
        let lower_bound = lower_bound.max(0.0);
        let measure: f64 = operator.mass().iter().sum();
        let dimension = operator.domain().dimension();
        let unit_eigenvalue = unit_eigenvalue(operator.domain(), measure);
        Self {
            active,
            root_mass,
            starts,
            columns,
            values,
            null_space,
            unit_eigenvalue,
            dimension,
            lower_bound,
        }
    }

    /// Whether `eigenvalue`, at or above the smallest one, leaves room for a positive semidefinite operator.
    ///
    /// # Errors
    /// [`SpectralError::Indefinite`] if it is negative beyond rounding.
    pub fn check_semidefinite(&self, eigenvalue: f64) -> Result<(), SpectralError> {
        if eigenvalue < -NEGATIVE * self.bound() {
            return Err(SpectralError::Indefinite { eigenvalue });
        }
        Ok(())
    }

    pub fn len(&self) -> usize {
        self.active.len()
    }

    /// An upper bound of the spectrum (Gershgorin).
    pub fn bound(&self) -> f64 {
        let row =
            |row: usize| self.values[self.starts[row]..self.starts[row + 1]].iter().map(|v| v.abs()).sum();
        (0..self.len()).map(row).fold(0.0, f64::max)
    }

    /// `y = A x`.
    pub fn apply(&self, x: &Block, y: &mut Block) {
        for (row, target) in y.iter_mut().enumerate() {
            let mut sum = [0.0; LANES];
            for at in self.starts[row]..self.starts[row + 1] {
                let (value, source) = (self.values[at], &x[self.columns[at]].0);
                (0..LANES).for_each(|l| sum[l] += value * source[l]);
            }
            *target = Lanes(sum);
        }
    }

    /// The eigenbasis of the generalized problem: exact constants for the null space, then the
    /// first `values.len()` columns of `vectors`.
    pub fn eigenbasis(
        &self,
        operator: &Operator,
        values: &[f64],
        vectors: &BlockMatrix,
        count: usize,
    ) -> Result<Eigenbasis, SpectralError> {
        let zeros = self.null_space.len().min(count);
        let mut functions = vec![0.0; operator.len() * count];
        for (at, &v) in self.active.iter().enumerate() {
            let target = &mut functions[v as usize * count..(v as usize + 1) * count];
            if let Some((label, constant)) = self.null_space.constant(at).filter(|&(label, _)| label < zeros)
            {
                target[label] = constant;
            }
            for (i, t) in target[zeros..].iter_mut().enumerate() {
                *t = vectors.at(at, i) / self.root_mass[at];
            }
        }
        let eigenvalues = std::iter::repeat_n(0.0, zeros).chain(values[..count - zeros].iter().copied());
        Eigenbasis::new(operator.domain(), operator.mass().to_vec(), eigenvalues.collect(), functions)
            .map_err(|_| SpectralError::Overflow)
    }
}
