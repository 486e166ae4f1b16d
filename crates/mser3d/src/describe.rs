use mser3d_descriptors::{DescriptorError, Descriptors, hks, region_descriptors, si_hks};
use mser3d_shape::{Domain, Eigenbasis};

use crate::progress::{NO_PROGRESS, ProgressFn, Stage, report};
use crate::{Descriptor, Error, Parameters, Region};

/// Elements that are described before anyone asks whether to go on: some tens of milliseconds.
const ELEMENTS: usize = 1 << 14;

/// The descriptors of regions: means over their elements (eq. 11).
///
/// SI-vHKS is the modulus of a Fourier transform over log time. That makes it the same at any scale, but
/// it also loses where on the time axis a signature lies, which tells a part from the larger part
/// around it. [`Descriptor::SizedSiHks`] gives the place back as one number more, in samples of the time
/// axis: `samples_per_octave * 2/d * log2(V_region / V_body)`, with d = 3 in a volume, 2 on a surface (heat
/// takes a time of `V^(2/d)` to cross a body of measure V). It depends on neither pose nor scale.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn describe(
    basis: &Eigenbasis,
    regions: &[Region],
    parameters: &Parameters,
) -> Result<Descriptors, Error> {
    describe_with(basis, regions, parameters, NO_PROGRESS)
}

/// As [`describe`], telling how many regions' worth of the work is done.
pub(crate) fn describe_with(
    basis: &Eigenbasis,
    regions: &[Region],
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<Descriptors, Error> {
    let told = |done: usize| report(progress, Stage::Descriptors, done, regions.len());
    told(0)?;
    let signature = signature(basis, parameters);
    let mut stopped = Ok(());
    let members: Vec<&[u32]> = regions.iter().map(|r| &r.elements[..]).collect();
    let rows = region_descriptors(&members, basis.mass(), |elements| {
        let first = signature(&elements[..elements.len().min(ELEMENTS)])?;
        let mut values = first.values().to_vec();
        for (chunk, part) in elements.chunks(ELEMENTS).enumerate().skip(1) {
            stopped = told(regions.len() * chunk * ELEMENTS / elements.len());
            if stopped.is_err() {
                // With too few rows, nothing is made of them.
                break;
            }
            values.extend_from_slice(signature(part)?.values());
        }
        Descriptors::new(first.width(), values)
    });
    stopped?;
    let rows = rows?;
    told(regions.len())?;
    let Descriptor::SizedSiHks(own) = &parameters.descriptor else { return Ok(rows) };
    let unit = own.samples_per_octave as f64 * 2.0 / f64::from(basis.domain().dimension());
    let sizes = regions.iter().map(|region| unit * region.volume_fraction.log2());
    let values = rows.rows().zip(sizes).flat_map(|(row, size)| row.iter().copied().chain([size])).collect();
    Ok(Descriptors::new(rows.width() + 1, values)?)
}

/// What describes elements by their numbers.
fn signature<'a>(
    basis: &'a Eigenbasis,
    parameters: &'a Parameters,
) -> impl Fn(&[u32]) -> Result<Descriptors, DescriptorError> + 'a {
    move |elements| match &parameters.descriptor {
        Descriptor::SizedSiHks(own) | Descriptor::SiHks(own) => {
            let mut own = own.clone();
            if let (None, Some(measure)) = (own.unit, parameters.reference_measure) {
                own.unit = Some(match basis.domain() {
                    Domain::Volume => (measure / own.reference_volume).powf(2.0 / 3.0),
                    Domain::Surface => measure / own.reference_area,
                });
            }
            si_hks(basis, &own, Some(elements))
        }
        Descriptor::Hks(own) => hks(basis, own, Some(elements)),
    }
}
