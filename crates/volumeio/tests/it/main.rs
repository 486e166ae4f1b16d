//! The crate as its users see it.

mod files;
mod good_files;
mod limits;
#[cfg(feature = "serde")]
mod records;
mod shared_cases;

#[path = "../../examples/convert.rs"]
mod convert;
#[path = "../../examples/mask_by_threshold.rs"]
mod mask_by_threshold;

#[test]
fn the_examples_run() {
    mask_by_threshold::main().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    std::fs::write(
        at("a.mha"),
        "NDims = 2\nDimSize = 2 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n\u{1}\u{2}",
    )
    .unwrap();
    let said = convert::convert(&at("a.mha"), &at("a.npy")).unwrap();
    assert_eq!((&said["dims"], &said["type"]), (&serde_json::json!([2, 1, 1]), &serde_json::json!("u8")));
    assert_eq!(convert::convert(&at("a.npy"), &at("a.nii.gz")).unwrap()["kind"], "one");
}
