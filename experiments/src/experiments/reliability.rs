//! `cargo xtask reliability`: whether regions are found again as surely as their reliability says.

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_evaluation::{DetectedRegions, IndexSet};
use rayon::prelude::*;

use crate::pose_sets::{Kind, PoseSet, SetArguments};
use crate::repeats::{Found, Repeats, regions};

/// What `cargo xtask reliability` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    /// Deformed copies of each shape
    #[arg(long, default_value_t = 6)]
    copies: usize,
    /// How far each wave of a deformation moves the shape, over its diagonal
    #[arg(long, default_value_t = Parameters::default().reliability.amplitude)]
    amplitude: f64,
    /// Where reliability.md is written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// A region and a pose that it was looked for on.
struct Trial {
    reliability: f64,
    found: bool,
    /// The trials of each set weigh as much together.
    weight: f64,
}

/// Measures reliability on all shapes, looks for all regions on all other poses, and writes the diagram.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut trials: Vec<(String, Vec<Trial>)> = Vec::new();
    let mut rows = String::new();
    for set in arguments.sets.read()? {
        eprintln!("{}", set.name);
        let found = detect(&set, arguments)?;
        let repeats = Repeats::new(&set.null, &found)?;
        let again = |pose: usize| repeats.best_of(pose);
        let mut of_set = Vec::new();
        let mut kept = [1.0, 0.8, 0.7, 0.5].map(|part| (part, 0.0, 0));
        for (pose, f) in found.iter().enumerate() {
            let reliability: Vec<f64> = f.regions.iter().map(|r| r.reliability.unwrap_or(f64::NAN)).collect();
            let mut order: Vec<usize> = (0..reliability.len()).collect();
            order.sort_by(|&a, &b| reliability[b].total_cmp(&reliability[a]));
            for best in again(pose) {
                let trial =
                    |r: usize| Trial { reliability: reliability[r], found: best[r] > 0.8, weight: 1.0 };
                of_set.extend((0..reliability.len()).map(trial));
                for (part, sum, pairs) in &mut kept {
                    let n = (*part * order.len() as f64).ceil() as usize;
                    let hits = order[..n].iter().filter(|&&r| best[r] > 0.8).count();
                    *sum += hits as f64 / n.max(1) as f64;
                    *pairs += 1;
                }
            }
        }
        let weight = 1.0 / of_set.len().max(1) as f64;
        of_set.iter_mut().for_each(|trial| trial.weight = weight);
        let area = area_under_curve(&of_set).map_or("-".into(), |area| format!("{area:.2}"));
        write!(rows, "| {} | {:.1} | {area} |", set.name, regions(&found))?;
        for (_, sum, pairs) in kept {
            write!(rows, " {:.3} |", sum / f64::from(pairs.max(1)))?;
        }
        rows.push('\n');
        trials.push((set.name.clone(), of_set));
    }
    let text = page(arguments, &rows, &trials)?;
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("reliability.md"), &text)?;
    print!("{text}");
    Ok(())
}

/// What the detector finds on all meshes of a set, with reliabilities.
fn detect(set: &PoseSet, arguments: &Arguments) -> Result<Vec<Found>, Box<dyn Error>> {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(arguments.sets.voxels);
    parameters.reliability.deformations = Some(arguments.copies);
    parameters.reliability.amplitude = arguments.amplitude;
    if set.kind == Kind::Poses {
        parameters = parameters.with_scale_of(Input::Volume(set.null.mesh()))?;
    }
    let detect = |(name, mesh): &(String, mser3d::shape::TriangleMesh)| -> Result<Found, String> {
        let features = Detector::new(parameters.clone())
            .detect(Input::Volume(mesh))
            .map_err(|e| format!("{}: {name}: {e}", set.name))?;
        let vertices = mesh.vertices().len();
        let members = |r: &mser3d::Region| IndexSet::from_members(vertices, r.vertices.iter().copied());
        let sets =
            features.regions.iter().map(members).collect::<Result<_, _>>().map_err(|e| e.to_string())?;
        let descriptors = features.descriptors.rows().map(<[f64]>::to_vec).collect();
        Ok(Found { detection: DetectedRegions { regions: sets, descriptors }, regions: features.regions })
    };
    Ok(set.poses.par_iter().map(detect).collect::<Result<Vec<_>, String>>()?)
}

/// The chance that of two trials the one with the larger reliability is found and the other not, where one is.
fn area_under_curve(trials: &[Trial]) -> Option<f64> {
    let of = |found: bool| trials.iter().filter(move |t| t.found == found).map(|t| t.reliability);
    let mut lost: Vec<f64> = of(false).collect();
    lost.sort_by(f64::total_cmp);
    let wins: Vec<f64> = of(true)
        .map(|r| {
            let below = lost.partition_point(|&l| l < r);
            let equal = lost.partition_point(|&l| l <= r) - below;
            below as f64 + 0.5 * equal as f64
        })
        .collect();
    let pairs = lost.len() * wins.len();
    (pairs > 0).then(|| wins.iter().sum::<f64>() / pairs as f64)
}

/// Logistic regression of `found` on the logarithm of the odds: offset and slope, 0 and 1 where reliability is right.
fn calibration(trials: &[&Trial]) -> [f64; 2] {
    let log_odds = |t: &Trial| (t.reliability / (1.0 - t.reliability).max(1e-12)).max(1e-12).ln();
    let [mut offset, mut slope] = [0.0, 1.0];
    for _ in 0..50 {
        let (mut g, mut h) = ([0.0; 2], [1e-9, 0.0, 1e-9]);
        for t in trials {
            let x = log_odds(t);
            let p = 1.0 / (1.0 + (-(offset + slope * x)).exp());
            let left = t.weight * (f64::from(u8::from(t.found)) - p);
            let curved = t.weight * p * (1.0 - p);
            g = [g[0] + left, g[1] + left * x];
            h = [h[0] + curved, h[1] + curved * x, h[2] + curved * x * x];
        }
        let determinant = h[0] * h[2] - h[1] * h[1];
        offset += (h[2] * g[0] - h[1] * g[1]) / determinant;
        slope += (h[0] * g[1] - h[1] * g[0]) / determinant;
    }
    [offset, slope]
}

fn page(
    arguments: &Arguments,
    rows: &str,
    trials: &[(String, Vec<Trial>)],
) -> Result<String, std::fmt::Error> {
    let all: Vec<&Trial> = trials.iter().flat_map(|(_, trials)| trials).collect();
    let mut bins = String::new();
    for low in [0.0, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.975] {
        let high = [0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.925, 0.95, 0.975, 1.0].into_iter().find(|&h| h > low);
        let high = high.unwrap_or(1.0);
        let inside: Vec<&&Trial> =
            all.iter().filter(|t| t.reliability >= low && (t.reliability < high || high == 1.0)).collect();
        let weight: f64 = inside.iter().map(|t| t.weight).sum();
        let mean = |value: &dyn Fn(&Trial) -> f64| {
            inside.iter().map(|t| t.weight * value(t)).sum::<f64>() / weight.max(1e-300)
        };
        if !inside.is_empty() {
            let (said, was) = (mean(&|t| t.reliability), mean(&|t| f64::from(u8::from(t.found))));
            let share = weight / trials.len() as f64;
            writeln!(bins, "| {low} to {high} | {:.1} % | {said:.3} | {was:.3} |", 100.0 * share)?;
        }
    }
    let areas: Vec<f64> = trials.iter().filter_map(|(_, trials)| area_under_curve(trials)).collect();
    let mean = areas.iter().sum::<f64>() / areas.len().max(1) as f64;
    let [offset, slope] = calibration(&all);
    let (copies, amplitude, voxels) = (arguments.copies, arguments.amplitude, arguments.sets.voxels);
    Ok(format!(
        "# How surely regions are found again

Made by `cargo xtask reliability` on {voxels} voxels: {copies} deformed copies of each shape, each wave by {amplitude} of
its diagonal. Every region is looked for on every other pose of its set: it is found if a region there overlaps it by
more than 0.8, by vertex area, the mirror image allowed where a symmetry is known.

*Area* is that under the curve of reliability for being found: the chance that of two regions, one found and one not, the
found one is the more reliable. None where all are found; the mean of the others is {mean:.2}. The other columns give the share
found of the most reliable regions of each shape, among all regions of the other.

| set | regions | area | all | best 80 % | best 70 % | best 50 % |
|---|---|---|---|---|---|---|
{rows}
Reliability is a chance: of regions with 0.9, nine in ten should be found. Here by reliability, all sets of the same
weight:

| reliability | of all regions | said | found |
|---|---|---|---|
{bins}
A logistic regression on the logarithm of the odds that reliability says gives an offset of {offset:.2} and a slope of {slope:.2};
0 and 1 are right.
"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trials(reliable: impl Fn(f64) -> f64) -> Vec<Trial> {
        // Found with the chance x, spread evenly.
        let trial = |i: usize| {
            let x = 0.05 + 0.9 * (i % 10) as f64 / 9.0;
            Trial { reliability: reliable(x), found: ((i / 10) as f64 + 0.5) / 100.0 < x, weight: 1.0 }
        };
        (0..1000).map(trial).collect()
    }

    #[test]
    fn right_chances_are_calibrated_and_others_are_not() {
        let right = trials(|x| x);
        let [offset, slope] = calibration(&right.iter().collect::<Vec<_>>());
        assert!(offset.abs() < 0.02 && (slope - 1.0).abs() < 0.02, "{offset} {slope}");
        let bold = trials(|x| x * x / (x * x + (1.0 - x) * (1.0 - x)));
        let [_, slope] = calibration(&bold.iter().collect::<Vec<_>>());
        assert!((slope - 0.5).abs() < 0.02, "{slope}");
    }

    #[test]
    fn the_area_is_a_half_for_chance_and_one_for_certainty() {
        assert_eq!(area_under_curve(&trials(|_| 0.5)), Some(0.5));
        let certain: Vec<Trial> =
            [0.2, 0.8].map(|reliability| Trial { reliability, found: reliability > 0.5, weight: 1.0 }).into();
        assert_eq!(area_under_curve(&certain), Some(1.0));
        assert_eq!(area_under_curve(&certain[..1]), None);
    }
}
