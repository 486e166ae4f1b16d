//! `track`: identities through a sequence.

use std::fs;
use std::path::{Path, PathBuf};

use crate::common::*;
use serde_json::Value;

const COARSE: &str = "--voxels 2500 --quiet";

fn track(inputs: &[PathBuf], folder: &Path, options: &str) -> std::process::Output {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("track").args(inputs).arg("-o").arg(folder).args(options.split_whitespace());
    command.output().unwrap()
}

/// As [`track`], of a run that must succeed: `tracks.json`.
fn tracks(inputs: &[PathBuf], folder: &Path, options: &str) -> Value {
    let output = track(inputs, folder, options);
    assert!(output.status.success(), "{}", text(&output.stderr));
    json(&folder.join("tracks.json"))
}

/// A block with a handle on top, of this length, moved along x. With `turned` its triangles are listed from the last one on.
fn block(folder: &Path, name: &str, handle: f64, x: f64, turned: bool) -> PathBuf {
    let parts = [([-2.0, -2.0, 0.0], [2.0, 2.0, 4.0]), ([-0.6, -0.6, 3.9], [0.6, 0.6, 4.0 + handle])];
    let mut text = String::from("OFF\n16 24 0\n");
    for (low, high) in parts {
        for line in box_off(low, high).lines().skip(2).take(8) {
            let p: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            text += &format!("{} {} {}\n", p[0] + x, p[1], p[2]);
        }
    }
    let mut faces: Vec<String> = Vec::new();
    for first in [0, 8] {
        for line in box_off([0.0; 3], [1.0; 3]).lines().skip(10) {
            let v: Vec<u32> = line.split(' ').skip(1).map(|v| v.parse().unwrap()).collect();
            faces.push(format!("3 {} {} {}\n", v[0] + first, v[1] + first, v[2] + first));
        }
    }
    if turned {
        faces.reverse();
    }
    let path = folder.join(name);
    fs::write(&path, text + &faces.concat()).unwrap();
    path
}

/// The frames in which the track of the region at the end of the handle is found.
fn frames_of_handle(tracks: &Value) -> Vec<Vec<u64>> {
    let is_handle = |track: &&Value| track["sightings"][0]["centroid"][2].as_f64().unwrap() > 5.0;
    let frames = |track: &Value| {
        track["sightings"].as_array().unwrap().iter().map(|s| s["frame"].as_u64().unwrap()).collect()
    };
    tracks["tracks"].as_array().unwrap().iter().filter(is_handle).map(frames).collect()
}

#[test]
fn a_region_that_comes_back_in_time_is_the_same() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    // The handle is drawn in for two frames.
    let handles = [6.0, 6.0, 0.1, 0.1, 6.0];
    let frames: Vec<PathBuf> =
        (0..).zip(handles).map(|(i, h)| block(at, &format!("f{i}.off"), h, 0.0, false)).collect();
    let kept = tracks(&frames, &at.join("kept"), &format!("{COARSE} --max-gap 2"));
    // Several regions of the handle, one in the other.
    let kept_frames = frames_of_handle(&kept);
    assert!(
        !kept_frames.is_empty() && kept_frames.iter().all(|frames| *frames == [0, 1, 4]),
        "{kept_frames:?}"
    );
    let lost = tracks(&frames, &at.join("lost"), &format!("{COARSE} --max-gap 1"));
    let count = kept_frames.len();
    let expected = [vec![vec![0, 1]; count], vec![vec![4]; count]].concat();
    assert_eq!(frames_of_handle(&lost), expected);
    // The innermost, which has the vertices.
    let handle = kept["tracks"].as_array().unwrap().iter().rev().find(|t| t["found"] == 3).unwrap();
    // Equal frames overlap wholly.
    assert_eq!(handle["sightings"][1]["overlap"], 1.0);
    assert_eq!((&handle["first_frame"], &handle["last_frame"]), (&0.into(), &4.into()));
    assert!(handle["sightings"][0]["overlap"].is_null());
    // Reliability is that of the copies of the frames within three: of the first frame its own and the next one's.
    let odds = |i: usize| {
        let record = json(&at.join(format!("kept/f{i}/regions.json")));
        let region =
            record["regions"].as_array().unwrap().iter().find(|r| r["track"] == handle["id"]).unwrap();
        let reliability = region["reliability"].as_f64().unwrap();
        (reliability / (1.0 - reliability)).ln()
    };
    let pooled = 1.0 / (1.0 + (-0.5 * (odds(0) + odds(1))).exp());
    assert!((handle["sightings"][0]["reliability"].as_f64().unwrap() - pooled).abs() < 1e-9);
    assert_ne!(odds(0), odds(1), "each frame has another copy");

    // Its colour is the same in all frames.
    for frame in [0, 1, 4] {
        let record = json(&at.join(format!("kept/f{frame}/regions.json")));
        let region =
            record["regions"].as_array().unwrap().iter().find(|r| r["track"] == handle["id"]).unwrap();
        assert_eq!(region["colour"], handle["colour"]);
        let ply = fs::read(at.join(format!("kept/f{frame}/surface.ply"))).unwrap();
        let colour: Vec<u8> =
            handle["colour"].as_array().unwrap().iter().map(|c| c.as_u64().unwrap() as u8).collect();
        assert!(ply.windows(3).any(|bytes| bytes == colour));
    }
    // A row for each sighting.
    let csv = fs::read_to_string(at.join("kept/tracks.csv")).unwrap();
    let sightings: u64 =
        kept["tracks"].as_array().unwrap().iter().map(|t| t["found"].as_u64().unwrap()).sum();
    assert_eq!(csv.lines().count() as u64, sightings + 1);
    assert!(csv.contains(&format!("\n{},4,f4,,", handle["id"])), "{csv}");
}

#[test]
fn a_sequence_is_shown_as_page_pictures_and_animated_mesh() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let handles = [6.0, 5.5, 5.0];
    let frames: Vec<PathBuf> =
        (0..).zip(handles).map(|(i, h)| block(at, &format!("f{i}.off"), h, 0.0, false)).collect();
    let out = at.join("out");
    let all = "--html --glb --pictures --height 64 --reliability 0";
    let tracks = tracks(&frames, &out, &format!("{COARSE} {all}"));
    let page = fs::read_to_string(out.join("tracks.html")).unwrap();
    let head = page_head(&page);
    assert_eq!((&head["total"], head["frames"].as_array().unwrap().len()), (&3.into(), 3));
    assert_eq!(head["tracks"].as_array().unwrap().len(), tracks["tracks"].as_array().unwrap().len());
    assert_eq!(head["triangles"].as_array().unwrap().len(), 1, "they are the same in all frames");
    // Three frames, an eighth of a second each.
    let moving = fs::read(out.join("moving.png")).unwrap();
    let control = moving.windows(4).position(|chunk| chunk == b"acTL").unwrap();
    assert_eq!(moving[control + 4..control + 8], [0, 0, 0, 3]);
    assert!(fs::read(out.join("strip.png")).unwrap().starts_with(b"\x89PNG"));
    let options =
        mser3d_meshio::ReadOptions { animation: Some("sequence".into()), time: 0.125, ..Default::default() };
    let second = mser3d_meshio::read_mesh(&out.join("tracks.glb"), &options).unwrap().mesh;
    let highest = second.vertices().iter().map(|p| p[2]).fold(0.0, f64::max);
    assert!((highest - 9.5).abs() < 1e-6, "{highest}");

    // One mesh cannot have other triangles in each frame.
    let other = block(at, "other.off", 6.0, 0.0, true);
    let output = track(&[frames[0].clone(), other], &at.join("mixed"), &format!("{COARSE} --glb"));
    assert_fails(&output, 1, &["mixed", "other triangles"]);
    // Tracking again takes the pictures of older tracks away.
    track(&frames, &out, &format!("{COARSE} --reliability 0"));
    assert!(
        !out.join("tracks.html").exists()
            && !out.join("moving.png").exists()
            && out.join("tracks.json").exists()
    );
}

#[test]
fn frames_with_other_triangles_are_compared_by_descriptor_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let frames = [
        block(at, "a.off", 6.0, 0.0, false),
        block(at, "b.off", 6.0, 30.0, true),
        block(at, "c.off", 6.0, 60.0, true),
    ];
    let output = track(&frames, &at.join("out"), "--voxels 2500");
    assert!(output.status.success() && text(&output.stderr).contains("by descriptor and place"));
    let found = json(&at.join("out/tracks.json"));
    let by: Vec<&Value> = found["frames"].as_array().unwrap().iter().map(|f| &f["identity"]).collect();
    assert_eq!(by, [&Value::Null, &"descriptors".into(), &"vertices".into()]);
    let frames = frames_of_handle(&found);
    assert!(!frames.is_empty() && frames.iter().all(|frames| *frames == [0, 1, 2]), "{frames:?}");
    let handle = found["tracks"].as_array().unwrap().iter().find(|t| t["found"] == 3).unwrap();
    // The body is moved, but otherwise the same.
    assert!(handle["sightings"][1]["likeness"].as_f64().unwrap() > 0.9, "{handle}");
    assert_eq!(handle["sightings"][2]["overlap"], 1.0);
}

#[test]
fn an_animation_is_tracked_the_same_by_any_number_of_threads_and_again() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let figure = [fixtures().join("human.glb")];
    let options = format!("{COARSE} --animation poses --frames 3 --reliability 0");
    let first = tracks(&figure, &at.join("a"), &format!("{options} --threads 1"));
    assert_eq!(first["frames"].as_array().unwrap().len(), 3);
    assert!(first["frames"][2]["time"].as_f64().unwrap() > 0.0);
    assert!(first["tracks"].as_array().unwrap().iter().any(|t| t["found"] == 3), "{first:#}");
    tracks(&figure, &at.join("b"), &format!("{options} --threads 2"));
    let files = |of: &str| {
        let names = ["tracks.json", "tracks.csv", "tracks.parquet"];
        names.map(|name| fs::read(at.join(of).join(name)).unwrap())
    };
    let before = files("a");
    assert!(before == files("b"));
    let output = track(&figure, &at.join("a"), &options.replace("--quiet", ""));
    assert!(text(&output.stdout).contains("(0 computed, 3 kept, 0 failed)"), "{}", text(&output.stdout));
    assert!(before == files("a"));
}

#[test]
fn what_is_no_sequence_and_wrong_options_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let figure = [fixtures().join("human.glb")];
    let fails = |inputs: &[PathBuf], options: &str, code: i32, words: &[&str]| {
        assert_fails(&track(inputs, &at.join("out"), options), code, words);
        assert!(!at.join("out").exists());
    };
    fails(&figure, "--animation dance", 1, &["human.glb", "no animation \"dance\"", "poses"]);
    fails(&figure, "--frames 1", 2, &["frames", "from 2"]);
    fails(&figure, "--frames 4 --every 0.1", 2, &["--frames", "--every"]);
    fails(&figure, "--every 0", 2, &["--every", "positive"]);
    fails(&figure, "--min-overlap 0", 2, &["min_overlap", "above 0"]);
    fails(&figure, "--label all", 2, &["--label all", "choose a label"]);
    let block = block(at, "a.off", 6.0, 0.0, false);
    fails(std::slice::from_ref(&block), "", 1, &["a.off", "no animation", "several files"]);
    fails(&[block.clone(), block], "--animation walk", 1, &["a.off", "is of one file"]);
    let beyond = detect(&figure[0], &at.join("out"), "--animation poses --time 99");
    assert_fails(&beyond, 1, &["human.glb", "\"poses\"", "ends at", "99 s"]);
}
