//! How the cost grows: our solvers on series of cases, with the exponents of the power laws that fit.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use mser3d::spectral::Eigensolver;

use super::cases::{Case, series};
use super::solvers::our_command;
use crate::comparisons::python::answer;
use crate::comparisons::resources::processor;

/// What one case took, on one thread.
struct Cost {
    size: usize,
    /// User and system time, seconds.
    cpu: f64,
    /// Highest memory, bytes.
    peak: f64,
    /// Vectors that the operator, or its inverse, was applied to.
    applications: f64,
}

/// Runs all series and writes `spectrum_growth.md`.
pub fn run(folder: &Path, repeat: usize) -> Result<(), Box<dyn Error>> {
    let mut page = format!(
        "# How the cost of the spectrum grows\n\n\
         Made by `cargo xtask bench spectrum --growth`: our default solver on one thread, the figure of \
         `fixtures/`, the least CPU seconds of {repeat} runs. A growth is the exponent b of the power law \
         c x^b that fits a column best, in logarithms. Applications are vectors that the stencil of a solid, \
         or the factors of a surface, were applied to.\n\nMachine: {}.\n",
        processor()
    );
    for series in series() {
        let start = page.len();
        write!(page, "\n## {}\n\n", series.title)?;
        writeln!(page, "| {} | CPU s | MB | applications |\n|---|---|---|---|", series.size)?;
        let mut costs = Vec::with_capacity(series.cases.len());
        for (size, case) in &series.cases {
            let mut runs = Vec::with_capacity(repeat);
            for _ in 0..repeat.max(1) {
                runs.push(cost(*size, case)?);
            }
            let Some(best) = runs.into_iter().min_by(|a, b| a.cpu.total_cmp(&b.cpu)) else { continue };
            let Cost { cpu, peak, applications, .. } = best;
            writeln!(page, "| {size} | {cpu:.2} | {:.0} | {applications} |", peak / 1e6)?;
            costs.push(best);
        }
        let growth = |column: fn(&Cost) -> f64| {
            let points: Vec<_> = costs.iter().map(|cost| (cost.size as f64, column(cost))).collect();
            exponent(&points)
        };
        let [cpu, peak, applications] = [growth(|c| c.cpu), growth(|c| c.peak), growth(|c| c.applications)];
        writeln!(page, "| growth | {cpu:.2} | {peak:.2} | {applications:.2} |")?;
        print!("{}", &page[start..]);
    }
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join("spectrum_growth.md"), page)?;
    Ok(())
}

/// Solves a case in a process of its own.
fn cost(size: usize, case: &Case) -> Result<Cost, Box<dyn Error>> {
    let mut command = our_command(Eigensolver::Auto, case)?;
    let answer = answer(command.env("RAYON_NUM_THREADS", "1"))?;
    let number = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);
    Ok(Cost { size, cpu: number("cpu"), peak: number("peak"), applications: number("applications") })
}

/// The slope of ln y over ln x by least squares.
fn exponent(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean_x = logs.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = logs.iter().map(|(_, y)| y).sum::<f64>() / n;
    let covariance: f64 = logs.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = logs.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponent_of_a_power_law() {
        let points = [1.0, 3.0, 10.0, 50.0].map(|x: f64| (x, 7.0 * x.powf(4.0 / 3.0)));
        assert!((exponent(&points) - 4.0 / 3.0).abs() < 1e-12);
    }
}
