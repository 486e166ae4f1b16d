//! `cargo xtask poses`: how well regions of one pose are found again on others.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::Parameters;
use mser3d::comptree::StabilityRule;
use mser3d::shape::TriangleMesh;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::shrec::isometry;
use mser3d_evaluation::{Correspondence, NullShape, Score, read_symmetry};

use crate::solved::{Solved, mesh, stem};

/// What `cargo xtask poses` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// The pose that others are compared with [default: the human of fixtures/]
    null: Option<PathBuf>,
    /// Other poses of it, with the same vertices [default: all of fixtures/]
    #[arg(requires = "null")]
    poses: Vec<PathBuf>,
    /// Left-right symmetry: line i holds the number of vertex i's mirror vertex
    #[arg(long, requires = "null")]
    symmetry: Option<PathBuf>,
    /// Voxels of the null pose; others get the same pitch
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Eigenpairs of each solid
    #[arg(long, default_value_t = 100)]
    eigenpairs: usize,
}

/// Title, stability rule, and whether links that the surface crosses are cut.
const DETECTORS: [(&str, StabilityRule, bool); 4] = [
    ("default", StabilityRule::Windowed, true),
    ("paper", StabilityRule::Paper, true),
    ("baseline", StabilityRule::Baseline, true),
    ("no cut links", StabilityRule::Windowed, false),
];

/// Prints the scores of every detector on every pose.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures");
    let (mut null_path, mut poses) = (arguments.null.clone(), arguments.poses.clone());
    let mut mirror = arguments.symmetry.clone();
    if null_path.is_none() {
        let human = |pose: &str| fixtures.join(format!("human_{pose}.off"));
        null_path = Some(human("rest"));
        poses = ["walk", "kick", "sit", "wave", "crouch", "touch", "press"].map(human).into();
        mirror = Some(fixtures.join("human_symmetry.txt"));
    }
    let null_path = null_path.unwrap_or_default();
    let mut null = NullShape::new(mesh(&null_path)?);
    if let Some(path) = &mirror {
        let vertices = null.mesh().vertices().len();
        null = null.with_symmetry(read_symmetry(path, vertices)?)?;
    }
    println!("{:13} {:20} regions   found at .7   .8   .9   matched at .8", "detector", "pose");
    for cut_links in [true, false] {
        score_detectors(arguments, &null_path, &null, &poses, cut_links)?;
    }
    Ok(())
}

/// The detectors that share voxels and spectra.
fn score_detectors(
    arguments: &Arguments,
    null_path: &Path,
    null: &NullShape,
    poses: &[PathBuf],
    cut_links: bool,
) -> Result<(), Box<dyn Error>> {
    let correspondence = Correspondence::identity(null.mesh().vertices().len());
    let solve = |mesh: &TriangleMesh, pitch| {
        let voxelize = VoxelizeParameters { pitch, cut_links, ..Default::default() };
        let spectrum = SpectrumParameters { eigenpairs: arguments.eigenpairs.into(), ..Default::default() };
        Solved::volume(mesh, &voxelize, &spectrum)
    };
    let rest = solve(null.mesh(), Pitch::Voxels(arguments.voxels))?;
    let pitch = rest.pitch().map_or(Pitch::Voxels(arguments.voxels), Pitch::Size);
    let mut others = Vec::new();
    for path in poses {
        let pose = isometry(null.mesh(), &mesh(path)?)?;
        others.push((stem(path), solve(&pose.mesh, pitch)?));
    }
    for (title, rule, _) in DETECTORS.iter().filter(|(_, _, cut)| *cut == cut_links) {
        let mut parameters = Parameters::default();
        parameters.stability.rule = *rule;
        parameters.reference_measure = Some(rest.measure());
        let on_null = rest.detect(&parameters)?;
        println!("{title:13} {:20} {:7}", stem(null_path), on_null.regions.len());
        let mut scores = Vec::new();
        for (pose, solved) in &others {
            let found = solved.detect(&parameters)?;
            let score = Score::new(null, &on_null, &found, &correspondence)?;
            print_row(title, pose, found.regions.len() as f64, shares(&score));
            scores.push(score);
        }
        let mean = |i: usize| scores.iter().map(|s| shares(s)[i]).sum::<f64>() / scores.len() as f64;
        let regions = scores.iter().map(|s| s.best.len()).sum::<usize>() as f64 / scores.len() as f64;
        print_row(title, "mean", regions, [0, 1, 2, 3].map(mean));
    }
    Ok(())
}

/// Repeatability at .7, .8 and .9, and matching score at .8.
fn shares(score: &Score) -> [f64; 4] {
    [score.repeatability(0.7), score.repeatability(0.8), score.repeatability(0.9), score.matching_score(0.8)]
}

fn print_row(title: &str, pose: &str, regions: f64, [low, middle, high, matched]: [f64; 4]) {
    println!(
        "{title:13} {pose:20} {regions:7.1}        {low:.2}  {middle:.2}  {high:.2}            {matched:.2}"
    );
}
