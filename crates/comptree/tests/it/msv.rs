//! Maximally stable volumes against their definition by areas at levels.
use mser3d_comptree::shape::Connectivity;
use mser3d_comptree::{
    ComponentTree, Ellipsoid, InvalidParameter, Moments, MsvParameters, Polarity, TreeError,
    maximally_stable_volumes,
};
use proptest::prelude::*;

/// The component at a level around a vertex, by flooding: 26 neighbours, dark regions.
fn flood(dims: [usize; 3], values: &[u8], start: usize, level: i32) -> Vec<usize> {
    let mut inside = vec![false; values.len()];
    let mut stack = vec![start];
    inside[start] = true;
    while let Some(v) = stack.pop() {
        let at = [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]];
        for w in 0..values.len() {
            let other = [w % dims[0], w / dims[0] % dims[1], w / dims[0] / dims[1]];
            let near = (0..3).all(|i| at[i].abs_diff(other[i]) <= 1);
            if near && !inside[w] && i32::from(values[w]) <= level {
                inside[w] = true;
                stack.push(w);
            }
        }
    }
    (0..values.len()).filter(|&v| inside[v]).collect()
}

/// Regions by the definition: each voxel at its own value floods a region; its variation compares with
/// the flood delta higher; it is stable if the region one grey value higher, when that is another, varies
/// more, and no region that turns into it one grey value higher varies less.
fn by_definition(dims: [usize; 3], values: &[u8], parameters: &MsvParameters) -> Vec<(usize, u8)> {
    let mut regions: Vec<(Vec<usize>, i32)> = (0..values.len())
        .map(|v| (flood(dims, values, v, i32::from(values[v])), i32::from(values[v])))
        .collect();
    regions.sort();
    regions.dedup();
    let area_at = |r: &(Vec<usize>, i32), level: i32| flood(dims, values, r.0[0], level).len() as f64;
    let variation: Vec<f64> = regions
        .iter()
        .map(|r| (area_at(r, r.1 + parameters.delta as i32) - r.0.len() as f64) / r.0.len() as f64)
        .collect();
    let parent = |i: usize| {
        let larger = |&j: &usize| {
            regions[j].0.len() > regions[i].0.len() && regions[i].0.iter().all(|v| regions[j].0.contains(v))
        };
        (0..regions.len()).filter(larger).min_by_key(|&j| regions[j].0.len())
    };
    let next = |i: usize| parent(i).filter(|&p| regions[p].1 <= regions[i].1 + 1);
    let stable = |i: usize| {
        parent(i).is_some()
            && next(i).is_none_or(|p| variation[i] < variation[p])
            && (0..regions.len()).all(|c| next(c) != Some(i) || variation[c] >= variation[i])
    };
    let total = values.len() as f64;
    let mut found: Vec<(usize, u8)> = Vec::new();
    let mut stays: Vec<bool> = (0..regions.len()).map(stable).collect();
    let mut order: Vec<usize> = (0..regions.len()).filter(|&i| stays[i]).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(regions[i].0.len()));
    for i in order {
        let area = regions[i].0.len() as f64;
        let mut above = parent(i).unwrap();
        while let Some(p) = parent(above).filter(|_| !stays[above]) {
            above = p;
        }
        let above = regions[above].0.len() as f64;
        stays[i] = variation[i] < parameters.max_variation
            && (parameters.min_area * total..=parameters.max_area * total).contains(&area)
            && (above - area) / above >= parameters.min_diversity;
        if stays[i] {
            found.push((regions[i].0.len(), regions[i].1 as u8));
        }
    }
    found.sort_unstable();
    found
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn volumes_are_those_of_the_definition(
        values in prop::collection::vec(0u8..12, 60),
        delta in 1u8..5,
        max_variation in 0.3f64..3.0,
        min_diversity in 0.0f64..0.6,
    ) {
        let dims = [5, 4, 3];
        let parameters = MsvParameters { delta: f64::from(delta), min_area: 0.03, max_area: 0.8, max_variation, min_diversity, step: 1.0 };
        let tree = ComponentTree::from_grid(dims, Connectivity::TwentySix, &values, 1.0, Polarity::Sublevel).unwrap();
        let selection = maximally_stable_volumes(&tree, &parameters).unwrap();
        let mut found: Vec<(usize, u8)> = selection.regions.iter().map(|r| (r.volume as usize, r.altitude as u8)).collect();
        found.sort_unstable();
        prop_assert_eq!(&found, &by_definition(dims, &values, &parameters));
        let report = selection.report;
        let removed = report.unstable + report.too_large + report.too_small + report.overlapping;
        prop_assert_eq!(report.candidates, removed + report.kept);
        // Bright regions are the dark ones of the negative.
        let negative: Vec<u8> = values.iter().map(|v| 255 - v).collect();
        let bright = ComponentTree::from_grid(dims, Connectivity::TwentySix, &negative, 1.0, Polarity::Superlevel).unwrap();
        let bright = maximally_stable_volumes(&bright, &parameters).unwrap();
        prop_assert!(selection.regions.iter().zip(&bright.regions).all(|(a, b)| (a.node, a.parent) == (b.node, b.parent)));
    }
}

#[test]
fn a_solid_ellipsoid_in_noise_is_found_and_fitted() {
    let dims = [48, 40, 36];
    let (centre, radii) = ([24.3, 19.1, 17.7], [15.0, 9.0, 6.0]);
    // Turned about z by a known angle.
    let (sin, cos) = 0.6f64.sin_cos();
    let inside = |p: [f64; 3]| {
        let [x, y, z] = [p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]];
        let local = [cos * x + sin * y, cos * y - sin * x, z];
        (0..3).map(|i| (local[i] / radii[i]).powi(2)).sum::<f64>() <= 1.0
    };
    let position = |v: u32| {
        let v = v as usize;
        [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]].map(|c| c as f64)
    };
    let n = dims.iter().product::<usize>();
    let noise = |v: usize| (v.wrapping_mul(0x9e37_79b9) >> 7 & 15) as u8;
    let values: Vec<u8> =
        (0..n).map(|v| if inside(position(v as u32)) { 170 } else { 60 } + noise(v)).collect();
    let tree =
        ComponentTree::from_grid(dims, Connectivity::TwentySix, &values, 1.0, Polarity::Superlevel).unwrap();
    let parameters = MsvParameters { min_area: 0.01, ..Default::default() };
    let selection = maximally_stable_volumes(&tree, &parameters).unwrap();
    let region = selection.regions[0];
    let exact = 4.0 / 3.0 * std::f64::consts::PI * radii.iter().product::<f64>();
    assert!((region.volume / exact - 1.0).abs() < 0.02, "{} voxels of {exact}", region.volume);
    let fit = Ellipsoid::fit(&Moments::of(tree.vertices(region.node), position, 1.0), 3);
    for i in 0..3 {
        assert!(
            (fit.centre[i] - centre[i]).abs() < 0.1 && (fit.semi_axes[i] - radii[i]).abs() < 0.15,
            "{fit:?}"
        );
    }
    let along = fit.axes[0][0] * cos + fit.axes[0][1] * sin;
    assert!(along.abs() > 0.999);
}

#[test]
fn an_image_and_a_constant_have_their_answers() {
    let flat =
        ComponentTree::from_grid([9, 9, 1], Connectivity::Six, &[7u8; 81], 1.0, Polarity::Sublevel).unwrap();
    assert!(maximally_stable_volumes(&flat, &MsvParameters::default()).unwrap().regions.is_empty());
    let empty =
        ComponentTree::from_grid::<u8>([0, 0, 0], Connectivity::Six, &[], 1.0, Polarity::Sublevel).unwrap();
    assert!(maximally_stable_volumes(&empty, &MsvParameters::default()).unwrap().regions.is_empty());
    let wrong = MsvParameters { delta: 0.0, ..Default::default() };
    assert!(matches!(
        maximally_stable_volumes(&flat, &wrong),
        Err(TreeError::InvalidParameter(InvalidParameter { name: "delta", .. }))
    ));
}
