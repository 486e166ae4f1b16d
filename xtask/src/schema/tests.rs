use mser3d::shape::{BitGrid, Frame, VoxelGrid};
use mser3d::voxelize::Pitch;
use mser3d::{Descriptor, DescriptorKind, Detector, Input, Parameters, Weight};
use mser3d_results::msv::{MsvResults, MsvSearchParameters};
use mser3d_results::{Identity, Results, ShapeFile, Sighting, Track, TrackParameters, TrackedFrame};
use mser3d_volumeio::{Affine, Volume};
use serde_json::json;

use super::*;

#[test]
fn the_files_are_what_would_be_written() {
    for (name, text) in files().unwrap() {
        let kept = std::fs::read_to_string(docs().join(name)).unwrap_or_default();
        assert!(kept == text, "docs/{name} is not what the record is; run cargo xtask schema");
    }
}

/// Few voxels and eigenpairs.
fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(1500);
    parameters.spectrum.eigenpairs = 20.into();
    parameters
}

#[test]
fn records_conform() {
    let schema = schema::<Record>("regions.json").to_value();
    let human = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/human_rest.off");
    let file = ShapeFile::read(&human, &Default::default()).unwrap();
    let detector = Detector::new(parameters());
    let features = detector.detect(file.input(mser3d::Domain::Volume).unwrap()).unwrap();
    let of_file = Results::of_file(&features, &file).unwrap().record;
    assert!(!of_file.regions.is_empty() && of_file.voxelization.is_some());

    // A solid without a mesh, with other choices.
    let dims = [30, 8, 8];
    let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let mut mallet = BitGrid::full(dims).unwrap();
    for voxel in BitGrid::full(dims).unwrap().ones() {
        mallet.set(voxel, voxel[0] < 12 || voxel[1] < 3);
    }
    let grid = VoxelGrid::solid(frame, mallet).unwrap();
    let descriptor: Descriptor = DescriptorKind::Hks.into();
    let detector = Detector::new(Parameters { weight: Weight::Commute, descriptor, ..parameters() });
    let features = detector.detect(Input::Solid(&grid)).unwrap();
    let mut of_mask = Results::new(&features, None, "mallet").unwrap().record;
    let infinite = of_file.regions[0].clone();
    of_mask.regions.extend([f64::INFINITY, f64::NAN].map(|stability| {
        let mut region = infinite.clone();
        region.stability = stability;
        region
    }));
    for record in [of_file, of_mask] {
        let record = serde_json::from_str(&record.to_json().unwrap()).unwrap();
        assert_eq!(problems(&schema, &schema, &record, "record"), [""; 0]);
    }
}

#[test]
fn msv_records_conform() {
    let schema = schema::<MsvRecord>("msv.json").to_value();
    let bright =
        |v: usize| if [v % 12, v / 12 % 12, v / 144].iter().all(|&a| (3..8).contains(&a)) { 200 } else { 10 };
    let samples: Vec<u8> = (0..12 * 12 * 12).map(bright).collect();
    let volume = Volume::new([12; 3], 1, Affine::default(), samples).unwrap();
    let found = MsvResults::find(&volume, "cube.nrrd", &MsvSearchParameters::default()).unwrap().record;
    assert!(found.searches.iter().any(|search| !search.regions.is_empty()));
    let record = serde_json::to_value(&found).unwrap();
    assert_eq!(problems(&schema, &schema, &record, "record"), [""; 0]);
}

#[test]
fn track_records_conform() {
    let schema = schema::<TracksRecord>("tracks.json").to_value();
    let frame = |time, regions, identity| TrackedFrame {
        name: "fox_0".into(),
        path: "fox.glb".into(),
        time,
        regions,
        identity,
    };
    let sighting = |frame, overlap, likeness| Sighting {
        frame,
        region: 3,
        overlap,
        likeness,
        reliability: overlap,
        volume: 2.0,
        volume_fraction: 0.25,
        centroid: [0.0, -1.5, 1e9],
    };
    let track = Track {
        id: 0,
        colour: [0, 120, 255],
        colour_of: 0,
        first_frame: 0,
        last_frame: 3,
        found: 3,
        mean_overlap: Some(0.75),
        reliability: None,
        sightings: vec![
            sighting(0, None, None),
            sighting(1, Some(0.75), None),
            sighting(3, None, Some(f64::NAN)),
        ],
    };
    let frames = vec![
        frame(Some(0.0), Some(1), None),
        frame(Some(0.5), Some(1), Some(Identity::Vertices)),
        frame(None, None, None),
        frame(None, Some(1), Some(Identity::Descriptors)),
    ];
    let mut tracks = TracksRecord::new(TrackParameters::default(), frames, vec![track]);
    tracks.warnings.push("1 frame has no result".into());
    let record = serde_json::to_value(&tracks).unwrap();
    assert_eq!(problems(&schema, &schema, &record, "record"), [""; 0]);
    // And what another program might write is told.
    let mut wrong = record.clone();
    wrong["tracks"][0]["colour"] = json!([0, 120]);
    wrong["frames"][1]["identity"] = json!("names");
    wrong["tracks"][0]["sightings"][1].as_object_mut().unwrap().remove("region");
    let told = problems(&schema, &schema, &wrong, "record").join("; ");
    for problem in ["record.tracks[0].colour", "record.frames[1].identity", "sightings[1] has no \"region\""]
    {
        assert!(told.contains(problem), "{told}");
    }
}

/// Where a value does not conform to a schema: the part of JSON Schema that our schemas use.
fn problems(root: &Value, schema: &Value, value: &Value, place: &str) -> Vec<String> {
    let Some(keywords) = schema.as_object() else {
        return if schema == &json!(false) { vec![format!("{place} must not be there")] } else { Vec::new() };
    };
    let all = |schemas: &Value| -> Vec<Vec<String>> {
        schemas.as_array().unwrap().iter().map(|s| problems(root, s, value, place)).collect()
    };
    let mut found = Vec::new();
    for (keyword, says) in keywords {
        match keyword.as_str() {
            "$ref" => {
                let target = root.pointer(says.as_str().unwrap().strip_prefix('#').unwrap()).unwrap();
                found.extend(problems(root, target, value, place));
            }
            "anyOf" | "oneOf" => {
                let each = all(says);
                if each.iter().all(|problems| !problems.is_empty()) {
                    found.push(format!("{place} is none of: {}", each.concat().join("; ")));
                }
            }
            "allOf" => found.extend(all(says).concat()),
            "type" => {
                let known = says.as_array().cloned().unwrap_or_else(|| vec![says.clone()]);
                if !known.iter().any(|name| is_a(value, name.as_str().unwrap())) {
                    found.push(format!("{place} is {value}, not {says}"));
                }
            }
            "enum" if !says.as_array().unwrap().contains(value) => found.push(format!("{place} is {value}")),
            "const" if says != value => found.push(format!("{place} is {value}, not {says}")),
            "minimum" if value.as_f64().is_some_and(|x| x < says.as_f64().unwrap()) => {
                found.push(format!("{place} is {value} < {says}"))
            }
            "minItems" | "maxItems" => {
                let (count, bound) = (value.as_array().map(|a| a.len() as u64), says.as_u64().unwrap());
                let right = |n: u64| if keyword == "minItems" { n >= bound } else { n <= bound };
                if !count.is_none_or(right) {
                    found.push(format!("{place} is {value}, but {keyword} is {bound}"));
                }
            }
            "items" => {
                for (i, item) in value.as_array().into_iter().flatten().enumerate() {
                    found.extend(problems(root, says, item, &format!("{place}[{i}]")));
                }
            }
            "required" => {
                let missing =
                    says.as_array().unwrap().iter().filter(|k| value.get(k.as_str().unwrap()).is_none());
                found.extend(missing.map(|key| format!("{place} has no {key}")));
            }
            "properties" => {
                for (key, schema) in says.as_object().unwrap() {
                    let own = value.get(key).map(|v| problems(root, schema, v, &format!("{place}.{key}")));
                    found.extend(own.into_iter().flatten());
                }
            }
            "additionalProperties" => {
                let known = |key: &String| keywords["properties"].get(key).is_some();
                for (key, own) in value.as_object().into_iter().flatten().filter(|(key, _)| !known(key)) {
                    found.extend(problems(root, says, own, &format!("{place}.{key}")));
                }
            }
            // What says nothing about a value, or was looked at with another keyword.
            "$defs" | "$schema" | "title" | "description" | "format" | "default" | "enum" | "const"
            | "minimum" | "maximum" => {}
            other => found.push(format!("{place}: this test does not know the keyword {other}")),
        }
    }
    found
}

fn is_a(value: &Value, name: &str) -> bool {
    match name {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "integer" => value.is_i64() || value.is_u64(),
        "number" => value.is_number(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        _ => value.is_object(),
    }
}

#[test]
fn what_does_not_conform_is_told() {
    let schema = json!({
        "type": "object", "required": ["id", "centre"],
        "properties": {"id": {"type": "integer", "minimum": 0}, "rule": {"enum": ["a", "b"]}},
    });
    let told = |value: Value| problems(&schema, &schema, &value, "region").join("; ");
    assert_eq!(told(json!({"id": 1, "centre": 2, "rule": "b"})), "");
    assert_eq!(told(json!({"id": 0.5, "rule": "a", "centre": 0})), "region.id is 0.5, not \"integer\"");
    assert_eq!(told(json!({"id": 1, "rule": "c"})), "region.rule is \"c\"; region has no \"centre\"");
}

#[test]
fn descriptions_are_plain() {
    let text = "As [`crate::Region::stability`] or\n[`x`](y::x) has it.\n\nNone: `[0, 1]`.";
    assert_eq!(plain(text), "As `stability` or `x` has it.\n\nNone: `[0, 1]`.");
}
