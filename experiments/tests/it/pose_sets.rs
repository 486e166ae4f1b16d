//! `poses` and `peers` on sets of the fixtures, and on what is no set.

use std::fs;
use std::process::{Command, Output};

fn experiments(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_experiments"));
    command.args(arguments).args(["--voxels", "1500"]);
    command
}

fn succeeds(command: &mut Command) -> String {
    let Output { status, stdout, stderr } = command.output().unwrap();
    assert!(status.success(), "{}", String::from_utf8_lossy(&stderr));
    String::from_utf8(stdout).unwrap()
}

/// The numbers at the end of the line that begins with this.
fn numbers(text: &str, start: &str) -> Vec<f64> {
    let line = text.lines().find_map(|line| line.strip_prefix(start)).unwrap();
    line.split_whitespace().map(|word| word.parse().unwrap()).collect()
}

#[test]
fn poses_gives_a_row_to_each_detector_and_set_and_their_means() {
    let text = succeeds(experiments(&["poses", "quadruped", "human"]).args(["--eigenpairs", "20"]));
    assert_eq!(text.lines().count(), 1 + 2 * 4 + 4);
    let row = |set: &str| numbers(&text, &format!("{:13} {set:20}", "default"));
    let (quadruped, human, mean) = (row("quadruped"), row("human"), row("mean of the sets"));
    assert_eq!(mean.len(), 5);
    assert!((mean[0] - 0.5 * (quadruped[0] + human[0])).abs() < 0.11, "{text}");
    for i in 1..5 {
        assert!((0.3..=1.0).contains(&mean[i]), "{text}");
        assert!((mean[i] - 0.5 * (quadruped[i] + human[i])).abs() < 0.0011, "{text}");
    }
    assert!(mean[1] >= mean[2] && mean[2] >= mean[3] && mean[2] >= mean[4], "{text}");
}

#[test]
fn an_unknown_set_is_an_error_that_names_the_known_ones() {
    let output = experiments(&["poses", "centaur"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success());
    assert!(text.starts_with("error: centaur: neither one of human, quadruped, "), "{text}");
}

#[test]
fn peers_that_are_not_here_are_named_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    let mut command = experiments(&["peers", "quadruped"]);
    command.arg("--python").arg(folder.path().join("no-python")).arg("--output").arg(&out);
    // No compiler.
    command.env("PATH", folder.path()).env("CARGO_TARGET_DIR", folder.path());
    let text = succeeds(&mut command);
    assert!(text.contains("* no ToMATo (to get it: pip install numpy gudhi"), "{text}");
    assert!(text.contains("* no shape diameter (to get it: apt-get install g++ libcgal-dev)"), "{text}");
    let table = fs::read_to_string(out.join("peers.csv")).unwrap();
    let mut detectors: Vec<&str> = table.lines().skip(1).filter_map(|line| line.split(',').nth(2)).collect();
    detectors.dedup();
    assert_eq!(detectors, ["ours", "paper", "baseline"]);
    for line in table.lines().skip(1) {
        let row: Vec<f64> = line.split(',').filter_map(|word| word.parse().ok()).collect();
        let [wanted, parts, middle, high, failed] = row[..] else { panic!("{line}") };
        assert!(parts > 0.0 && parts <= wanted && high <= middle && middle <= 1.0 && failed == 0.0, "{line}");
    }
    assert!(
        fs::read_to_string(out.join("peers.md"))
            .unwrap()
            .contains("| set | parts | ours | paper | baseline |")
    );
}

#[test]
fn tables_of_some_sets_do_not_replace_those_of_all() {
    let output = experiments(&["selection", "quadruped"]).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && text.contains("name another folder with --output"), "{text}");
}
