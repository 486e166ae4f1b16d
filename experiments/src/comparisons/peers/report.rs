//! The table as text, as a page and as CSV.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

/// A detector on a set at one number of parts.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    pub set: String,
    pub detector: &'static str,
    /// How many parts were asked for.
    pub wanted: usize,
    /// How many there were: the mean over the shapes.
    pub parts: f64,
    /// Above 0.8 and above 0.9: means over the pairs.
    pub repeatability: [f64; 2],
    /// Shapes on which the detector failed, and why.
    pub failed: Vec<String>,
}

/// The head of the terminal's table.
pub const TITLES: &str = "set                   parts  detector        given    at .8    .9";

const HEAD: &str = "\
# Parts found again: ours and others, at equal numbers

Made by `cargo xtask peers`. Each shape of a set is compared with each other, both ways; of the synthetic sets, the body at rest
with each of its transforms of strength 3. Cells hold the share of parts whose best overlap with a part of the other
shape is above 0.8 / above 0.9, the mirror image allowed where the symmetry is known, and how many parts a shape had.
More parts make it easier to find one again, so both shapes of a pair are cut to the number in the second column; who has fewer
is scored with what there is, and a shape without parts counts 0. The best at 0.8 is bold.

* **ours, paper, baseline**: the best regions of each rule: ours those that a real merge ends first, the largest first;
  `paper` by stability, `baseline` by volume.
* **ToMATo** (Chazal et al. 2013): that many most persistent clusters of log H at a time scale of 0.25, on our linked
  voxels.
* **Shape diameter** (Shapira et al. 2008): segmented into 2 to 12 clusters of diameters, on all shapes of a set into
  as many as come nearest to the number of parts, on average. Segments are connected. Meshes of fewer than 10,000 vertices
  are refined first.

Of the last two, what has under 1 % or over 75 % of the volume or area is no part, as by the filters of ours.
";

impl Row {
    pub fn line(&self) -> String {
        let Self { set, detector, wanted, parts, repeatability: [b, c], failed } = self;
        let failed = match failed.len() {
            0 => String::new(),
            count => format!("   failed on {count}"),
        };
        format!("{set:21} {wanted:5}  {detector:15} {parts:5.1}    {b:.3} {c:.3}{failed}")
    }

    fn cell(&self, bold: bool) -> String {
        let [b, c] = self.repeatability;
        let mark = if bold { "**" } else { "" };
        format!("{mark}{b:.2} / {c:.2}{mark} ({:.1})", self.parts)
    }
}

/// Writes `peers.csv` and `peers.md`.
pub fn write(folder: &Path, rows: &[Row], heading: &[String]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut csv = String::from("set,wanted,detector,parts,repeatability_0.8,repeatability_0.9,failed\n");
    for row in rows {
        let Row { set, wanted, detector, parts, repeatability: [b, c], failed } = row;
        writeln!(csv, "{set},{wanted},{detector},{parts:.2},{b:.4},{c:.4},{}", failed.len())?;
    }
    std::fs::write(folder.join("peers.csv"), csv)?;
    std::fs::write(folder.join("peers.md"), page(rows, heading)?)?;
    Ok(())
}

fn page(rows: &[Row], heading: &[String]) -> Result<String, Box<dyn Error>> {
    let mut page = String::from(HEAD);
    for line in heading {
        writeln!(page, "\n{line}")?;
    }
    let detectors = distinct(rows.iter().map(|row| row.detector));
    writeln!(page, "\n| set | parts | {} |", detectors.join(" | "))?;
    writeln!(page, "|---|---|{}", "---|".repeat(detectors.len()))?;
    let means = means(rows);
    let mut above = String::new();
    for group in groups(rows).into_iter().chain(groups(&means)) {
        let best = group.iter().map(|row| row.repeatability[0]).fold(0.0, f64::max);
        let (set, wanted) = (&group[0].set, group[0].wanted);
        write!(page, "| {set} | {wanted} |")?;
        for detector in &detectors {
            let row = group.iter().find(|row| row.detector == *detector);
            write!(page, " {} |", row.map_or(String::new(), |row| row.cell(row.repeatability[0] == best)))?;
        }
        page.push('\n');
        let Some(ours) = group.iter().find(|row| row.detector == "ours") else { continue };
        for row in group.iter().filter(|row| row.repeatability[0] > ours.repeatability[0] + 1e-12) {
            let [theirs, own] = [row, ours].map(|row| row.repeatability[0]);
            writeln!(above, "| {set} | {wanted} | {} | {theirs:.3} | {own:.3} |", row.detector)?;
        }
    }
    if !above.is_empty() {
        page.push_str("\n## Where another is above ours at 0.8\n\n| set | parts | | it | ours |\n|---|---|---|---|---|\n");
        page.push_str(&above);
    }
    let mut failures: Vec<String> = Vec::new();
    for row in rows {
        let failure = row.failed.iter().map(|f| format!("* {} on {}: {f}\n", row.detector, row.set));
        failures.extend(failure.filter(|f| !failures.contains(f)).collect::<Vec<_>>());
    }
    if !failures.is_empty() {
        write!(page, "\n## What failed, and counts as shapes without parts\n\n{}", failures.concat())?;
    }
    Ok(page)
}

/// The rows of each set and number.
fn groups(rows: &[Row]) -> Vec<Vec<&Row>> {
    let keys = distinct(rows.iter().map(|row| (&row.set, row.wanted)));
    keys.iter().map(|key| rows.iter().filter(|row| (&row.set, row.wanted) == *key).collect()).collect()
}

/// Means over the sets.
fn means(rows: &[Row]) -> Vec<Row> {
    let keys = distinct(rows.iter().map(|row| (row.wanted, row.detector)));
    let mean = |&(wanted, detector): &(usize, &'static str)| {
        let of: Vec<&Row> =
            rows.iter().filter(|row| (row.wanted, row.detector) == (wanted, detector)).collect();
        let mean =
            |value: &dyn Fn(&Row) -> f64| of.iter().map(|row| value(row)).sum::<f64>() / of.len() as f64;
        let repeatability = [0, 1].map(|i| mean(&|row| row.repeatability[i]));
        let set = "mean of the sets".to_owned();
        Row { set, detector, wanted, parts: mean(&|row| row.parts), repeatability, failed: Vec::new() }
    };
    keys.iter().map(mean).collect()
}

/// What there is, each once, in order of appearance.
fn distinct<T: PartialEq>(all: impl Iterator<Item = T>) -> Vec<T> {
    let mut kept = Vec::new();
    for one in all {
        if !kept.contains(&one) {
            kept.push(one);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(set: &str, detector: &'static str, parts: f64, repeatability: [f64; 2], failed: &[&str]) -> Row {
        let failed = failed.iter().map(|text| text.to_string()).collect();
        Row { set: set.into(), detector, wanted: 4, parts, repeatability, failed }
    }

    #[test]
    fn the_page_names_the_best_and_who_is_above_ours() {
        let rows = [
            row("a", "ours", 4.0, [0.5, 0.25], &[]),
            row("a", "other", 3.0, [1.0, 0.75], &["x (y)"]),
            row("b", "ours", 4.0, [1.0, 1.0], &[]),
            row("b", "other", 2.0, [0.25, 0.0], &[]),
        ];
        let page = page(&rows, &["Machine: none.".into()]).unwrap();
        for line in [
            "| set | parts | ours | other |",
            "| a | 4 | 0.50 / 0.25 (4.0) | **1.00 / 0.75** (3.0) |",
            "| b | 4 | **1.00 / 1.00** (4.0) | 0.25 / 0.00 (2.0) |",
            "| mean of the sets | 4 | **0.75 / 0.62** (4.0) | 0.62 / 0.38 (2.5) |",
            "| a | 4 | other | 1.000 | 0.500 |",
            "* other on a: x (y)",
        ] {
            assert!(page.lines().any(|l| l == line), "{line}\n{page}");
        }
        assert_eq!(page.matches("| other | 1.000").count(), 1);
    }
}
