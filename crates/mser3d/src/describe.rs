use mser3d_descriptors::{DescriptorError, Descriptors, SiHksParameters, hks, region_descriptors, si_hks};
use mser3d_shape::{Domain, Eigenbasis};

use crate::progress::{NO_PROGRESS, ProgressFn, Stage, report};
use crate::sides::find_sides;
use crate::{Descriptor, DiscreteShape, Error, Parameters, Region, Sides};

/// The descriptors of a body's regions, and their left and right.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Described {
    /// A row for each region, in their order.
    pub descriptors: Descriptors,
    /// Which regions are mirror images of each other, and on which side each is.
    pub sides: Sides,
}

/// How much a body's evidence of its sides weighs beside the rest of the descriptor, in octaves of its time axis.
const BODY_WEIGHT: f64 = 0.5;

/// How much that of a pair of twins alone weighs.
const PAIR_WEIGHT: f64 = 0.25;

/// The descriptors of regions of one body: means over their elements (eq. 11), and what tells their sides.
///
/// SI-vHKS is the modulus of a Fourier transform over log time. That makes it the same at any scale, but
/// it also loses where on the time axis a signature lies, which tells a part from the larger part
/// around it. [`Descriptor::SizedSiHks`] gives the place back as one number more, in samples of the time
/// axis: `samples_per_octave * 2/d * log2(V_region / V_body)`, with d = 3 in a volume, 2 on a surface (heat
/// takes a time of `V^(2/d)` to cross a body of measure V). It depends on neither pose nor scale.
///
/// Heat is the same on both sides of a body. [`Descriptor::SidedSiHks`] adds [`Sides::evidence`], in samples of the time axis
/// too: the body's evidence times `0.5 samples_per_octave`, that of the region's pair times `0.25 samples_per_octave`, and
/// before them how far the region is in the middle, times the root of the sum of both squares. A sure side decides between
/// twins, whose other numbers are equal. An unsure one is short, and changes little.
///
/// `basis` is that of `shape`, and elements of `regions` are numbered as there.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn describe(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    regions: &[Region],
    parameters: &Parameters,
) -> Result<Described, Error> {
    describe_with(shape, basis, regions, parameters, NO_PROGRESS)
}

/// As [`describe`], telling how many regions' worth of the work is done.
pub(crate) fn describe_with(
    shape: &DiscreteShape,
    basis: &Eigenbasis,
    regions: &[Region],
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<Described, Error> {
    let base = match &parameters.descriptor {
        Descriptor::SidedSiHks(own) | Descriptor::SizedSiHks(own) | Descriptor::SiHks(own) => own.clone(),
        Descriptor::Hks(_) => SiHksParameters::default(),
    };
    let unit = own_unit(&base, basis, parameters);
    let plain = means(basis, regions, progress, |elements| si_hks(basis, &unit, Some(elements)))?;
    let octave = base.samples_per_octave as f64;
    let unit = octave * 2.0 / f64::from(basis.domain().dimension());
    let sizes = regions.iter().map(|region| vec![unit * region.volume_fraction.log2()]);
    let sized = beside(&plain, 1, sizes)?;
    let reference = parameters.reference_measure.unwrap_or(basis.measure());
    let unit_time = reference.powf(2.0 / f64::from(basis.domain().dimension()));
    let sides = find_sides(shape, basis, regions, &sized, octave, unit_time)?;
    let descriptors = match &parameters.descriptor {
        Descriptor::SidedSiHks(_) => {
            let width = sides.evidence.width();
            let weigh = |row: &[f64]| {
                let (middle, sided) = row.split_at(1);
                let (body, pair) = sided.split_at(width / 2);
                let weighed = |part: &[f64], w: f64| part.iter().map(|x| w * octave * x).collect::<Vec<_>>();
                let of_middle = BODY_WEIGHT.hypot(PAIR_WEIGHT);
                [weighed(middle, of_middle), weighed(body, BODY_WEIGHT), weighed(pair, PAIR_WEIGHT)].concat()
            };
            beside(&sized, width, sides.evidence.rows().map(weigh))?
        }
        Descriptor::SizedSiHks(_) => sized,
        Descriptor::SiHks(_) => plain,
        Descriptor::Hks(own) => means(basis, regions, progress, |elements| hks(basis, own, Some(elements)))?,
    };
    Ok(Described { descriptors, sides })
}

/// Share of the work when all regions have their signatures; the rest tells left from right.
const SIGNED: f64 = 0.65;

/// The means of signatures over regions; `signature` describes elements by their numbers.
fn means(
    basis: &Eigenbasis,
    regions: &[Region],
    progress: ProgressFn,
    signature: impl Fn(&[u32]) -> Result<Descriptors, DescriptorError>,
) -> Result<Descriptors, Error> {
    let told = |done: f64| report(progress, Stage::Descriptors, SIGNED * done);
    let members: Vec<&[u32]> = regions.iter().map(|r| &r.elements[..]).collect();
    let rows = region_descriptors(&members, basis.mass(), |elements| -> Result<_, Error> {
        let first = elements.first().map_or(0.0, |&first| f64::from(first));
        told(first / basis.mass().len() as f64)?;
        Ok(signature(elements)?)
    })?;
    told(1.0)?;
    Ok(rows)
}

/// The same rows with `width` numbers more in each.
fn beside(
    rows: &Descriptors,
    width: usize,
    more: impl Iterator<Item = Vec<f64>>,
) -> Result<Descriptors, DescriptorError> {
    let values = rows.rows().zip(more).flat_map(|(row, more)| row.iter().copied().chain(more)).collect();
    Descriptors::new(rows.width() + width, values)
}

/// The signature of each element of a body, a row each: what the descriptors of its regions are means of, but for size and
/// sides.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn signatures(basis: &Eigenbasis, parameters: &Parameters) -> Result<Descriptors, Error> {
    Ok(match &parameters.descriptor {
        Descriptor::SidedSiHks(own) | Descriptor::SizedSiHks(own) | Descriptor::SiHks(own) => {
            si_hks(basis, &own_unit(own, basis, parameters), None)?
        }
        Descriptor::Hks(own) => hks(basis, own, None)?,
    })
}

/// The parameters with their unit of time: that of the reference measure or, without one, that of the basis, which is then not
/// asked for with each block of elements.
fn own_unit(own: &SiHksParameters, basis: &Eigenbasis, parameters: &Parameters) -> SiHksParameters {
    let of_measure = |measure: f64| match basis.domain() {
        Domain::Volume => (measure / own.reference_volume).powf(2.0 / 3.0),
        Domain::Surface => measure / own.reference_area,
    };
    let unit =
        own.unit.unwrap_or_else(|| of_measure(parameters.reference_measure.unwrap_or(basis.measure())));
    SiHksParameters { unit: Some(unit), ..own.clone() }
}
