use std::path::{Path, PathBuf};

use mser3d::descriptors::{Descriptors, MatchParameters, match_descriptors};
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
}

impl DescribedResult {
    /// Reads a result that has regions to compare.
    ///
    /// # Errors
    /// [`CollectionError::Results`], [`CollectionError::NoRegions`].
    pub fn load(folder: &Path) -> Result<Self, CollectionError> {
        let results = Results::load(folder)?;
        let settings = DescriptorSettings::of(&results.record);
        if results.record.regions.is_empty() {
            return Err(CollectionError::NoRegions { folder: folder.to_owned() });
        }
        let descriptors = Descriptors::new(results.descriptor_width, results.descriptors.clone())?;
        Ok(Self { folder: folder.to_owned(), results, settings, descriptors })
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
    /// Euclidean distance of their descriptors.
    pub distance: f64,
    /// The region of the first shape that is nearest but for the partner.
    pub rival: Option<u32>,
    /// Its distance.
    pub rival_distance: Option<f64>,
    /// Whether the rival is about as near.
    pub ambiguous: bool,
    /// Whether the rival looks like the partner's mirror image: ambiguous, of like volume, and apart
    /// from it. Intrinsic descriptors cannot tell left from right.
    pub symmetric: bool,
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
    /// How many are right, where a ground truth is known.
    pub precision: Option<PrecisionRecall>,
    /// What the user should know.
    pub warnings: Vec<String>,
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
    pub parameters: MatchParameters,
    /// What was found.
    pub result: Matching,
}

impl MatchRecord {
    /// The record of a matching of these results with these parameters.
    pub fn new(
        first: &DescribedResult,
        second: &DescribedResult,
        parameters: &MatchParameters,
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

/// Volumes that differ by less than this factor may be mirror images.
const LIKE_VOLUME: f64 = 1.25;

/// Matches each region of `second` to one of `first` by descriptor.
///
/// # Errors
/// [`CollectionError::DifferentDescriptors`]; [`CollectionError::Descriptors`] for parameters out of range.
pub fn match_results(
    first: &DescribedResult,
    second: &DescribedResult,
    parameters: &MatchParameters,
) -> Result<Matching, CollectionError> {
    if let Some(what) = first.settings.difference(&second.settings) {
        let (first, second) = (first.folder.clone(), second.folder.clone());
        return Err(CollectionError::DifferentDescriptors { first, second, what });
    }
    let found = match_descriptors(&second.descriptors, &first.descriptors, parameters)?;
    let matches: Vec<RegionMatch> = found
        .into_iter()
        .map(|m| {
            let rival = m.rival.map(|r| r.reference);
            RegionMatch {
                region: m.query as u32,
                partner: m.partner.reference as u32,
                distance: m.partner.distance,
                rival: rival.map(|r| r as u32),
                rival_distance: m.rival.map(|r| r.distance),
                ambiguous: m.ambiguous,
                symmetric: m.ambiguous
                    && rival.is_some_and(|r| mirrored(&first.results, m.partner.reference, r)),
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
    Ok(Matching { matches, unmatched, precision: None, warnings })
}

/// Whether two regions of a shape may be mirror images: of like volume, and apart.
fn mirrored(results: &Results, a: usize, b: usize) -> bool {
    let volume = |region: usize| results.record.regions[region].volume;
    let (small, large) = (volume(a).min(volume(b)), volume(a).max(volume(b)));
    let members = |region: usize| match results.region_voxels.get(region) {
        Some(voxels) if !voxels.is_empty() => voxels,
        _ => &results.region_vertices[region],
    };
    large < LIKE_VOLUME * small && members(a).iter().all(|m| members(b).binary_search(m).is_err())
}

impl Matching {
    /// The matches as comma-separated values, with a header line.
    pub fn to_csv(&self) -> String {
        let mut csv = String::from(
            "region,partner,distance,rival,rival_distance,ambiguous,symmetric,overlap,mirrored_overlap,verdict\n",
        );
        let optional = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
        for m in &self.matches {
            let rival = m.rival.map_or(String::new(), |r| r.to_string());
            let verdict = m.truth.map_or("", |t| t.verdict.name());
            csv.push_str(&format!(
                "{},{},{},{rival},{},{},{},{},{},{verdict}\n",
                m.region,
                m.partner,
                m.distance,
                optional(m.rival_distance),
                m.ambiguous,
                m.symmetric,
                optional(m.truth.map(|t| t.overlap)),
                optional(m.truth.and_then(|t| t.mirrored_overlap)),
            ));
        }
        csv
    }
}
