//! Regions followed through a sequence of results.

mod front;
mod glb;
mod kinship;
mod lasting;
mod likeness;
mod page;
mod pictures;
mod pieces;
mod reliability;
mod sequence;
mod tables;
mod touching;
mod tracker;

use std::path::Path;

use mser3d_results::{Checksums, Record, Results, TrackParameters, TracksRecord};

use crate::folder::remove_file;
use crate::{CollectionError, Plan};
pub use glb::track_glb;
pub use page::track_page;
pub use pictures::track_pictures;
pub use sequence::{Sampling, plan_sequence, share_parameters};
use tracker::Tracker;

/// The name of the page of a sequence.
const PAGE: &str = "tracks.html";

/// What is made of the frames of a sequence.
pub(crate) const TRACK_FILES: [&str; 7] =
    [TracksRecord::FILE, tables::CSV, tables::PARQUET, PAGE, pictures::STRIP, pictures::MOVING, glb::GLB];

/// Follows the regions of a sequence whose results a batch has put into a folder, and gives each an identity:
///
/// * `tracks.json` ([`TracksRecord`]), and one row for each track and frame as `tracks.csv` and `tracks.parquet`;
/// * in each frame's `regions.json` the track and its colour of each region, which all pictures of the frame take;
///   its `surface.ply` has them too.
///
/// How regions are compared, and how long one may be missing, stands at [`TrackParameters`]. `heard` is told after each frame how
/// many are through, and cancels by false.
///
/// # Errors
/// [`CollectionError::InvalidParameter`]; [`CollectionError::Cancelled`]; [`CollectionError::DifferentDescriptors`] between
/// frames without the same triangles; [`CollectionError::NotACollection`] when no frame has a result; errors of reading and writing.
pub fn track_results(
    folder: &Path,
    plan: &Plan,
    parameters: &TrackParameters,
    heard: &dyn Fn(usize) -> bool,
) -> Result<TracksRecord, CollectionError> {
    remove_tracks(folder)?;
    let mut tracker = Tracker::new(*parameters)?;
    for (number, job) in plan.jobs.iter().enumerate() {
        let result = folder.join(&job.name);
        if result.join("regions.json").is_file() {
            tracker.push(&job.name, &Results::load(&result)?)?;
        } else {
            let time = job.options.pose.animation.as_ref().map(|_| job.options.pose.time);
            tracker.push_missing(&job.name, &job.path.to_string_lossy(), time);
        }
        if !heard(number + 1) {
            return Err(CollectionError::Cancelled);
        }
    }
    let record = tracker.finish()?;
    if record.frames.iter().all(|frame| frame.regions.is_none()) {
        let problem = "has no result of any frame; see failures.json".to_owned();
        return Err(CollectionError::NotACollection { folder: folder.to_owned(), problem });
    }
    for (frame, about) in record.frames.iter().enumerate().filter(|(_, about)| about.regions.is_some()) {
        colour(&folder.join(&about.name), frame, &record)?;
    }
    tables::write(folder, &record)?;
    record.write(folder)?;
    Checksums::add(folder, &[TracksRecord::FILE, tables::CSV, tables::PARQUET])?;
    Ok(record)
}

/// Takes away what was made of other results, the record first.
fn remove_tracks(folder: &Path) -> Result<(), CollectionError> {
    Checksums::forget(folder, &TRACK_FILES)?;
    TRACK_FILES.iter().try_for_each(|name| remove_file(&folder.join(name)))
}

/// Writes tracks and colours into a frame's result.
fn colour(result: &Path, frame: usize, tracks: &TracksRecord) -> Result<(), CollectionError> {
    let mut own = vec![(None, None); Record::load(result)?.regions.len()];
    for track in &tracks.tracks {
        if let Ok(at) = track.sightings.binary_search_by_key(&frame, |sighting| sighting.frame) {
            own[track.sightings[at].region as usize] = (Some(track.id), Some(track.colour));
        }
    }
    let mut results = Results::load(result)?;
    for (region, (track, colour)) in results.record.regions.iter_mut().zip(own) {
        (region.track, region.colour) = (track, colour);
    }
    Ok(results.write_colours(result)?)
}
