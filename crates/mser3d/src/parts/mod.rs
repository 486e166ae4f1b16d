//! Parts: the few pieces that a person would draw, each element in exactly one.
//!
//! Regions overlap and nest; parts do not. They are the limbs of a body and what is left of it, the trunk. They are chosen
//! among the nodes of the component trees:
//!
//! 1. `candidates`: the regions of each tree, whatever filters and pooling made of them. The border of each is taken down its
//!    branch to where it is narrow (`borders`).
//! 2. `twins`: candidates that are mirror images, or equal, come and go together. Where the body has sides, `opposites` says at the end
//!    which of the parts are mirror images.
//! 3. `choose`: they are taken in the order of a score, if they are nested or disjoint and each part keeps enough.
//! 4. `smooth`: borders are smoothed, by diffusion. `pieces`: what falls apart becomes several parts.

mod borders;
mod candidates;
mod choose;
mod opposites;
mod parameters;
mod pieces;
mod smooth;
mod twins;

use mser3d_shape::TriangleMesh;

use self::borders::{BodyLinks, Links};
use self::candidates::Candidates;
use self::choose::ChosenPart;
pub use self::parameters::{PartCount, PartParameters};
use crate::regions::centroid;
use crate::{Error, Features, Sidedness};

/// A part of a body.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Part {
    /// The body that it is a part of, as a place in [`Features::bodies`].
    pub body: usize,
    /// Whether it is what the other parts of its body leave, or a piece of that: of a dumbbell, of which the thin bar is the
    /// hot part, both balls.
    pub trunk: bool,
    /// The region that is most like what it grew from, of those that overlap it by half or more, as a place in
    /// [`Features::regions`]. None for the trunk.
    pub region: Option<usize>,
    /// The parts that are its mirror images, or equal to it, as places in [`Partition::parts`], ascending.
    pub twins: Vec<usize>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of its body.
    pub volume_fraction: f64,
    /// Its voxels or surface vertices, ascending.
    pub elements: Vec<u32>,
    /// The mesh's vertices that are in it, ascending.
    pub vertices: Vec<u32>,
    /// Centre of mass.
    pub centroid: [f64; 3],
}

/// The parts of a shape.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Partition {
    /// By descending volume.
    pub parts: Vec<Part>,
    /// The part of each voxel or surface vertex. None is missing: whatever was searched is in a part.
    pub part_of_element: Vec<u32>,
    /// The part of each vertex of the mesh, in file order; none for those whose body was not searched.
    pub part_of_vertex: Vec<Option<u32>>,
}

/// Divides each body that was searched into parts. `mesh` is the one that the features are of, if there is one: where it is
/// finer than the voxels, borders are smoothed along it too.
///
/// A part is what ends at a narrow place. A *limb* is the last component before a real merge that has lasted a while
/// ([`PartParameters::min_lifetime`]). With [`PartCount::Auto`] the parts are the limbs and the trunk. Otherwise limbs are
/// taken in the order of their lifetime, and if that is not enough, parts of limbs and of the trunk, those with the narrowest
/// borders first. Mirror images are taken together or not at all; so are more than two that are equal. So there can be fewer
/// parts than are asked for, never more, unless the body itself is in pieces: each part is connected.
///
/// Which regions were selected does not matter, only the trees. Of a shape without limbs, such as a ball, there is one part.
///
/// ```
/// # fn run(mesh: &mser3d::shape::TriangleMesh) -> Result<(), mser3d::Error> {
/// use mser3d::{Detector, Input, PartParameters, Parameters, partition};
///
/// let features = Detector::new(Parameters::default()).detect(Input::Volume(mesh))?;
/// let partition = partition(&features, Some(mesh), &PartParameters::default())?;
/// for part in &partition.parts {
///     println!("{:.1} % of the volume around {:?}", 100.0 * part.volume_fraction, part.centroid);
/// }
/// # Ok(())
/// # }
/// ```
///
/// Cost: for each tree some passes over the links, trees beside each other. About a twentieth of a second of one core for 45,000
/// voxels.
///
/// # Errors
/// [`Error::InvalidParameter`] from [`PartParameters::validate`]; [`Error::Tree`] and [`Error::Descriptor`] only in theory.
pub fn partition(
    features: &Features,
    mesh: Option<&TriangleMesh>,
    parameters: &PartParameters,
) -> Result<Partition, Error> {
    parameters.validate()?;
    let shape = &features.shape;
    let links = Links::of(shape)?;
    let mass = features.measures();
    let mut parts: Vec<Part> = Vec::new();
    for (number, body) in features.bodies.iter().enumerate() {
        let measure = body.measure();
        let own = BodyLinks::new(&body.elements, &links, body.basis.mass());
        let candidates = Candidates::of(features, number, &own, &mass, parameters)?;
        let mut chosen = candidates.choose(&own, measure, &mass, parameters);
        let (labels, count) = (&mut chosen.labels, chosen.parts.len());
        let smallest = parameters.min_volume_fraction * measure;
        smooth::smooth_with_care(labels, count, &own, smooth::steps_on_grid(parameters.smoothing));
        let pieces = pieces::join_crumbs(labels, count, &own, smallest);
        for from in pieces::split(labels, count, &pieces, smallest) {
            let ChosenPart { trunk, region, .. } = chosen.parts[from];
            chosen.parts.push(ChosenPart { trunk, region, twins: Vec::new() });
        }
        let mut elements = vec![Vec::new(); chosen.parts.len()];
        for (&element, &part) in body.elements.iter().zip(&chosen.labels) {
            elements[part as usize].push(element);
        }
        let first = parts.len();
        parts.extend(chosen.parts.into_iter().zip(elements).map(|(part, elements)| {
            let volume = elements.iter().map(|&e| mass[e as usize]).sum();
            Part {
                body: number,
                trunk: part.trunk,
                region: part.region,
                twins: part.twins.iter().map(|twin| first + twin).collect(),
                volume,
                volume_fraction: volume / measure,
                vertices: Vec::new(),
                centroid: centroid(&elements, shape.positions(), &mass),
                elements,
            }
        }));
    }
    by_volume(&mut parts);
    pair_by_sides(&mut parts, features);
    let mut part_of_element = vec![0; shape.len()];
    for (number, part) in (0..).zip(&parts) {
        part.elements.iter().for_each(|&e| part_of_element[e as usize] = number);
    }
    let of_element = |element: &Option<u32>| element.map(|e| part_of_element[e as usize]);
    let mut part_of_vertex: Vec<Option<u32>> = shape.element_of_vertex().iter().map(of_element).collect();
    if let (Some(mesh), Some(grid)) = (mesh, shape.grid()) {
        let pitch = grid.frame().voxel_volume().cbrt();
        smooth::smooth_vertices(&mut part_of_vertex, parts.len(), mesh, pitch * parameters.smoothing);
    }
    for (vertex, part) in (0..).zip(&part_of_vertex) {
        if let Some(part) = part {
            parts[*part as usize].vertices.push(vertex);
        }
    }
    Ok(Partition { parts, part_of_element, part_of_vertex })
}

/// Corrects twins of bodies whose sides are told.
fn pair_by_sides(parts: &mut [Part], features: &Features) {
    let mirrored = features.parameters.descriptor.first_mirrored();
    let width = mirrored.unwrap_or(features.descriptors.width());
    // Of what a mirror image leaves as it is.
    let distance = |a: usize, b: usize| {
        let rows = features.descriptors.row(a).iter().zip(features.descriptors.row(b)).take(width);
        rows.map(|(x, y)| (x - y) * (x - y)).sum::<f64>().sqrt()
    };
    for (number, body) in features.bodies.iter().enumerate() {
        if !matches!(body.sidedness, Sidedness::Sided { .. }) {
            continue;
        }
        let own: Vec<usize> = (0..parts.len()).filter(|&part| parts[part].body == number).collect();
        let region = |part: usize| parts[own[part]].region;
        let sides: Vec<Option<f64>> = (0..own.len())
            .map(|part| region(part).and_then(|region| features.regions[region].side))
            .collect();
        let volumes: Vec<f64> = own.iter().map(|&part| parts[part].volume).collect();
        let place = |part: &usize| own.iter().position(|own| own == part);
        let mut twins: Vec<Vec<usize>> =
            own.iter().map(|&part| parts[part].twins.iter().filter_map(place).collect()).collect();
        let apart = |a: usize, b: usize| Some(distance(region(a)?, region(b)?));
        let place = |a: usize, b: usize, others: &[usize]| {
            let rows = (features.cosines.row(region(a)?), features.cosines.row(region(b)?));
            let others = others.iter().filter_map(|&other| Some((region(other)?, volumes[other])));
            let square =
                |(other, volume): (usize, f64)| [volume * (rows.0[other] - rows.1[other]).powi(2), volume];
            let sum = others.map(square).fold([0.0; 2], |sum, own| [sum[0] + own[0], sum[1] + own[1]]);
            (sum[1] > 0.0).then(|| (sum[0] / sum[1]).sqrt())
        };
        opposites::pair_by_sides(&mut twins, &sides, &volumes, place, apart);
        for (&part, twins) in own.iter().zip(twins) {
            parts[part].twins = twins.into_iter().map(|twin| own[twin]).collect();
        }
    }
}

/// Orders parts by descending volume; of equal volumes, the one with the smaller element first.
fn by_volume(parts: &mut Vec<Part>) {
    let mut order: Vec<usize> = (0..parts.len()).collect();
    let first = |part: &Part| part.elements.first().copied();
    order.sort_by(|&a, &b| {
        parts[b].volume.total_cmp(&parts[a].volume).then(first(&parts[a]).cmp(&first(&parts[b])))
    });
    let mut place = vec![0; parts.len()];
    order.iter().enumerate().for_each(|(to, &from)| place[from] = to);
    let mut moved: Vec<(usize, Part)> = std::mem::take(parts).into_iter().enumerate().collect();
    moved.sort_by_key(|(from, _)| place[*from]);
    parts.extend(moved.into_iter().map(|(_, mut part)| {
        part.twins.iter_mut().for_each(|twin| *twin = place[*twin]);
        part.twins.sort_unstable();
        part
    }));
}
