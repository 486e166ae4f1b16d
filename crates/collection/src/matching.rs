use std::path::{Path, PathBuf};

use mser3d::Sidedness;
use mser3d::descriptors::{
    DescriptorError, DescriptorMatch, Descriptors, MatchParameters, RegionCosines, match_regions,
};
use mser3d_evaluation::{MatchTruth, PrecisionRecall};
use mser3d_results::Results;
use mser3d_shape::Choice;
use serde::{Deserialize, Serialize};

use crate::{CollectionError, DescriptorSettings};

/// A result with regions to compare, and how its descriptors were made.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct DescribedResult {
    /// The folder, for messages.
    pub folder: PathBuf,
    /// What it holds.
    pub results: Results,
    /// How its descriptors were made.
    pub settings: DescriptorSettings,
    /// Its descriptors.
    pub descriptors: Descriptors,
    /// How near its regions are to each other.
    pub cosines: RegionCosines,
}

impl DescribedResult {
    /// Reads a result that has regions to compare.
    ///
    /// # Errors
    /// [`CollectionError::Results`], [`CollectionError::NoRegions`].
    pub fn load(folder: &Path) -> Result<Self, CollectionError> {
        Self::new(Results::load(folder)?, folder)
    }

    /// A result that is in memory; `folder` names it in messages.
    ///
    /// # Errors
    /// [`CollectionError::NoRegions`].
    pub fn new(results: Results, folder: &Path) -> Result<Self, CollectionError> {
        let settings = DescriptorSettings::of(&results.record);
        if results.record.regions.is_empty() {
            return Err(CollectionError::NoRegions { folder: folder.to_owned() });
        }
        let descriptors = Descriptors::new(results.descriptor_width, results.descriptors.clone())?;
        let cosines = RegionCosines::new(results.record.regions.len(), results.cosines.clone())?;
        Ok(Self { folder: folder.to_owned(), results, settings, descriptors, cosines })
    }

    /// The descriptors of its mirror image; the same where they know no sides.
    fn mirrored(&self) -> Result<Descriptors, DescriptorError> {
        let first = self.settings.descriptor.first_mirrored().unwrap_or(self.descriptors.width());
        let sign = |(i, x): (usize, &f64)| if i < first { *x } else { -x };
        let rows = self.descriptors.rows().flat_map(|row| row.iter().enumerate().map(sign));
        Descriptors::new(self.descriptors.width(), rows.collect())
    }

    /// Whether matches of a region can tell it from its twin.
    fn tells_sides(&self, region: u32) -> bool {
        let record = &self.results.record;
        let body = record.bodies.get(record.regions[region as usize].body as usize);
        let sided = body.is_some_and(|body| matches!(body.sidedness, Sidedness::Sided { .. }));
        sided && self.settings.descriptor.first_mirrored().is_some()
    }
}

/// A region of one shape and its partner on the other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RegionMatch {
    /// Region of the second shape.
    pub region: u32,
    /// Its partner on the first shape.
    pub partner: u32,
    /// Euclidean distance of their descriptors, and what speaks against the pair in the other pairs
    /// ([`MatchParameters::consistency`]).
    pub distance: f64,
    /// The region of the first shape that is nearest but for the partner, by the same distance.
    pub rival: Option<u32>,
    /// Its distance.
    pub rival_distance: Option<f64>,
    /// Whether the rival is about as near.
    pub ambiguous: bool,
    /// The partner's mirror image on the first shape, where left and right cannot be told on one of both shapes: it could
    /// as well be the partner.
    pub symmetric_partner: Option<u32>,
    /// How right the match is, where a ground truth is known.
    pub truth: Option<MatchTruth>,
}

/// The regions of a second shape matched to those of a first.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Matching {
    /// The matches, by region of the second shape.
    pub matches: Vec<RegionMatch>,
    /// Regions of the second shape that got no partner.
    pub unmatched: Vec<u32>,
    /// Whether the second shape was taken for a mirror image, because that fits better
    /// ([`MatchingParameters::allow_mirror`]).
    pub mirrored: bool,
    /// How many are right, where a ground truth is known.
    pub precision: Option<PrecisionRecall>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Parameters of [`match_results`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MatchingParameters {
    /// How regions are matched.
    #[serde(flatten)]
    pub regions: MatchParameters,
    /// Whether left may be matched to right, of the whole shape at once, where that fits better. Default: no.
    pub allow_mirror: bool,
}

/// What `matches.json` says: which results were matched, how, and what was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct MatchRecord {
    /// The version of mser3d that matched them.
    pub mser3d: String,
    /// Folder of the first result.
    pub first: String,
    /// Folder of the second result.
    pub second: String,
    /// How partners were chosen.
    #[serde(flatten)]
    pub parameters: MatchingParameters,
    /// What was found.
    pub result: Matching,
}

impl MatchRecord {
    /// The record of a matching of these results with these parameters.
    pub fn new(
        first: &DescribedResult,
        second: &DescribedResult,
        parameters: &MatchingParameters,
        result: &Matching,
    ) -> Self {
        let path = |of: &DescribedResult| of.folder.to_string_lossy().into_owned();
        Self {
            mser3d: env!("CARGO_PKG_VERSION").to_owned(),
            first: path(first),
            second: path(second),
            parameters: *parameters,
            result: result.clone(),
        }
    }
}

/// Matches each region of `second` to one of `first`, by descriptor and so that the matches hold together
/// ([`match_regions`]).
///
/// # Errors
/// [`CollectionError::DifferentDescriptors`]; [`CollectionError::Descriptors`] for parameters out of range.
pub fn match_results(
    first: &DescribedResult,
    second: &DescribedResult,
    parameters: &MatchingParameters,
) -> Result<Matching, CollectionError> {
    if let Some(what) = first.settings.difference(&second.settings) {
        let (first, second) = (first.folder.clone(), second.folder.clone());
        return Err(CollectionError::DifferentDescriptors { first, second, what });
    }
    let of = |descriptors: &Descriptors, parameters: &MatchParameters| {
        let references = (&first.descriptors, &first.cosines);
        match_regions((descriptors, &second.cosines), references, parameters)
    };
    let mut descriptors = second.descriptors.clone();
    let mut mirrored = false;
    if parameters.allow_mirror {
        let image = second.mirrored()?;
        // By what every region costs, without the rules that drop some.
        let all =
            MatchParameters { consistency: parameters.regions.consistency, ..MatchParameters::default() };
        let cost = |matches: Vec<DescriptorMatch>| matches.iter().map(|m| m.partner.distance).sum::<f64>();
        mirrored = cost(of(&image, &all)?) < cost(of(&descriptors, &all)?);
        if mirrored {
            descriptors = image;
        }
    }
    let found = of(&descriptors, &parameters.regions)?;
    let matches: Vec<RegionMatch> = found
        .into_iter()
        .map(|m| {
            let (region, partner) = (m.query as u32, m.partner.reference as u32);
            let twin = first.results.record.regions[m.partner.reference].twin;
            let told = first.tells_sides(partner) && second.tells_sides(region);
            RegionMatch {
                region,
                partner,
                distance: m.partner.distance,
                rival: m.rival.map(|r| r.reference as u32),
                rival_distance: m.rival.map(|r| r.distance),
                ambiguous: m.ambiguous,
                symmetric_partner: twin.filter(|_| !told),
                truth: None,
            }
        })
        .collect();
    let regions = second.descriptors.len() as u32;
    let unmatched = (0..regions).filter(|id| matches.iter().all(|m| m.region != *id)).collect();
    let mut warnings: Vec<String> = first.settings.caution(&second.settings).into_iter().collect();
    let versions = [&first.results.record.mser3d, &second.results.record.mser3d];
    if versions[0] != versions[1] {
        warnings.push(format!("made by different versions of mser3d, {} and {}", versions[0], versions[1]));
    }
    Ok(Matching { matches, unmatched, mirrored, precision: None, warnings })
}

impl Matching {
    /// The matches as comma-separated values, with a header line.
    pub fn to_csv(&self) -> String {
        let mut csv = String::from(
            "region,partner,distance,rival,rival_distance,ambiguous,symmetric_partner,overlap,mirrored_overlap,verdict\n",
        );
        let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
        for m in &self.matches {
            let region = |region: Option<u32>| region.map_or(String::new(), |r| r.to_string());
            let (rival, twin) = (region(m.rival), region(m.symmetric_partner));
            let verdict = m.truth.map_or("", |t| t.verdict.name());
            csv.push_str(&format!(
                "{},{},{},{rival},{},{},{twin},{},{},{verdict}\n",
                m.region,
                m.partner,
                m.distance,
                optional(m.rival_distance),
                m.ambiguous,
                optional(m.truth.map(|t| t.overlap)),
                optional(m.truth.and_then(|t| t.mirrored_overlap)),
            ));
        }
        csv
    }
}
