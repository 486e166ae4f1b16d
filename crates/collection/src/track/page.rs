use std::path::Path;

use mser3d_results::{Identity, RegionRecord, Results, ResultsError, TracksRecord, Up};
use mser3d_viewer::{Rgb, SequenceFrame, SequencePage, SequenceTrack, TrackPoint};

use super::front::front;
use crate::CollectionError;

/// The page of a sequence may have so many bytes for its frames.
const LARGEST: f64 = 9e6;

/// Bytes of a page for each vertex of a frame, and for each triangle that is new in it.
const OF_VERTEX: f64 = 8.0 * 4.0 / 3.0;
const OF_TRIANGLE: f64 = 12.0 * 4.0 / 3.0;

/// A page on which a tracked sequence plays in a browser, from the folder that [`track_results`](crate::track_results) wrote:
/// each frame's surface in the colours of its tracks, seen from its body's front, a slider for the time, and each track's numbers over time.
///
/// Where all frames would make the page larger than about 9 MB, only every second is on it, or every third, and so on, and the page says so.
///
/// # Errors
/// Errors of reading the folder, and [`CollectionError::LargeSequence`] where not even two frames fit.
pub fn track_page(folder: &Path, title: &str, up: Up) -> Result<String, CollectionError> {
    let record = TracksRecord::load(folder)?;
    let there: Vec<usize> =
        (0..record.frames.len()).filter(|&f| record.frames[f].regions.is_some()).collect();
    let load = |frame: usize| Results::load(&folder.join(&record.frames[frame].name));
    let Some(&first) = there.first() else {
        let problem = "has no result of any frame".to_owned();
        return Err(CollectionError::NotACollection { folder: folder.to_owned(), problem });
    };
    let mesh = load(first)?.mesh;
    let vertices = mesh.vertices().len() as f64 * OF_VERTEX;
    // Of a sequence with other triangles in each frame, all may be new.
    let triangles = mesh.triangles().len() as f64 * OF_TRIANGLE;
    let others = record.frames.iter().any(|f| f.identity == Some(Identity::Descriptors));
    let of_frame = if others { vertices + triangles } else { vertices };
    let room = ((LARGEST - triangles) / of_frame).max(0.0) as usize;
    if room < 2.min(there.len()) {
        let bytes = (triangles + 2.0 * of_frame) as usize;
        return Err(CollectionError::LargeSequence { bytes, limit: LARGEST as usize });
    }
    let step = there.len().div_ceil(room);
    let mut page = SequencePage::new(title, up, front(folder, &record, up)?);
    for &frame in there.iter().step_by(step) {
        let results = load(frame)?;
        let of_region = |region: u32| results.record.regions.get(region as usize)?.track;
        let innermost = |&region: &i32| {
            let track = u32::try_from(region).ok().and_then(of_region);
            track.map_or(-1, |track| track as i32)
        };
        let track: Vec<i32> = results.vertex_region().iter().map(innermost).collect();
        let pair = |r: &RegionRecord| Some([r.track?, r.parent.and_then(of_region)?]);
        let parents: Vec<[u32; 2]> = results.record.regions.iter().filter_map(pair).collect();
        let shown = page.push(&SequenceFrame {
            number: frame,
            time: record.frames[frame].time,
            mesh: &results.mesh,
            track: &track,
            parents: &parents,
        });
        shown.map_err(ResultsError::from)?;
    }
    let tracks: Vec<SequenceTrack> = record
        .tracks
        .iter()
        .map(|track| SequenceTrack {
            colour: Rgb(track.colour),
            colour_of: track.colour_of,
            sightings: (track.sightings.iter())
                .map(|s| TrackPoint {
                    frame: s.frame,
                    volume_fraction: s.volume_fraction,
                    overlap: s.overlap,
                    reliability: s.reliability,
                })
                .collect(),
        })
        .collect();
    let mut note = record.warnings.join("; ");
    if step > 1 {
        let left_out = format!("only one of {step} frames is shown, so that the page is not too large");
        note = if note.is_empty() { left_out } else { format!("{note}; {left_out}") };
    }
    Ok(page.finish(record.frames.len(), &tracks, &note))
}
