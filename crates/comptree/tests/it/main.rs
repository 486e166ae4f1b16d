//! Tests of component trees and stable regions, in one binary.
mod attributes;
mod builders;
mod common;
mod definition;
#[path = "../../examples/cells.rs"]
mod example;
mod higra;
mod msv;
mod names;
mod parts;
mod selection;
mod vlfeat;

#[test]
fn the_example_runs() {
    example::main().unwrap();
}
