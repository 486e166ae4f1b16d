//! `(A + sigma I)^(-1)` by sparse Cholesky factorization (faer, AMD ordering).

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use rayon::prelude::*;

use crate::SpectralError;
use crate::standard::StandardProblem;
use crate::tall::{LANES, Tall};

/// The factor of `A + sigma I`.
pub(crate) struct Inverse {
    symbolic: SymbolicCholesky<usize>,
    factor: Vec<f64>,
}

impl Inverse {
    pub fn new(problem: &StandardProblem, sigma: f64) -> Result<Self, SpectralError> {
        let n = problem.len();
        let mut values = problem.values.clone();
        for row in 0..n {
            for at in problem.starts[row]..problem.starts[row + 1] {
                if problem.columns[at] == row {
                    values[at] += sigma;
                }
            }
        }
        let broken = || SpectralError::NotPositiveDefinite { shift: sigma };
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &problem.starts, None, &problem.columns);
        let parameters = CholeskySymbolicParams::default();
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, parameters)
            .map_err(|_| broken())?;
        let mut factor = vec![0.0; symbolic.len_val()];
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| broken())?;
        symbolic
            .factorize_numeric_llt(
                &mut factor,
                SparseColMatRef::new(pattern, &values),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|_| broken())?;
        Ok(Self { symbolic, factor })
    }

    /// `x = (A + sigma I)^(-1) x`, block by block: a kernel for another number of columns would round
    /// differently.
    pub fn apply(&self, x: &mut Tall) {
        let n = x.rows();
        x.blocks_mut().par_iter_mut().for_each(|block| {
            let mut columns = vec![0.0; n * LANES];
            for (row, lanes) in block.iter().enumerate() {
                (0..LANES).for_each(|j| columns[j * n + row] = lanes.0[j]);
            }
            let scratch = self.symbolic.solve_in_place_scratch::<f64>(LANES, Par::Seq);
            let mut memory = MemBuffer::new(scratch);
            LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(&mut columns, n, LANES),
                Par::Seq,
                MemStack::new(&mut memory),
            );
            for (row, lanes) in block.iter_mut().enumerate() {
                (0..LANES).for_each(|j| lanes.0[j] = columns[j * n + row]);
            }
        });
    }
}
