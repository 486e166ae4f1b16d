//! Eigenbases with closed forms.

use mser3d_shape::{Domain, Eigenbasis};
use std::f64::consts::PI;

/// All eigenpairs of the 6-neighbour Neumann Laplacian of a box of voxels of pitch h:
/// lambda = sum_a (2 - 2 cos(pi p_a / n_a)) / h^2, phi = a product of cosines.
pub fn box_basis(dims: [usize; 3], h: f64) -> Eigenbasis {
    let voxels = h.powi(3);
    grid_basis(&dims, h, Domain::Volume, voxels)
}

/// The same of a flat sheet of square cells: a surface.
pub fn sheet_basis(dims: [usize; 2], h: f64) -> Eigenbasis {
    grid_basis(&dims, h, Domain::Surface, h * h)
}

fn grid_basis(dims: &[usize], h: f64, domain: Domain, cell: f64) -> Eigenbasis {
    let n: usize = dims.iter().product();
    let digits = |mut number: usize| -> Vec<usize> {
        let digit = |d: &usize| {
            let digit = number % d;
            number /= d;
            digit
        };
        dims.iter().map(digit).collect()
    };
    let lambda = |mode: usize| -> f64 {
        let one = |(p, d): (usize, &usize)| 2.0 - 2.0 * (PI * p as f64 / *d as f64).cos();
        digits(mode).into_iter().zip(dims).map(one).sum::<f64>() / (h * h)
    };
    let mut modes: Vec<usize> = (0..n).collect();
    modes.sort_by(|a, b| lambda(*a).total_cmp(&lambda(*b)));
    let phi = |vertex: usize, mode: usize| -> f64 {
        let one = |((p, x), d): ((usize, usize), &usize)| {
            let norm = if p == 0 { 1.0 } else { 2.0 };
            (norm / *d as f64).sqrt() * (PI * p as f64 * (x as f64 + 0.5) / *d as f64).cos()
        };
        digits(mode).into_iter().zip(digits(vertex)).zip(dims).map(one).product::<f64>() / cell.sqrt()
    };
    let functions: Vec<f64> =
        (0..n).flat_map(|v| modes.iter().map(move |&m| phi(v, m)).collect::<Vec<_>>()).collect();
    let values = modes.iter().map(|&m| lambda(m)).collect();
    Eigenbasis::new(domain, vec![cell; n], values, functions).unwrap()
}

/// Only the first k eigenpairs.
pub fn truncated(basis: &Eigenbasis, k: usize) -> Eigenbasis {
    let mut basis = basis.clone();
    basis.truncate(k);
    basis
}

/// Runs on a pool of this many threads.
pub fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}
