//! Repeatability between all ordered pairs of a set's shapes, of all regions or of the best few.

use std::error::Error;

use mser3d::Region;
use mser3d::comptree::StabilityRule;
use mser3d_evaluation::{Correspondence, DetectedRegions, NullShape, Overlaps};
use rayon::prelude::*;

/// What a detector found on a shape.
pub struct Found {
    pub regions: Vec<Region>,
    pub detection: DetectedRegions,
}

/// By what regions are ranked.
#[derive(Clone, Copy)]
pub enum Score {
    /// Parts that a real merge ends come first; of them, and of the others, the larger.
    Merged,
    /// How long a part lasts before a real merge.
    Lifetime,
    Stability,
    Persistence,
    Volume,
}

impl Score {
    /// The score that the regions of a rule are ranked by.
    pub fn of(rule: StabilityRule) -> Self {
        match rule {
            StabilityRule::Paper => Self::Stability,
            StabilityRule::Baseline => Self::Volume,
            StabilityRule::Windowed => Self::Merged,
        }
    }
}

/// The places of the `count` best regions. Where a score says nothing, the larger region is better.
pub fn best(regions: &[Region], score: Score, count: usize) -> Vec<usize> {
    let value = |region: &Region| match score {
        Score::Merged => f64::from(region.merge.is_some()),
        Score::Lifetime => region.merge.map_or(f64::NAN, |merge| merge.lifetime),
        Score::Stability => region.stability,
        Score::Persistence => region.persistence,
        Score::Volume => region.volume,
    };
    let value = |i: usize| Some(value(&regions[i])).filter(|x| !x.is_nan()).unwrap_or(f64::NEG_INFINITY);
    let mut order: Vec<usize> = (0..regions.len()).collect();
    order.sort_by(|&a, &b| value(b).total_cmp(&value(a)));
    order.truncate(count);
    order
}

/// Overlaps between the regions of all ordered pairs of poses.
pub struct Repeats {
    /// The pose that is searched, the pose whose regions are looked for, and their overlaps.
    pairs: Vec<(usize, usize, Overlaps)>,
    /// For each pair the overlap of each region with its match.
    matched: Vec<Vec<f64>>,
}

impl Repeats {
    pub fn new(null: &NullShape, found: &[Found]) -> Result<Self, Box<dyn Error>> {
        let same = Correspondence::identity(null.mesh().vertices().len());
        let pairs: Vec<(usize, usize)> = (0..found.len())
            .flat_map(|a| (0..found.len()).map(move |b| (a, b)))
            .filter(|(a, b)| a != b)
            .collect();
        let compare = |&(a, b): &(usize, usize)| {
            let (from, to) = (&found[a].detection, &found[b].detection);
            let overlaps = Overlaps::new(null, &from.regions, &to.regions, &same)?;
            let matched = overlaps.matched(&from.descriptors, &to.descriptors)?;
            Ok(((a, b, overlaps), matched))
        };
        let compared =
            pairs.par_iter().map(compare).collect::<Result<Vec<_>, mser3d_evaluation::EvaluationError>>()?;
        let (pairs, matched) = compared.into_iter().unzip();
        Ok(Self { pairs, matched })
    }

    /// Mean share of regions whose best overlap is above the threshold; a pose without regions counts 0.
    pub fn repeatability(&self, found: &[Found], threshold: f64) -> f64 {
        self.of_best(found, Score::Volume, usize::MAX, threshold)
    }

    /// The same of the best `count` regions of each pose, searched among the best of the other.
    pub fn of_best(&self, found: &[Found], score: Score, count: usize, threshold: f64) -> f64 {
        let kept: Vec<Vec<usize>> = found.iter().map(|f| best(&f.regions, score, count)).collect();
        mean(self.pairs.iter().map(|(a, b, overlaps)| share(overlaps, &kept[*a], &kept[*b], threshold)))
    }

    /// The same of one pose against the first, both ways, with `count` regions each.
    pub fn of_pose(&self, found: &[Found], score: Score, pose: usize, count: usize, threshold: f64) -> f64 {
        let kept = |i: usize| best(&found[i].regions, score, count);
        let wanted = |(a, b, _): &&(usize, usize, Overlaps)| (*a.min(b), *a.max(b)) == (0, pose);
        let pairs = self.pairs.iter().filter(wanted);
        mean(pairs.map(|(a, b, overlaps)| share(overlaps, &kept(*a), &kept(*b), threshold)))
    }

    /// Of the regions of the second shape of a pair, the share found again on the first, and the share whose nearest
    /// descriptor is of a region that overlaps above the threshold.
    pub fn of_pair(&self, found: &[Found], pair: [usize; 2], threshold: f64) -> [f64; 2] {
        let all = pair.map(|shape| best(&found[shape].regions, Score::Volume, usize::MAX));
        let place = self.pairs.iter().position(|(a, b, _)| [*a, *b] == pair);
        place.map_or([0.0; 2], |at| {
            let again = share(&self.pairs[at].2, &all[0], &all[1], threshold);
            [again, mser3d_evaluation::share_above(&self.matched[at], threshold)]
        })
    }

    /// For each other shape the best overlap there of each region of one.
    pub fn best_of(&self, shape: usize) -> impl Iterator<Item = Vec<f64>> {
        self.pairs.iter().filter(move |pair| pair.1 == shape).map(|(_, _, overlaps)| overlaps.best())
    }

    /// Mean share of regions whose nearest descriptor is of a region that overlaps above the threshold.
    pub fn matching(&self, threshold: f64) -> f64 {
        mean(self.matched.iter().map(|m| mser3d_evaluation::share_above(m, threshold)))
    }

    /// Share of all regions that are found on no other pose at the threshold.
    pub fn nowhere(&self, found: &[Found], threshold: f64) -> f64 {
        let mut lost = 0;
        for (pose, f) in found.iter().enumerate() {
            let here: Vec<Vec<f64>> = self.best_of(pose).collect();
            lost += (0..f.regions.len()).filter(|&r| here.iter().all(|best| best[r] <= threshold)).count();
        }
        let all: usize = found.iter().map(|f| f.regions.len()).sum();
        lost as f64 / all.max(1) as f64
    }
}

fn share(overlaps: &Overlaps, from: &[usize], to: &[usize], threshold: f64) -> f64 {
    let again = |&&t: &&usize| from.iter().any(|&n| overlaps.get(t, n) > threshold);
    if to.is_empty() { 0.0 } else { to.iter().filter(again).count() as f64 / to.len() as f64 }
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0), |(sum, n), x| (sum + x, n + 1));
    sum / f64::from(count.max(1))
}

/// Mean number of regions of a shape.
pub fn regions(found: &[Found]) -> f64 {
    found.iter().map(|f| f.regions.len()).sum::<usize>() as f64 / found.len().max(1) as f64
}

/// The number of regions of the shape that has fewest.
pub fn fewest(found: &[Found]) -> usize {
    found.iter().map(|f| f.regions.len()).min().unwrap_or_default()
}
