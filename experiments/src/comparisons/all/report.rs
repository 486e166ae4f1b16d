//! The one table: as text, as a page and as CSV.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use crate::comparisons::resources::Usage;

/// Who did something, and what it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Line {
    /// The stage, and what it was done to.
    pub case: [String; 2],
    /// The program, and its threads if they were given.
    pub by: String,
    pub threads: Option<usize>,
    /// User and system time of all threads, seconds; NaN where nothing was measured.
    pub cpu: f64,
    /// Seconds.
    pub wall: f64,
    /// CPU seconds over those of the case's first line; NaN where nothing is compared.
    pub ratio: f64,
    pub note: String,
}

/// The head of the terminal's table.
pub const TITLES: &str =
    "stage          by                              threads    CPU s   wall s  ratio  note";

impl Line {
    /// What one program took.
    pub fn new(case: &[String; 2], by: &str, threads: Option<usize>, usage: &Usage) -> Self {
        let Usage { cpu, wall, .. } = *usage;
        Self { case: case.clone(), by: by.into(), threads, cpu, wall, ratio: f64::NAN, note: String::new() }
    }

    /// Why there is no number.
    pub fn without(case: &[String; 2], by: &str, why: String) -> Self {
        let nothing = Usage { cpu: f64::NAN, wall: f64::NAN, peak: f64::NAN };
        Self { note: why, ..Self::new(case, by, None, &nothing) }
    }

    /// The same with a remark.
    pub fn with(self, note: String) -> Self {
        Self { note, ..self }
    }

    fn cells(&self) -> [String; 8] {
        let seconds = |x: f64| if x < 1.0 { known(x, 3) } else { known(x, 2) };
        let threads = self.threads.map_or(String::new(), |n| n.to_string());
        let [stage, case] = self.case.clone();
        let (cpu, wall, ratio) = (seconds(self.cpu), seconds(self.wall), known(self.ratio, 1));
        [stage, case, self.by.clone(), threads, cpu, wall, ratio, self.note.clone()]
    }

    /// A line of the terminal's table.
    pub fn text(&self) -> String {
        let [stage, case, by, threads, cpu, wall, ratio, note] = self.cells();
        format!("{stage:14} {by:31} {threads:>7} {cpu:>8} {wall:>8} {ratio:>6}  {case}; {note}")
    }
}

fn known(x: f64, digits: usize) -> String {
    if x.is_nan() { String::new() } else { format!("{x:.digits$}") }
}

/// Sets the ratios: to the first line of each case that has CPU seconds.
pub fn compare(lines: &mut [Line]) {
    for group in lines.chunk_by_mut(|a, b| a.case == b.case) {
        let first = group.iter().map(|line| line.cpu).find(|cpu| !cpu.is_nan()).unwrap_or(f64::NAN);
        if group.len() > 1 {
            group.iter_mut().for_each(|line| line.ratio = line.cpu / first);
        }
    }
}

/// Writes `speed.csv` and `speed.md`.
pub fn write(folder: &Path, lines: &[Line], heading: &[String], quick: bool) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut page = format!(
        "# Speed: all stages in one table\n\n\
         Made by `cargo xtask bench all{}`, all in one run. Each program is a process of its own, and programs that are \
         compared run in turns. CPU seconds are user and system time of all threads. The run with the fewest counts. Reading \
         files counts where a whole program is measured, and not elsewhere. A ratio is CPU seconds over those of the case's \
         first line. The pages of the stages say more: [spectrum](spectrum.md), [trees](tree.md), [voxels](voxelize.md).\n",
        if quick { " --quick" } else { "" }
    );
    for line in heading {
        writeln!(page, "\n{line}")?;
    }
    page +=
        "\n| stage | case | by | threads | CPU s | wall s | ratio | |\n|---|---|---|---|---|---|---|---|\n";
    let mut csv = String::from("stage,case,by,threads,cpu_s,wall_s,ratio,note\n");
    for line in lines {
        let cells = line.cells();
        writeln!(page, "| {} |", cells.join(" | "))?;
        writeln!(csv, "{}", cells.map(|cell| cell.replace(',', ";")).join(","))?;
    }
    std::fs::write(folder.join("speed.csv"), csv)?;
    std::fs::write(folder.join("speed.md"), page)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratios_are_to_the_first_line_of_a_case() {
        let case = |name: &str| ["stage".to_string(), name.to_string()];
        let line = |name: &str, cpu| {
            Line::new(&case(name), "someone", None, &Usage { cpu, wall: 1.0, peak: f64::NAN })
        };
        let missing = Line::without(&case("b"), "no one", "not here".into());
        let mut lines = vec![line("a", 2.0), line("a", 3.0), missing, line("b", 4.0), line("c", 5.0)];
        compare(&mut lines);
        let ratios: Vec<String> = lines.iter().map(|line| known(line.ratio, 1)).collect();
        assert_eq!(ratios, ["1.0", "1.5", "", "1.0", ""]);
    }
}
