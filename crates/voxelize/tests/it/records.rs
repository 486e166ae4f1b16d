//! Parameters and reports survive JSON, under the names that they have in Rust.
#![cfg(feature = "serde")]

use crate::common::*;
use mser3d_shape::Frame;
use mser3d_voxelize::*;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::{from_str, json, to_string, to_value};

fn survives<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(value: &T) {
    assert_eq!(&from_str::<T>(&to_string(value).unwrap()).unwrap(), value);
}

#[test]
fn parameters_and_pitches() {
    for (pitch, stands_as) in [
        (Pitch::Voxels(45_000), json!({"voxels": 45_000})),
        (Pitch::Resolution(128), json!({"resolution": 128})),
        (Pitch::Size(0.1), json!({"size": 0.1})),
        (Pitch::Spacing([0.1, 0.2, 0.3]), json!({"spacing": [0.1, 0.2, 0.3]})),
    ] {
        assert_eq!(to_value(pitch).unwrap(), stands_as);
        let morphology = Some(Morphology::Close);
        let frame = Frame::new([4, 5, 6], [0.1; 3], [0.3; 3]).unwrap();
        let (origin, frame) = (Some([0.5; 3]), Some(frame));
        survives(&VoxelizeParameters { pitch, morphology, origin, frame, ..Default::default() });
    }
    let written = to_value(VoxelizeParameters::default()).unwrap();
    let expected = json!({
        "pitch": {"voxels": 45_000},
        "inside": "auto",
        "overlap": "auto",
        "cut_links": true,
        "connectivity": "6",
        "origin": null,
        "frame": null,
        "morphology": null,
        "largest_only": true,
    });
    assert_eq!(written, expected);
}

#[test]
fn diagnoses_and_reasons() {
    let ball = sphere([0.0; 3], 1.0, 3);
    let holed = altered(&ball, |i, t| (i > 3).then_some(t));
    let turned = altered(&ball, |i, [a, b, c]| Some(if i < 3 { [a, c, b] } else { [a, b, c] }));
    for mesh in [&ball, &holed, &turned] {
        let diagnosis = diagnose(mesh);
        survives(&diagnosis);
        survives(&diagnosis.reason);
        let solid = voxelize(mesh, &VoxelizeParameters::default()).unwrap();
        survives(&solid.warnings);
        survives(&solid.topology);
    }
    let json = to_value(diagnose(&turned)).unwrap();
    assert_eq!(json["reason"], json!({"closed-after-turning": {"turned": 3}}));
    assert_eq!((&json["inside"], &json["cavities"]), (&json!("winding"), &json!(0)));
    assert_eq!(to_value(Reason::Closed).unwrap(), json!("closed"));
}

#[cfg(feature = "schema")]
#[test]
fn the_schema_names_the_choices() {
    let schema = schemars::schema_for!(VoxelizeParameters).to_value();
    assert_eq!(schema["$defs"]["InsideTest"]["enum"], json!(["auto", "parity", "vote", "winding"]));
    assert!(schema["properties"]["frame"].is_object());
}
