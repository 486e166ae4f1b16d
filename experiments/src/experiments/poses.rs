//! `cargo xtask poses`: how well regions of one pose are found again on others, or of one person on others.

use std::error::Error;

use mser3d::Parameters;
use mser3d::comptree::StabilityRule;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::VoxelizeParameters;

use crate::pose_sets::SetArguments;
use crate::repeats::{Repeats, regions};

/// What `cargo xtask poses` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
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

/// Prints the scores of every detector on every set: means over all ordered pairs.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let sets = arguments.sets.read()?;
    println!("{:13} {:20} regions   found at .7    .8    .9   matched at .8", "detector", "set");
    // Of each detector: regions, repeatability at .7, .8 and .9, matching at .8.
    let mut scores = [const { Vec::<[f64; 5]>::new() }; DETECTORS.len()];
    for set in &sets {
        for cut in [true, false] {
            let voxelize = VoxelizeParameters { cut_links: cut, ..Default::default() };
            let spectrum =
                SpectrumParameters { eigenpairs: arguments.eigenpairs.into(), ..Default::default() };
            let solved = set.solve(arguments.sets.voxels, &voxelize, &spectrum)?;
            for (number, (title, rule, _)) in DETECTORS.iter().enumerate().filter(|(_, d)| d.2 == cut) {
                let mut parameters = Parameters::default();
                parameters.stability.rule = *rule;
                let found = set.detect(&solved, &parameters)?;
                let repeats = Repeats::new(&set.null, &found)?;
                let [low, middle, high] = [0.7, 0.8, 0.9].map(|t| repeats.repeatability(&found, t));
                let score = [regions(&found), low, middle, high, repeats.matching(0.8)];
                print_row(title, &set.name, score);
                scores[number].push(score);
            }
        }
    }
    if sets.len() > 1 {
        for ((title, ..), scores) in DETECTORS.iter().zip(&scores) {
            let mean = |i: usize| scores.iter().map(|s| s[i]).sum::<f64>() / scores.len() as f64;
            print_row(title, "mean of the sets", [0, 1, 2, 3, 4].map(mean));
        }
    }
    Ok(())
}

fn print_row(title: &str, set: &str, [regions, low, middle, high, matched]: [f64; 5]) {
    println!("{title:13} {set:20} {regions:7.1}       {low:.3} {middle:.3} {high:.3}           {matched:.3}");
}
