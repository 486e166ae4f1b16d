//! The crate as its users see it.

mod common;

mod damage;
mod exact;
mod hierarchy;
mod links;
mod masks;
mod real;
mod records;
mod soup;
mod symmetry;

#[path = "../../examples/mask_of_a_mesh.rs"]
mod mask_of_a_mesh;

#[test]
fn the_example_runs() {
    mask_of_a_mesh::main().unwrap();
}
