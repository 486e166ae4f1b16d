//! From the generalized problem to a standard one, and back.

use mser3d_laplace::Operator;
use mser3d_shape::{Domain, Eigenbasis};

use crate::SpectralError;
use crate::tall::{Block, LANES, Lanes, Tall};
use rayon::prelude::*;

/// Rows that a thread sums up at a time.
const ROWS: usize = 1 << 13;

/// `W phi = lambda M phi` as the standard problem `A x = lambda x`, `A = M^(-1/2) W M^(-1/2)`,
/// `x = M^(1/2) phi`, over the rows that have mass.
pub(crate) struct StandardProblem {
    /// The row of the operator that each row of A is.
    pub active: Vec<u32>,
    /// M^(1/2) of each row.
    pub root_mass: Vec<f64>,
    /// A by rows (it is symmetric): start of each row, columns ascending, values.
    pub starts: Vec<usize>,
    pub columns: Vec<usize>,
    pub values: Vec<f64>,
    pub null_space: NullSpace,
    /// V^(-2/3) of a volume, 1/A of a surface: the unit in which eigenvalues are small numbers.
    pub unit_eigenvalue: f64,
    /// 3 of a volume, 2 of a surface.
    pub dimension: u32,
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
            if let Some(row) = operator.stiffness().outer_view(v as usize) {
                for (u, &w) in row.iter().filter(|&(u, _)| position[u] != usize::MAX) {
                    columns.push(position[u]);
                    values.push(w / (root_mass[at] * root_mass[position[u]]));
                }
            }
            starts.push(columns.len());
        }
        let parts = operator.components();
        let labels: Vec<u32> = active.iter().map(|&v| parts.labels[v as usize]).collect();
        let null_space = NullSpace::new(&labels, &root_mass);
        let measure: f64 = operator.mass().iter().sum();
        let dimension = operator.domain().dimension();
        let unit_eigenvalue = unit_eigenvalue(operator.domain(), measure);
        Self { active, root_mass, starts, columns, values, null_space, unit_eigenvalue, dimension }
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
        vectors: &Tall,
        count: usize,
    ) -> Result<Eigenbasis, SpectralError> {
        let zeros = self.null_space.len().min(count);
        let mut functions = vec![0.0; operator.len() * count];
        for (at, &v) in self.active.iter().enumerate() {
            let target = &mut functions[v as usize * count..(v as usize + 1) * count];
            if let Some(constant) = target[..zeros].get_mut(self.null_space.label(at)) {
                *constant = self.null_space.constant(at);
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

/// The null space of A, known in advance: one vector M^(1/2) for each component.
#[derive(Clone, Debug)]
pub(crate) struct NullSpace {
    labels: Vec<u32>,
    /// M^(1/2) on its component, normalized: the entry of the null vector at each row.
    entries: Vec<f64>,
    /// 1 / sqrt(measure) of each component: the value of its constant eigenfunction.
    constants: Vec<f64>,
    /// Eigenvectors that are known and shall not be found again.
    known: Option<Tall>,
}

impl NullSpace {
    /// From the component of each row (any numbers) and M^(1/2).
    pub fn new(labels: &[u32], root_mass: &[f64]) -> Self {
        // Number the components by their first row.
        let mut number = vec![u32::MAX; labels.iter().max().map_or(0, |&m| m as usize + 1)];
        let mut measures: Vec<f64> = Vec::new();
        let mut renumbered = Vec::with_capacity(labels.len());
        for (&label, root) in labels.iter().zip(root_mass) {
            let slot = &mut number[label as usize];
            if *slot == u32::MAX {
                *slot = measures.len() as u32;
                measures.push(0.0);
            }
            measures[*slot as usize] += root * root;
            renumbered.push(*slot);
        }
        let constants: Vec<f64> = measures.iter().map(|m| 1.0 / m.sqrt()).collect();
        let entries = renumbered.iter().zip(root_mass).map(|(&c, root)| root * constants[c as usize]);
        Self { entries: entries.collect(), labels: renumbered, constants, known: None }
    }

    /// With eigenvectors that take no part either.
    pub fn and(&self, known: &Tall) -> Self {
        Self { known: Some(known.clone()), ..self.clone() }
    }

    /// Columns of the eigenvectors that take no part.
    pub fn known_columns(&self) -> usize {
        self.known.as_ref().map_or(0, |known| known.blocks().len() * LANES)
    }

    /// Dimension: the number of components.
    pub fn len(&self) -> usize {
        self.constants.len()
    }

    /// Rows of the null vectors.
    pub fn rows(&self) -> usize {
        self.labels.len()
    }

    pub fn label(&self, row: usize) -> usize {
        self.labels[row] as usize
    }

    pub fn constant(&self, row: usize) -> f64 {
        self.constants[self.labels[row] as usize]
    }

    /// Makes the columns orthogonal to the null space and to what else takes no part.
    pub fn project_out(&self, columns: &mut Tall) {
        if let Some(known) = &self.known {
            let all = 0..known.blocks().len();
            let overlaps = known.gram(all.clone(), columns);
            columns.subtract(known, all, overlaps.as_ref());
        }
        for block in columns.blocks_mut() {
            let parts = (block.par_chunks(ROWS), self.labels.par_chunks(ROWS), self.entries.par_chunks(ROWS));
            let partial = |(rows, labels, entries): (&[Lanes], &[u32], &[f64])| {
                let mut sums = vec![[0.0; LANES]; self.len()];
                for ((lanes, &label), entry) in rows.iter().zip(labels).zip(entries) {
                    (0..LANES).for_each(|l| sums[label as usize][l] += entry * lanes.0[l]);
                }
                sums
            };
            let partials: Vec<Vec<[f64; LANES]>> = parts.into_par_iter().map(partial).collect();
            let mut sums = vec![[0.0; LANES]; self.len()];
            for (sum, part) in partials.iter().flat_map(|part| part.iter().enumerate()) {
                (0..LANES).for_each(|l| sums[sum][l] += part[l]);
            }
            let parts =
                (block.par_chunks_mut(ROWS), self.labels.par_chunks(ROWS), self.entries.par_chunks(ROWS));
            parts.into_par_iter().for_each(|(rows, labels, entries)| {
                for ((lanes, &label), entry) in rows.iter_mut().zip(labels).zip(entries) {
                    (0..LANES).for_each(|l| lanes.0[l] -= entry * sums[label as usize][l]);
                }
            });
        }
    }
}

/// All eigenpairs of a small problem by a dense solver.
pub(crate) fn dense_eigenpairs(problem: &StandardProblem) -> Result<(Vec<f64>, Tall), SpectralError> {
    let n = problem.len();
    let mut matrix = faer::Mat::<f64>::zeros(n, n);
    for row in 0..n {
        for at in problem.starts[row]..problem.starts[row + 1] {
            matrix[(row, problem.columns[at])] = problem.values[at];
        }
    }
    // Lift the null space above everything else, so that it cannot mix with small eigenvalues.
    let lift = 2.0 * problem.bound().max(f64::MIN_POSITIVE);
    let null = &problem.null_space;
    for i in 0..n {
        for j in 0..n {
            if null.label(i) == null.label(j) {
                matrix[(i, j)] += lift * null.entries[i] * null.entries[j];
            }
        }
    }
    let (values, vectors) = crate::tall::small_eigen(&matrix).ok_or(SpectralError::Overflow)?;
    let rest = n - null.len();
    let mut tall = Tall::zeros(n, rest);
    tall.fill(rest, |row, column| vectors[(row, column)]);
    Ok((values[..rest].iter().map(|v| v.max(0.0)).collect(), tall))
}
