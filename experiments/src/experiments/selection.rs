//! `cargo xtask selection`: what each choice of the detector is worth, as docs/results/selection.md.

mod detectors;
mod figure;
mod report;

use std::error::Error;
use std::path::PathBuf;

use crate::pose_sets::SetArguments;
use crate::repeats::Repeats;
use figure::{Figure, Row};

/// What `cargo xtask selection` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    /// Where selection.md and selection.csv are written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// Runs every detector on every figure and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut figures = Vec::new();
    for set in arguments.sets.read()? {
        eprintln!("spectra of {}", set.name);
        figures.push(Figure::solve(set, arguments.sets.voxels)?);
    }
    let mut rows = Vec::new();
    for detector in detectors::all() {
        eprintln!("{}", detector.title);
        let mut row = Row { detector, found: Vec::new(), repeats: Vec::new() };
        for figure in &figures {
            let found = figure.detect(&row.detector)?;
            row.repeats.push(Repeats::new(&figure.set.null, &found)?);
            row.found.push(found);
        }
        rows.push(row);
    }
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("selection.csv"), report::csv(&figures, &rows))?;
    std::fs::write(arguments.output.join("selection.md"), report::markdown(&figures, &rows)?)?;
    Ok(())
}
