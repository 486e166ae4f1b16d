//! Facts about operators, and how the crate is used.

mod heat_flow;
mod mean_curvature;
mod operators;

#[path = "../../examples/cooling.rs"]
mod cooling;

#[test]
fn the_example_runs() {
    cooling::main().unwrap();
}
