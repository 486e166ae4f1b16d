//! Rows of the result, as a table for the terminal, CSV, and a page. Rows of cases that were not run again stay.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use super::SAME;

/// One solver on one case, the fastest of its repetitions.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub case: String,
    pub rows: usize,
    pub eigenpairs: usize,
    pub tolerance: f64,
    pub solver: String,
    pub threads: usize,
    pub cpu: f64,
    pub wall: f64,
    /// Bytes.
    pub peak: f64,
    pub residual: f64,
    pub orthogonality: f64,
    /// To the oracle's eigenvalues, relative; NaN without an oracle.
    pub difference: f64,
    /// CPU seconds over those of our row for the same case.
    pub ratio: f64,
    /// Whether our result has the same bits for every number of threads: "yes", "no" or "".
    pub same_bits: String,
    /// The solver of ours that did it; empty where that is not known.
    pub used: String,
}

const HEADER: &str = "case,rows,eigenpairs,tolerance,solver,threads,cpu_s,wall_s,peak_mb,residual,\
                      orthogonality,difference,ratio,same_bits";

impl Row {
    /// Whether ours is another answer than the oracle's, far from its tolerance, or not the same for any number of threads.
    pub fn is_wrong(&self) -> bool {
        let wrong = self.difference > SAME || self.residual > 100.0 * self.tolerance;
        self.solver.starts_with("mser3d") && (wrong || self.same_bits == "no")
    }

    fn to_csv(&self) -> String {
        format!(
            "{},{},{},{:e},{},{},{:.2},{:.2},{:.0},{:.1e},{:.1e},{:.1e},{:.2},{}",
            self.case,
            self.rows,
            self.eigenpairs,
            self.tolerance,
            self.solver,
            self.threads,
            self.cpu,
            self.wall,
            self.peak / 1e6,
            self.residual,
            self.orthogonality,
            self.difference,
            self.ratio,
            self.same_bits
        )
    }

    fn from_csv(line: &str) -> Option<Self> {
        let fields: Vec<&str> = line.split(',').collect();
        let &[case, rows, eigenpairs, tolerance, solver, threads, ..] = fields.as_slice() else {
            return None;
        };
        let number = |at: usize| fields.get(at)?.parse::<f64>().ok();
        Some(Self {
            case: case.into(),
            rows: rows.parse().ok()?,
            eigenpairs: eigenpairs.parse().ok()?,
            tolerance: tolerance.parse().ok()?,
            solver: solver.into(),
            threads: threads.parse().ok()?,
            cpu: number(6)?,
            wall: number(7)?,
            peak: number(8)? * 1e6,
            residual: number(9)?,
            orthogonality: number(10)?,
            difference: number(11)?,
            ratio: number(12)?,
            same_bits: (*fields.get(13)?).into(),
            used: String::new(),
        })
    }
}

/// The head of the terminal's table.
pub const TITLES: &str =
    "solver               threads   CPU s  wall s    MB  residual  orthog.  difference  ratio  bits";

/// A line of the terminal's table.
pub fn line(row: &Row) -> String {
    format!(
        "{:20} {:7} {:7.2} {:7.2} {:5.0}   {:7.1e}  {:7.1e}     {:7.1e} {:6.1}  {}",
        row.solver,
        row.threads,
        row.cpu,
        row.wall,
        row.peak / 1e6,
        row.residual,
        row.orthogonality,
        row.difference,
        row.ratio,
        match row.same_bits.as_str() {
            "yes" => "same",
            "no" => "DIFFERENT",
            _ => "",
        }
    )
}

/// Writes `spectrum.csv` and `spectrum.md`, keeping earlier rows of other cases. `order` is the order of cases.
pub fn write(
    folder: &Path,
    rows: &[Row],
    order: &[String],
    heading: &[String],
) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let csv_path = folder.join("spectrum.csv");
    let earlier = std::fs::read_to_string(&csv_path).unwrap_or_default();
    let mut all: Vec<Row> = earlier.lines().filter_map(Row::from_csv).collect();
    all.retain(|old| rows.iter().all(|new| new.case != old.case));
    all.extend_from_slice(rows);
    let position = |row: &Row| order.iter().position(|case| *case == row.case).unwrap_or(usize::MAX);
    all.sort_by_key(position);

    let mut csv = format!("{HEADER}\n");
    all.iter().for_each(|row| csv += &(row.to_csv() + "\n"));
    std::fs::write(csv_path, csv)?;

    let mut page = String::from(
        "# Eigenpairs: our solvers and others\n\n\
         Made by `cargo xtask bench spectrum`. CPU seconds are user and system time of all threads, over \
         factorization and iteration, the least of the repetitions; files, assembly and imports are not \
         counted. MB is the process's peak. The residual is the largest |W phi - lambda M phi| / (lambda \
         |phi|) in the norms of M^-1 and M, computed by one formula for all. The difference is the largest \
         relative one to the eigenvalues of the first of SciPy + CHOLMOD, SciPy + SuperLU and Spectra that \
         ran and missed none that another found: a missed eigenvalue would show. The ratio is CPU seconds over ours on one thread.\n",
    );
    for line in heading {
        writeln!(page, "\n{line}")?;
    }
    let mut last = "";
    for row in &all {
        if row.case != last {
            write!(
                page,
                "\n## {}: {} rows, k = {}, residual {:.0e}\n\n\
                 | solver | threads | CPU s | wall s | MB | residual | orthogonality | difference | ratio | same bits |\n\
                 |---|---|---|---|---|---|---|---|---|---|\n",
                row.case, row.rows, row.eigenpairs, row.tolerance
            )?;
            last = &row.case;
        }
        let known = |x: f64, text: String| if x.is_nan() { String::new() } else { text };
        writeln!(
            page,
            "| {} | {} | {:.2} | {:.2} | {:.0} | {:.1e} | {:.1e} | {} | {} | {} |",
            row.solver,
            row.threads,
            row.cpu,
            row.wall,
            row.peak / 1e6,
            row.residual,
            row.orthogonality,
            known(row.difference, format!("{:.1e}", row.difference)),
            known(row.ratio, format!("{:.1}", row.ratio)),
            row.same_bits
        )?;
    }
    std::fs::write(folder.join("spectrum.md"), page)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_other_cases_stay() {
        let folder = std::env::temp_dir().join(format!("mser3d-report-{}", std::process::id()));
        let row = |case: &str, cpu| Row {
            case: case.into(),
            rows: 10,
            eigenpairs: 2,
            tolerance: 1e-9,
            solver: "one".into(),
            threads: 1,
            cpu,
            wall: 2.0,
            peak: 3e6,
            residual: 1e-10,
            orthogonality: 1e-12,
            difference: f64::NAN,
            ratio: 1.0,
            same_bits: "yes".into(),
            used: String::new(),
        };
        let order = ["a".to_string(), "b".to_string()];
        write(&folder, &[row("b", 1.0)], &order, &[]).unwrap();
        write(&folder, &[row("a", 2.0)], &order, &[]).unwrap();
        write(&folder, &[row("b", 3.0)], &order, &[]).unwrap();
        let csv = std::fs::read_to_string(folder.join("spectrum.csv")).unwrap();
        let rows: Vec<Row> = csv.lines().filter_map(Row::from_csv).collect();
        let seen: Vec<(&str, f64)> = rows.iter().map(|r| (r.case.as_str(), r.cpu)).collect();
        assert_eq!(seen, [("a", 2.0), ("b", 3.0)]);
        let page = std::fs::read_to_string(folder.join("spectrum.md")).unwrap();
        assert!(page.contains("## a: 10 rows") && page.contains("## b: 10 rows"));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
