//! Weights that are no matter of heat: fields, curvature; and what smooths them.

use mser3d::comptree::{AltitudeScale, ComponentTree, Polarity};
use mser3d::descriptors::TimeScale;
use mser3d::shape::{BitGrid, Choice, Connectivity, Frame, TriangleMesh, VoxelGrid};
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d::{
    Bodies, Detector, DiscreteShape, Error, Features, Field, Input, NO_PROGRESS, Parameters, Weight,
    find_regions, find_regions_of_field,
};

use crate::{club, cuboid};

/// A bar of voxels along x, each `size` long.
fn bar(length: usize, size: f64) -> VoxelGrid {
    let dims = [length, 4, 4];
    let frame = Frame::new(dims, [0.0; 3], [size; 3]).unwrap();
    VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap()
}

fn along_x(shape: &DiscreteShape, f: impl Fn(f64) -> f64) -> Result<Field, Error> {
    Field::scalar(shape.positions().iter().map(|p| f(p[0])).collect())
}

fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(4000);
    parameters.spectrum.eigenpairs = 12.into();
    parameters.reliability.deformations = Some(0);
    parameters
}

/// Two hills: their heights at the ends of the bar, 0 between them.
fn hills(x: f64) -> f64 {
    if x < 15.0 { 3.0 * (15.0 - x).floor() - 40.0 } else { 2.0 * (x - 15.0).floor() - 40.0 }
}

#[test]
fn a_field_of_two_hills_has_the_tree_of_two_hills() {
    let grid = bar(30, 1.0);
    let field = |shape: &DiscreteShape| along_x(shape, hills);
    let detector = Detector::new(parameters()).with_weight(&field);
    let features = detector.detect(Input::Solid(&grid)).unwrap();
    assert_eq!(features.parameters.weight, Weight::Field);
    assert_eq!(features.parameters.polarity, Some(Polarity::Superlevel));
    assert_eq!(features.trees.len(), 1, "a field has no time");
    // A node for each step of each hill, 15 of each; those at the saddle are one, which is the root.
    let tree = features.tree(0).unwrap();
    assert_eq!(tree.len(), 29);
    let mut altitudes = tree.altitudes().to_vec();
    altitudes.sort_by(f64::total_cmp);
    let mut expected: Vec<f64> = (0..15).flat_map(|i| [3.0, 2.0].map(|s| s * f64::from(i) - 40.0)).collect();
    expected.sort_by(f64::total_cmp);
    expected.remove(0);
    assert_eq!(altitudes, expected, "the user's own numbers, negative ones too");
    // Just before they merge, the hills are 14 slices each.
    let largest: Vec<_> = features.regions.iter().take(2).collect();
    assert!(largest.iter().all(|r| r.elements.len() == 14 * 16 && r.merge.is_some()));
    let mut before = [largest[0].altitude, largest[1].altitude];
    before.sort_by(f64::total_cmp);
    assert_eq!(before, [-38.0, -37.0]);
}

#[test]
fn neither_the_unit_of_a_field_nor_where_it_is_zero_matters() {
    let grid = bar(40, 1.0);
    let wavy = |x: f64| (0.7 * x).sin() + 0.05 * x;
    let found = |factor: f64, shift: f64| {
        let field = move |shape: &DiscreteShape| along_x(shape, |x| factor * wavy(x) + shift);
        Detector::new(parameters()).with_weight(&field).detect(Input::Solid(&grid)).unwrap()
    };
    let plain = found(1.0, 0.0);
    assert!(plain.regions.len() >= 3, "{}", plain.regions.len());
    for (factor, shift) in [(1e6, 0.0), (1e-9, 0.0), (1e-30, 0.0), (2.0, -7.0), (1.0, 1000.0), (1.0, 1e6)] {
        let other = found(factor, shift);
        assert_eq!(other.regions.len(), plain.regions.len(), "{factor} {shift}");
        for (a, b) in plain.regions.iter().zip(&other.regions) {
            assert_eq!(a.elements, b.elements);
            let (expected, size) = (factor * a.altitude + shift, factor + shift.abs());
            assert!((b.altitude - expected).abs() <= 1e-9 * size, "{} {expected}", b.altitude);
            // In multiples of the field's standard deviation.
            assert!(a.stability == b.stability || (a.stability / b.stability - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn a_field_of_vectors_weighs_links_by_their_distance() {
    let grid = bar(30, 1.0);
    let shape = DiscreteShape::solid(grid.clone(), Connectivity::Six);
    let basis = shape.spectrum(&parameters().spectrum, NO_PROGRESS).unwrap().basis;
    let values: Vec<f64> = shape.positions().iter().map(|p| (p[0] * 0.37).sin() + 0.1 * p[1]).collect();
    // Vectors of one number: the absolute difference, the paper's edge weight of a vertex weight.
    let field = Field::vectors(1, values.clone()).unwrap();
    let own = Parameters::of_weight(Weight::Field);
    let found = find_regions_of_field(&shape, &basis, &field, &own, NO_PROGRESS).unwrap();
    let edges: Vec<[u32; 2]> = grid.graph(Connectivity::Six).unwrap().edges().collect();
    let difference = |&[u, v]: &[u32; 2]| (values[u as usize] - values[v as usize]).abs();
    let mut weights: Vec<f64> = edges.iter().map(difference).collect();
    mser3d::comptree::join_levels(&mut weights, 1e-9);
    let polarity = Polarity::Sublevel;
    let tree =
        ComponentTree::from_edge_weights(grid.len(), &edges, &weights, basis.mass(), polarity).unwrap();
    assert_eq!(found.trees[0].tree, Some(tree));

    // Two colours: no distance inside of either, one between them.
    let halves = |shape: &DiscreteShape| {
        let colour = |p: [f64; 3]| if p[0] < 12.0 { [3.0, 4.0, 0.0] } else { [0.0; 3] };
        Field::vectors(3, shape.positions().iter().flat_map(colour).collect())
    };
    let features = Detector::new(parameters()).with_weight(&halves).detect(Input::Solid(&grid)).unwrap();
    assert_eq!(features.parameters.polarity, Some(Polarity::Sublevel));
    let tree = features.tree(0).unwrap();
    assert_eq!(tree.altitudes(), [0.0, 0.0, 5.0]);
    let sizes: Vec<usize> = features.regions.iter().map(|r| r.elements.len()).collect();
    assert_eq!(sizes, [18 * 16, 12 * 16]);
}

#[test]
fn bodies_have_their_own_part_of_a_field() {
    let dims = [50, 4, 4];
    let mut inside = BitGrid::full(dims).unwrap();
    (0..16).for_each(|i| inside.set([30, i / 4, i % 4], false));
    let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let grid = VoxelGrid::solid(frame, inside).unwrap();
    let field = |shape: &DiscreteShape| along_x(shape, f64::floor);
    let all = Parameters { bodies: Bodies::All, ..parameters() };
    let features = Detector::new(all).with_weight(&field).detect(Input::Solid(&grid)).unwrap();
    let ranges = |f: &Features| -> Vec<[f64; 2]> {
        let sorted = |i: usize| {
            let mut altitudes = f.tree(i).unwrap().altitudes().to_vec();
            altitudes.sort_by(f64::total_cmp);
            [altitudes[0], altitudes[altitudes.len() - 1]]
        };
        (0..f.trees.len()).map(sorted).collect()
    };
    assert_eq!(ranges(&features), [[0.0, 29.0], [31.0, 49.0]]);
}

#[test]
fn what_lies_on_the_surface_is_carried_inside() {
    let mesh = club(1.0);
    let (solid, _) = DiscreteShape::volume(&mesh, &parameters().voxelize).unwrap();
    let pitch = solid.grid().unwrap().frame().spacing()[0];
    // Coordinates are harmonic: carried inside they are those of the voxels, but for half a voxel at the surface. The mesh
    // has triangles from end to end, so that no vertex is near to most voxels.
    let coordinates = mesh.vertices().as_flattened().to_vec();
    let carried = solid.carry(&Field::vectors(3, coordinates).unwrap()).unwrap();
    assert!(carried.has_vectors() && carried.len() == solid.len());
    for (voxel, place) in solid.positions().iter().enumerate() {
        for a in 0..3 {
            let error = (carried.at(voxel)[a] - place[a]).abs();
            assert!(error < 0.75 * pitch, "{error} at {place:?}, {:?}", carried.at(voxel));
        }
    }
    // On the surface itself vertices are elements, and those at one position are one.
    let mut repeated = mesh.vertices().to_vec();
    repeated.push(repeated[0]);
    let seam = TriangleMesh::new(repeated, mesh.triangles().to_vec()).unwrap();
    let surface = DiscreteShape::surface(&seam).unwrap();
    let mut values = vec![0.0; 17];
    (values[0], values[16], values[5]) = (1.0, 3.0, 7.0);
    let carried = surface.carry(&Field::scalar(values).unwrap()).unwrap();
    assert_eq!(carried.len(), 16);
    assert_eq!([carried.at(0)[0], carried.at(5)[0], carried.at(1)[0]], [2.0, 7.0, 0.0]);
}

#[test]
fn a_body_that_is_not_searched_counts_for_nothing() {
    // A small box touches nothing, one voxel from a large one; its values are absurd.
    let (mut vertices, mut triangles) = cuboid([0.0; 3], [10.0; 3]);
    let (more, others) = cuboid([10.5, 2.0, 2.0], [13.0, 4.0, 4.0]);
    vertices.extend(more);
    triangles.extend(others.iter().map(|t| t.map(|v| v + 8)));
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let voxelize = VoxelizeParameters { pitch: Pitch::Size(0.5), ..Default::default() };
    let (solid, _) = DiscreteShape::volume(&mesh, &voxelize).unwrap();
    assert_eq!(solid.len(), 8000);
    let values = (0..16).map(|v| if v < 8 { 1.0 } else { 1e9 }).collect();
    let carried = solid.carry(&Field::scalar(values).unwrap()).unwrap();
    assert!(carried.values().iter().all(|x| (x - 1.0).abs() < 1e-6));
}

/// A ball by latitude and longitude, two vertices at the poles.
fn ball(rings: u32) -> TriangleMesh {
    let around = 2 * rings;
    let mut vertices = vec![[0.0, 0.0, 1.0]];
    for i in 1..rings {
        let polar = std::f64::consts::PI * f64::from(i) / f64::from(rings);
        vertices.extend((0..around).map(|j| {
            let angle = std::f64::consts::TAU * f64::from(j) / f64::from(around);
            [polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()]
        }));
    }
    vertices.push([0.0, 0.0, -1.0]);
    let at = |i: u32, j: u32| match i {
        0 => 0,
        i if i == rings => (rings - 1) * around + 1,
        i => 1 + (i - 1) * around + j % around,
    };
    let quads = (0..rings).flat_map(|i| (0..around).map(move |j| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let triangles = triangles.filter(|[a, b, c]| a != b && b != c && a != c).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn the_curvature_of_a_ball_is_one_over_its_radius_on_it_and_in_it() {
    let mesh = ball(24);
    let scaled = mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(|x| 2.0 * x)).collect()).unwrap();
    let surface = DiscreteShape::surface(&scaled).unwrap();
    let (solid, _) = DiscreteShape::volume(&scaled, &parameters().voxelize).unwrap();
    for shape in [surface, solid] {
        let curvature = shape.mean_curvature().unwrap();
        assert_eq!(curvature.len(), shape.len());
        let error = curvature.values().iter().map(|h| (h - 0.5).abs()).fold(0.0, f64::max);
        assert!(error < 0.01, "{error}");
    }
}

#[test]
fn what_is_nearly_the_same_everywhere_has_no_altitudes() {
    // The errors of a ball's curvature are not its spread: lifetimes stay as small as they are.
    let surface = DiscreteShape::surface(&ball(24)).unwrap();
    let own = Parameters { spectrum: parameters().spectrum, ..Parameters::of_weight(Weight::Curvature) };
    let found = Detector::new(own).detect(Input::Shape(Box::new(surface))).unwrap();
    let lifetimes: Vec<f64> = found.regions.iter().filter_map(|r| Some(r.merge?.lifetime)).collect();
    assert!(lifetimes.iter().all(|lifetime| *lifetime < 0.01), "{lifetimes:?}");
}

#[test]
fn curvature_finds_the_handle_of_a_club_and_says_when_there_is_no_surface() {
    // A block of 4 x 4 x 4 and a handle 1.2 thick: its faces are flat, and its edges near to each other.
    let mesh = club(1.0);
    let parameters = Parameters { smooth_weight: Some(TimeScale::Relative(0.01)), ..parameters() };
    let curvature = Parameters { weight: Weight::Curvature, ..parameters.clone() };
    let mut linear = curvature.clone();
    linear.stability.altitude = AltitudeScale::Linear;
    let features = Detector::new(linear.clone()).detect(Input::Volume(&mesh)).unwrap();
    assert!(features.regions.iter().any(|r| r.centroid[0] > 6.0), "{:?}", features.regions.len());
    assert!(features.trees[0].time.is_none());
    // The stages by themselves come to the same.
    let (shape, _) = DiscreteShape::volume(&mesh, &linear.voxelize).unwrap();
    let basis = shape.spectrum(&linear.spectrum, NO_PROGRESS).unwrap().basis;
    assert_eq!(find_regions(&shape, &basis, &linear, NO_PROGRESS).unwrap().regions, features.regions);
    let mask = shape.grid().unwrap();
    assert_eq!(Detector::new(linear).detect(Input::Solid(mask)).unwrap_err(), Error::NoMesh);
}

#[test]
fn heat_smooths_a_field_before_the_tree_is_built() {
    let grid = bar(30, 1.0);
    let shape = DiscreteShape::solid(grid.clone(), Connectivity::Six);
    let noisy = |shape: &DiscreteShape| {
        let spike = |p: [f64; 3]| {
            if (p[0] as u32 + p[1] as u32 + p[2] as u32).is_multiple_of(2) { 9.0 } else { 0.0 }
        };
        Field::scalar(shape.positions().iter().map(|p| hills(p[0]) + spike(p)).collect())
    };
    let nodes = |smooth: Option<TimeScale>| {
        let parameters = Parameters { smooth_weight: smooth, ..parameters() };
        let features = Detector::new(parameters).with_weight(&noisy).detect(Input::Solid(&grid)).unwrap();
        let leaves = features.tree(0).unwrap().leaves().count();
        (leaves, features.regions.len())
    };
    assert!(nodes(None).0 > 100);
    // Hills are left, and nothing where heat had long enough.
    let (leaves, regions) = nodes(Some(TimeScale::Absolute(2.0)));
    assert!(leaves <= 4 && regions >= 2, "{leaves} {regions}");
    assert_eq!(nodes(Some(TimeScale::Relative(1e3))).1, 0);
    // A vector is smoothed number by number: twice the same is twice the same.
    let field = noisy(&shape).unwrap();
    let basis = shape.spectrum(&parameters().spectrum, NO_PROGRESS).unwrap().basis;
    let own =
        Parameters { smooth_weight: Some(TimeScale::Absolute(2.0)), ..Parameters::of_weight(Weight::Field) };
    let found = |width: usize| {
        let values = field.values().iter().flat_map(|&x| std::iter::repeat_n(x, width)).collect();
        let field = Field::vectors(width, values).unwrap();
        find_regions_of_field(&shape, &basis, &field, &own, NO_PROGRESS)
            .unwrap()
            .trees
            .remove(0)
            .tree
            .unwrap()
    };
    let (one, four) = (found(1), found(4));
    assert_eq!(one.len(), four.len());
    let doubled = one.altitudes().iter().zip(four.altitudes());
    assert!(doubled.into_iter().all(|(a, b)| (2.0 * a - b).abs() < 1e-9));
}

#[test]
fn an_estimate_knows_what_carries_and_smooths() {
    let mesh = club(1.0);
    let regions = |weight: Weight, smooth: Option<f64>| {
        let smooth_weight = smooth.map(TimeScale::Relative);
        let estimate =
            Parameters { smooth_weight, ..Parameters::of_weight(weight) }.estimate(&Input::Volume(&mesh));
        estimate.stages.regions
    };
    let [heat, edge] = [Weight::Heat, Weight::Edge].map(|weight| regions(weight, None));
    assert_eq!(edge, regions(Weight::Diffusion, None));
    assert!((edge / heat - 2.0).abs() < 1e-9);
    // One tree in place of two; the surface's values are carried inside.
    assert!(regions(Weight::Curvature, None) > regions(Weight::Commute, None));
    let smoothed = [0.001, 0.1].map(|t| regions(Weight::Heat, Some(t)) - heat);
    assert!(smoothed[0] > 0.0 && smoothed[1] > 3.0 * smoothed[0], "{smoothed:?}");
}

#[test]
fn what_is_no_weight_is_said() {
    let grid = bar(30, 1.0);
    let detect = |field: &(dyn Fn(&DiscreteShape) -> Result<Field, Error> + Sync), scale| {
        let mut detector = Detector::new(parameters()).with_weight(field);
        detector.parameters.stability.altitude = scale;
        detector.detect(Input::Solid(&grid))
    };
    let short = |_: &DiscreteShape| Field::scalar(vec![1.0; 7]);
    let error = detect(&short, AltitudeScale::Linear).unwrap_err();
    assert_eq!(
        error,
        Error::FieldLength { found: 7, expected: 480, what: "voxels or vertices in the shape" }
    );
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let with = |shape: &DiscreteShape| along_x(shape, |x| if x < 29.0 { x } else { bad });
        let error = detect(&with, AltitudeScale::Linear).unwrap_err().to_string();
        assert!(error.starts_with(&format!("value 29 is {bad}; a weight is a finite number")), "{error}");
    }
    // A logarithm of what has none.
    let signed = |shape: &DiscreteShape| along_x(shape, hills);
    let error = detect(&signed, AltitudeScale::Log).unwrap_err();
    assert_eq!(error, Error::NoLogarithm { value: -40.0 });
    let positive = |shape: &DiscreteShape| along_x(shape, |x| hills(x) + 41.0);
    assert!(detect(&positive, AltitudeScale::Log).is_ok());
    // A constant has one level, and no region.
    let constant = |shape: &DiscreteShape| along_x(shape, |_| -3.0);
    let features = detect(&constant, AltitudeScale::Linear).unwrap();
    assert_eq!((features.tree(0).unwrap().altitudes(), features.regions.len()), (&[-3.0][..], 0));
    // Without a field.
    let none = Detector::new(Parameters::of_weight(Weight::Field)).detect(Input::Solid(&grid));
    assert_eq!(none.unwrap_err(), Error::NoField);
    for &weight in Weight::ALL {
        let smooth =
            Parameters { smooth_weight: Some(TimeScale::Relative(0.1)), ..Parameters::of_weight(weight) };
        assert_eq!(smooth.validate().is_ok(), weight.is_of_elements(), "{weight}");
    }
    assert!(Field::vectors(0, vec![]).is_err() && Field::vectors(3, vec![0.0; 4]).is_err());
}

#[test]
fn diffusion_distances_don_t_depend_on_how_long_links_are() {
    // The same rod in voxels twice as long along x: the gradient of the heat kernel is the same, not the difference.
    let rod = |n: usize| {
        let dims = [n, 2, 2];
        let frame = Frame::new(dims, [0.0; 3], [40.0 / n as f64, 1.0, 1.0]).unwrap();
        VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap()
    };
    let highest = |n: usize| {
        let mut parameters = Parameters { weight: Weight::Diffusion, ..parameters() };
        parameters.time_scales = vec![TimeScale::Absolute(60.0)];
        let features = Detector::new(parameters).detect(Input::Solid(&rod(n))).unwrap();
        features.tree(0).unwrap().altitudes().iter().copied().fold(0.0, f64::max)
    };
    let (fine, coarse) = (highest(80), highest(40));
    assert!((fine / coarse - 1.0).abs() < 0.02, "{fine} {coarse}");
}
