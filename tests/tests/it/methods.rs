//! The other ways through the pipeline: surfaces, weights, neighbourhoods, stability rules.

use std::collections::HashSet;

use mser3d::comptree::StabilityRule;
use mser3d::shape::{Choice, Connectivity};
use mser3d::{Features, Input, Weight};
use mser3d_tests::{coarse, features, fixture, solid_features};

/// Regions come by size, are nested or disjoint within a tree, and name as parent the smallest region
/// that contains them.
fn assert_consistent(features: &Features) {
    let sets: Vec<HashSet<u32>> =
        features.regions.iter().map(|r| r.elements.iter().copied().collect()).collect();
    for (i, region) in features.regions.iter().enumerate() {
        assert!(region.elements.is_sorted() && sets[i].len() == region.elements.len());
        assert!(region.volume_fraction > 0.0 && region.volume_fraction < 1.0);
        for j in 0..i {
            assert!(features.regions[j].volume >= region.volume);
            if features.regions[j].tree == region.tree {
                assert!(sets[i].is_subset(&sets[j]) || sets[i].is_disjoint(&sets[j]), "{j} and {i}");
            }
        }
        let parent = (0..sets.len()).rev().find(|&j| j < i && sets[i].is_subset(&sets[j]));
        assert_eq!(region.parent, parent, "of {i}");
        let map = features.shape.element_of_vertex();
        let expected: Vec<u32> = (0..map.len() as u32)
            .filter(|&v| map[v as usize].is_some_and(|e| sets[i].contains(&e)))
            .collect();
        assert_eq!(region.vertices, expected);
    }
}

/// The farthest any region's centroid is from the axis of a figure, left and right.
fn reach(features: &Features) -> [f64; 2] {
    let x = features.regions.iter().map(|r| r.centroid[0]);
    x.fold([0.0; 2], |[right, left], x| [right.min(x), left.max(x)])
}

#[test]
fn every_weight_finds_both_arms_in_the_volume_and_on_the_surface() {
    let mesh = fixture("human_rest.off");
    let mut parameters = coarse(4000, 60);
    // A field is whatever it is.
    for &weight in Weight::ALL.iter().filter(|weight| **weight != Weight::Field) {
        parameters.weight = weight;
        parameters.stability.altitude = weight.altitude();
        for input in [Input::Volume(&mesh), Input::Surface(&mesh)] {
            let domain = input.domain();
            let features = features(input, &parameters);
            assert_consistent(&features);
            let trees = if weight.has_time_scale() { parameters.time_scales.len() } else { 1 };
            assert_eq!(features.trees.len(), trees);
            let [right, left] = reach(&features);
            assert!(features.regions.len() >= 7, "{weight:?} {domain:?}: {}", features.regions.len());
            assert!(right < -0.3 && left > 0.3, "{weight:?} {domain:?}: {right} {left}");
        }
    }
}

#[test]
fn diagonal_neighbours_follow_the_same_rules() {
    for pose in ["human_rest.off", "human_touch.off"] {
        let mesh = fixture(pose);
        let mut parameters = coarse(4000, 40);
        let six = solid_features(&mesh, &parameters);
        parameters.voxelize.connectivity = Connectivity::TwentySix;
        let all = solid_features(&mesh, &parameters);
        assert_consistent(&all);
        let [a, b] = [&six, &all].map(|f| f.regions.len());
        assert!(a.abs_diff(b) <= 3, "{pose}: {a} regions with 6 neighbours, {b} with 26");
        // The Laplacian has six neighbours in either case.
        if six.shape.len() == all.shape.len() {
            assert_eq!(six.bodies[0].basis.eigenvalues(), all.bodies[0].basis.eigenvalues());
        }
    }
}

#[test]
fn stability_rules_differ_as_published() {
    let mesh = fixture("human_rest.off");
    let mut parameters = coarse(4000, 40);
    let mut count = |rule| {
        parameters.stability.rule = rule;
        let features = solid_features(&mesh, &parameters);
        assert_consistent(&features);
        for tree in &features.trees {
            let r = &tree.selection.report;
            let cut = r.blunt + r.too_small + r.too_large + r.unstable + r.overlapping;
            assert_eq!(r.candidates - cut, r.kept, "{r:?}");
            assert!(r.candidates <= r.nodes);
        }
        features.regions.len()
    };
    // Neighbouring differences are noise: they let most nodes through.
    let [windowed, paper, baseline] =
        [StabilityRule::Windowed, StabilityRule::Paper, StabilityRule::Baseline].map(&mut count);
    assert!(baseline < windowed && windowed < paper, "{baseline} {windowed} {paper}");
}
