//! Spectra as facts of the field, and how the crate is used.

mod choice;
mod counts;
mod figures;
mod multigrid;
mod odd;
mod semidefinite;
mod spectra;
mod stored;

#[path = "../../examples/drum.rs"]
mod drum;

#[test]
fn the_example_runs() {
    drum::main().unwrap();
}
