//! The table as text, as a page and as CSV.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

/// One library on one mesh at one resolution.
#[derive(Clone, Debug)]
pub struct Row {
    /// The mesh and the grid.
    pub case: String,
    /// Name, version, and what comes out.
    pub library: String,
    /// Threads of ours; peers take what they like.
    pub threads: Option<usize>,
    /// Seconds of the best run.
    pub wall: f64,
    /// CPU seconds of a run.
    pub cpu: f64,
    /// Peak beyond the mesh, bytes; NaN where it is not known.
    pub memory: f64,
    /// Voxels that differ from ours.
    pub differing: Option<u64>,
    /// Of these seconds to ours: by the clock, and of the processor.
    pub ratios: [f64; 2],
}

/// The head of the terminal's table.
pub const TITLES: &str = "library                                          threads     wall s      CPU s     MB  wall x   CPU x  differing";

fn known(x: f64, digits: usize) -> String {
    if x.is_nan() { String::new() } else { format!("{x:.digits$}") }
}

impl Row {
    /// All but the case.
    fn cells(&self) -> [String; 8] {
        [
            self.library.clone(),
            self.threads.map_or(String::new(), |n| n.to_string()),
            known(self.wall, 5),
            known(self.cpu, 5),
            known(self.memory / 1e6, 0),
            known(self.ratios[0], 1),
            known(self.ratios[1], 1),
            self.differing.map_or(String::new(), |n| n.to_string()),
        ]
    }

    pub fn line(&self) -> String {
        let [library, threads, wall, cpu, memory, wall_ratio, cpu_ratio, differing] = self.cells();
        format!(
            "{library:48} {threads:>7} {wall:>10} {cpu:>10} {memory:>6} {wall_ratio:>7} {cpu_ratio:>7} {differing:>10}"
        )
    }
}

/// Writes `voxelize.csv` and `voxelize.md`.
pub fn write(folder: &Path, rows: &[Row], heading: &[String]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut csv =
        String::from("case,library,threads,wall_s,cpu_s,memory_mb,wall_ratio,cpu_ratio,differing\n");
    let mut page = String::from(
        "# Solid voxels: ours and others\n\n\
         Made by `cargo xtask bench voxelize`: one mesh, one grid, all in one run. Wall seconds are those of the best \
         run, CPU seconds the mean of ours and the least of the peers'. MB is the peak beyond the mesh, of ours. \
         A factor is a peer's seconds over ours: over counted crossings, and for winding numbers over the \
         diagnosed mesh; by the clock over our row with the most threads, of the processor over that with \
         one. Differing voxels are counted against the diagnosed mesh. Peers write a byte or more for each \
         voxel, as they do; rays start on the same lines. Open3D's time excludes building its tree, ours \
         excludes nothing.\n",
    );
    for line in heading {
        writeln!(page, "\n{line}")?;
    }
    let mut last = "";
    for row in rows {
        if row.case != last {
            last = &row.case;
            write!(
                page,
                "\n## {last}\n\n| library | threads | wall s | CPU s | MB | wall factor | CPU factor | differing |\n\
                 |---|---|---|---|---|---|---|---|\n"
            )?;
        }
        writeln!(page, "| {} |", row.cells().join(" | "))?;
        let fields = row.cells().map(|cell| cell.replace(',', ";"));
        writeln!(csv, "{},{}", row.case.replace(',', ";"), fields.join(","))?;
    }
    std::fs::write(folder.join("voxelize.csv"), csv)?;
    std::fs::write(folder.join("voxelize.md"), page)?;
    Ok(())
}
