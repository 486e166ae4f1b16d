//! The crate as its users see it.

mod common;
mod good_files;

mod bad_files;
mod cases;
mod cells;
mod gltf;
mod limits;
mod mutations;
mod real_files;
mod round_trips;

#[path = "../../examples/mesh_to_paraview.rs"]
mod mesh_to_paraview;

#[test]
fn the_example_runs() {
    mesh_to_paraview::main().unwrap();
}
