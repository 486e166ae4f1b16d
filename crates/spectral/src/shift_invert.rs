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
use crate::tall::Tall;

/// Right-hand sides solved together. Fixed, because a kernel for another width rounds differently.
pub(crate) const SOLVE_WIDTH: usize = 8;

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

    /// `y = (A + sigma I)^(-1) x`; the number of columns is a multiple of [`SOLVE_WIDTH`].
    pub fn apply(&self, x: &Tall, y: &mut Tall) {
        let (n, width) = (x.rows(), x.stride());
        let solved: Vec<Vec<f64>> = (0..width / SOLVE_WIDTH)
            .into_par_iter()
            .map(|part| {
                let mut columns = vec![0.0; n * SOLVE_WIDTH];
                for row in 0..n {
                    for j in 0..SOLVE_WIDTH {
                        columns[j * n + row] = x.row(row)[part * SOLVE_WIDTH + j];
                    }
                }
                let scratch = self.symbolic.solve_in_place_scratch::<f64>(SOLVE_WIDTH, Par::Seq);
                let mut memory = MemBuffer::new(scratch);
                LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                    Conj::No,
                    MatMut::from_column_major_slice_mut(&mut columns, n, SOLVE_WIDTH),
                    Par::Seq,
                    MemStack::new(&mut memory),
                );
                columns
            })
            .collect();
        y.data_mut().par_chunks_mut(width).enumerate().for_each(|(row, target)| {
            for (j, t) in target.iter_mut().enumerate() {
                *t = solved[j / SOLVE_WIDTH][j % SOLVE_WIDTH * n + row];
            }
        });
    }
}
