//! How surely regions are found again.
use mser3d::shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d::spectral::EigenpairRange;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Error, Features, Input, Parameters, Weight};

use crate::{club, parameters};

fn with_copies(copies: usize) -> Parameters {
    let mut parameters = parameters();
    parameters.reliability.deformations = Some(copies);
    parameters
}

fn detect(parameters: &Parameters, input: Input) -> Features {
    Detector::new(parameters.clone()).detect(input).unwrap()
}

fn reliabilities(features: &Features) -> Vec<Option<f64>> {
    features.regions.iter().map(|region| region.reliability).collect()
}

#[test]
fn the_handle_of_a_club_is_more_reliable_than_its_end_as_mesh_and_as_mask() {
    let mesh = club(1.0);
    let solid = detect(&with_copies(4), Input::Volume(&mesh));
    let mask = solid.shape.grid().unwrap().clone();
    for features in [&solid, &detect(&with_copies(4), Input::Solid(&mask))] {
        let [handle, .., end] = &features.regions[..] else { panic!("{}", features.regions.len()) };
        assert!(handle.merge.is_some() && end.merge.is_none());
        let more = handle.reliability > end.reliability && handle.reliability > Some(0.6);
        assert!(more, "{:?}", reliabilities(features));
        assert!(features.regions.iter().all(|r| r.reliability.is_some_and(|p| (0.0..=1.0).contains(&p))));
    }
    assert_eq!(
        solid.regions[solid.ranked()[0]].reliability,
        reliabilities(&solid).into_iter().max_by(|a, b| a.unwrap().total_cmp(&b.unwrap())).unwrap()
    );
}

#[test]
fn without_copies_nothing_is_measured_and_nothing_else_changes() {
    let mesh = club(1.0);
    let (without, measured) =
        (detect(&with_copies(0), Input::Volume(&mesh)), detect(&with_copies(2), Input::Volume(&mesh)));
    assert!(without.regions.iter().all(|region| region.reliability.is_none()));
    let places = |f: &Features| f.regions.iter().map(|r| (r.elements.clone(), r.parent)).collect::<Vec<_>>();
    assert_eq!(places(&without), places(&measured));
    assert_eq!(without.descriptors, measured.descriptors);
}

#[test]
fn reliability_is_the_same_for_any_number_of_threads() {
    let mesh = club(1.0);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| reliabilities(&detect(&with_copies(3), Input::Volume(&mesh))))
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn unreliable_regions_can_be_dropped() {
    let mesh = club(1.0);
    let all = detect(&with_copies(4), Input::Volume(&mesh));
    let least = reliabilities(&all).into_iter().flatten().fold(0.0, f64::max);
    let mut parameters = with_copies(4);
    parameters.reliability.min_reliability = Some(least);
    let kept = detect(&parameters, Input::Volume(&mesh));
    assert!(!kept.regions.is_empty() && kept.regions.len() < all.regions.len());
    assert!(kept.regions.iter().all(|region| region.reliability >= Some(least)));
    assert_eq!(kept.descriptors.rows().len(), kept.regions.len());
    assert!(kept.regions.iter().all(|region| region.parent.is_none_or(|p| p < kept.regions.len())));
    parameters.reliability.deformations = Some(0);
    let error = Detector::new(parameters).detect(Input::Volume(&mesh)).err().unwrap();
    assert!(
        matches!(&error, Error::InvalidParameter(_)) && error.to_string().contains("deformations"),
        "{error}"
    );
}

#[test]
fn a_surface_and_a_small_mask_are_deformed_too() {
    let mesh: TriangleMesh = club(1.0);
    let mut parameters = with_copies(2);
    parameters.spectrum.eigenpairs = EigenpairRange::AtMost(8);
    let surface = detect(&parameters, Input::Surface(&mesh));
    assert!(surface.regions.iter().all(|region| region.reliability.is_some()));
    // A bar of few voxels, which a deformation may leave without anything.
    let frame = Frame::new([12, 2, 1], [0.0; 3], [1.0; 3]).unwrap();
    let bar = VoxelGrid::solid(frame, BitGrid::full([12, 2, 1]).unwrap()).unwrap();
    assert!(Detector::new(parameters).detect(Input::Solid(&bar)).is_ok());
}

#[test]
fn copies_that_would_take_long_are_not_searched_unless_asked_for() {
    let mesh = club(1.0);
    let mut parameters = Parameters::default();
    assert_eq!(parameters.copies(&Input::Volume(&mesh)), 6);
    parameters.voxelize.pitch = Pitch::Voxels(4_000_000);
    assert_eq!(parameters.copies(&Input::Volume(&mesh)), 0);
    let stages = |parameters: &Parameters| parameters.estimate(&Input::Volume(&mesh)).stages;
    assert_eq!(stages(&parameters).reliability, 0.0);
    parameters.reliability.min_reliability = Some(0.9);
    assert_eq!(parameters.copies(&Input::Volume(&mesh)), 6, "a least reliability has to be measured");
    parameters.reliability.deformations = Some(2);
    assert_eq!(parameters.copies(&Input::Volume(&mesh)), 2);
    assert!(stages(&parameters).reliability > 5.0);
    // What a shape was made of is not known afterwards.
    let features = detect(&with_copies(2), Input::Volume(&mesh));
    assert_eq!(parameters.copies(&Input::Shape(Box::new(features.shape))), 0);
    // Nor is a field on copies, so no least reliability can be asked for.
    parameters.weight = Weight::Field;
    assert_eq!(parameters.copies(&Input::Volume(&mesh)), 0);
    let error = parameters.validate().unwrap_err().to_string();
    assert!(error.contains("min_reliability is 0.9") && error.contains("field"), "{error}");
}
