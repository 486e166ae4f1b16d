use std::path::Path;

use mser3d_meshio::{Moment, write_moving_glb};
use mser3d_results::{Identity, Results, TracksRecord};
use mser3d_viewer::{frame_milliseconds, label_colour};

use super::lasting::{colours, lasting_tracks};
use crate::CollectionError;

pub(super) const GLB: &str = "tracks.glb";

/// Writes a tracked sequence from its folder as binary glTF, `tracks.glb`, for Blender and the web: the animation, with the colour of
/// its innermost track in the first frame at each vertex, of the pieces of the body that are found in half of the frames or more.
///
/// # Errors
/// [`CollectionError::NotACollection`] where frames have other triangles than the first, or less than two have a result; errors
/// of reading the folder and of writing.
pub fn track_glb(folder: &Path) -> Result<(), CollectionError> {
    let record = TracksRecord::load(folder)?;
    let refuse = |problem: &str| CollectionError::NotACollection {
        folder: folder.to_owned(),
        problem: problem.to_owned(),
    };
    if record.frames.iter().any(|frame| frame.identity == Some(Identity::Descriptors)) {
        return Err(refuse(
            "has frames with other triangles than the frame before, which one animated mesh cannot hold",
        ));
    }
    let there: Vec<_> = record.frames.iter().filter(|frame| frame.regions.is_some()).collect();
    let times: Vec<f64> = there.iter().filter_map(|frame| frame.time).collect();
    let step = frame_milliseconds(&times) / 1000.0;
    let (mut moments, mut first) = (Vec::with_capacity(there.len()), None);
    for (number, frame) in there.iter().enumerate() {
        let results = Results::load(&folder.join(&frame.name))?;
        let time = frame.time.unwrap_or(number as f64 * step);
        moments.push(Moment { time, vertices: results.mesh.vertices().to_vec() });
        first.get_or_insert(results);
    }
    let Some(first) = first.filter(|_| moments.len() > 1) else {
        return Err(refuse("has a result of one frame only, which is no motion"));
    };
    let of_tracks = colours(&record);
    let colour = |&track: &i32| label_colour(&of_tracks, track).0;
    let colours: Vec<[u8; 3]> = lasting_tracks(&first, &record).iter().map(colour).collect();
    Ok(write_moving_glb(&folder.join(GLB), &first.mesh, &moments, &colours)?)
}
