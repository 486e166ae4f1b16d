//! The example of this crate runs.

#[path = "../../examples/components_of_a_mask.rs"]
mod example;

#[test]
fn the_example_runs() {
    example::main().unwrap();
}
