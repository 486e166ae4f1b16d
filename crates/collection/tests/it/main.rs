//! The example of this crate runs, on two poses of the repository's figure.

#[path = "../../examples/batch_and_match.rs"]
#[allow(dead_code)]
mod example;

use std::path::Path;

#[test]
fn the_example_runs() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures");
    if !fixtures.is_dir() {
        eprintln!("skipped: the shapes in fixtures/ are part of the repository, not of the package");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let shapes = folder.path().join("shapes");
    std::fs::create_dir(&shapes).unwrap();
    for pose in ["human_rest.off", "human_walk.off"] {
        std::fs::copy(fixtures.join(pose), shapes.join(pose)).unwrap();
    }
    let matched = example::batch_and_match(&shapes, &folder.path().join("results")).unwrap();
    assert!(matched >= 8, "{matched} regions matched");
}
