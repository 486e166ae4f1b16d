//! Problems and solutions as files, for solvers in other languages: little-endian, see `experiments/peers`.

use std::error::Error;
use std::fs::File;
use std::io::{BufReader, BufWriter, Read, Write};
use std::path::Path;

use mser3d::laplace::Operator;

use super::cases::Problem;

/// Writes `operator.bin` (rows and entries as u64; starts and row numbers as i32, values, mass as f64:
/// compressed columns) and, for a surface, `mesh.bin` (vertices and triangles as u64, then both).
pub fn write_problem(folder: &Path, problem: &Problem, operator: &Operator) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut file = BufWriter::new(File::create(folder.join("operator.bin"))?);
    let stiffness = operator.stiffness();
    for size in [operator.len(), stiffness.nnz()] {
        file.write_all(&(size as u64).to_le_bytes())?;
    }
    for &start in stiffness.indptr().to_proper().iter() {
        file.write_all(&i32::try_from(start)?.to_le_bytes())?;
    }
    for &row in stiffness.indices() {
        file.write_all(&i32::try_from(row)?.to_le_bytes())?;
    }
    for value in stiffness.data().iter().chain(operator.mass()) {
        file.write_all(&value.to_le_bytes())?;
    }
    file.flush()?;
    if let Problem::Mesh(mesh) = problem {
        let mut file = BufWriter::new(File::create(folder.join("mesh.bin"))?);
        for size in [mesh.vertices().len(), mesh.triangles().len()] {
            file.write_all(&(size as u64).to_le_bytes())?;
        }
        for x in mesh.vertices().as_flattened() {
            file.write_all(&x.to_le_bytes())?;
        }
        for &v in mesh.triangles().as_flattened() {
            file.write_all(&i32::try_from(v)?.to_le_bytes())?;
        }
        file.flush()?;
    }
    Ok(())
}

/// Eigenvalues (k) and eigenvectors (n x k, row by row).
pub struct Solution {
    pub values: Vec<f64>,
    pub functions: Vec<f64>,
}

/// Reads what a peer wrote.
pub fn read_solution(path: &Path, rows: usize, eigenpairs: usize) -> Result<Solution, Box<dyn Error>> {
    let mut file = BufReader::new(File::open(path)?);
    let mut numbers = |count: usize| -> Result<Vec<f64>, Box<dyn Error>> {
        let mut bytes = vec![0; 8 * count];
        file.read_exact(&mut bytes)?;
        Ok(bytes.as_chunks::<8>().0.iter().map(|b| f64::from_le_bytes(*b)).collect())
    };
    Ok(Solution { values: numbers(eigenpairs)?, functions: numbers(rows * eigenpairs)? })
}

/// The largest |W phi - lambda M phi| / (lambda |phi|) over the non-zero eigenvalues, in the norms of M^-1 and
/// M, and the largest entry of |Phi^T M Phi - I|: one formula for every solver.
pub fn residual_and_orthogonality(operator: &Operator, values: &[f64], functions: &[f64]) -> (f64, f64) {
    let k = values.len();
    let zero = 1e-9 * values.last().copied().unwrap_or(0.0);
    let (mut errors, mut norms) = (vec![0.0; k], vec![0.0; k]);
    let mut gram = vec![0.0; k * k];
    let mut image = vec![0.0; k];
    for (row, column) in operator.stiffness().outer_iterator().enumerate() {
        let mass = operator.mass()[row];
        if mass == 0.0 {
            continue;
        }
        image.fill(0.0);
        for (u, &w) in column.iter() {
            let other = &functions[u * k..(u + 1) * k];
            image.iter_mut().zip(other).for_each(|(sum, x)| *sum += w * x);
        }
        let phi = &functions[row * k..(row + 1) * k];
        for i in 0..k {
            errors[i] += (image[i] - values[i] * mass * phi[i]).powi(2) / mass;
            norms[i] += mass * phi[i] * phi[i];
            let scaled = mass * phi[i];
            gram[i * k..i * k + i + 1].iter_mut().zip(phi).for_each(|(sum, x)| *sum += scaled * x);
        }
    }
    let relative = |i: usize| (errors[i] / norms[i]).sqrt() / values[i];
    let residual = (0..k).filter(|&i| values[i] > zero).map(relative).fold(0.0, f64::max);
    let off = |(i, j): (usize, usize)| (gram[i * k + j] - f64::from(u8::from(i == j))).abs();
    let pairs = (0..k).flat_map(|i| (0..=i).map(move |j| (i, j)));
    (residual, pairs.map(off).fold(0.0, f64::max))
}

/// The largest difference between two lists of eigenvalues, relative to the value or, near zero, to the
/// smallest that isn't. Infinite where one list is shorter.
pub fn difference(found: &[f64], expected: &[f64]) -> f64 {
    if found.len() != expected.len() {
        return f64::INFINITY;
    }
    let zero = 1e-9 * expected.last().copied().unwrap_or(0.0);
    let floor = expected.iter().copied().find(|&e| e > zero).unwrap_or(1.0);
    let differences = found.iter().zip(expected).map(|(f, e)| (f - e).abs() / e.max(floor));
    differences.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missed_eigenvalue_is_a_difference() {
        let expected = [1e-15, 1.0, 2.0, 2.0, 3.0];
        assert!(difference(&[0.0, 1.0, 2.0, 2.0, 3.0], &expected) < 1e-14);
        assert!(difference(&[0.0, 1.0, 2.0, 3.0, 4.0], &expected) > 0.3);
        assert!(difference(&[0.0, 1.0], &expected).is_infinite());
    }
}
