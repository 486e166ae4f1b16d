//! `cargo xtask selection`: what each choice of the detector is worth, as docs/results/selection.md.

mod detectors;
mod figure;
mod repeats;
mod report;

use std::error::Error;
use std::path::{Path, PathBuf};

use crate::solved::stem;
use figure::{Figure, Row};
use repeats::Repeats;

/// What `cargo xtask selection` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// More figures: folders with poses of one mesh as .off files and their left-right symmetry in
    /// symmetry.txt; voxels are sized by the first by name
    figures: Vec<PathBuf>,
    /// Voxels of the first pose of each figure; others get the same pitch
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Where selection.md and selection.csv are written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// Runs every detector on every figure and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    let fixture = |figure: &str, poses: &[&str]| {
        let paths = poses.iter().map(|pose| fixtures.join(format!("{figure}_{pose}.off"))).collect();
        (figure.to_owned(), paths, fixtures.join(format!("{figure}_symmetry.txt")))
    };
    let mut sources: Vec<(String, Vec<PathBuf>, PathBuf)> = vec![
        fixture("human", &["rest", "walk", "kick", "sit", "wave", "crouch", "touch", "press"]),
        fixture("quadruped", &["rest", "gallop", "graze"]),
    ];
    for folder in &arguments.figures {
        sources.push(folder_of_poses(folder)?);
    }
    let mut figures = Vec::new();
    for (name, paths, symmetry) in sources {
        eprintln!("spectra of {name}");
        figures.push(Figure::solve(name, &paths, &symmetry, arguments.voxels)?);
    }
    let mut rows = Vec::new();
    for detector in detectors::all() {
        eprintln!("{}", detector.title);
        let mut row = Row { detector, found: Vec::new(), repeats: Vec::new() };
        for figure in &figures {
            let found = figure.detect(&row.detector)?;
            row.repeats.push(Repeats::new(&figure.null, &found)?);
            row.found.push(found);
        }
        rows.push(row);
    }
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("selection.csv"), report::csv(&figures, &rows))?;
    std::fs::write(arguments.output.join("selection.md"), report::markdown(&figures, &rows)?)?;
    Ok(())
}

fn folder_of_poses(folder: &Path) -> Result<(String, Vec<PathBuf>, PathBuf), Box<dyn Error>> {
    let mut poses: Vec<PathBuf> = std::fs::read_dir(folder)
        .map_err(|e| format!("{}: {e}", folder.display()))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "off"))
        .collect();
    poses.sort();
    if poses.len() < 2 {
        return Err(format!("{}: two poses or more are needed, as .off files", folder.display()).into());
    }
    Ok((stem(folder), poses, folder.join("symmetry.txt")))
}
