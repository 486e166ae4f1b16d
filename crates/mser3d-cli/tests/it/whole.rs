//! Nothing good is lost, and what is damaged is found out: `mser3d verify`, full disks, two runs at once, wrong parameters.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Output};

use crate::common::*;

const SMALL: &str = "--voxels 1500 --eigenpairs 20 --quiet";

/// All files below a folder.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().display().to_string();
                all.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    all
}

fn flip(path: &Path, from_end: usize) {
    let mut bytes = fs::read(path).unwrap();
    let at = bytes.len() - from_end;
    bytes[at] ^= 8;
    fs::write(path, bytes).unwrap();
}

fn verify(folders: &[&Path]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("verify").args(folders).output().unwrap()
}

/// Fails, names all of this, and has not panicked.
fn says(output: &Output, words: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(!stderr.contains("panicked"), "{stderr}");
    words.iter().for_each(|word| assert!(stderr.contains(word), "{word:?} is not in: {stderr}"));
}

fn batch(inputs: &[&Path], folder: &Path, options: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("batch").args(inputs).arg("-o").arg(folder).args(options.split_whitespace()).output().unwrap()
}

/// Runs the program where no file may grow beyond so many blocks, as on a disk that is full.
fn on_a_full_disk(blocks: usize, arguments: &str) -> Output {
    // The signal is ignored, so that writing is an error, as it is on a full disk.
    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" {arguments}");
    Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_mser3d")]).output().unwrap()
}

#[test]
fn verify_names_what_is_wrong_with_a_result() {
    let root = tempfile::tempdir().unwrap();
    let out = root.path().join("out");
    regions(&fixtures().join("human_rest.off"), &out, SMALL);
    let output = verify(&[&out]);
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    assert_eq!(text(&output.stdout), "1 result and 0 tables checked: nothing is wrong\n");
    for name in ["features.npz", "surface.ply", "volume.vti", "regions.json"] {
        let whole = fs::read(out.join(name)).unwrap();
        flip(&out.join(name), whole.len() / 2);
        says(&verify(&[&out]), &[name, "damaged", "SHA-256", "1 are damaged"]);
        let view = mser3d(["view".as_ref(), out.as_os_str()]);
        // Pages are not made of the voxels for ParaView.
        match name {
            "volume.vti" => assert!(view.status.success()),
            _ => assert_fails(&view, 1, &[name, "damaged", "mser3d detect"]),
        }
        fs::write(out.join(name), &whole[..whole.len() - 9]).unwrap();
        says(&verify(&[&out]), &[name, "bytes, but"]);
        fs::write(out.join(name), whole).unwrap();
    }
    fs::remove_file(out.join("volume.vti")).unwrap();
    let output = verify(&[&out]);
    assert!(output.status.success() && text(&output.stderr).contains("volume.vti: is not there any more"));
    // A file that is exported into the folder in the place of another is what was written.
    let surface = out.join("surface.ply");
    let export = mser3d(["export".as_ref(), out.as_os_str(), "-o".as_ref(), surface.as_os_str()]);
    assert!(export.status.success() && verify(&[&out]).status.success());
    fs::remove_file(out.join("checksums.json")).unwrap();
    let output = verify(&[&out]);
    assert!(output.status.success() && text(&output.stderr).contains("has no checksums"), "{output:?}");
    fs::remove_file(out.join("features.npz")).unwrap();
    says(&verify(&[&out, root.path()]), &["features.npz"]);
    says(&verify(&[&root.path().join("none")]), &["none", "no such folder"]);
}

#[test]
fn a_batch_does_what_is_damaged_again_and_says_so() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    let meshes = ["human_rest.off", "human_walk.off", "human_kick.off"].map(|name| fixtures().join(name));
    let inputs = [&*meshes[0], &*meshes[1], &*meshes[2]];
    let all = path("all");
    assert!(batch(&inputs, &all, SMALL).status.success());
    let output = verify(&[&all]);
    assert!(output.status.success(), "{output:?}");
    assert!(text(&output.stdout).starts_with("3 results and 3 tables checked"), "{output:?}");
    let whole = contents(&all);
    // Nobody could be kept out of a table by reading it: damage is found before.
    for name in ["regions.parquet", "shapes.parquet", "failures.json"] {
        let bytes = fs::read(all.join(name)).unwrap();
        flip(&all.join(name), bytes.len() / 2 + 1);
        says(&verify(&[&all]), &[name, "damaged"]);
        if name == "regions.parquet" {
            says(&mser3d(["query".as_ref(), all.as_os_str(), "human_rest".as_ref()]), &[name, "damaged"]);
            // And without checksums, by reading with care.
            let sums = fs::read(all.join("checksums.json")).unwrap();
            fs::remove_file(all.join("checksums.json")).unwrap();
            fs::write(all.join(name), &bytes[..bytes.len() - 20]).unwrap();
            says(&mser3d(["query".as_ref(), all.as_os_str(), "human_rest".as_ref()]), &[name, "--merge"]);
            says(&verify(&[&all]), &[name, "--merge"]);
            fs::write(all.join("checksums.json"), sums).unwrap();
        }
        fs::write(all.join(name), bytes).unwrap();
    }
    // One result is cut short, one is changed, one has lost its checksums and is empty.
    let features = |shape: &str| all.join(shape).join("features.npz");
    let cut = fs::read(features("human_rest")).unwrap();
    fs::write(features("human_rest"), &cut[..cut.len() / 2]).unwrap();
    flip(&all.join("human_walk/volume.vti"), 1000);
    fs::remove_file(all.join("human_kick/checksums.json")).unwrap();
    fs::write(features("human_kick"), "").unwrap();
    says(&verify(&[&all]), &["human_rest/features.npz", "human_walk/volume.vti", "human_kick/features.npz"]);
    let output = batch(&inputs, &all, "--voxels 1500 --eigenpairs 20");
    assert!(output.status.success(), "{output:?}");
    assert!(text(&output.stdout).starts_with("3 shapes computed, 0 kept"), "{output:?}");
    for (shape, file) in
        [("human_rest", "features.npz"), ("human_walk", "volume.vti"), ("human_kick", "features.npz")]
    {
        let stderr = text(&output.stderr);
        let said = stderr
            .lines()
            .any(|line| line.contains(&format!("warning: {shape}: computed again")) && line.contains(file));
        assert!(said, "{stderr}");
    }
    assert!(verify(&[&all]).status.success());
    for (name, bytes) in contents(&all) {
        let varies = name.ends_with("regions.json") || name.ends_with("checksums.json");
        assert!(varies || whole[&name] == bytes, "{name}");
    }
    assert!(
        text(&batch(&inputs, &all, "--voxels 1500 --eigenpairs 20").stdout)
            .starts_with("0 shapes computed, 3 kept")
    );
}

#[test]
fn matches_are_whole_and_verified() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    for name in ["human_rest", "human_kick"] {
        regions(&fixtures().join(name).with_extension("off"), &path(name), SMALL);
    }
    let run = |options: &str| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        command.arg("match").args([path("human_rest"), path("human_kick")]).arg("-o").arg(path("m"));
        let output = command.args(options.split_whitespace()).output().unwrap();
        assert!(output.status.success(), "{output:?}");
    };
    run("--html");
    assert!(path("m/matches.html").is_file());
    assert_eq!(text(&verify(&[&path("m")]).stdout), "1 result and 0 tables checked: nothing is wrong\n");
    // A page of other matches goes.
    run("--rule mutual");
    let names: Vec<String> = contents(&path("m")).into_keys().collect();
    assert_eq!(names, ["checksums.json", "matches.csv", "matches.json", "matches.png"]);
    flip(&path("m/matches.csv"), 30);
    says(&verify(&[&path("m")]), &["matches.csv", "damaged"]);
    // Matches in the folder of a result leave it whole.
    let mut all = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    all.arg("match").args([path("human_kick"), path("human_rest")]).arg("-o").arg(path("human_rest"));
    assert!(all.output().unwrap().status.success());
    assert!(verify(&[&path("human_rest")]).status.success());
    regions(&fixtures().join("human_rest.off"), &path("human_rest"), SMALL);
    assert!(verify(&[&path("human_rest")]).status.success() && path("human_rest/matches.json").is_file());
}

#[test]
fn a_wrong_parameter_takes_no_good_result() {
    let root = tempfile::tempdir().unwrap();
    let all = root.path().join("all");
    let mesh = root.path().join("body.off");
    fs::copy(fixtures().join("human_rest.off"), &mesh).unwrap();
    assert!(batch(&[&mesh], &all, SMALL).status.success());
    let before = contents(&all.join("body"));
    let query = || mser3d(["query".as_ref(), all.as_os_str(), "body".as_ref(), "--include-itself".as_ref()]);
    assert!(query().status.success());
    let kept = |output: &Output, why: &str| {
        says(output, &["1 of 1 shapes failed", "its earlier result is kept", why]);
        let mut now = contents(&all.join("body"));
        let failure = now.remove("failure.json").unwrap();
        assert!(text(&failure).contains(why) && text(&failure).contains("\"kept\": true"), "{failure:?}");
        assert!(now == before);
        assert_eq!(json(&all.join("failures.json")).as_array().unwrap().len(), 1);
        // It is as good as it was.
        assert!(query().status.success());
        let output = verify(&[&all]);
        assert!(
            output.status.success() && text(&output.stderr).contains("its last run failed"),
            "{output:?}"
        );
    };
    kept(&batch(&[&mesh], &all, "--voxels 1500 --eigenpairs 900000 --quiet"), "900000 eigenpairs");
    // A file that cannot be read any more, and a disk that is full.
    let off = fs::read(&mesh).unwrap();
    fs::write(&mesh, "OFF").unwrap();
    kept(&batch(&[&mesh], &all, SMALL), "body.off");
    fs::write(&mesh, off).unwrap();
    let arguments =
        format!("batch {} -o {} --voxels 1600 --eigenpairs 20 --quiet", mesh.display(), all.display());
    kept(&on_a_full_disk(120, &arguments), "cannot be written");
    // With the right parameters again, nothing is left of it.
    let output = batch(&[&mesh], &all, "--voxels 1500 --eigenpairs 20");
    assert!(text(&output.stdout).starts_with("0 shapes computed, 1 kept, 0 failed"), "{output:?}");
    assert!(contents(&all.join("body")) == before);
    assert_eq!(json(&all.join("failures.json")), serde_json::json!([]));
    // A result of other descriptors stays, but is no row beside those that it does not compare with.
    let walk = fixtures().join("human_walk.off");
    let options = "--voxels 1500 --eigenpairs 21 --quiet";
    fs::write(&mesh, "OFF").unwrap();
    says(&batch(&[&mesh, &walk], &all, options), &["1 of 2 shapes failed", "its earlier result is kept"]);
    let mut now = contents(&all.join("body"));
    now.remove("failure.json").unwrap();
    assert!(now == before);
    let found =
        mser3d(["query".as_ref(), all.as_os_str(), "human_walk".as_ref(), "--include-itself".as_ref()]);
    assert!(found.status.success() && !text(&found.stdout).contains("body"), "{found:?}");
}

#[test]
fn the_second_run_into_a_folder_is_refused() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    let mesh = fixtures().join("human_rest.off");
    let volume = path("grey.npy");
    fs::write(&volume, npy([12; 3], |x, y, z| x + y + z > 12)).unwrap();
    let out = path("out");
    regions(&mesh, &out, SMALL);
    let before = contents(&out);
    // As another run holds it.
    let held = File::open(&out).unwrap();
    held.lock().unwrap();
    for arguments in [
        vec!["detect", mesh.to_str().unwrap()],
        vec!["msv", volume.to_str().unwrap()],
        vec!["batch", mesh.to_str().unwrap()],
        vec!["track", mesh.to_str().unwrap(), mesh.to_str().unwrap()],
    ] {
        let output = mser3d(arguments.iter().chain(&["-o", out.to_str().unwrap()]));
        assert_fails(&output, 1, &["out: another", "is writing to this"]);
        assert!(contents(&out) == before, "{arguments:?}");
    }
    // Who reads is not kept out, and who comes later neither.
    assert!(verify(&[&out]).status.success());
    drop(held);
    regions(&mesh, &out, SMALL);
}

#[test]
fn no_shape_takes_the_name_of_a_table() {
    let root = tempfile::tempdir().unwrap();
    let shapes = root.path().join("shapes");
    fs::create_dir(&shapes).unwrap();
    let names = ["regions.parquet.off", "shapes.parquet.off", "failures.json.off", "checksums.json.off"];
    for name in names {
        fs::copy(fixtures().join("human_rest.off"), shapes.join(name)).unwrap();
    }
    let all = root.path().join("all");
    for _ in 0..2 {
        let output = batch(&[&shapes], &all, SMALL);
        assert!(output.status.success(), "{output:?}");
        names.iter().for_each(|name| assert!(all.join(name).join("regions.json").is_file(), "{name}"));
    }
    assert!(verify(&[&all]).status.success());
    let query = mser3d(["query".as_ref(), all.as_os_str(), "regions.parquet.off".as_ref()]);
    assert!(query.status.success() && text(&query.stdout).contains("failures.json.off"), "{query:?}");
}

#[test]
fn a_tracked_sequence_is_verified_with_its_tables() {
    let root = tempfile::tempdir().unwrap();
    let all = root.path().join("all");
    let frames = ["human_rest.off", "human_walk.off"].map(|name| fixtures().join(name));
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("track").args(&frames).arg("-o").arg(&all).args(SMALL.split(' '));
    assert!(command.output().unwrap().status.success());
    let output = verify(&[&all]);
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    assert!(text(&output.stdout).starts_with("2 results and 6 tables"), "{output:?}");
    for name in ["tracks.json", "tracks.parquet", "tracks.csv"] {
        let bytes = fs::read(all.join(name)).unwrap();
        flip(&all.join(name), 30);
        says(&verify(&[&all]), &[name, "damaged"]);
        fs::write(all.join(name), bytes).unwrap();
    }
    // A track that leads to a region that is not there, of a file without checksums.
    fs::remove_file(all.join("checksums.json")).unwrap();
    let tracks = fs::read_to_string(all.join("tracks.json")).unwrap();
    fs::write(all.join("tracks.json"), tracks.replacen("\"region\": 0", "\"region\": 70", 1)).unwrap();
    says(&verify(&[&all]), &["tracks.json", "has no region"]);
}
