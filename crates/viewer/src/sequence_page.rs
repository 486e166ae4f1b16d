//! The page of a sequence: a body in motion, coloured by its tracks, with a slider for the time.

use base64::Engine;
use mser3d_shape::{BoundingBox, Choice, TriangleMesh};
use serde_json::{Value, json};

use crate::page::{Pack, escape, fill};
use crate::{NO_REGION, Rgb, Up, ViewerError, frame_milliseconds};

const TEMPLATE: &str = include_str!("../page/sequence/sequence.html");
const STYLE: &str = include_str!("../page/sequence/sequence.css");
/// Concatenated in this order into one function scope.
const SCRIPTS: [&str; 6] = [
    include_str!("../page/data.js"),
    include_str!("../page/camera.js"),
    include_str!("../page/sequence/frames.js"),
    include_str!("../page/sequence/draw.js"),
    include_str!("../page/sequence/numbers.js"),
    include_str!("../page/sequence/main.js"),
];

/// A frame of a [`SequencePage`].
#[derive(Clone, Debug)]
pub struct SequenceFrame<'a> {
    /// Its number in the sequence. Frames may be left out of the page.
    pub number: usize,
    /// When it is, in seconds.
    pub time: Option<f64>,
    /// Its surface.
    pub mesh: &'a TriangleMesh,
    /// The innermost track at each vertex; -1 for none.
    pub track: &'a [i32],
    /// Tracks of this frame, and the track that is around each.
    pub parents: &'a [[u32; 2]],
}

/// A track of a [`SequencePage`].
#[derive(Clone, Debug)]
pub struct SequenceTrack {
    /// Its colour in all frames.
    pub colour: Rgb,
    /// The track that it has its colour of; itself where it has one of its own.
    pub colour_of: u32,
    /// Where it is found.
    pub sightings: Vec<TrackPoint>,
}

/// The numbers of a track in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackPoint {
    /// The number of the frame.
    pub frame: usize,
    /// Its share of the volume or area.
    pub volume_fraction: f64,
    /// Its overlap with the frame before.
    pub overlap: Option<f64>,
    /// How surely it is found again.
    pub reliability: Option<f64>,
}

/// A self-contained HTML page of a body in motion: it plays, a slider goes through the time, and a click on the body or on the
/// table of tracks shows a track's numbers over time. By keyboard too; a browser without WebGL2 shows all but the body.
///
/// Places of vertices are kept in 16 bits of the frame's box for each coordinate, so a frame of n vertices has 8 n bytes, 4/3 of
/// that in the page; triangles are kept once as long as they stay the same.
///
/// ```
/// use mser3d_shape::TriangleMesh;
/// use mser3d_viewer::{PALETTE, SequenceFrame, SequencePage, SequenceTrack, TrackPoint, Up};
///
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let point = |frame| TrackPoint { frame, volume_fraction: 0.2, overlap: None, reliability: Some(0.9) };
/// let mut page = SequencePage::new("A tetrahedron", Up::Y, None);
/// for number in 0..2 {
///     page.push(&SequenceFrame { number, time: None, mesh: &mesh, track: &[0, -1, -1, 0], parents: &[] })?;
/// }
/// let track = SequenceTrack { colour: PALETTE[0].middle, colour_of: 0, sightings: vec![point(0), point(1)] };
/// let html = page.finish(2, &[track], "");
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct SequencePage {
    title: String,
    up: Up,
    front: Option<f64>,
    pack: Pack,
    frames: Vec<Value>,
    times: Vec<f64>,
    /// The triangles that the last frame has, and all that there are in the page.
    last: Vec<[u32; 3]>,
    triangles: Vec<Value>,
}

impl SequencePage {
    /// A page without frames. `front` is the azimuth of the body's front, in degrees ([`View::azimuth`](crate::View::azimuth)), from
    /// which the page counts its own; without one that is finite the file's axes rule.
    pub fn new(title: &str, up: Up, front: Option<f64>) -> Self {
        let title = title.to_owned();
        let (pack, frames, times) = (Pack::default(), Vec::new(), Vec::new());
        Self { title, up, front, pack, frames, times, last: Vec::new(), triangles: Vec::new() }
    }

    /// Adds the next frame.
    ///
    /// # Errors
    /// [`ViewerError::Empty`] for a mesh without triangles, [`ViewerError::SizeMismatch`] unless there is one track for each vertex.
    pub fn push(&mut self, frame: &SequenceFrame<'_>) -> Result<(), ViewerError> {
        let mesh = frame.mesh;
        let Some(BoundingBox { min, max }) = mesh.bounding_box().filter(|_| !mesh.triangles().is_empty())
        else {
            return Err(ViewerError::Empty { reason: "the mesh has no triangles" });
        };
        crate::model::fits("tracks of vertices", frame.track.len(), mesh.vertices().len())?;
        if self.triangles.is_empty() || self.last != mesh.triangles() {
            self.last = mesh.triangles().to_vec();
            self.triangles.push(self.pack.u32(self.last.iter().flatten().copied()));
        }
        let step: [f64; 3] = std::array::from_fn(|a| (max[a] - min[a]) / 65535.0);
        let quantised = |p: &[f64; 3]| -> [u16; 3] {
            std::array::from_fn(
                |a| if step[a] > 0.0 { ((p[a] - min[a]) / step[a]).round() as u16 } else { 0 },
            )
        };
        let position = self.pack.u16(mesh.vertices().iter().flat_map(quantised));
        let track = self.pack.i16(frame.track.iter().map(|&t| i16::try_from(t).unwrap_or(-1)));
        self.times.extend(frame.time);
        self.frames.push(json!({
            "number": frame.number,
            "time": frame.time,
            "low": min,
            "step": step,
            "position": position,
            "track": track,
            "parents": frame.parents,
            "triangles": self.triangles.len() - 1,
        }));
        Ok(())
    }

    /// The page of these tracks through a sequence of `total` frames. `note` is said below the table.
    pub fn finish(self, total: usize, tracks: &[SequenceTrack], note: &str) -> String {
        let point = |p: &TrackPoint| {
            json!({
                "frame": p.frame,
                "fraction": p.volume_fraction,
                "overlap": p.overlap,
                "reliability": p.reliability,
            })
        };
        let track = |track: &SequenceTrack| {
            json!({
                "colour": track.colour.0,
                "colourOf": track.colour_of,
                "sightings": track.sightings.iter().map(point).collect::<Vec<_>>(),
            })
        };
        let head = json!({
            "title": self.title,
            "up": self.up.name(),
            "front": self.front.filter(|front| front.is_finite()),
            "none": NO_REGION.0,
            "shapes": [],
            "frames": self.frames,
            "total": total,
            "interval": frame_milliseconds(&self.times),
            "triangles": self.triangles,
            "tracks": tracks.iter().map(track).collect::<Vec<_>>(),
            "note": note,
        });
        // Inside a script element, only "<" could end it.
        let head = head.to_string().replace('<', "\\u003c");
        let parts = [
            ("{{title}}", escape(&self.title)),
            ("{{style}}", STYLE.to_owned()),
            ("{{script}}", SCRIPTS.concat()),
            ("{{head}}", head),
            ("{{arrays}}", base64::engine::general_purpose::STANDARD.encode(self.pack.bytes())),
        ];
        fill(TEMPLATE, &parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_are_kept_once_and_places_in_sixteen_bits() {
        let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 2., 0.], [0., 0., 4.]];
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let mesh = TriangleMesh::new(corners, faces).unwrap();
        let other = TriangleMesh::new(mesh.vertices().to_vec(), mesh.triangles()[1..].to_vec()).unwrap();
        let mut page = SequencePage::new("t", Up::Z, None);
        for (number, mesh) in [&mesh, &mesh, &other].into_iter().enumerate() {
            page.push(&SequenceFrame { number, time: None, mesh, track: &[0, 0, -1, 1], parents: &[[1, 0]] })
                .unwrap();
        }
        // Triangles of 48 and 36 bytes; of each frame 24 for places and 8 for tracks.
        assert_eq!(page.pack.bytes().len(), 48 + 36 + 3 * 32);
        assert_eq!(page.frames[2]["triangles"], 1);
        // The first vertex is at the low corner, the last at the top of z.
        assert_eq!(page.pack.bytes()[48..54], [0; 6]);
        assert_eq!(page.pack.bytes()[48 + 22..48 + 24], [255, 255]);
        let short = SequenceFrame { number: 3, time: None, mesh: &mesh, track: &[0], parents: &[] };
        assert!(page.push(&short).unwrap_err().to_string().contains("tracks of vertices"));
    }
}
