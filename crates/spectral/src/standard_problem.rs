//! From the generalized problem to a standard one, and back.

use mser3d_laplace::Operator;
use mser3d_shape::{Domain, Eigenbasis};

use crate::SpectralError;
use crate::block_matrix::BlockMatrix;
use crate::null_space::NullSpace;
use crate::row::{Block, LANES, Lanes};

/// An eigenvalue below minus this, relative to the bound of the spectrum, is negative and no rounding error.
pub(crate) const NEGATIVE: f64 = 1e-10;

/// `W phi = lambda M phi` as the standard problem `A x = lambda x`, `A = M^(-1/2) W M^(-1/2)`,
/// `x = M^(1/2) phi`, over the rows that have mass.
pub(crate) struct StandardProblem {
    /// The row of the operator that each row of A is.
    pub active: Vec<u32>,
    /// M^(1/2) of each row.
    pub root_mass: Vec<f64>,
    /// A by rows (it is symmetric): start of each row, columns ascending with the diagonal among them,
    /// values.
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
    /// No eigenvalue lies above this, by Gershgorin's circles.
    pub bound: f64,
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
        for (at, &v) in active.iter().enumerate() {
            let first = columns.len();
            for (u, &w) in operator.stiffness().outer_view(v as usize).iter().flat_map(|row| row.iter()) {
                if position[u] != usize::MAX {
                    columns.push(position[u]);
                    values.push(w / (root_mass[at] * root_mass[position[u]]));
                }
            }
            // A shift needs a place on the diagonal, in a row of zeros too.
            if let Err(place) = columns[first..].binary_search(&at) {
                columns.insert(first + place, at);
                values.insert(first + place, 0.0);
            }
            starts.push(columns.len());
        }
        let [lowest, bound] = gershgorin(&starts, &columns, &values);
        let parts = operator.components();
        let labels: Vec<u32> = active.iter().map(|&v| parts.labels[v as usize]).collect();
        let mut sums_to_zero = vec![true; parts.len()];
        for (row, &label) in parts.labels.iter().enumerate() {
            sums_to_zero[label as usize] &= operator.sums_to_zero(row);
        }
        let null_space = NullSpace::new(&labels, &root_mass, |label| sums_to_zero[label as usize]);
        let lower_bound = if null_space.len() > 0 { 0.0 } else { lowest };
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
            bound,
        }
    }

    /// Whether `eigenvalue`, at or above the smallest one, leaves room for a positive semidefinite operator.
    ///
    /// # Errors
    /// [`SpectralError::Indefinite`] if it is negative beyond rounding.
    pub fn check_semidefinite(&self, eigenvalue: f64) -> Result<(), SpectralError> {
        if eigenvalue < -NEGATIVE * self.bound {
            return Err(SpectralError::Indefinite { eigenvalue });
        }
        Ok(())
    }

    pub fn len(&self) -> usize {
        self.active.len()
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

/// The lower end of Gershgorin's circles of all rows, or 0 if it is less, and the upper end of those around
/// 0.
fn gershgorin(starts: &[usize], columns: &[usize], values: &[f64]) -> [f64; 2] {
    let (mut lowest, mut highest) = (f64::INFINITY, 0.0f64);
    for (row, ends) in starts.windows(2).enumerate() {
        let (mut low, mut size) = (0.0, 0.0);
        for (&column, &value) in columns[ends[0]..ends[1]].iter().zip(&values[ends[0]..ends[1]]) {
            low += if column == row { value } else { -value.abs() };
            size += value.abs();
        }
        (lowest, highest) = (lowest.min(low), highest.max(size));
    }
    [if lowest.is_finite() { lowest.max(0.0) } else { 0.0 }, highest]
}
