//! `shrec11`, killed and run again, and with files missing.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures").join(name)
}

/// Few voxels, eigenpairs and classes.
fn command(output: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(["shrec11", "--voxels", "1500", "--eigenpairs", "20", "--output"]).arg(output);
    command
}

fn synthesize(output: &Path) -> Command {
    let mut command = command(output);
    command.arg("--synthesize").arg(fixture("human_rest.off"));
    command.args(["--classes", "scaling", "noise", "--strengths", "1", "5"]);
    command.args(["--detectors", "volume-heat", "surface-edge"]);
    command.stdout(Stdio::null()).stderr(Stdio::null());
    command
}

fn succeeds(command: &mut Command) -> Output {
    let output = command.stdout(Stdio::piped()).stderr(Stdio::piped()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    output
}

fn tables(output: &Path) -> [String; 3] {
    ["regions.csv", "shapes.csv", "summary.md"].map(|name| fs::read_to_string(output.join(name)).unwrap())
}

/// Files of detections on transforms that are whole.
fn keys(output: &Path) -> usize {
    let folder = output.join("detections/volume-heat");
    let Ok(entries) = fs::read_dir(folder) else { return 0 };
    entries.filter(|e| e.as_ref().unwrap().path().extension().is_some_and(|e| e == "key")).count()
}

#[test]
fn a_killed_run_goes_on_where_it_was_and_gives_the_same_numbers() {
    let folder = tempfile::tempdir().unwrap();
    let [whole, killed] = ["whole", "killed"].map(|name| folder.path().join(name));
    succeeds(&mut synthesize(&whole));

    let mut child = synthesize(&killed).spawn().unwrap();
    while keys(&killed) == 0 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let kept = keys(&killed);
    assert!(kept > 0);
    // A file that is cut short, as by a full disk, has no key.
    fs::write(killed.join("detections/volume-heat/0001.scaling.5.regions"), "0 1 2\n").unwrap();
    let _ = fs::remove_file(killed.join("detections/volume-heat/0001.scaling.5.key"));
    let log = String::from_utf8(succeeds(&mut synthesize(&killed)).stderr).unwrap();
    assert!(log.contains(" left"), "nothing was left to do: {log}");
    assert_eq!(tables(&killed), tables(&whole));

    // A third run finds everything done; another setting is refused.
    let log = String::from_utf8(succeeds(&mut synthesize(&killed)).stderr).unwrap();
    assert!(!log.contains(" left"), "{log}");
    assert_eq!(tables(&killed), tables(&whole));
    let other = synthesize(&killed).args(["--seed", "2"]).stderr(Stdio::piped()).output().unwrap();
    assert!(!other.status.success());
    assert!(String::from_utf8_lossy(&other.stderr).contains("other settings"));

    let [regions, shapes, _] = tables(&whole);
    assert_eq!(shapes.lines().count(), 1 + 8 * 4); // seven descriptors and a surface, four shapes
    // Overlaps in voxels are known in volumes.
    assert!(
        regions
            .lines()
            .filter(|l| l.starts_with("volume-heat,"))
            .all(|l| l.split(',').all(|c| !c.is_empty()))
    );
    let page = fs::read_to_string(whole.join("index.html")).unwrap();
    for file in ["repeatability_5.svg", "matching_3.svg", "pictures/0001.noise.png", "shapes.csv"] {
        assert!(page.contains(file) && whole.join(file).exists(), "{file}");
    }
}

#[test]
fn what_is_missing_is_named_and_the_rest_and_other_detectors_are_scored() {
    let folder = tempfile::tempdir().unwrap();
    let (made, data, output) =
        (folder.path().join("made"), folder.path().join("made/benchmark"), folder.path().join("out"));
    let one = ["--detectors", "volume-heat-baseline"];
    succeeds(command(&made).arg("--synthesize").arg(fixture("human_rest.off")).args(one).args([
        "--classes",
        "noise",
        "scaling",
    ]));
    fs::remove_file(data.join("0001.noise.2.off")).unwrap();
    fs::write(data.join("corr/0001.noise.3.corr"), "1 1 0 0 1 1 0\n").unwrap();
    // Another detector's folder: one region, the whole shape, everywhere but on one shape.
    let theirs = folder.path().join("theirs");
    fs::create_dir(&theirs).unwrap();
    let vertices = fs::read_to_string(data.join("0001.null.0.off")).unwrap();
    let vertices: usize = vertices.split_ascii_whitespace().nth(1).unwrap().parse().unwrap();
    let all: Vec<String> = (0..vertices).map(|v| v.to_string()).collect();
    for name in ["0001.null.0", "0001.noise.1", "0001.noise.4", "0001.scaling.1"] {
        fs::write(theirs.join(format!("{name}.regions")), all.join(" ")).unwrap();
        fs::write(theirs.join(format!("{name}.descriptors")), "1 2 3").unwrap();
    }

    let run = succeeds(command(&output).arg("--data").arg(&data).args(one).arg("--detections").arg(&theirs));
    let log = String::from_utf8(run.stderr).unwrap();
    for named in [
        "class holes: no shapes",
        "0001.noise.2.off: not there",
        "0001.noise.3.corr:1: 7 columns",
        "0001.noise.5.regions: ",
    ] {
        assert!(log.contains(named), "{named}: {log}");
    }
    let shapes = fs::read_to_string(output.join("shapes.csv")).unwrap();
    let rows = |detector: &str| -> Vec<String> {
        shapes.lines().filter(|l| l.starts_with(&format!("{detector},"))).map(String::from).collect()
    };
    assert_eq!(rows("volume-heat-baseline").len(), 8);
    let theirs = rows("theirs");
    assert!(theirs.contains(&"theirs,1,noise,4,1,1,1,1,1,1,1,1".into()), "{theirs:?}");
    assert!(theirs.contains(&"theirs,1,noise,5,0,0,0,0,0,0,0,0".into()));
    assert_eq!(theirs.len(), 8);

    let run =
        succeeds(command(&output).arg("--data").arg(&data).args(one).args(["--classes", "noise", "view"]));
    assert!(String::from_utf8_lossy(&run.stderr).contains("class view: no shapes; there are noise, scaling"));
}
