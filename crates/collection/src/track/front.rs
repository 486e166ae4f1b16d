use std::path::Path;

use mser3d_results::{Results, TracksRecord, Up};

use crate::CollectionError;

/// The azimuth of the body's front in a sequence: of the first frame that tells ([`Results::front`]). A camera that stays needs one.
pub(super) fn front(folder: &Path, record: &TracksRecord, up: Up) -> Result<Option<f64>, CollectionError> {
    for frame in record.frames.iter().filter(|frame| frame.regions.is_some()) {
        let results = Results::load(&folder.join(&frame.name))?;
        if let Some(front) = results.front(up) {
            return Ok(Some(front));
        }
        // All frames were made with the same choices.
        if results.record.parts.is_none() {
            break;
        }
    }
    Ok(None)
}
