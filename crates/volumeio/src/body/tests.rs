use super::*;
use crate::{Affine, Samples, Segment, VolumeFormat};

fn loaded(channels: usize, kind: ChannelKind, samples: impl Into<Samples>) -> LoadedVolume {
    let samples = samples.into();
    let volume = Volume::new([samples.len() / channels, 1, 1], channels, Affine::default(), samples);
    LoadedVolume { channels: kind, ..LoadedVolume::plain(volume.unwrap(), VolumeFormat::Npy) }
}

fn inside(volume: &LoadedVolume, parameters: &BodyParameters) -> Result<Vec<u32>, String> {
    let body = volume.body(parameters).map_err(|e| e.to_string())?;
    Ok(body.mask.ones().map(|v| v[0]).collect())
}

fn label(label: Label) -> BodyParameters {
    BodyParameters { label: Some(label), ..Default::default() }
}

#[test]
fn zero_and_another_value_are_a_mask_and_nan_is_outside() {
    let plain = BodyParameters::default();
    for mask in [
        Samples::U8(vec![0, 255, 255, 0]),
        Samples::F32(vec![f32::NAN, -3.5, -3.5, -0.0]),
        Samples::I16(vec![0, -1, -1, 0]),
    ] {
        assert_eq!(inside(&loaded(1, ChannelKind::One, mask), &plain), Ok(vec![1, 2]));
    }
    let nan = loaded(1, ChannelKind::One, vec![f64::NAN, 1.0]).body(&plain).unwrap();
    assert!(nan.notes[0].contains("1 voxels are NaN"), "{:?}", nan.notes);
    for (empty, says) in
        [(vec![0.0, 0.0], "zero everywhere"), (vec![0.0, f64::NAN], "zero or NaN everywhere")]
    {
        let error = inside(&loaded(1, ChannelKind::One, empty), &plain).unwrap_err();
        assert!(error.contains(says), "{error}");
    }
}

#[test]
fn labels_and_grey_values_are_asked_for() {
    let plain = BodyParameters::default();
    let map = loaded(1, ChannelKind::One, vec![0u16, 0, 0, 3, 3, 7, 7, 7, 0]);
    let error = inside(&map, &plain).unwrap_err();
    assert!(error.contains("0 (4 voxels), 3 (2 voxels), 7 (3 voxels); choose one with --label"), "{error}");
    assert_eq!(inside(&map, &label(Label::Value(3))), Ok(vec![3, 4]));
    assert_eq!(inside(&map, &label(Label::Value(0))), Ok(vec![0, 1, 2, 8]));
    assert!(inside(&map, &label(Label::Value(4))).unwrap_err().contains("no label 4; there are 0 (4"));
    let grey = loaded(1, ChannelKind::One, vec![0.0, 0.25, 0.5, 0.75, f64::NAN]);
    let error = inside(&grey, &plain).unwrap_err();
    assert!(error.starts_with("grey values: 0 (1 voxels), 0.25") && error.contains("--threshold"), "{error}");
    let threshold = |t| BodyParameters { threshold: Some(t), ..Default::default() };
    assert_eq!(inside(&grey, &threshold(0.5)), Ok(vec![2, 3]));
    assert!(inside(&grey, &threshold(2.0)).unwrap_err().contains("no value is 2 or more"));
    let both = BodyParameters { threshold: Some(1.0), ..label(Label::Value(1)) };
    assert!(inside(&grey, &both).unwrap_err().contains("give one"));
    // Noisy whole numbers, as of a CT, are grey values.
    let ct =
        loaded(1, ChannelKind::One, (0..400).map(|i| (i * 7919 % 251 - 1024) as i16).collect::<Vec<_>>());
    assert!(
        inside(&ct, &plain).unwrap_err().contains("grey values: 251 different values from -1024 to -774")
    );
    assert!(ct.labels(None).unwrap_err().to_string().contains("no labels"));
    assert_eq!(
        map.labels(None).unwrap().iter().map(|l| (l.value, l.voxels)).collect::<Vec<_>>(),
        [(3, 2), (7, 3)]
    );
}

#[test]
fn several_volumes_are_asked_for() {
    let series = loaded(2, ChannelKind::Volumes, vec![0u8, 1, 1, 0, 0, 0]);
    let error = inside(&series, &BodyParameters::default()).unwrap_err();
    assert!(error.contains("2 volumes; choose one with --volume N, from 0 to 1"), "{error}");
    let volume = |v| BodyParameters { volume: Some(v), ..Default::default() };
    assert_eq!(inside(&series, &volume(0)), Ok(vec![1]));
    assert_eq!(inside(&series, &volume(1)), Ok(vec![0]));
    assert!(inside(&series, &volume(2)).unwrap_err().contains("no volume 2"));
    let grey = loaded(3, ChannelKind::Colours, vec![0u8, 0, 0, 9, 9, 9]);
    let body = grey.body(&BodyParameters::default()).unwrap();
    assert!(body.mask.get([1, 0, 0]) && body.notes[0].contains("the same grey"));
}

#[test]
fn segments_are_found_by_name_in_any_layer() {
    let segment = |value, layer, name: &str| Segment { value, layer, name: name.into() };
    let mut layers = loaded(2, ChannelKind::Layers, vec![1u8, 0, 1, 1, 2, 1]);
    layers.segments = vec![segment(1, 0, "liver"), segment(2, 0, "spleen"), segment(1, 1, "vessel")];
    let named = |name: &str| label(Label::Name(name.into()));
    assert_eq!(inside(&layers, &named("vessel")), Ok(vec![1, 2]));
    assert_eq!(inside(&layers, &named("liver")), Ok(vec![0, 1]));
    assert_eq!(inside(&layers, &label(Label::Value(2))), Ok(vec![2]));
    assert!(inside(&layers, &label(Label::Value(1))).unwrap_err().contains("several layers"));
    assert!(inside(&layers, &named("kidney")).unwrap_err().contains("1 is liver"));
    let all = layers.labels(None).unwrap();
    assert_eq!(
        all.iter().filter_map(|l| l.name.as_deref()).collect::<Vec<_>>(),
        ["liver", "spleen", "vessel"]
    );
}

#[test]
fn a_body_around_the_border_is_suspect() {
    let mut values = vec![1u8; 125];
    values[62] = 0;
    let volume = Volume::new([5; 3], 1, Affine::default(), values).unwrap();
    let loaded = LoadedVolume::plain(volume, VolumeFormat::Npy);
    assert!(
        loaded.body(&BodyParameters::default()).unwrap().notes[0].contains("100 % of the volume's border")
    );
    assert!(loaded.body(&label(Label::Value(0))).unwrap().notes.is_empty());
}
