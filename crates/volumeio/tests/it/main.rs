//! The crate as its users see it.

mod files;
#[cfg(feature = "serde")]
mod records;
mod shared_cases;

#[path = "../../examples/mask_by_threshold.rs"]
mod mask_by_threshold;

#[test]
fn the_example_runs() {
    mask_by_threshold::main().unwrap();
}
