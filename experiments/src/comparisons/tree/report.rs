//! The table as text, as a page and as CSV.

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

/// One library on one field, the fastest of its repetitions.
#[derive(Clone, Debug)]
pub struct Row {
    pub field: &'static str,
    pub vertices: usize,
    pub weights: &'static str,
    pub library: String,
    pub threads: usize,
    /// Seconds.
    pub cpu: f64,
    /// Seconds.
    pub wall: f64,
    /// Peak beyond the field, bytes.
    pub memory: f64,
    /// Of the nodes; `None` for a spanning tree.
    pub digest: Option<(String, u64)>,
    /// Whether the nodes are the oracle's: "yes", "no" or "".
    pub same: &'static str,
    /// Of Higra's seconds to these: of the processor, and by the clock.
    pub ratios: [f64; 2],
}

/// The head of the terminal's table.
pub const TITLES: &str = "field       weights  library                   threads    CPU s   wall s  bytes/voxel  CPU x  wall x  tree";

impl Row {
    pub fn line(&self) -> String {
        format!(
            "{:11} {:7}  {:25} {:7} {:8.4} {:8.4} {:12.1} {:>6} {:>7}  {}",
            self.field,
            self.weights,
            self.library,
            self.threads,
            self.cpu,
            self.wall,
            self.memory / self.vertices as f64,
            known(self.ratios[0]),
            known(self.ratios[1]),
            match self.same {
                "yes" => "same",
                "no" => "DIFFERENT",
                _ => "",
            }
        )
    }
}

fn known(ratio: f64) -> String {
    if ratio.is_nan() { String::new() } else { format!("{ratio:.1}") }
}

/// Writes `tree.csv` and `tree.md`.
pub fn write(folder: &Path, rows: &[Row], heading: &[String]) -> Result<(), Box<dyn Error>> {
    std::fs::create_dir_all(folder)?;
    let mut csv = String::from(
        "field,vertices,weights,library,threads,cpu_s,wall_s,bytes_per_voxel,cpu_ratio,wall_ratio,nodes,same_tree\n",
    );
    let mut page = String::from(
        "# Component trees: ours and others\n\n\
         Made by `cargo xtask bench tree`: trees of one field by all libraries, in turns, each in a process of its \
         own; the run with the fewest CPU seconds counts. Reading the field is not counted, nor, for weights on \
         edges, is making Higra's and SciPy's graph; memory is all beyond the field, that graph included. Neighbours \
         share a face; an edge's weight is the absolute difference of its ends. *Smooth* fields are sums of waves \
         with a little noise, *grey* ones the same in steps, so with ties. A factor is Higra's seconds divided by \
         the row's. Trees are the same when their nodes of more than one vertex agree in altitude, size, and \
         altitude and size of the parent. SciPy only finds a minimum spanning tree.\n",
    );
    for line in heading {
        writeln!(page, "\n{line}")?;
    }
    let mut last = ("", "");
    for row in rows {
        if (row.field, row.weights) != last {
            last = (row.field, row.weights);
            write!(
                page,
                "\n## {}: {} voxels, weights on {}\n\n\
                 | library | threads | CPU s | wall s | bytes a voxel | CPU factor | wall factor | same tree |\n\
                 |---|---|---|---|---|---|---|---|\n",
                row.field,
                row.vertices,
                if row.weights == "edge" { "edges" } else { "vertices" }
            )?;
        }
        let bytes = row.memory / row.vertices as f64;
        let [cpu, wall] = row.ratios.map(known);
        let Row { field, vertices, weights, library, threads, same, .. } = row;
        let seconds = format!("{:.4} | {:.4}", row.cpu, row.wall);
        writeln!(page, "| {library} | {threads} | {seconds} | {bytes:.1} | {cpu} | {wall} | {same} |")?;
        let seconds = seconds.replace(" | ", ",");
        let nodes = row.digest.as_ref().map_or(String::new(), |digest| digest.1.to_string());
        writeln!(
            csv,
            "{field},{vertices},{weights},{library},{threads},{seconds},{bytes:.1},{cpu},{wall},{nodes},{same}"
        )?;
    }
    std::fs::write(folder.join("tree.csv"), csv)?;
    std::fs::write(folder.join("tree.md"), page)?;
    Ok(())
}
