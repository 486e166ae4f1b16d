//! Our solvers, in a process of their own.

use std::error::Error;

use mser3d::shape::Choice;
use mser3d::spectral::{
    Eigensolver, Spectrum, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid,
};
use serde_json::json;

use super::cases::{Case, Problem};
use super::exchange::residual_and_orthogonality;
use crate::comparisons::resources::Stopwatch;

/// Solves a case and prints what it took and what came out, as JSON.
pub fn solve_and_print(case: &Case, solver: Eigensolver) -> Result<(), Box<dyn Error>> {
    let parameters = SpectrumParameters {
        eigenpairs: case.eigenpairs.into(),
        tolerance: case.tolerance,
        solver,
        ..Default::default()
    };
    let progress = |_| std::ops::ControlFlow::Continue(());
    let problem = case.problem()?;
    let (spectrum, usage) = match &problem {
        Problem::Grid(grid) => {
            let watch = Stopwatch::start();
            let spectrum = smallest_eigenpairs_of_grid(grid, &parameters, &progress)?;
            (spectrum, watch.stop())
        }
        Problem::Mesh(_) => {
            let operator = problem.operator()?;
            let watch = Stopwatch::start();
            let spectrum = smallest_eigenpairs(&operator, &parameters, &progress)?;
            (spectrum, watch.stop())
        }
    };
    let (values, functions) = (spectrum.basis.eigenvalues(), spectrum.basis.functions().to_f64());
    let (residual, orthogonality) = residual_and_orthogonality(&problem.operator()?, values, &functions);
    let answer = json!({
        "cpu": usage.cpu,
        "wall": usage.wall,
        "peak": usage.peak,
        "values": values,
        "residual": residual,
        "orthogonality": orthogonality,
        "digest": format!("{:016x}", digest(&spectrum)),
        "solver": spectrum.report.solver.name(),
        "applications": spectrum.report.applications,
    });
    println!("{answer}");
    Ok(())
}

/// FNV-1a over the bits of all eigenvalues and functions: equal bits, equal digests.
fn digest(spectrum: &Spectrum) -> u64 {
    let numbers = spectrum.basis.eigenvalues().iter().copied().chain(spectrum.basis.functions().values());
    numbers.fold(0xcbf2_9ce4_8422_2325, |hash, x| (hash ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3))
}
