//! `cargo xtask sides`: whether regions are matched to the right side of the body, without a symmetry map.

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use mser3d::descriptors::{Descriptors, MatchParameters, SiHksParameters, match_regions};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::VoxelizeParameters;
use mser3d::{Descriptor, Parameters, Sidedness, Sides};
use mser3d_evaluation::{Correspondence, IndexSet, Overlaps};
use rayon::prelude::*;

use crate::pose_sets::{PoseSet, SetArguments};

/// What `cargo xtask sides` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    /// Where sides.md is written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// At which overlap a region is found again.
const FOUND: f64 = 0.8;

/// Numbers in a row of the table.
const COLUMNS: usize = 10;

/// What was found on a shape.
struct Found {
    regions: Vec<IndexSet>,
    /// Descriptors without sides, and with.
    plain: Descriptors,
    sided: Descriptors,
    sides: Sides,
}

/// Sums over ordered pairs of shapes.
#[derive(Default)]
struct Sums {
    pairs: f64,
    /// Shares of regions: found again on the same side, matched by each descriptor, and by the better of the nearest
    /// without sides and its twin.
    found: f64,
    plain: f64,
    sided: f64,
    bound: f64,
    /// All together, as `mser3d match` does it.
    together: f64,
    /// The same where left and right may be exchanged.
    plain_mirrored: f64,
    sided_mirrored: f64,
    /// Regions that are found again and have twins on both shapes, and those of them that are nearer to the right one.
    twinned: usize,
    right: usize,
}

/// Measures all sets, and writes the page.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let mut rows = String::new();
    let mut means: Vec<[f64; COLUMNS]> = Vec::new();
    for set in arguments.sets.read()? {
        eprintln!("{}", set.name);
        let found = detect(&set, arguments.sets.voxels)?;
        let is_sided = |f: &Found| matches!(f.sides.sidedness, Sidedness::Sided { .. });
        let sided = found.iter().filter(|f| is_sided(f)).count();
        let all = sums(&set, &found, |_| true)?;
        let bodies = sums(&set, &found, is_sided)?;
        let numbers = [
            all.found / all.pairs,
            all.plain / all.pairs,
            all.sided / all.pairs,
            all.together / all.pairs,
            all.bound / all.pairs,
            all.right as f64 / all.twinned as f64,
            bodies.sided / bodies.pairs,
            bodies.together / bodies.pairs,
            all.plain_mirrored / all.pairs,
            all.sided_mirrored / all.pairs,
        ];
        write!(rows, "| {} | {sided} of {} |", set.name, found.len())?;
        write_row(&mut rows, &numbers)?;
        means.push(numbers);
    }
    if means.len() > 1 {
        rows.push_str("| mean | |");
        let mean = |i: usize| {
            let values: Vec<f64> = means.iter().map(|m| m[i]).filter(|x| x.is_finite()).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        write_row(&mut rows, &std::array::from_fn(mean))?;
    }
    let text = page(arguments.sets.voxels, &rows);
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("sides.md"), &text)?;
    print!("{text}");
    Ok(())
}

fn write_row(rows: &mut String, numbers: &[f64; COLUMNS]) -> std::fmt::Result {
    for number in numbers {
        match number.is_finite() {
            true => write!(rows, " {number:.3} |")?,
            false => rows.push_str(" - |"),
        }
    }
    rows.push('\n');
    Ok(())
}

fn detect(set: &PoseSet, voxels: usize) -> Result<Vec<Found>, Box<dyn Error>> {
    let solved = set.solve(voxels, &VoxelizeParameters::default(), &SpectrumParameters::default())?;
    let sided = Parameters { reference_measure: set.reference_measure(&solved), ..Parameters::default() };
    let plain =
        Parameters { descriptor: Descriptor::SizedSiHks(SiHksParameters::default()), ..sided.clone() };
    let detect = |solved: &crate::solved::Solved| -> Result<Found, Box<dyn Error>> {
        let regions = solved.regions(&sided)?;
        let described = solved.describe(&regions, &sided)?;
        let plain = solved.describe(&regions, &plain)?.descriptors;
        let (sided, sides) = (described.descriptors, described.sides);
        Ok(Found { regions: solved.vertex_sets(&regions)?, plain, sided, sides })
    };
    let found = solved.par_iter().map(|solved| detect(solved).map_err(|e| e.to_string()));
    Ok(found.collect::<Result<_, _>>()?)
}

/// Sums over the ordered pairs of those shapes that count.
fn sums(set: &PoseSet, found: &[Found], counts: impl Fn(&Found) -> bool) -> Result<Sums, Box<dyn Error>> {
    let mut sums = Sums::default();
    let same = Correspondence::identity(set.null.mesh().vertices().len());
    for (a, from) in found.iter().enumerate().filter(|(_, f)| counts(f)) {
        for (b, to) in found.iter().enumerate().filter(|(_, f)| counts(f)) {
            if a == b {
                continue;
            }
            let direct = Overlaps::direct(&set.null, &from.regions, &to.regions, &same)?;
            let either = Overlaps::new(&set.null, &from.regions, &to.regions, &same)?;
            sums.add(from, to, &direct, &either)?;
        }
    }
    Ok(sums)
}

impl Sums {
    fn add(
        &mut self,
        from: &Found,
        to: &Found,
        direct: &Overlaps,
        either: &Overlaps,
    ) -> Result<(), Box<dyn Error>> {
        let count = to.regions.len();
        let share =
            |hit: &dyn Fn(usize) -> bool| (0..count).filter(|&r| hit(r)).count() as f64 / count.max(1) as f64;
        let plain: Vec<Option<usize>> = to.plain.rows().map(|row| nearest(row, &from.plain)).collect();
        let sided: Vec<Option<usize>> = to.sided.rows().map(|row| nearest(row, &from.sided)).collect();
        let (queries, references) = ((&to.sided, &to.sides.cosines), (&from.sided, &from.sides.cosines));
        let together: Vec<Option<usize>> = match_regions(queries, references, &MatchParameters::default())?
            .iter()
            .map(|m| Some(m.partner.reference))
            .collect();
        let is =
            |overlaps: &Overlaps, r: usize, n: Option<usize>| n.is_some_and(|n| overlaps.get(r, n) > FOUND);
        let best =
            |r: usize| (0..from.regions.len()).max_by(|&m, &n| direct.get(r, m).total_cmp(&direct.get(r, n)));
        self.pairs += 1.0;
        self.found += share(&|r| is(direct, r, best(r)));
        self.plain += share(&|r| is(direct, r, plain[r]));
        self.sided += share(&|r| is(direct, r, sided[r]));
        self.together += share(&|r| is(direct, r, together.get(r).copied().flatten()));
        self.bound += share(&|r| {
            let twin = plain[r].and_then(|n| from.sides.twins[n]);
            is(direct, r, plain[r]) || is(direct, r, twin)
        });
        self.plain_mirrored += share(&|r| is(either, r, plain[r]));
        self.sided_mirrored += share(&|r| is(either, r, sided[r]));
        for r in (0..count).filter(|&r| to.sides.twins[r].is_some() && is(direct, r, best(r))) {
            let Some((right, twin)) = best(r).and_then(|n| Some((n, from.sides.twins[n]?))) else { continue };
            let far = |n: usize| distance(to.sided.row(r), from.sided.row(n));
            self.twinned += 1;
            self.right += usize::from(far(right) < far(twin));
        }
        Ok(())
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum()
}

fn nearest(row: &[f64], among: &Descriptors) -> Option<usize> {
    let distances = among.rows().map(|other| distance(row, other)).enumerate();
    distances.min_by(|x, y| x.1.total_cmp(&y.1)).map(|(n, _)| n)
}

fn page(voxels: usize, rows: &str) -> String {
    format!(
        "# Left and right

Made by `cargo xtask sides` on {voxels} voxels. Every region is looked for on every other pose of its set. It is found
again if a region there overlaps it by more than {FOUND}, by vertex area and on the same side of the body: no
symmetry is used, except in the last two columns. *Matched* means that the nearest in descriptor space is such a region.

* *Bodies with sides*: on how many left and right can be told; the others are the same front and back as far as voxels
  show, or have no two regions that are mirror images.
* *Without sides*: the descriptor `sized-si-hks`. *With sides*: the default, `sided-si-hks`. *Together*: by that, and so
  that the matches hold together, as `mser3d match` does it. *If sides were known*: the better of the nearest without
  sides and its twin.
* *Side right*: of regions that are found again and have a twin on both shapes, the share that is nearer to the right one
  than to its twin.
* *Bodies with sides only*: with sides, and together, between those bodies.
* *Either side*: the better of the direct and the mirrored overlap counts, where the symmetry is known.

| set | bodies with sides | found again | without sides | with sides | together | if sides were known | side right | bodies with sides only | the same together | either side, without sides | either side, with sides |
|---|---|---|---|---|---|---|---|---|---|---|---|
{rows}"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_is_by_all_numbers() {
        let among = Descriptors::new(2, vec![0.0, 5.0, 1.0, -1.0, 1.0, 1.0]).unwrap();
        assert_eq!(nearest(&[0.0, 1.0], &among), Some(2));
        assert_eq!(nearest(&[0.0, 1.0], &Descriptors::new(2, vec![]).unwrap()), None);
    }
}
