use std::io::Write;
use std::path::Path;

use mser3d_fileio::write_atomically;
use mser3d_results::{RenderOptions, Results, ResultsError, TracksRecord};
use mser3d_shape::{BoundingBox, TriangleMesh};
use mser3d_viewer::{
    Colours, Image, Model, Panel, View, ViewerError, frame_milliseconds, render, write_animation,
};

use super::front::front;
use super::lasting::{colours, lasting_tracks};
use crate::CollectionError;

pub(super) const STRIP: &str = "strip.png";
pub(super) const MOVING: &str = "moving.png";

/// Pictures in a strip.
const STRIP_FRAMES: usize = 8;

/// The most pictures of an animation.
const MOST_FRAMES: usize = 240;

/// Draws a tracked sequence from its folder: `strip.png`, up to eight of its frames in a row, and `moving.png`, an animated PNG of all
/// frames (of more than 240 frames only of every second, third and so on). What is found in half of the
/// frames or more has its colour, and the camera stays, before the body's own front where that can be told.
///
/// # Errors
/// Errors of reading the folder and of drawing.
pub fn track_pictures(folder: &Path, options: &RenderOptions) -> Result<(), CollectionError> {
    let record = TracksRecord::load(folder)?;
    let there: Vec<usize> =
        (0..record.frames.len()).filter(|&f| record.frames[f].regions.is_some()).collect();
    let load = |frame: usize| Results::load(&folder.join(&record.frames[frame].name));
    let mut corners = Vec::new();
    for &frame in &there {
        if let Some(bounds) = load(frame)?.mesh.bounding_box() {
            corners.extend([bounds.min, bounds.max]);
        }
    }
    let Some(stage) = BoundingBox::around(corners) else {
        return Err(ResultsError::from(ViewerError::Empty { reason: "no frame has a surface" }).into());
    };
    let view = View::THREE_QUARTER.turned(front(folder, &record, options.up)?.unwrap_or(0.0));
    let colours = colours(&record);
    let model = |frame: usize| -> Result<Model, ResultsError> {
        let results = load(frame)?;
        let mut labels = lasting_tracks(&results, &record);
        let mesh = on_stage(&results.mesh, &stage)?;
        labels.resize(mesh.vertices().len(), -1);
        Ok(Model::from_mesh(&mesh, Colours::Regions { labels: &labels, colours: &colours })?)
    };
    let caption = |frame: usize| match record.frames[frame].time {
        Some(time) => format!("{time:.2} s"),
        None => format!("frame {frame}"),
    };

    let count = there.len().min(STRIP_FRAMES);
    let chosen = |i: usize| there[i * (there.len() - 1) / (count - 1).max(1)];
    let models = (0..count).map(|i| model(chosen(i))).collect::<Result<Vec<Model>, ResultsError>>()?;
    let panels: Vec<Panel<'_>> = (models.iter().enumerate())
        .map(|(i, model)| Panel { model, view, caption: caption(chosen(i)) })
        .collect();
    let strip = render(&panels, options).map_err(ResultsError::from)?;
    write(&folder.join(STRIP), |out| strip.write_png(out))?;

    let step = there.len().div_ceil(MOST_FRAMES);
    let mut pictures: Vec<Image> = Vec::new();
    let mut times = Vec::new();
    for &frame in there.iter().step_by(step) {
        let model = &model(frame)?;
        let panel = Panel { model, view, caption: String::new() };
        pictures.push(render(&[panel], options).map_err(ResultsError::from)?);
        times.extend(record.frames[frame].time);
    }
    write(&folder.join(MOVING), |out| write_animation(&pictures, frame_milliseconds(&times), out))
}

fn write(
    path: &Path,
    picture: impl FnOnce(&mut dyn Write) -> Result<(), ViewerError>,
) -> Result<(), CollectionError> {
    let mut bytes = Vec::new();
    picture(&mut bytes).map_err(ResultsError::from)?;
    Ok(write_atomically(path, |out| out.write_all(&bytes))?)
}

/// A mesh with the corners of the stage as triangles without area, so that pictures of all frames have one place and size.
fn on_stage(mesh: &TriangleMesh, stage: &BoundingBox) -> Result<TriangleMesh, ResultsError> {
    let first = mesh.vertices().len() as u32;
    let (mut vertices, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    for corner in 0..8u32 {
        vertices
            .push(std::array::from_fn(|a| if corner >> a & 1 == 0 { stage.min[a] } else { stage.max[a] }));
        triangles.push([first + corner; 3]);
    }
    Ok(TriangleMesh::new(vertices, triangles)?)
}
