//! Directions that an iteration leaves out: the known null vectors, and eigenvectors found before.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use crate::block_matrix::BlockMatrix;
use crate::row::{LANES, Lanes};

/// Rows that a thread sums up at a time.
const ROWS: usize = 1 << 13;

/// The part of the null space of A that is known in advance: M^(1/2) on each component whose rows of W sum to
/// zero.
#[derive(Clone, Debug)]
pub(crate) struct NullSpace {
    /// The null vector of each row; 0 on components without one, where its entry is 0.
    labels: Vec<u32>,
    /// M^(1/2) on its component, normalized: the entry of the null vector at each row.
    entries: Vec<f64>,
    /// 1 / sqrt(measure) of each null vector's component: the value of its constant eigenfunction.
    constants: Vec<f64>,
    /// Eigenvectors that are known and shall not be found again.
    known: Option<BlockMatrix>,
}

impl NullSpace {
    /// From the component of each row (any numbers), M^(1/2), and whether a component's rows sum to zero.
    pub fn new(labels: &[u32], root_mass: &[f64], sums_to_zero: impl Fn(u32) -> bool) -> Self {
        // Number the components by their first row.
        let mut number = vec![u32::MAX; labels.iter().max().map_or(0, |&m| m as usize + 1)];
        let mut measures: Vec<f64> = Vec::new();
        let mut renumbered = Vec::with_capacity(labels.len());
        for (&label, root) in labels.iter().zip(root_mass) {
            if !sums_to_zero(label) {
                renumbered.push(u32::MAX);
                continue;
            }
            let slot = &mut number[label as usize];
            if *slot == u32::MAX {
                *slot = measures.len() as u32;
                measures.push(0.0);
            }
            measures[*slot as usize] += root * root;
            renumbered.push(*slot);
        }
        let constants: Vec<f64> = measures.iter().map(|m| 1.0 / m.sqrt()).collect();
        let entry =
            |(&c, root): (&u32, &f64)| constants.get(c as usize).map_or(0.0, |constant| root * constant);
        let entries = renumbered.iter().zip(root_mass).map(entry).collect();
        let labels = renumbered.into_iter().map(|c| if c == u32::MAX { 0 } else { c }).collect();
        Self { labels, entries, constants, known: None }
    }

    /// With eigenvectors that take no part either.
    pub fn and(&self, known: &BlockMatrix) -> Self {
        Self { known: Some(known.clone()), ..self.clone() }
    }

    /// Dimension: the number of components whose rows sum to zero.
    pub fn len(&self) -> usize {
        self.constants.len()
    }

    /// Rows of the null vectors.
    pub fn rows(&self) -> usize {
        self.labels.len()
    }

    /// Which eigenfunction is constant on the row's component, and its value there, if there is one.
    pub fn constant(&self, row: usize) -> Option<(usize, f64)> {
        let label = self.labels[row] as usize;
        (self.entries[row] != 0.0).then(|| (label, self.constants[label]))
    }

    /// `factor` times the entry (row, column) of the projection onto the null vectors.
    pub fn projection(&self, factor: f64, row: usize, column: usize) -> f64 {
        match self.labels[row] == self.labels[column] {
            true => factor * self.entries[row] * self.entries[column],
            false => 0.0,
        }
    }

    /// Makes the columns orthogonal to the null space and to what else takes no part.
    pub fn project_out(&self, columns: &mut BlockMatrix) {
        if let Some(known) = &self.known {
            let all = 0..known.blocks().len();
            let overlaps = known.gram(all.clone(), columns);
            columns.subtract(known, all, overlaps.as_ref());
        }
        if self.len() == 0 {
            return;
        }
        let arch = pulp::Arch::new();
        for block in columns.blocks_mut() {
            let parts = (block.par_chunks(ROWS), self.labels.par_chunks(ROWS), self.entries.par_chunks(ROWS));
            let partial = |(rows, labels, entries): (&[Lanes], &[u32], &[f64])| {
                arch.dispatch(Overlaps { rows, labels, entries, count: self.len() })
            };
            let partials: Vec<Vec<Lanes>> = parts.into_par_iter().map(partial).collect();
            let mut sums = vec![Lanes::ZERO; self.len()];
            for (sum, part) in partials.iter().flat_map(|part| part.iter().enumerate()) {
                (0..LANES).for_each(|l| sums[sum].0[l] += part.0[l]);
            }
            let parts =
                (block.par_chunks_mut(ROWS), self.labels.par_chunks(ROWS), self.entries.par_chunks(ROWS));
            parts.into_par_iter().for_each(|(rows, labels, entries)| {
                arch.dispatch(TakeOut { rows, labels, entries, sums: &sums });
            });
        }
    }
}

/// The scalar products of some rows with each of the null vectors.
struct Overlaps<'a> {
    rows: &'a [Lanes],
    labels: &'a [u32],
    entries: &'a [f64],
    count: usize,
}

impl WithSimd for Overlaps<'_> {
    type Output = Vec<Lanes>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Vec<Lanes> {
        let mut sums = vec![Lanes::ZERO; self.count];
        let mut start = 0;
        // Neighbouring rows mostly belong to one component, whose sums then stay in a register.
        for labels in self.labels.chunk_by(|a, b| a == b) {
            let rows = start..start + labels.len();
            let mut sum = sums[labels[0] as usize].0;
            for (row, entry) in self.rows[rows.clone()].iter().zip(&self.entries[rows.clone()]) {
                sum = std::array::from_fn(|l| sum[l] + entry * row.0[l]);
            }
            sums[labels[0] as usize] = Lanes(sum);
            start = rows.end;
        }
        sums
    }
}

/// Takes so much of each null vector out of some rows.
struct TakeOut<'a> {
    rows: &'a mut [Lanes],
    labels: &'a [u32],
    entries: &'a [f64],
    sums: &'a [Lanes],
}

impl WithSimd for TakeOut<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for ((row, &label), entry) in self.rows.iter_mut().zip(self.labels).zip(self.entries) {
            let sum = self.sums[label as usize].0;
            *row = Lanes(std::array::from_fn(|l| row.0[l] - entry * sum[l]));
        }
    }
}
