use std::collections::BTreeSet;

use mser3d_results::{Results, Track, TracksRecord};
use mser3d_viewer::Rgb;

/// The innermost track at each vertex of a frame whose piece of the body is found in half of all frames or more, by it or by another of its
/// colour; -1 for none. What comes and goes would make pictures flicker.
pub(super) fn lasting_tracks(results: &Results, record: &TracksRecord) -> Vec<i32> {
    let regions = &results.record.regions;
    let mut frames = vec![BTreeSet::new(); record.tracks.len()];
    for Track { colour_of, sightings, .. } in &record.tracks {
        if let Some(own) = frames.get_mut(*colour_of as usize) {
            own.extend(sightings.iter().map(|sighting| sighting.frame));
        }
    }
    let lasts = |track: u32| {
        let piece = record.tracks.get(track as usize).and_then(|track| frames.get(track.colour_of as usize));
        piece.is_some_and(|own| 2 * own.len() >= record.frames.len())
    };
    // Parents come first.
    let mut shown: Vec<i32> = Vec::with_capacity(regions.len());
    for region in regions {
        let around = region.parent.and_then(|parent| shown.get(parent as usize).copied()).unwrap_or(-1);
        shown.push(region.track.filter(|&track| lasts(track)).map_or(around, |track| track as i32));
    }
    let of_region =
        |&region: &i32| usize::try_from(region).ok().and_then(|r| shown.get(r)).copied().unwrap_or(-1);
    results.vertex_region().iter().map(of_region).collect()
}

/// The colours of all tracks.
pub(super) fn colours(record: &TracksRecord) -> Vec<Rgb> {
    record.tracks.iter().map(|track| Rgb(track.colour)).collect()
}
