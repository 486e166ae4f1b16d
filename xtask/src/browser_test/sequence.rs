//! The page of a sequence: it plays.

use std::path::Path;
use std::time::Duration;

use mser3d_results::{Results, Up};
use mser3d_viewer::{SequenceFrame, SequencePage, SequenceTrack, TrackPoint};

use super::session::{Session, colours, write};
use crate::command::mser3d;

/// Frames of the page.
const FRAMES: usize = 24;
/// The region that comes and goes: found in the first half only.
const BRIEF: usize = 1;

/// A page on which the figure bows, its regions as tracks.
pub(super) fn page(results: &Results, path: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let mut page = SequencePage::new("A figure in motion", Up::Y, results.front(Up::Y));
    let track = results.vertex_region();
    let parents: Vec<[u32; 2]> =
        results.record.regions.iter().filter_map(|r| Some([r.id, r.parent?])).collect();
    for number in 0..FRAMES {
        let angle = 0.9 * (std::f64::consts::PI * number as f64 / (FRAMES - 1) as f64).sin();
        let (sin, cos) = angle.sin_cos();
        let bow = |p: &[f64; 3]| [p[0], cos * p[1] - sin * p[2], sin * p[1] + cos * p[2]];
        let mesh = results.mesh.with_vertices(results.mesh.vertices().iter().map(bow).collect())?;
        let time = Some(number as f64 / 24.0);
        page.push(&SequenceFrame { number, time, mesh: &mesh, track: &track, parents: &parents })?;
    }
    let colours = results.colours();
    let tracks: Vec<SequenceTrack> = results
        .record
        .regions
        .iter()
        .map(|region| {
            let found = if region.id as usize == BRIEF { FRAMES / 2 } else { FRAMES };
            let sighting = |frame| TrackPoint {
                frame,
                volume_fraction: region.volume_fraction,
                overlap: (frame > 0).then_some(0.95),
                reliability: region.reliability,
            };
            SequenceTrack {
                colour: colours[region.id as usize],
                colour_of: region.id,
                sightings: (0..found).map(sighting).collect(),
            }
        })
        .collect();
    let html = page.finish(FRAMES, &tracks, "");
    write(path, html.as_bytes())?;
    Ok(())
}

/// It plays, stops, goes by slider and keyboard, and shows a track's numbers.
pub(super) fn plays(session: &mut Session<'_>) -> Result<(), String> {
    session.load("sequence.html")?;
    plays_on(session, "sequence")?;
    // From the table: a track that is found in half of the frames.
    let row = format!("document.querySelectorAll('#tracks tbody button')[{BRIEF}].click()");
    session.browser.evaluate(&row)?;
    let told = session.browser.text("#details")?;
    let wanted = [
        format!("Track {BRIEF}"),
        format!("found in {} of {FRAMES} frames", FRAMES / 2),
        "Reliability".into(),
    ];
    if let Some(missing) = wanted.iter().find(|w| !told.contains(w.as_str())) {
        return Err(format!("the panel says {told:?}, without {missing:?}"));
    }
    session.shot("sequence-track.png")?;
    // From the body: its middle belongs to some track, or to none, and then nothing is chosen.
    session.browser.press("Escape")?;
    let place = session.centre("#canvas", 0.5)?;
    session.browser.click(place)?;
    let told = session.browser.text("#details h2")?;
    if !told.starts_with("Track") && told != "No track chosen" {
        return Err(format!("after a click on the body the panel is headed {told:?}"));
    }
    Ok(())
}

/// The frames of an animated file, tracked by the program, play too: of the fox where it is there, else of a figure.
pub(super) fn animation_plays(session: &mut Session<'_>) -> Result<(), String> {
    session.load("moving/tracks.html")?;
    plays_on(session, "moving")?;
    session.press_button("[data-view=\"2\"]")?;
    session.shot("moving-side.png").map(|_| ())
}

/// Tracks an animated file, and writes its page to a folder.
pub(super) fn track(folder: &Path) -> Result<(), String> {
    let fox = Path::new("../shared/data/gltf/Fox.glb");
    let (file, animation) =
        if fox.exists() { (fox, "Run") } else { (Path::new("fixtures/quadruped.glb"), "poses") };
    let (file, folder, frames) =
        (file.display().to_string(), folder.display().to_string(), FRAMES.to_string());
    let what = ["--animation", animation, "--frames", &frames, "--voxels", "8000", "--html", "--quiet"];
    mser3d(&[&["track", &file, "-o", &folder], &what[..]].concat())
}

/// Three times look different; it plays, stops, and goes frame by frame.
fn plays_on(session: &mut Session<'_>, name: &str) -> Result<(), String> {
    let mut shots = Vec::new();
    for (number, frame) in [0, 6, 12].into_iter().enumerate() {
        let go = format!(
            "(() => {{ const t = document.getElementById('time'); t.value = {frame}; t.dispatchEvent(new Event('input')); }})()"
        );
        session.browser.evaluate(&go)?;
        let said = session.browser.text("#now")?;
        if !said.starts_with(&format!("frame {frame} of {FRAMES}")) {
            return Err(format!("at frame {frame} the page says {said:?}"));
        }
        shots.push(session.shot(&format!("{name}-{}.png", number + 1))?);
    }
    if shots[0] == shots[1] || shots[1] == shots[2] {
        return Err("two times look the same".into());
    }
    let seen = colours(&shots[0])?;
    if seen < 100 {
        return Err(format!("only {seen} colours are seen: the body is not drawn"));
    }
    // Playing goes on by itself, and stops.
    session.browser.press(" ")?;
    let before = session.browser.text("#now")?;
    std::thread::sleep(Duration::from_millis(600));
    if session.browser.text("#now")? == before {
        return Err(format!("playing stays at {before:?}"));
    }
    session.browser.press(" ")?;
    let stopped = session.browser.text("#now")?;
    std::thread::sleep(Duration::from_millis(300));
    if session.browser.text("#now")? != stopped {
        return Err("it plays on after the pause".into());
    }
    session.browser.press(".")?;
    if session.browser.text("#now")? == stopped {
        return Err("the point key shows no other frame".into());
    }
    Ok(())
}

/// Without WebGL2 the table and the curves are there.
pub(super) fn is_read_without_webgl(session: &mut Session<'_>) -> Result<(), String> {
    session.load("sequence.html")?;
    let shown = session.browser.evaluate("!document.getElementById('failure').hidden")?;
    session.browser.evaluate("document.querySelector('#tracks tbody button').click()")?;
    let told = session.browser.text("#details")?;
    if shown != true || !told.contains("Track 0") {
        return Err(format!("without WebGL2 the panel says {told:?}"));
    }
    Ok(())
}
