//! What may become a part: the regions of a body's trees, each with its narrowest border.

use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;
use std::ops::Range;

use mser3d_comptree::{
    AltitudeScale, ComponentTree, Merge, StabilityParameters, StabilityRule, StableRegion, stable_regions,
};
use mser3d_descriptors::{Descriptors, HksParameters, TimeScale, hks};
use mser3d_shape::{Domain, Eigenbasis, IndexSet};
use rayon::prelude::*;

use super::PartParameters;
use super::borders::{BodyLinks, Bordered, down, narrowest, of_nodes};
use super::twins::{like_volume, twin_groups};
use crate::weighing::{KEPT_ELEMENTS, in_turn};
use crate::{Error, Features};

/// The share of a region that its part keeps at least when its border is moved to a narrow place.
const KEPT: f64 = 0.5;

/// The growth at a merge of two that are alike, not of three.
const TWO: f64 = 2.5;

/// The share of a lifetime after which a merge is still under way.
const SOON: f64 = 0.05;

/// Lifetimes of limbs that are not ends of rods, whatever the altitude scale: more than ln 2.
const LASTS: f64 = 1.0;

/// The share of a body from which a component is all of it.
const ALL: f64 = 0.95;

/// From how many times a border on a cross-section is much wider. Where heat is nearly the same everywhere, a level has steps,
/// and its border is up to 1.6 times the cross-section of a rod.
const WIDER: f64 = 2.0;

/// The times at which candidates are compared.
const TWIN_TIMES: [f64; 6] = [0.05, 0.1, 0.2, 0.5, 1.0, 2.0];

/// A node of a tree that may become a part.
pub(super) struct Candidate {
    /// The region that it stands for.
    pub region: Option<usize>,
    /// The tree that it is of.
    pub tree: usize,
    /// Its elements, numbered as in the shape.
    pub elements: IndexSet,
    /// Volume or area.
    pub volume: f64,
    /// How surely it is a limb.
    pub score: Score,
}

/// What candidates are ranked by.
#[derive(Clone, Copy, Debug)]
pub(super) struct Score {
    /// How long it lasts before a real merge ends it; 0 where none does.
    pub lifetime: f64,
    /// The length of a round limb of its volume and border, over its radius: the larger, the narrower is what it hangs by.
    pub narrowness: f64,
}

fn lifetime(region: &StableRegion) -> f64 {
    region.merge.map_or(0.0, |merge| merge.lifetime)
}

/// How surely a region is a part of its own.
fn score(region: &StableRegion, place: &Bordered, is_end: bool, domain: Domain) -> Score {
    let Bordered { volume, border, .. } = *place;
    let radius = match domain {
        Domain::Volume => (border / PI).sqrt(),
        Domain::Surface => border / (2.0 * PI),
    };
    let lifetime = match () {
        // What heat does not flow out of lasts for ever.
        () if border == 0.0 => f64::INFINITY,
        () if is_end => 0.0,
        () => lifetime(region),
    };
    Score { lifetime, narrowness: volume / border / radius }
}

/// Whether a region is the end of a rod and not a limb: it merges with one like it, then there is nothing left that they could
/// be limbs of, and nowhere is it much wider than its border. At an end that is cut off straight, the heat kernel is twice that
/// in the middle, so that it lasts ln 2.
fn is_end_of_rod(
    tree: &ComponentTree,
    region: &StableRegion,
    place: &Bordered,
    scale: AltitudeScale,
    measure: f64,
) -> bool {
    let meets_its_like = |merge: &Merge| merge.growth < TWO && merge.lifetime < LASTS;
    let Some(merge) = region.merge.filter(meets_its_like) else { return false };
    let level = |node: u32| match scale {
        AltitudeScale::Log => tree.altitude(node).max(f64::MIN_POSITIVE).ln(),
        AltitudeScale::Linear => tree.altitude(node),
    };
    let Some(merged) = tree.parent(region.node) else { return false };
    let soon = |&node: &u32| (level(node) - level(merged)).abs() <= SOON * merge.lifetime;
    let last = std::iter::successors(Some(merged), |&node| tree.parent(node)).take_while(soon).last();
    let is_all = last.is_some_and(|node| tree.volume(node) >= ALL * measure);
    is_all && place.bulge < WIDER
}

/// The candidates of a body, in groups that come and go together.
pub(super) struct Candidates {
    pub all: Vec<Candidate>,
    /// Places of candidates.
    pub groups: Vec<Vec<usize>>,
}

/// A region of a tree with its narrowest border.
struct Narrowed {
    top: StableRegion,
    place: Bordered,
}

impl Candidates {
    /// Those of all trees of a body: of trees that are not kept, one after the other.
    pub fn of(
        features: &Features,
        body: usize,
        links: &BodyLinks,
        mass: &[f64],
        parameters: &PartParameters,
    ) -> Result<Self, Error> {
        let own: Vec<usize> =
            (0..features.trees.len()).filter(|&tree| features.trees[tree].body == body).collect();
        let kept = own.iter().all(|&tree| features.trees[tree].tree.is_some());
        let in_turn = in_turn(features.shape.len(), features.parameters.weight, own.len(), kept);
        let heat = Heat::new(&features.bodies[body].basis)?;
        let of_tree = |tree: usize| Self::of_tree(features, tree, &heat, links, mass, parameters);
        let found: Vec<Self> =
            own.into_par_iter().with_min_len(in_turn).map(of_tree).collect::<Result<_, Error>>()?;
        let mut all = Self { all: Vec::new(), groups: Vec::new() };
        for of_tree in found {
            let first = all.all.len();
            let moved = |group: Vec<usize>| group.into_iter().map(|place| first + place).collect();
            all.groups.extend(of_tree.groups.into_iter().map(moved));
            all.all.extend(of_tree.all);
        }
        Ok(all)
    }

    fn of_tree(
        features: &Features,
        number: usize,
        heat: &Heat,
        links: &BodyLinks,
        mass: &[f64],
        parameters: &PartParameters,
    ) -> Result<Self, Error> {
        let tree = &*features.tree(number)?;
        let body = features.trees[number].body;
        let searched = &features.bodies[body];
        let rule = stability(&features.parameters.stability, parameters);
        let tops = stable_regions(tree, &rule)?.regions;
        let borders = of_nodes(tree, links, features.parameters.weight);
        let mut found: Vec<Narrowed> = Vec::new();
        for top in tops {
            let place = narrowest(tree, &borders, top.node, KEPT);
            // Of several with one border, such as a limb and a chance union of it with a little more, the one that lasts.
            match found.iter_mut().find(|other| other.place.node == place.node) {
                Some(other) if lifetime(&other.top) >= lifetime(&top) => {}
                Some(other) => other.top = top,
                None => found.push(Narrowed { top, place }),
            }
        }
        let groups = groups(heat, tree, &found)?;
        // The border of twins is where that of the smallest is.
        for group in &groups {
            let smallest = group.iter().map(|&c| found[c].place.volume).fold(f64::INFINITY, f64::min);
            for &member in group {
                let place = &mut found[member].place;
                let node = cut_off(tree, place.node, smallest);
                if node != place.node {
                    *place = narrowest(tree, &borders, node, 1.0);
                }
            }
        }
        drop(borders);
        let (domain, measure) = (searched.basis.domain(), searched.measure());
        let candidate = |Narrowed { top, place }: Narrowed| {
            let element = |&v: &u32| searched.elements[v as usize];
            let elements = tree.vertices(place.node).iter().map(element);
            let is_end = is_end_of_rod(tree, &top, &place, rule.altitude, measure);
            Ok(Candidate {
                region: stands_for(features, body, tree.vertices(top.node), &searched.elements, mass)?,
                tree: number,
                elements: IndexSet::from_members(features.shape.len(), elements)?,
                volume: place.volume,
                score: score(&top, &place, is_end, domain),
            })
        };
        Ok(Self { all: found.into_par_iter().map(candidate).collect::<Result<_, Error>>()?, groups })
    }
}

/// How the regions of a tree are found that may become parts: by the windowed rule, which knows real merges, none dropped
/// because it is nearly as large as another.
fn stability(own: &StabilityParameters, parameters: &PartParameters) -> StabilityParameters {
    let usual = StabilityParameters::default();
    StabilityParameters {
        rule: StabilityRule::Windowed,
        altitude: own.altitude,
        min_volume_fraction: parameters.min_volume_fraction,
        max_volume_fraction: usual.max_volume_fraction.max(parameters.min_volume_fraction),
        // Ends of rods are told by other means.
        sharp_borders: false,
        min_diversity: 0.0,
        ..usual
    }
}

/// Groups of twins among regions of a tree: those that end alike. They are described by the logarithm of their mean heat
/// kernel at some times, both cut off where they have the same volume.
fn groups(heat: &Heat, tree: &ComponentTree, found: &[Narrowed]) -> Result<Vec<Vec<usize>>, Error> {
    let volumes: Vec<f64> = found.iter().map(|c| c.place.volume).collect();
    let may_be_twins = |a: usize, b: usize| {
        let (a, b) = (&found[a], &found[b]);
        let nested = |x: &Narrowed, y: &Narrowed| tree.contains(x.place.node, y.place.node);
        let ends = |x: &Narrowed| x.top.merge.is_some();
        ends(a) == ends(b) && !nested(a, b) && !nested(b, a)
    };
    let cut_alike = |a: usize, b: usize| {
        let volume = volumes[a].min(volumes[b]);
        [a, b].map(|region| cut_off(tree, found[region].place.node, volume))
    };
    let pairs = (0..found.len()).flat_map(|b| (0..b).map(move |a| (a, b)));
    let compared = pairs.filter(|&(a, b)| like_volume(volumes[a], volumes[b]) && may_be_twins(a, b));
    let heat = heat.means(tree, compared.flat_map(|(a, b)| cut_alike(a, b)).collect())?;
    let distance = |a: usize, b: usize| {
        let [a, b] = cut_alike(a, b).map(|node| heat[&node].map(f64::ln));
        let squares: f64 = a.iter().zip(b).map(|(x, y)| (x - y).powi(2)).sum();
        (squares / TWIN_TIMES.len() as f64).sqrt()
    };
    Ok(twin_groups(&volumes, |a, b| may_be_twins(a, b).then(|| distance(a, b))))
}

/// Elements whose heat kernel is looked at at a time.
const BLOCK: usize = 1 << 14;

/// The heat kernel of elements at the times at which candidates are compared.
struct Heat<'b> {
    basis: &'b Eigenbasis,
    times: HksParameters,
    /// That of all elements, unless the shape is large.
    all: Option<Descriptors>,
}

impl<'b> Heat<'b> {
    fn new(basis: &'b Eigenbasis) -> Result<Self, Error> {
        // The unit is that of the whole basis, which is not asked for with each block.
        let unit = basis.unit_time();
        let times = HksParameters { times: TWIN_TIMES.map(|time| TimeScale::Absolute(time * unit)).to_vec() };
        let all = (basis.mass().len() <= KEPT_ELEMENTS).then(|| hks(basis, &times, None)).transpose()?;
        Ok(Self { basis, times, all })
    }

    /// Adds that of some elements, times their mass, to sums; each takes those in its range of places.
    fn add(&self, elements: &[u32], sums: &mut [(Range<usize>, &mut Sums)]) -> Result<(), Error> {
        let made = match self.all {
            Some(_) => None,
            None => Some(hks(self.basis, &self.times, Some(elements))?),
        };
        let row = |place: usize| match (&self.all, &made) {
            (Some(all), _) => all.row(elements[place] as usize),
            (None, Some(made)) => made.row(place),
            (None, None) => &[],
        };
        for (places, sums) in sums {
            for place in places.clone() {
                let mass = self.basis.mass()[elements[place] as usize];
                sums.iter_mut().zip(row(place)).for_each(|(sum, h)| *sum += mass * h);
            }
        }
        Ok(())
    }

    /// The mean over some nodes of a tree.
    fn means(&self, tree: &ComponentTree, nodes: BTreeSet<u32>) -> Result<BTreeMap<u32, Sums>, Error> {
        let mut sums: Vec<(u32, Range<usize>, Sums)> =
            nodes.into_iter().map(|node| (node, tree.slice(node), Sums::default())).collect();
        sums.sort_by_key(|(_, slice, _)| slice.start);
        // Slices are nested or disjoint, and each element is looked at once.
        let mut next = 0;
        for number in 0..sums.len() {
            let end = sums[number].1.end;
            next = next.max(sums[number].1.start);
            while next < end {
                let block = next..end.min(next + BLOCK);
                let within = |slice: &Range<usize>| {
                    slice.start.max(block.start) - block.start
                        ..slice.end.clamp(block.start, block.end) - block.start
                };
                let reached = sums[number..].iter_mut().take_while(|(_, slice, _)| slice.start < block.end);
                let mut reached: Vec<(Range<usize>, &mut Sums)> =
                    reached.map(|(_, slice, sums)| (within(slice), sums)).collect();
                self.add(&tree.permutation()[block.clone()], &mut reached)?;
                next = block.end;
            }
        }
        let mean = |(node, _, sums): (u32, _, Sums)| (node, sums.map(|sum| sum / tree.volume(node)));
        Ok(sums.into_iter().map(mean).collect())
    }
}

/// A number for each time.
type Sums = [f64; TWIN_TIMES.len()];

/// The node down the branch that has about this volume, or the node itself where there is none.
fn cut_off(tree: &ComponentTree, node: u32, volume: f64) -> u32 {
    let chain = down(tree, node, 0.9 * volume);
    chain.into_iter().find(|&below| tree.volume(below) <= 1.02 * volume).unwrap_or(node)
}

/// The pooled region that a region of a tree is, or that was kept in its place: the one that overlaps it most, at least by
/// half.
fn stands_for(
    features: &Features,
    body: usize,
    vertices: &[u32],
    elements: &[u32],
    mass: &[f64],
) -> Result<Option<usize>, Error> {
    let own = IndexSet::from_members(features.shape.len(), vertices.iter().map(|&v| elements[v as usize]))?;
    let volume: f64 = own.members().map(|e| mass[e]).sum();
    let mut best = (0.5, None);
    for (place, region) in features.regions.iter().enumerate().filter(|(_, region)| region.body == body) {
        if volume.min(region.volume) < best.0 * volume.max(region.volume) {
            continue;
        }
        let common: f64 =
            region.elements.iter().filter(|&&e| own.contains(e as usize)).map(|&e| mass[e as usize]).sum();
        let overlap = common / (volume + region.volume - common);
        if overlap > best.0 {
            best = (overlap, Some(place));
        }
    }
    Ok(best.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_comptree::Polarity;

    #[test]
    fn means_that_are_made_as_they_come_are_those_of_a_table() {
        let count = 3 * BLOCK;
        let functions: Vec<f64> = (0..2 * count).map(|i| (i as f64 * 0.37).sin()).collect();
        let basis = Eigenbasis::new(Domain::Volume, vec![0.5; count], vec![0.0, 1.0], functions).unwrap();
        let edges: Vec<[u32; 2]> = (1..count as u32).map(|v| [v - 1, v]).collect();
        let heights: Vec<f64> = (0..count).map(|i| (i as f64 * 1e-3).sin() + 1e-6 * i as f64).collect();
        let tree =
            ComponentTree::from_vertex_weights(&edges, &heights, basis.mass(), Polarity::Sublevel).unwrap();
        let nodes: BTreeSet<u32> = (0..tree.len() as u32).rev().step_by(1777).collect();
        let kept = Heat::new(&basis).unwrap();
        let none = Heat { all: None, ..Heat::new(&basis).unwrap() };
        let (means, table) = (none.means(&tree, nodes.clone()).unwrap(), kept.all.as_ref().unwrap());
        assert_eq!(means, kept.means(&tree, nodes.clone()).unwrap());
        for node in nodes {
            let mut sums = Sums::default();
            for &v in tree.vertices(node) {
                let mass = basis.mass()[v as usize];
                sums.iter_mut().zip(table.row(v as usize)).for_each(|(sum, h)| *sum += mass * h);
            }
            assert_eq!(means[&node], sums.map(|sum| sum / tree.volume(node)));
        }
    }
}
