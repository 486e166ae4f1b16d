//! Tests of weights, signatures and matches, in one binary.
mod chirality;
mod common;
mod dense_map;
#[path = "../../examples/rod.rs"]
mod example;
mod heat;
mod json;
mod matching;
mod precision;
mod signatures;

#[test]
fn the_example_runs() {
    example::main().unwrap();
}
