//! The tones of a round drum: the eigenvalues of a matrix of your own, here the Laplacian of a disc whose rim
//! is held.
//!
//! `cargo run -p mser3d-spectral --example drum`

use std::error::Error;
use std::ops::ControlFlow;

use mser3d_spectral::laplace::{Operator, sprs::TriMat};
use mser3d_spectral::shape::Domain;
use mser3d_spectral::{SpectrumParameters, smallest_eigenpairs};

/// Prints the six lowest frequencies beside the exact ones.
pub fn main() -> Result<(), Box<dyn Error>> {
    // Points of a square lattice inside the unit disc.
    let across = 80;
    let h = 2.0 / f64::from(across);
    let at = |i: i32| f64::from(i) * h - 1.0;
    let mut number = std::collections::BTreeMap::new();
    for (i, j) in (0..=across).flat_map(|i| (0..=across).map(move |j| (i, j))) {
        if at(i).powi(2) + at(j).powi(2) < 1.0 {
            number.insert((i, j), number.len());
        }
    }

    // Five points each: W = h^2 (4 u - sum of the neighbours) / h^2. Neighbours beyond the rim are 0, so they
    // leave no entry.
    let n = number.len();
    let mut stiffness = TriMat::new((n, n));
    for (&(i, j), &row) in &number {
        stiffness.add_triplet(row, row, 4.0);
        for neighbour in [(i - 1, j), (i + 1, j), (i, j - 1), (i, j + 1)] {
            if let Some(&column) = number.get(&neighbour) {
                stiffness.add_triplet(row, column, -1.0);
            }
        }
    }
    let drum = Operator::new(Domain::Surface, stiffness.to_csc(), vec![h * h; n])?;

    let parameters = SpectrumParameters { eigenpairs: 6.into(), ..Default::default() };
    let spectrum = smallest_eigenpairs(&drum, &parameters, &|_| ControlFlow::Continue(()))?;

    // A frequency is the root of an eigenvalue; exact ones are zeros of Bessel functions. The rim is a staircase up to
    // a step outside the circle, so the drum sounds about a hundredth too low.
    let exact = [2.4048, 3.8317, 3.8317, 5.1356, 5.1356, 5.5201];
    println!("{n} points, found by {}, residual {:.0e}", spectrum.report.solver, spectrum.report.residual);
    println!("frequency    exact");
    for (eigenvalue, exact) in spectrum.basis.eigenvalues().iter().zip(exact) {
        println!("{:9.4} {exact:8.4}", eigenvalue.sqrt());
    }
    Ok(())
}
