//! The tables.

use std::error::Error;
use std::fmt::Write;

use super::figure::Row;
use crate::pose_sets::{Kind, PoseSet};
use crate::repeats::{Score, fewest, regions};

/// A line for each detector and set.
pub fn csv(sets: &[PoseSet], rows: &[Row]) -> String {
    let mut text = String::from(
        "group,choice,set,shapes,regions,fewest_regions,repeatability_0.7,repeatability_0.8,repeatability_0.9,\
         nowhere_0.7,matching_0.8\n",
    );
    for row in rows {
        for (i, set) in sets.iter().enumerate() {
            let (found, repeats) = (&row.found[i], &row.repeats[i]);
            let [a, b, c] = [0.7, 0.8, 0.9].map(|t| repeats.repeatability(found, t));
            let (nowhere, matching) = (repeats.nowhere(found, 0.7), repeats.matching(0.8));
            let _ = writeln!(
                text,
                "{},\"{}\",{},{},{:.2},{},{a:.4},{b:.4},{c:.4},{nowhere:.4},{matching:.4}",
                row.detector.group,
                row.detector.title,
                set.name,
                set.poses.len(),
                regions(found),
                fewest(found),
            );
        }
    }
    text
}

/// The page: choices, in the mean and set by set, then the same number of regions, then every pose.
pub fn markdown(sets: &[PoseSet], rows: &[Row]) -> Result<String, Box<dyn Error>> {
    let mut text = String::from(HEAD);
    mean_of_sets(&mut text, rows);
    choices(&mut text, sets, rows);
    text.push_str(CHOICE);
    equal_numbers(&mut text, sets, rows);
    between_persons(&mut text, sets, rows)?;
    every_pose(&mut text, sets, rows)?;
    Ok(text)
}

fn mean_of_sets(text: &mut String, rows: &[Row]) {
    text.push_str("## Mean of the sets\n\n| | regions | .7 | .8 | .9 | nowhere | matching |\n|---|---|---|---|---|---|---|\n");
    for row in rows {
        let sets = row.found.iter().zip(&row.repeats);
        let values: Vec<[f64; 6]> = sets
            .map(|(found, repeats)| {
                let [a, b, c] = [0.7, 0.8, 0.9].map(|t| repeats.repeatability(found, t));
                [regions(found), a, b, c, repeats.nowhere(found, 0.7), repeats.matching(0.8)]
            })
            .collect();
        let mean = |i: usize| values.iter().map(|v| v[i]).sum::<f64>() / values.len() as f64;
        let [n, a, b, c, nowhere, matching] = [0, 1, 2, 3, 4, 5].map(mean);
        let title = &row.detector.title;
        let _ =
            writeln!(text, "| {title} | {n:.1} | {a:.3} | {b:.3} | {c:.3} | {nowhere:.3} | {matching:.3} |");
    }
    text.push('\n');
}

fn choices(text: &mut String, sets: &[PoseSet], rows: &[Row]) {
    for (i, set) in sets.iter().enumerate() {
        let _ = writeln!(
            text,
            "## {}: {} {}\n\n| | regions (fewest) | .7 | .8 | .9 | nowhere | matching |",
            set.name,
            set.poses.len(),
            match set.kind {
                Kind::Poses => "poses",
                Kind::Persons => "persons",
            }
        );
        text.push_str("|---|---|---|---|---|---|---|\n");
        for row in rows {
            let (found, repeats) = (&row.found[i], &row.repeats[i]);
            let [a, b, c] = [0.7, 0.8, 0.9].map(|t| repeats.repeatability(found, t));
            let _ = writeln!(
                text,
                "| {} | {:.1} ({}) | {a:.3} | {b:.3} | {c:.3} | {:.3} | {:.3} |",
                row.detector.title,
                regions(found),
                fewest(found),
                repeats.nowhere(found, 0.7),
                repeats.matching(0.8)
            );
        }
        text.push('\n');
    }
}

/// Detectors, and by what their regions are ranked.
const RANKED: [(&str, &str, Score); 7] = [
    ("default", "default, merged parts first, by volume", Score::Merged),
    ("default", "default by lifetime", Score::Lifetime),
    ("default", "default by stability", Score::Stability),
    ("default", "default by persistence", Score::Persistence),
    ("default", "default by volume", Score::Volume),
    ("paper", "paper by stability", Score::Stability),
    ("baseline", "baseline by volume", Score::Volume),
];

fn equal_numbers(text: &mut String, sets: &[PoseSet], rows: &[Row]) {
    text.push_str(EQUAL);
    for (i, set) in sets.iter().enumerate() {
        let counts = [4, 6, 8, 10, 12, 16, 20];
        let _ = write!(text, "### {}\n\n| ", set.name);
        for count in counts {
            let _ = write!(text, "| {count} ");
        }
        let _ = writeln!(text, "|\n|---|{}", "---|".repeat(counts.len()));
        for (title, label, score) in RANKED {
            let Some(row) = rows.iter().find(|r| r.detector.title == title) else { continue };
            let _ = write!(text, "| {label} ");
            for count in counts {
                if fewest(&row.found[i]) < count {
                    text.push_str("| ");
                    continue;
                }
                let [b, c] = [0.8, 0.9].map(|t| row.repeats[i].of_best(&row.found[i], score, count, t));
                let _ = write!(text, "| {b:.2} / {c:.2} ");
            }
            text.push_str("|\n");
        }
        text.push('\n');
    }
}

/// The default and the other stability rules.
fn modes(rows: &[Row]) -> Result<[&Row; 3], Box<dyn Error>> {
    let row = |title: &str| rows.iter().find(|r| r.detector.title == title).ok_or("a mode is missing");
    Ok([row("default")?, row("paper")?, row("baseline")?])
}

fn between_persons(text: &mut String, sets: &[PoseSet], rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let modes = modes(rows)?;
    for (i, set) in sets.iter().enumerate().filter(|(_, set)| set.kind == Kind::Persons) {
        let _ = writeln!(text, "{PERSONS_START} {}{PERSONS}", set.name);
        for (searched, (on, _)) in set.poses.iter().enumerate() {
            for (sought, (of, _)) in set.poses.iter().enumerate().filter(|(s, _)| *s != searched) {
                let _ = write!(text, "| {of} | {on} |");
                for row in modes {
                    let found = &row.found[i];
                    let [b, c] = [0.8, 0.9].map(|t| row.repeats[i].of_pair(found, [searched, sought], t));
                    let count = found[sought].regions.len();
                    let _ = write!(text, " {count} | {:.2} / {:.2} | {:.2} |", b[0], c[0], b[1]);
                }
                text.push('\n');
            }
        }
        text.push('\n');
    }
    Ok(())
}

fn every_pose(text: &mut String, sets: &[PoseSet], rows: &[Row]) -> Result<(), Box<dyn Error>> {
    let [ours, paper, baseline] = modes(rows)?;
    text.push_str(POSES);
    let of_one_body = |(_, set): &(usize, &PoseSet)| set.kind == Kind::Poses;
    for (i, set) in sets.iter().enumerate().filter(of_one_body) {
        for (pose, (name, _)) in set.poses.iter().enumerate().skip(1) {
            let of = |row: &Row, count, threshold| {
                let score = Score::of(row.detector.parameters.stability.rule);
                row.repeats[i].of_pose(&row.found[i], score, pose, count, threshold)
            };
            let count = |row: &Row| row.found[i][0].regions.len().min(row.found[i][pose].regions.len());
            let cells = |row: &Row, count| {
                let [b, c] = [0.8, 0.9].map(|t| of(row, count, t));
                format!("{b:.2} / {c:.2}")
            };
            let (with_paper, with_baseline) =
                (count(ours).min(count(paper)), count(ours).min(count(baseline)));
            let _ = writeln!(
                text,
                "| {} | {name} | {with_paper} | {} | {} | {with_baseline} | {} | {} |",
                set.name,
                cells(ours, with_paper),
                cells(paper, with_paper),
                cells(ours, with_baseline),
                cells(baseline, with_baseline),
            );
        }
    }
    Ok(())
}

const HEAD: &str = "\
# Which regions are selected, and how well they repeat

Made by `cargo xtask selection` on 45,000 voxels and 100 eigenpairs. Every choice differs from the defaults in one
thing. Each shape of a set is compared with each other, both ways: a region is found again if its overlap with a
region of the other shape is above 0.7, 0.8 or 0.9 (columns), by vertex area, the mirror image allowed where the
symmetry is known (not of the fox and the rigged figure). *nowhere* is the share of regions that no other shape has
at an overlap of 0.7; *matching* the share whose nearest descriptor is of a region with an overlap above 0.8.

";
const CHOICE: &str = "\
## What the tables say

* **Window.** From 0.2 to 0.3 it hardly matters. A smaller window finds regions that repeat less at 0.9; a larger one finds
  fewer, which repeat no better.
* **Parts.** Without a least lifetime nearly simultaneous merges count in the order in which they happen to come, and bumps
  end parts: fewer regions repeat, most of all on the fox. From 0.05 to 0.2 it hardly matters. Blunt borders are rare on
  these bodies; what they cost are regions on balls and bricks.
* **Weight.** H(v,v) and 1/H(u,v) on links find nearly the same regions. The commute time finds fewer, which repeat less
  at 0.9: it has one scale. Diffusion distance and curvature repeat badly. Smoothed for 0.01, H(v,v) loses some small
  regions and repeats as well.
* **Time scales.** Four scales an octave apart find more regions than one or two, and these repeat better: what one tree
  misses on some pose is mostly in the next. Most is gained on the fox, the hardest of the poses. More scales, or longer
  ones, add regions and gain nothing.
* **Neighbours.** 6 and 26 are equal: the solid is the same, and H is smooth. 6 is cheaper.
* **Altitude.** On a linear scale fewer regions repeat.
* **Pooling.** At 0.7 different parts of a limb are taken for one region on one pose and for two on the next. At 0.9 more
  regions are kept that are nearly the same, which makes each easier to find again.
* **Filters.** Diversity hardly matters after pooling. In the mean regions down to 0.5 % of the volume
  repeat as well as those over 1 %, but fewer are recognized.

";
const EQUAL: &str = "\
## The same number of regions

The best regions of each pose by a score, searched among as many of the other pose: repeatability at 0.8 / 0.9. More
regions make it easier to find one again, so detectors are compared at equal numbers. A detector that fills each limb
with nested regions, as `paper` does, loses its lead here.

Regions that a real merge ends come first, of these and of the others the largest. Where such a part ends is decided by the
shape there, not by a maximum on a flat curve, and voxels blur the border of a large part less. Stability ranks badly: the
stablest regions are middles of limbs, and they slide. Nor does
lifetime rank a few well, how long a part lasts from the real merge it came from to the one that ends it; on the fox
least of all.

";
const PERSONS_START: &str = "## Between persons:";
const PERSONS: &str = "

The regions of one person looked for on another: how many there are, the share found again at 0.8 / 0.9, and the share
whose nearest descriptor is of a region with an overlap above 0.8. Each person has the voxel size and the times that
its own volume gives.

| regions of | looked for on | default | found | matched | paper | found | matched | baseline | found | matched |
|---|---|---|---|---|---|---|---|---|---|---|";
const POSES: &str = "\
## Every pose against the first

As many regions of each as the poorer of the two detectors has on the poorer pose, both ways, at 0.8 / 0.9. Of the default
those that a real merge ends come first, the largest first; `paper` is ranked by stability, `baseline` by volume.

| set | pose | regions | default | paper | regions | default | baseline |
|---|---|---|---|---|---|---|---|
";
