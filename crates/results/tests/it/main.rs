//! Folders give back what was written, and the example runs.

mod damage;
#[path = "../../examples/mesh_to_page.rs"]
#[allow(dead_code)]
mod example;
mod fine_surface;
mod folder;
mod front;
mod pages;

#[test]
fn the_example_runs() {
    example::main().unwrap();
}
