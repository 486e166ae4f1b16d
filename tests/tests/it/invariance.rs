//! What does not change the result, and what stops it.

use std::ops::ControlFlow;

use mser3d::shape::Choice;
use mser3d::shape::TriangleMesh;
use mser3d::{Detector, DiscreteShape, Error, Features, Input, NO_PROGRESS, Stage, Weight, find_regions};
use mser3d_tests::{coarse, features, fixture, solid_features};

fn mapped(mesh: &TriangleMesh, map: impl Fn(f64) -> f64) -> TriangleMesh {
    mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(&map)).collect()).unwrap()
}

fn assert_close(a: &Features, b: &Features, tolerance: f64) {
    let (a, b) = (a.descriptors.values(), b.descriptors.values());
    let largest = a.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    let difference = a.iter().zip(b).fold(0.0, |m: f64, (x, y)| m.max((x - y).abs()));
    assert!(a.len() == b.len() && difference <= tolerance * largest, "{difference:e} of {largest:e}");
}

#[test]
fn the_unit_of_length_changes_the_unit_of_the_result_alone() {
    let mesh = fixture("human_rest.off");
    let parameters = coarse(4000, 40);
    let [metres, eighths] = [1.0, 8.0].map(|s| solid_features(&mapped(&mesh, |x| s * x), &parameters));
    assert!(metres.regions.len() >= 10);
    assert_eq!(metres.regions.len(), eighths.regions.len());
    for (a, b) in metres.regions.iter().zip(&eighths.regions) {
        // A power of two leaves no rounding differences: the same voxels, hence the same vertices.
        assert_eq!((&a.elements, &a.vertices, a.parent), (&b.elements, &b.vertices, b.parent));
        assert!((b.volume / a.volume / 512.0 - 1.0).abs() < 1e-12);
        // H_t is a length^-3; its windowed stability is a number.
        assert!((b.altitude / a.altitude * 512.0 - 1.0).abs() < 1e-6, "{} {}", a.altitude, b.altitude);
        let same = a.stability == b.stability || (b.stability / a.stability - 1.0).abs() < 1e-6;
        assert!(same, "{} {}", a.stability, b.stability);
        assert!((0..3).all(|i| (b.centroid[i] / 8.0 - a.centroid[i]).abs() < 1e-9));
    }
    assert_close(&metres, &eighths, 1e-6);
}

#[test]
fn any_other_factor_and_a_shift_move_at_most_voxels_whose_centre_is_on_the_surface() {
    let mesh = fixture("human_rest.off");
    let parameters = coarse(4000, 40);
    let a = solid_features(&mesh, &parameters);
    let b = solid_features(&mapped(&mesh, |x| 7.0 * x + 100.0), &parameters);
    assert!(a.shape.len().abs_diff(b.shape.len()) <= 4, "{} {}", a.shape.len(), b.shape.len());
    assert_eq!(a.regions.len(), b.regions.len());
    for (a, b) in a.regions.iter().zip(&b.regions) {
        assert!((a.volume_fraction - b.volume_fraction).abs() < 0.002);
        assert!((0..3).all(|i| ((b.centroid[i] - 100.0) / 7.0 - a.centroid[i]).abs() < 0.01));
    }
}

#[test]
fn a_spectrum_serves_several_weights() {
    let mesh = fixture("quadruped_rest.off");
    let mut parameters = coarse(4000, 40);
    let (shape, _) = DiscreteShape::volume(&mesh, &parameters.voxelize).unwrap();
    let basis = shape.spectrum(&parameters.spectrum, NO_PROGRESS).unwrap().basis;
    for &weight in Weight::ALL.iter().filter(|weight| **weight != Weight::Field) {
        parameters.weight = weight;
        parameters.stability.altitude = weight.altitude();
        let found = find_regions(&shape, &basis, &parameters, NO_PROGRESS).unwrap();
        let at_once = solid_features(&mesh, &parameters);
        assert!(found.regions.len() >= 8, "{weight:?}: {}", found.regions.len());
        // Left and right come with the descriptors.
        let described = mser3d::describe(&shape, &basis, &found.regions, &parameters).unwrap();
        let mut sided = found.regions.clone();
        for (region, (twin, side)) in
            sided.iter_mut().zip(described.sides.twins.iter().zip(described.sides.sides))
        {
            (region.twin, region.side) = (*twin, side);
        }
        assert!(sided == at_once.regions, "{weight:?}");
        assert_eq!(found.duplicates, at_once.duplicates);
        let again = features(Input::Shape(Box::new(shape.clone())), &parameters);
        assert_eq!(again.regions, at_once.regions);
        assert_eq!(again.descriptors.values(), at_once.descriptors.values());
    }
}

#[test]
fn any_stage_can_be_cancelled() {
    let mesh = fixture("human_rest.off");
    for &stage in Stage::ALL {
        let cancel = |p: mser3d::Progress| match p.stage == stage {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        };
        let mut parameters = coarse(2000, 20);
        parameters.parts = Some(mser3d::PartParameters::default());
        parameters.reliability.deformations = Some(1);
        let detector = Detector::new(parameters).with_progress(&cancel);
        let error = detector.detect(Input::Volume(&mesh)).err();
        assert_eq!(error, Some(Error::Cancelled), "{stage:?}");
    }
}

#[test]
fn sizes_beyond_the_range_of_numbers_are_an_error() {
    let mesh = fixture("human_rest.off");
    for factor in [1e-200, 1e-30, 1e30, 1e200] {
        let far = mapped(&mesh, |x| factor * x);
        for input in [Input::Volume(&far), Input::Surface(&far)] {
            let domain = input.domain();
            let error = Detector::new(coarse(1000, 20)).detect(input).err().unwrap();
            let clear = matches!(error, Error::Scale { .. } | Error::Laplace(_));
            assert!(clear, "{factor:e} {domain}: {error}");
        }
    }
}
