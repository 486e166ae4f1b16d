use mser3d_results::{Results, TracksRecord};
use mser3d_viewer::Rgb;

/// The innermost track at each vertex of a frame that is found in half of all frames or more; -1 for none. What comes and goes would
/// make pictures flicker.
pub(super) fn lasting_tracks(results: &Results, record: &TracksRecord) -> Vec<i32> {
    let regions = &results.record.regions;
    let lasts = |track: u32| {
        record.tracks.get(track as usize).is_some_and(|track| 2 * track.found >= record.frames.len())
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
