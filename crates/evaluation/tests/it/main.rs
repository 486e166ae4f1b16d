//! The benchmark's files, its transforms, and the example.

mod files;
mod transforms;

#[path = "../../examples/score_detector.rs"]
mod example;

#[test]
fn the_example_runs() {
    example::main().unwrap();
}
