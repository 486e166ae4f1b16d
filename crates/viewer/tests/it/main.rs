//! Tests of pictures and pages, in one binary.
#[path = "../../examples/torus.rs"]
mod example;
mod page;
mod pictures;

use mser3d_viewer::shape::Choice;
use mser3d_viewer::{NamedView, Up, View};

#[test]
fn the_example_runs() {
    example::main().unwrap();
}

#[test]
fn views_and_axes_have_names() {
    let names: Vec<&str> = NamedView::ALL.iter().map(|view| view.name()).collect();
    assert_eq!(names, ["front", "three-quarter", "side", "back", "top"]);
    assert_eq!("top".parse::<NamedView>().map(View::from), Ok(View::TOP));
    assert_eq!("z".parse(), Ok(Up::Z));
}
