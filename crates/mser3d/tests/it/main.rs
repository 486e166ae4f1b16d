//! The pipeline: one detector for all inputs, its settings, and what it promises.

#[path = "../../examples/parts_of_a_solid.rs"]
mod example;

mod bodies;
mod parts;
mod progress;
mod reliability;
mod sides;
mod sight;
mod weights;
mod without_parts;

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use mser3d::comptree::Polarity;
use mser3d::shape::{BitGrid, Connectivity, Frame, TriangleMesh, VoxelGrid};
use mser3d::spectral::EigenpairRange;
use mser3d::voxelize::Pitch;
use mser3d::{
    Bodies, Detector, DiscreteShape, Domain, Error, Features, Input, Parameters, Stage, Warning, Weight,
    describe, find_regions,
};

/// A mesh of the folder of shared data, if that is there: OFF with triangles, no comments.
fn shared(name: &str) -> Option<TriangleMesh> {
    let path = format!("{}/../../../shared/{name}", env!("CARGO_MANIFEST_DIR"));
    let Ok(text) = std::fs::read_to_string(&path) else {
        println!("skipped: no {path}");
        return None;
    };
    let mut words = text.split_whitespace().skip(1);
    let mut next = || words.next().unwrap();
    let (vertices, triangles): (usize, usize) = (next().parse().unwrap(), next().parse().unwrap());
    next();
    let vertices = (0..vertices).map(|_| std::array::from_fn(|_| next().parse().unwrap())).collect();
    let mut triangle = |_| {
        assert_eq!(next(), "3");
        std::array::from_fn(|_| next().parse().unwrap())
    };
    Some(TriangleMesh::new(vertices, (0..triangles).map(&mut triangle).collect()).unwrap())
}

#[test]
fn the_example_runs() {
    example::main().unwrap();
}

/// A closed box.
fn cuboid(low: [f64; 3], high: [f64; 3]) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
    let corner = |i: usize| std::array::from_fn(|a| if i >> a & 1 == 1 { high[a] } else { low[a] });
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    ((0..8).map(corner).collect(), quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// A block with a thin handle along x, of some scale.
fn club(scale: f64) -> TriangleMesh {
    let (mut vertices, mut triangles) = cuboid([0.0, -2.0, -2.0], [4.0, 2.0, 2.0]);
    let (more, others) = cuboid([3.9, -0.6, -0.6], [10.0, 0.6, 0.6]);
    vertices.extend(more);
    triangles.extend(others.iter().map(|t| t.map(|v| v + 8)));
    TriangleMesh::new(vertices.iter().map(|p| p.map(|x| scale * x)).collect(), triangles).unwrap()
}

fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(3000);
    parameters.spectrum.eigenpairs = 30.into();
    parameters.reliability.deformations = Some(0);
    parameters
}

fn regions(features: &Features) -> Vec<(usize, f64, [f64; 3])> {
    features.regions.iter().map(|r| (r.elements.len(), r.altitude, r.centroid)).collect()
}

#[test]
fn the_handle_of_a_club_is_a_region_of_its_volume_and_of_its_voxels() {
    let mesh = club(1.0);
    let features = Detector::new(parameters()).detect(Input::Volume(&mesh)).unwrap();
    let handle = |f: &Features| f.regions.iter().any(|r| r.centroid[0] > 5.0 && r.volume_fraction < 0.25);
    assert!(handle(&features));
    assert_eq!((features.shape.domain(), features.run.stages.len()), (Domain::Volume, 5));
    // The same solid, given as the voxels it became, is the same to the bit.
    let grid = features.shape.grid().unwrap();
    let solid = Detector::new(parameters()).detect(Input::Solid(grid)).unwrap();
    assert_eq!(regions(&solid), regions(&features));
    assert_eq!(solid.descriptors.values(), features.descriptors.values());
    assert!(solid.voxelization.is_none() && solid.regions.iter().all(|r| r.vertices.is_empty()));
    assert_eq!(solid.run.stages[0].stage, Stage::Spectrum);
}

#[test]
fn stages_one_by_one_are_the_detector() {
    let (mesh, parameters) = (club(1.0), parameters());
    let whole = Detector::new(parameters.clone()).detect(Input::Volume(&mesh)).unwrap();
    let (shape, _) = DiscreteShape::volume(&mesh, &parameters.voxelize).unwrap();
    let basis = shape.spectrum(&parameters.spectrum, mser3d::NO_PROGRESS).unwrap().basis;
    let found = find_regions(&shape, &basis, &parameters, mser3d::NO_PROGRESS).unwrap();
    let described = describe(&shape, &basis, &found.regions, &parameters).unwrap();
    assert_eq!(described.descriptors.values(), whole.descriptors.values());
    assert_eq!(described.sides.sidedness, whole.bodies[0].sidedness);
    let mut regions = found.regions;
    for ((region, &twin), &side) in regions.iter_mut().zip(&described.sides.twins).zip(&described.sides.sides)
    {
        (region.twin, region.side) = (twin, side);
    }
    assert_eq!(regions, whole.regions);
    // A shape and a spectrum that are there serve other weights.
    let cached = |_: &DiscreteShape, _: &_, _: mser3d::ProgressFn| {
        Ok(mser3d::spectral::Spectrum::new(basis.clone(), whole.bodies[0].spectrum))
    };
    let other = Parameters { weight: Weight::Commute, ..parameters };
    let features = Detector::new(other).with_spectra(&cached).detect(Input::Shape(Box::new(shape))).unwrap();
    assert_eq!((features.trees.len(), features.trees[0].time_scale), (1, None));
    assert_eq!(features.parameters.polarity, Some(Polarity::Superlevel));
}

#[test]
fn regions_and_descriptors_do_not_depend_on_the_unit() {
    let [one, thousand] =
        [1.0, 1024.0].map(|s| Detector::new(parameters()).detect(Input::Volume(&club(s))).unwrap());
    assert_eq!(one.regions.len(), thousand.regions.len());
    for (a, b) in one.regions.iter().zip(&thousand.regions) {
        assert_eq!(a.elements, b.elements);
        assert!((b.volume / a.volume / 1024f64.powi(3) - 1.0).abs() < 1e-9);
    }
    for (a, b) in one.descriptors.values().iter().zip(thousand.descriptors.values()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}

#[test]
fn the_innermost_region_of_a_vertex_is_the_smallest_that_has_it() {
    for input in [Input::Volume(&club(1.0)), Input::Surface(&club(1.0))] {
        let features = Detector::new(Parameters {
            bodies: Bodies::Join, // The surface is two boxes.
            spectrum: mser3d::spectral::SpectrumParameters { eigenpairs: 12.into(), ..Default::default() },
            ..parameters()
        })
        .detect(input)
        .unwrap();
        for (vertex, innermost) in (0u32..).zip(features.region_of_vertex()) {
            let around = features.regions.iter().filter(|r| r.vertices.binary_search(&vertex).is_ok());
            let smallest = around.min_by(|a, b| a.volume.total_cmp(&b.volume));
            assert_eq!(innermost.map(|r| &features.regions[r as usize]), smallest);
        }
    }
}

#[test]
fn progress_goes_through_the_stages_and_can_cancel_in_each() {
    let mesh = club(1.0);
    let heard = Mutex::new(Vec::new());
    let hear = |p: mser3d::Progress| {
        heard.lock().unwrap().push(p);
        ControlFlow::Continue(())
    };
    let mut parameters = parameters();
    parameters.reliability.deformations = Some(3);
    Detector::new(parameters.clone()).with_progress(&hear).detect(Input::Volume(&mesh)).unwrap();
    let heard = heard.into_inner().unwrap();
    assert!(heard.is_sorted_by_key(|p| (p.stage as usize as f64, p.done)), "{heard:?}");
    assert!(heard.is_sorted_by_key(|p| p.overall) && heard.iter().all(|p| (0.0..=1.0).contains(&p.done)));
    assert_eq!(heard.last().map(|p| (p.done, p.overall)), Some((1.0, 1.0)));
    for calls in (0..heard.len()).step_by(3) {
        let left = AtomicUsize::new(calls);
        let stop = |_| match left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)) {
            Ok(_) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        };
        let result = Detector::new(parameters.clone()).with_progress(&stop).detect(Input::Volume(&mesh));
        assert_eq!(result.err(), Some(Error::Cancelled), "after {calls} calls");
    }
}

#[test]
fn a_small_shape_has_as_many_eigenpairs_as_voxels_unless_a_number_is_asked_for() {
    let frame = Frame::new([3, 3, 3], [0.0; 3], [1.0; 3]).unwrap();
    let cube = VoxelGrid::solid(frame, BitGrid::full([3, 3, 3]).unwrap()).unwrap();
    let features = Detector::default().detect(Input::Solid(&cube)).unwrap();
    assert_eq!(features.warnings, [Warning::FewEigenpairs { wanted: 100, available: 27 }]);
    let mut parameters = Parameters::default();
    parameters.spectrum.eigenpairs = EigenpairRange::Count(100);
    let error = Detector::new(parameters).detect(Input::Solid(&cube)).err().unwrap().to_string();
    assert!(error.contains("100 eigenpairs") && error.contains("27"), "{error}");
}

#[test]
fn what_is_out_of_range_is_named_before_the_work() {
    let cases: [(&str, fn(&mut Parameters)); 6] = [
        ("time_scales is empty", |p| p.time_scales.clear()),
        ("reference_measure is -1", |p| p.reference_measure = Some(-1.0)),
        ("eigenpairs is 0", |p| p.spectrum.eigenpairs = 0.into()),
        ("window is 0", |p| p.stability.window = 0.0),
        ("duplicate_overlap is NaN", |p| p.pool.duplicate_overlap = f64::NAN),
        ("min_volume_fraction is 0.8", |p| p.stability.min_volume_fraction = 0.8),
    ];
    for (text, change) in cases {
        let mut parameters = parameters();
        change(&mut parameters);
        let error = Detector::new(parameters).detect(Input::Volume(&club(1.0))).err().unwrap().to_string();
        assert!(error.contains(text), "{text}: {error}");
    }
}

#[test]
fn an_input_of_another_size_gets_the_scale_of_the_first() {
    let scaled = parameters().with_scale_of(Input::Volume(&club(1.0))).unwrap();
    let features = Detector::new(scaled.clone()).detect(Input::Volume(&club(1.1))).unwrap();
    let Pitch::Size(pitch) = scaled.voxelize.pitch else { panic!("{:?}", scaled.voxelize.pitch) };
    assert_eq!(features.shape.grid().unwrap().frame().spacing(), [pitch; 3]);
    let times = |f: &Features| f.trees.iter().map(|t| t.time.unwrap()).collect::<Vec<_>>();
    let first = Detector::new(scaled).detect(Input::Volume(&club(1.0))).unwrap();
    assert_eq!(times(&features), times(&first));
    // Of a solid that is voxels, the measure alone: its voxels have their size.
    let grid = first.shape.grid().unwrap();
    let of_solid = parameters().with_scale_of(Input::Solid(grid)).unwrap();
    assert_eq!(
        (of_solid.reference_measure, of_solid.voxelize.pitch),
        (Some(grid.volume()), Pitch::Voxels(3000))
    );
    let shape = DiscreteShape::solid(grid.clone(), Connectivity::Six);
    assert_eq!(of_solid.estimate(&Input::Shape(Box::new(shape))).elements, grid.len());
}
