//! mser3d at the command line.
fn main() {}
