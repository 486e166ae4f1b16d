use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use mser3d_comptree::{ComponentTree, Merge, Polarity, Selection, TreeRegions, pool};
use mser3d_descriptors::TimeScale;
use mser3d_shape::{Eigenbasis, IndexSet};
use rayon::prelude::*;

use crate::progress::{ProgressFn, Stage, report};
use crate::weighing::{Weighing, in_turn, stable_regions_in};
use crate::{DiscreteShape, Error, Field, Parameters, Positions, Weight};

/// A stable region.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Region {
    /// The smallest region that contains this one, as a place in the list of regions.
    pub parent: Option<usize>,
    /// Which of the bodies it is a part of, as a place in [`Features::bodies`](crate::Features::bodies).
    pub body: usize,
    /// Which of the trees it was found in.
    pub tree: usize,
    /// The weight at which it is complete: for the heat weights length^-3 in a volume, length^-2 on a
    /// surface (inverse for [`Weight::Edge`]).
    pub altitude: f64,
    /// s(l) = vol(l) / (d vol / d l) (eq. 5), where l is the altitude, by default its logarithm, or on the linear scale its multiple of
    /// the weight's spread ([`Parameters::stability`]): the region's volume over the
    /// rate at which it changes with l. By default the rate is measured over a window, `(vol(l + d) - vol(l - d)) / 2d`. No unit.
    /// Infinite where the volume does not change, NaN by the rule `baseline`, which measures none.
    pub stability: f64,
    /// How long its part stays on its own, in altitude (as for stability), smaller parts that join it included.
    pub persistence: f64,
    /// The real merge that ends it, if it is the last component before one.
    pub merge: Option<Merge>,
    /// How surely it is found again when the body moves: the chance of an overlap of 0.8 on another pose, 0 to 1, as
    /// measured on deformed copies of the shape ([`ReliabilityParameters`](crate::ReliabilityParameters)). None where it
    /// was not measured.
    pub reliability: Option<f64>,
    /// Its mirror image on the same body, as a place in the list of regions: the region of the other side that is
    /// like it. None of regions in the middle, of those whose mirror image was not found, and where more than two are alike.
    pub twin: Option<usize>,
    /// On which side of its body it is, from -1 to 1; near 0 in the middle ([`Sides::sides`](crate::Sides::sides)). None where the
    /// body has no sides ([`Body::sidedness`](crate::Body::sidedness)).
    pub side: Option<f64>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of its body: of the whole shape, unless bodies are searched each on its own.
    pub volume_fraction: f64,
    /// Its voxels or surface vertices, ascending.
    pub elements: Vec<u32>,
    /// The mesh's vertices that take their region from these elements, ascending.
    pub vertices: Vec<u32>,
    /// Centre of mass.
    pub centroid: [f64; 3],
    /// Where it begins: its element with the extreme weight, the one that enters its tree first, of several the first.
    pub tip: u32,
}

/// A component tree and what was selected from it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Tree {
    /// The body that it is of, as a place in [`Features::bodies`](crate::Features::bodies). Its vertices are that body's
    /// elements, numbered as there.
    pub body: usize,
    /// The time scale of its weight; none for a weight without time, such as the commute time.
    pub time_scale: Option<TimeScale>,
    /// The time in length^2; none for a weight without time.
    pub time: Option<f64>,
    /// Which way the level moves.
    pub polarity: Polarity,
    /// The tree. None where the shape has more than a million elements and the tree can be made anew, which
    /// [`Features::tree`](crate::Features::tree) does.
    pub tree: Option<ComponentTree>,
    /// Its stable regions, and what each filter cut.
    pub selection: Selection,
}

/// The regions of a shape, and the trees they come from.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RegionSet {
    /// By descending volume.
    pub regions: Vec<Region>,
    /// One tree for each time scale, or one.
    pub trees: Vec<Tree>,
    /// Regions of one tree that were dropped because another tree had them too.
    pub duplicates: usize,
}

/// Shares of the work of a time scale: its weights, and its component tree. The rest selects regions.
const WEIGHED: f64 = 0.4;
const BUILT: f64 = 0.4;

/// Builds one component tree for each time scale, selects its stable regions, and pools them. The shape is searched as
/// one body.
///
/// # Errors
/// [`Error::Tree`], [`Error::Descriptor`] and [`Error::Laplace`] (weights), [`Error::InvalidParameter`], [`Error::Cancelled`];
/// [`Error::NoField`] for [`Weight::Field`], which [`find_regions_of_field`] is for; [`Error::NoMesh`];
/// [`Error::NoLogarithm`].
pub fn find_regions(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<RegionSet, Error> {
    find_regions_with(shape, basis, None, parameters, progress)
}

/// As [`find_regions`], with a field on the elements as the weight, whatever the parameters' own is. Altitudes are as the
/// parameters say; take those of [`Parameters::of_weight`].
///
/// # Errors
/// As for [`find_regions`], and [`Error::FieldLength`].
pub fn find_regions_of_field(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    field: &Field,
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<RegionSet, Error> {
    let parameters = Parameters { weight: Weight::Field, ..parameters.clone() };
    find_regions_with(shape, basis, Some(field), &parameters, progress)
}

/// As [`find_regions`]; `field` has the values of weights that are no matter of heat.
pub(crate) fn find_regions_with(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    field: Option<&Field>,
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<RegionSet, Error> {
    parameters.validate()?;
    let scales: Vec<Option<TimeScale>> = if parameters.weight.has_time_scale() {
        parameters.time_scales.iter().copied().map(Some).collect()
    } else {
        vec![None]
    };
    let measure = basis.measure();
    let unit_time = unit_time(basis, parameters);
    let weighing = Weighing::new(shape, basis, field, parameters, unit_time)?;
    let done = Mutex::new(0.0);
    // Locked while it is told, so that progress only rises.
    let told = |more: f64| {
        let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += more / scales.len() as f64;
        report(progress, Stage::Regions, f64::min(*done, 1.0))
    };
    told(0.0)?;
    let time = |scale: &Option<TimeScale>| scale.map(|scale| scale.with_unit(unit_time)).transpose();
    let times: Vec<Option<f64>> = scales.iter().map(time).collect::<Result<_, _>>()?;
    let numbers: Vec<f64> = times.iter().map(|time| time.unwrap_or_default()).collect();
    let prepared = weighing.prepared(&numbers)?;
    let search = |(place, prepared): (usize, Option<Vec<f64>>)| {
        let (time_scale, time) = (scales[place], times[place]);
        let start = Instant::now();
        let values = weighing.at(numbers[place], prepared)?;
        let weighed = start.elapsed();
        told(WEIGHED)?;
        let (tree, unit) = values.into_tree(&weighing)?;
        told(BUILT)?;
        let selection = stable_regions_in(&tree, unit, &parameters.stability)?;
        let searched = start.elapsed() - weighed;
        let report = &selection.report;
        let (nodes, candidates, kept) = (report.nodes, report.candidates, report.kept);
        tracing::debug!(time, nodes, candidates, kept, ?weighed, ?searched, "component tree");
        told(1.0 - WEIGHED - BUILT)?;
        let tips: Vec<u32> = selection.regions.iter().map(|region| tree.first_vertex(region.node)).collect();
        let polarity = tree.polarity();
        let (tree, regions) = match weighing.keeps() {
            true => (Some(tree), None),
            false => (None, Some(TreeRegions::taken_from(tree, &selection))),
        };
        Ok((Tree { body: 0, time_scale, time, polarity, tree, selection }, regions, tips))
    };
    let in_turn = in_turn(shape.len(), parameters.weight, prepared.len(), weighing.keeps());
    let searched: Vec<(Tree, Option<TreeRegions>, Vec<u32>)> = prepared
        .into_par_iter()
        .enumerate()
        .with_min_len(in_turn)
        .map(search)
        .collect::<Result<_, Error>>()?;
    let (mut trees, mut taken, mut tips) = (Vec::new(), Vec::new(), Vec::new());
    for (tree, regions, tips_of_tree) in searched {
        trees.push(tree);
        taken.push(regions);
        tips.push(tips_of_tree);
    }
    let kept = trees.iter().map(|tree| Some(TreeRegions::of(tree.tree.as_ref()?, &tree.selection)));
    let selected: Vec<TreeRegions> =
        taken.into_iter().zip(kept).filter_map(|(taken, kept)| taken.or(kept)).collect();
    let pooled = pool(&selected, basis.mass(), &parameters.pool)?;
    drop(selected);
    let found: usize = trees.iter().map(|t| t.selection.regions.len()).sum();
    let duplicates = found - pooled.len();
    let regions = pooled
        .into_par_iter()
        .map(|region| {
            let stable = &trees[region.tree].selection.regions[region.region];
            Ok(Region {
                parent: region.parent,
                body: 0,
                tree: region.tree,
                altitude: stable.altitude,
                stability: stable.stability,
                persistence: stable.persistence,
                merge: stable.merge,
                reliability: None,
                twin: None,
                side: None,
                volume: region.volume,
                volume_fraction: region.volume / measure,
                vertices: vertices_in(shape, &region.vertices)?,
                centroid: centroid(&region.vertices, shape.positions(), basis.mass()),
                elements: region.vertices,
                tip: tips[region.tree][region.region],
            })
        })
        .collect::<Result<_, Error>>()?;
    Ok(RegionSet { regions, trees, duplicates })
}

/// The component tree at a time, made anew.
pub(crate) fn tree_at(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    parameters: &Parameters,
    time: Option<f64>,
) -> Result<ComponentTree, Error> {
    let weighing = Weighing::new(shape, basis, None, parameters, unit_time(basis, parameters))?;
    Ok(weighing.at(time.unwrap_or_default(), None)?.into_tree(&weighing)?.0)
}

/// The time that relative times are multiples of, in length^2.
fn unit_time(basis: &Eigenbasis, parameters: &Parameters) -> f64 {
    let reference = parameters.reference_measure.unwrap_or(basis.measure());
    reference.powf(2.0 / f64::from(basis.domain().dimension()))
}

/// The mesh's vertices that take their region from these elements, ascending.
pub(crate) fn vertices_in(shape: &DiscreteShape, elements: &[u32]) -> Result<Vec<u32>, Error> {
    let inside = IndexSet::from_members(shape.len(), elements.iter().copied())?;
    let taken = |&(_, element): &(u32, &Option<u32>)| element.is_some_and(|e| inside.contains(e as usize));
    Ok((0u32..).zip(shape.element_of_vertex()).filter(taken).map(|(vertex, _)| vertex).collect())
}

pub(crate) fn centroid(elements: &[u32], positions: Positions, mass: &[f64]) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut total = 0.0;
    positions.for_each_of(elements, |e, position| {
        let m = mass[e as usize];
        total += m;
        (0..3).for_each(|a| sum[a] += m * position[a]);
    });
    sum.map(|s| s / total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::NO_PROGRESS;
    use mser3d_shape::{BitGrid, Connectivity, Frame, VoxelGrid};

    #[test]
    fn a_tree_that_is_made_anew_is_the_same() {
        let dims = [30, 8, 6];
        let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
        let grid = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
        let shape = DiscreteShape::solid(grid, Connectivity::Six);
        for weight in [Weight::Heat, Weight::Edge] {
            let parameters = Parameters::of_weight(weight);
            let basis = shape.spectrum(&parameters.spectrum, NO_PROGRESS).unwrap().basis;
            let found = find_regions(&shape, &basis, &parameters, NO_PROGRESS).unwrap();
            for Tree { tree, time, .. } in found.trees {
                assert_eq!(Some(tree_at(&shape, &basis, &parameters, time).unwrap()), tree);
            }
        }
    }
}
