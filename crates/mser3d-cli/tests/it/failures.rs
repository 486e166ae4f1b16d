//! Wrong use, bad input, and places that cannot be written to.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::common::*;

/// Every file of `fixtures/bad` fails with what `MESSAGES` says of it, and leaves nothing behind.
#[test]
fn bad_files_fail_with_their_message_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let bad = fixtures().join("bad");
    let messages = fs::read_to_string(bad.join("MESSAGES")).unwrap();
    let mut files = 0;
    for line in messages.lines() {
        let name = line.split(':').next().unwrap();
        let out = folder.path().join("a/b");
        // Of an unknown ending the program says volumes too.
        let end = if line.contains("unknown file extension") { "; of volumes " } else { "\n" };
        let expected = format!("mser3d: {line}{end}");
        // Three dots stand for what the operating system says.
        let expected: Vec<&str> = expected.split("...").collect();
        for arguments in [vec!["detect", name, "-o", out.to_str().unwrap()], vec!["inspect", name]] {
            // In the folder of the files, so that messages name them as `MESSAGES` does.
            let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
            let output = command.args(arguments).current_dir(&bad).output().unwrap();
            assert_fails(&output, 1, &expected);
        }
        files += 1;
    }
    assert!(files > 80);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn solids_that_are_none_fail() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, contents: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, contents).unwrap();
        path
    };
    let unit = box_off([0.0; 3], [1.0; 3]);
    let out = folder.path().join("out");
    for (path, options, words) in [
        (write("one.off", b"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "", &["no volume", "--surface"][..]),
        (write("flat.off", box_off([0.0; 3], [1.0, 1.0, 0.0]).as_bytes()), "", &["no volume"]),
        (
            write("thin.off", box_off([0.0; 3], [100.0, 100.0, 0.001]).as_bytes()),
            "",
            &["thinner than a voxel"],
        ),
        (write("far.off", box_off([1e18; 3], [1e18 + 1024.0; 3]).as_bytes()), "", &["precision"]),
        (write("huge.off", box_off([0.0; 3], [1e30; 3]).as_bytes()), "", &["scale it"]),
        (write("tiny.off", box_off([0.0; 3], [1e-200; 3]).as_bytes()), "", &["scale it"]),
        (write("box.off", unit.as_bytes()), "--eigenpairs 10000000", &["10000000 eigenpairs", "only"]),
        (write("box2.off", unit.as_bytes()), "--eigenpairs 40000", &["eigenpairs", "MB", "limit"]),
        (write("box3.off", unit.as_bytes()), "--memory-limit 1", &["more than the limit of 1 MB"]),
        (write("box4.off", unit.as_bytes()), "--pitch 1e-9", &["use a pitch of at least"]),
        (write("box5.off", unit.as_bytes()), "--animation walk", &["no animation \"walk\""]),
        (write("none.npy", &npy([4, 4, 4], |_, _, _| false)), "", &["zero everywhere"]),
        (
            write("few.npy", &npy([4, 4, 4], |_, _, _| true)),
            "--eigenpairs 100",
            &["100 eigenpairs", "only 64"],
        ),
    ] {
        let name = path.display().to_string();
        let limit = if options.contains("40000") { " --memory-limit 1000" } else { "" };
        let output = detect(&path, &out, &format!("{options}{limit}"));
        assert_fails(&output, 1, &[words, &[&name]].concat());
        assert!(!out.exists(), "{name}");
    }
}

#[test]
fn a_small_shape_has_fewer_eigenpairs_than_is_usual() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::write(path("few.npy"), npy([9, 3, 3], |_, _, _| true)).unwrap();
    // A brick has no parts: the rule that looks for none finds regions in it all the same.
    let output = detect(&path("few.npy"), &path("few"), "--stability-rule baseline");
    assert!(output.status.success());
    assert!(text(&output.stderr).contains("only 81 eigenpairs in so small a shape"), "{output:?}");
    let report = json(&path("few/regions.json"));
    assert_eq!(
        (&report["spectrum"]["eigenpairs"], &report["warnings"].as_array().unwrap().len()),
        (&81.into(), &1)
    );
    // What was said compares with it is not refused.
    fs::write(path("more.npy"), npy([20, 4, 4], |_, _, _| true)).unwrap();
    let matches = |options: &str| {
        let options = format!("{options} --stability-rule baseline");
        assert!(detect(&path("more.npy"), &path("more"), &options).status.success());
        mser3d(["match".as_ref(), path("few").as_os_str(), path("more").as_os_str()])
    };
    assert_fails(&matches(""), 1, &["--eigenpairs 81 against 100"]);
    assert!(matches("--eigenpairs 81").status.success());
}

#[test]
fn a_bound_of_the_eigenvalues_serves_shapes_of_any_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let found: Vec<_> = [("small", [12, 8, 8]), ("large", [30, 20, 20])]
        .map(|(name, size)| {
            let input = path(&format!("{name}.npy"));
            fs::write(&input, npy(size, |_, _, _| true)).unwrap();
            let output = detect(&input, &path(name), "--lambda-max 90 --stability-rule baseline");
            assert!(output.status.success(), "{output:?}");
            let report = json(&path(name).join("regions.json"));
            assert_eq!(report["parameters"]["spectrum"]["eigenpairs"]["lambda_max"], 90.0);
            report["spectrum"]["eigenpairs"].as_u64().unwrap()
        })
        .into();
    // A box of a by b by b has pi^2 (i^2 / a^2 + (j^2 + k^2) / b^2), whatever its size.
    let side = (1.5f64).cbrt();
    let box_of = |i: u32, j: u32, k: u32| {
        let (i, rest) = (f64::from(i) / 1.5, f64::from(j * j + k * k));
        std::f64::consts::PI.powi(2) * (i * i + rest) * side * side
    };
    let numbers = (0..9).flat_map(|i| (0..9).flat_map(move |j| (0..9).map(move |k| (i, j, k))));
    let expected = numbers.filter(|&(i, j, k)| box_of(i, j, k) < 90.0).count();
    assert!(found.iter().all(|&count| count.abs_diff(expected as u64) <= 2), "{found:?} {expected}");
    let output = mser3d(["match".as_ref(), path("small").as_os_str(), path("large").as_os_str()]);
    assert!(output.status.success(), "{output:?}");
}

#[test]
fn wrong_use_exits_with_2_and_names_the_option() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mesh = fixtures().join("human_rest.off");
    for (options, words) in [
        ("--voxels 0", &["--voxels", "at least 1"][..]),
        ("--voxels 10 --pitch 1", &["--voxels", "--pitch"]),
        ("--pitch -1", &["--pitch", "positive"]),
        ("--pitch nan", &["--pitch", "positive"]),
        ("--eigenpairs 0", &["--eigenpairs", "at least 1"]),
        ("--eigenpairs ten", &["--eigenpairs", "whole number"]),
        ("--eigenpairs 9 --lambda-max 9", &["--eigenpairs", "--lambda-max"]),
        ("--lambda-max 0", &["lambda_max is 0", "above 0"]),
        ("--tolerance 0", &["tolerance", "above 0"]),
        ("--time-scale 0.5,-1", &["--time-scale", "positive"]),
        ("--time-scale 1 --absolute-time 1", &["--time-scale", "--absolute-time"]),
        ("--window 0", &["--window", "positive"]),
        ("--min-lifetime -1", &["--min-lifetime", "0 or more"]),
        ("--reliability 0 --min-reliability 0.5", &["reliability.deformations", "at least 1"]),
        ("--min-volume 2", &["--min-volume", "between 0 and 1"]),
        ("--min-volume 0.5 --max-volume 0.4", &["volume"]),
        ("--min-diversity -0.1", &["--min-diversity", "between 0 and 1"]),
        ("--duplicate-overlap 2", &["--duplicate-overlap"]),
        ("--reference-measure 0", &["--reference-measure"]),
        ("--weight heavy", &["--weight", "commute"]),
        ("--connectivity 18", &["--connectivity", "26"]),
        ("--threads 0", &["--threads"]),
        ("--surface --voxels 1000", &["--surface", "--voxels"]),
        ("--surface --no-cut-links", &["--surface", "--no-cut-links"]),
        ("--time 1", &["--time", "animation"]),
        ("--time -1", &["time", "-1"]),
        ("--no-such-option", &["--no-such-option"]),
    ] {
        let output = detect(&mesh, &out, options);
        assert_fails(&output, 2, words);
        assert!(!out.exists(), "{options}");
    }
    let mask = folder.path().join("mask.npy");
    fs::write(&mask, npy([20, 6, 6], |_, _, _| true)).unwrap();
    for options in ["--surface", "--voxels 100", "--resolution 9", "--overlap join", "--animation walk"] {
        let option = options.split(' ').next().unwrap();
        assert_fails(&detect(&mask, &out, options), 2, &[option]);
    }
    assert_fails(&mser3d(["detect"]), 2, &["INPUT"]);
    assert_eq!(mser3d([] as [&str; 0]).status.code(), Some(2));
}

#[test]
fn a_folder_that_cannot_be_written_to_is_found_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "mine").unwrap();
    let mesh = fixtures().join("human_rest.off");
    for out in [file.clone(), file.join("below")] {
        let name = out.display().to_string();
        assert_fails(&detect(&mesh, &out, ""), 1, &[&name, "-o"]);
    }
    assert_eq!(fs::read(&file).unwrap(), b"mine");
    assert_fails(&detect(&folder.path().join("none.off"), &folder.path().join("x"), ""), 1, &["none.off"]);
    assert_fails(&detect(folder.path(), &folder.path().join("x"), ""), 1, &["cannot be read"]);
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

#[test]
fn a_failed_run_leaves_an_older_result_whole() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mesh = fixtures().join("human_rest.off");
    regions(&mesh, &out, "--voxels 1000 --eigenpairs 20 --quiet");
    let before = contents(&out);
    assert_eq!(detect(&mesh, &out, "--voxels 1000 --eigenpairs 5000").status.code(), Some(1));
    assert_eq!(contents(&out), before);
    // A surface has no voxels: the old volume.vti would not belong to it.
    regions(&mesh, &out, "--surface --eigenpairs 20 --quiet");
    let after: Vec<String> = contents(&out).into_iter().map(|(name, _)| name).collect();
    assert_eq!(after, ["checksums.json", "features.npz", "regions.json", "surface.ply"]);
}

fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| {
        let entry = entry.unwrap();
        (entry.file_name().into_string().unwrap(), fs::read(entry.path()).unwrap())
    });
    let mut all: Vec<_> = entries.collect();
    all.sort();
    all
}

#[test]
fn a_closed_pipe_is_no_error() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = fixtures().join("human_rest.off");
    for json in [&[][..], &["--json"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        command.arg("detect").arg(&mesh).arg("-o").arg(folder.path());
        command.args(["--voxels", "4000", "--eigenpairs", "40"]).args(json);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && !text(&output.stderr).contains("standard output"), "{output:?}");
        assert!(folder.path().join("regions.json").exists());
    }
}
