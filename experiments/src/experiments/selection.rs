//! `cargo xtask selection`: what each choice of the detector is worth, as docs/results/selection.md.

mod detectors;
mod figure;
mod report;

use std::error::Error;
use std::path::PathBuf;

use crate::pose_sets::{SetArguments, in_repository};
use crate::repeats::Repeats;
use figure::{Figure, Row};

/// What `cargo xtask selection` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    /// Folder for selection.md and selection.csv [default: docs/results, when no SET is named]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Runs every detector on every figure and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let all = arguments.sets.sets.is_empty().then(|| in_repository("docs/results"));
    let output = arguments.output.clone().or(all);
    let output =
        output.ok_or("docs/results has the tables of all sets; name another folder with --output")?;
    let empty = |detector| Row { detector, found: Vec::new(), repeats: Vec::new() };
    let mut rows: Vec<Row> = detectors::all().into_iter().map(empty).collect();
    let sets = arguments.sets.read()?;
    // Set by set, for spectra are large.
    for set in &sets {
        eprintln!("spectra of {}", set.name);
        let figure = Figure::solve(set, arguments.sets.voxels)?;
        for row in &mut rows {
            eprintln!("{}: {}", set.name, row.detector.title);
            let found = figure.detect(&row.detector)?;
            row.repeats.push(Repeats::new(&set.null, &found)?);
            row.found.push(found);
        }
    }
    std::fs::create_dir_all(&output)?;
    std::fs::write(output.join("selection.csv"), report::csv(&sets, &rows))?;
    std::fs::write(output.join("selection.md"), report::markdown(&sets, &rows)?)?;
    Ok(())
}
