//! How surely regions are found again: not in the paper.
mod deformed;
mod warp;

use std::sync::Mutex;

use mser3d_shape::InvalidParameter;
use mser3d_spectral::{EigenpairRange, SpectrumParameters};
use rayon::prelude::*;

use crate::progress::{Progress, ProgressFn, Stage, report};
use crate::regions::find_regions_with;
use crate::{Body, DiscreteShape, Error, Input, Parameters, Region, RegionSet, Weight};
use deformed::{Deformed, Place};
pub(crate) use deformed::{Original, coarser, occupied};

/// How the reliability of regions is measured, and which of them are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReliabilityParameters {
    /// How many deformed copies of the shape are searched. 0 measures nothing. Default: none given, which is
    /// [`Parameters::copies`] of the input.
    pub deformations: Option<usize>,
    /// How far each of the six waves of a deformation moves the shape, over the diagonal of its box. Default 0.02.
    pub amplitude: f64,
    /// What the random deformations depend on.
    pub seed: u64,
    /// Regions that are less reliable are dropped, 0 to 1. Default: none.
    pub min_reliability: Option<f64>,
}

impl Default for ReliabilityParameters {
    fn default() -> Self {
        Self { deformations: None, amplitude: 0.02, seed: 1, min_reliability: None }
    }
}

impl ReliabilityParameters {
    /// Checks every range.
    ///
    /// # Errors
    /// [`Error::InvalidParameter`] for the first value out of its range.
    pub fn validate(&self) -> Result<(), Error> {
        let unless = InvalidParameter::unless;
        let amplitude = self.amplitude;
        unless(
            amplitude > 0.0 && amplitude <= 0.1,
            "reliability.amplitude",
            amplitude,
            "above 0, at most 0.1",
        )?;
        let copies = self.deformations.unwrap_or(0);
        let most = format!("at most {MOST_COPIES}");
        InvalidParameter::unless(copies <= MOST_COPIES, "reliability.deformations", copies, most)?;
        let least = self.min_reliability.unwrap_or(0.0);
        unless((0.0..=1.0).contains(&least), "min_reliability", least, "between 0 and 1")?;
        let asked = self.min_reliability.is_none() || self.deformations != Some(0);
        unless(asked, "reliability.deformations", 0.0, "at least 1, as a least reliability is asked for")?;
        Ok(())
    }
}

/// The most copies that can be asked for: each is searched like the shape.
const MOST_COPIES: usize = 10_000;

/// The most copies that are searched unless a number is asked for, and the fewest that say anything.
const COPIES: [usize; 2] = [6, 3];

/// Seconds of one core that they may take then, as estimated.
const BUDGET: f64 = 10.0;

impl Parameters {
    /// How many deformed copies of an input are searched: as many as the parameters say. If they don't, 6; or as few as 3
    /// where they would take longer than 10 seconds of one core by [`Parameters::estimate`], or none where 3 would, unless a
    /// least reliability is asked for. None of a shape that was made before, or for a weight that is a field, as their
    /// copies are not known.
    pub fn copies(&self, input: &Input) -> usize {
        match Original::of(input) {
            Some(original) => self.copies_of(original, input.expected_elements(self)),
            None => 0,
        }
    }

    /// The same of an input of so many elements.
    pub(crate) fn copies_of(&self, original: Original, elements: usize) -> usize {
        let [most, fewest] = COPIES;
        let ReliabilityParameters { deformations, min_reliability, .. } = self.reliability;
        match (self.weight, deformations, min_reliability) {
            (Weight::Field, ..) => 0,
            (_, Some(copies), _) => copies,
            (_, None, Some(_)) => most,
            (_, None, None) => {
                let affordable = (BUDGET / self.seconds_of_copy(&original.input(), elements)) as usize;
                if affordable < fewest { 0 } else { affordable.min(most) }
            }
        }
    }
}

/// What heat a copy's spectrum leaves out, relatively: exp(-LEFT_OUT) at the shortest time.
const LEFT_OUT: f64 = 7.0;

/// The tolerance of a copy's eigenpairs.
const TOLERANCE: f64 = 1e-3;

/// The chance that a region is found again at an overlap of 0.8 on another pose, from its mean best overlap x on deformed
/// copies: `1 / (1 + exp(-(BIAS + OVERLAP x)))`.
///
/// Logistic regression on all ordered pairs of poses of six sets, each set of the same weight: `cargo xtask reliability`
/// says how well it fits. Whether a merge ends the region, its lifetime and its stability were tried beside x: left out one
/// set at a time, they predict worse.
const BIAS: f64 = -0.8;
const OVERLAP: f64 = 5.5;

fn chance(overlap: f64) -> f64 {
    1.0 / (1.0 + (-(BIAS + OVERLAP * overlap)).exp())
}

/// Measures the reliability of regions, and drops those below the minimum.
///
/// The shape is deformed at random and searched again, `total` times, with the eigenpairs that its times need. `sets` holds
/// the regions of each body, with the elements numbered as in the body.
pub(crate) fn measure(
    original: Original,
    shape: &DiscreteShape,
    bodies: &[Body],
    sets: &mut [RegionSet],
    parameters: &Parameters,
    total: usize,
    progress: ProgressFn,
) -> Result<(), Error> {
    let own = &parameters.reliability;
    report(progress, Stage::Reliability, 0.0)?;
    let regions: Vec<Place> = sets
        .iter()
        .zip(bodies)
        .flat_map(|(set, body)| set.regions.iter().map(|region| place(region, &body.elements)))
        .collect();
    let spectra: Vec<SpectrumParameters> = bodies.iter().map(|body| spectrum(body, parameters)).collect();
    let stages = parameters.stages_of_copy(&original.input(), shape.len());
    let shares = Mutex::new(vec![0.0; total]);
    // How far a copy is says how far all are.
    let tell = |copy: u64, share: f64| {
        let mut shares = lock(&shares);
        let own = &mut shares[copy as usize];
        *own = share.max(*own);
        let done = shares.iter().sum::<f64>() / total as f64;
        progress(Progress { stage: Stage::Reliability, done, overall: done })
    };
    let search = |number: u64| -> Result<Vec<f64>, Error> {
        let goes_on = |told: Progress| tell(number, stages.share(told.stage, told.done));
        let overlaps = original
            .deform(
                shape,
                &regions,
                parameters,
                own.amplitude,
                own.seed.wrapping_mul(1 << 20).wrapping_add(number),
                &goes_on,
            )
            .and_then(|copy| overlaps(&copy, &regions, &spectra, parameters, &goes_on));
        if tell(number, 1.0).is_break() {
            return Err(Error::Cancelled);
        }
        // In a copy without a solid nothing is found again.
        match overlaps {
            Err(Error::Cancelled) => Err(Error::Cancelled),
            other => Ok(other.unwrap_or_else(|_| vec![0.0; regions.len()])),
        }
    };
    let found: Vec<Vec<f64>> = (0..total as u64).into_par_iter().map(search).collect::<Result<_, Error>>()?;
    let mut mean = (0..regions.len()).map(|i| found.iter().map(|f| f[i]).sum::<f64>() / total as f64);
    for set in sets {
        for region in &mut set.regions {
            region.reliability = mean.next().map(chance);
        }
        if let Some(least) = own.min_reliability {
            keep(&mut set.regions, |region| region.reliability.is_none_or(|r| r >= least));
        }
    }
    Ok(())
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Where a region of a body is in the shape.
fn place(region: &Region, body: &[u32]) -> Place {
    let elements = region.elements.iter().map(|&e| body[e as usize]).collect();
    Place { elements, vertices: region.vertices.clone() }
}

/// The eigenpairs that a copy of a body needs: where every weight has a time, those that matter at the shortest.
fn spectrum(body: &Body, parameters: &Parameters) -> SpectrumParameters {
    let eigenvalues = body.basis.eigenvalues();
    let measure = body.basis.measure();
    let unit = parameters
        .reference_measure
        .unwrap_or(measure)
        .powf(2.0 / f64::from(body.basis.domain().dimension()));
    let times = parameters.time_scales.iter().filter_map(|scale| scale.with_unit(unit).ok());
    let shortest = times.fold(f64::INFINITY, f64::min);
    let needed = if parameters.weight.has_time_scale() {
        // Two more, as the copy's differ.
        2 + eigenvalues.iter().filter(|&&lambda| lambda * shortest < LEFT_OUT).count()
    } else {
        eigenvalues.len()
    };
    SpectrumParameters {
        eigenpairs: EigenpairRange::AtMost(needed.min(eigenvalues.len())),
        tolerance: TOLERANCE.max(parameters.spectrum.tolerance),
        ..parameters.spectrum.clone()
    }
}

/// The best overlap of each region with one of the copy.
fn overlaps(
    copy: &Deformed,
    regions: &[Place],
    spectra: &[SpectrumParameters],
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<Vec<f64>, Error> {
    let (shape, bodies) = (&copy.prepared.shape, &copy.prepared.bodies);
    let field = match parameters.weight {
        Weight::Curvature => Some(shape.mean_curvature()?),
        _ => None,
    };
    let parts = if bodies.len() > 1 { shape.split(bodies)? } else { Vec::new() };
    let mut found = Vec::new();
    for (body, elements) in bodies.iter().enumerate() {
        let part = parts.get(body).unwrap_or(shape);
        let Some(wanted) = spectra.get(body).or(spectra.last()) else { continue };
        let basis = part.spectrum(wanted, progress)?.basis;
        let own = field.as_ref().map(|field| field.of(elements));
        let set = find_regions_with(part, &basis, own.as_ref(), parameters, progress)?;
        found.extend(set.regions.iter().map(|region| place(region, elements)));
    }
    copy.best_overlaps(regions, &found)
}

/// Drops regions; what they contained belongs to what contained them.
fn keep(regions: &mut Vec<Region>, kept: impl Fn(&Region) -> bool) {
    let mut place = Vec::with_capacity(regions.len());
    let mut next = 0;
    // Parents come first.
    for region in regions.iter() {
        let parent = region.parent.and_then(|p: usize| place[p]);
        place.push(if kept(region) {
            next += 1;
            Some(next - 1)
        } else {
            parent
        });
    }
    let parents: Vec<Option<usize>> =
        regions.iter().map(|region| region.parent.and_then(|p| place[p])).collect();
    let mut parents = parents.into_iter();
    regions.retain_mut(|region| {
        region.parent = parents.next().flatten();
        kept(region)
    });
}
