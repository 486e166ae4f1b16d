//! The libraries and the program are one: each reads what the other writes, and both answer alike.

use std::fs;
use std::path::Path;

use crate::common::*;
use mser3d::shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d::voxelize::Pitch;
use mser3d::{Bodies, Detector, Domain, Features, Input, Parameters};
use mser3d_collection::{BatchParameters, PlanParameters, plan, run_batch};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_results::{Record, Results, ShapeFile, ShapeOptions};

fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(3000);
    parameters.spectrum.eigenpairs = 30.into();
    parameters
}

fn succeeds(arguments: &[&dyn AsRef<std::ffi::OsStr>]) -> String {
    let output = mser3d(arguments.iter().map(|a| (*a).as_ref()));
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

#[test]
fn regions_take_the_librarys_tolerance_and_those_who_ask_for_eigenpairs_the_solvers() {
    let tolerance = |options: &[&str]| {
        let words = options.iter().chain(&["body.off"]);
        let args: mser3d_cli::DetectArgs = mser3d_cli::parse("detect", words).unwrap();
        args.parameters().unwrap().spectrum.tolerance
    };
    let (regions, eigenpairs) =
        (Parameters::default().spectrum.tolerance, mser3d::spectral::SpectrumParameters::default().tolerance);
    // What the help says.
    assert_eq!((regions, eigenpairs), (1e-4, 1e-9));
    assert_eq!(tolerance(&[]), regions);
    assert_eq!(tolerance(&["--write=nifti,fine-surface"]), regions);
    for what in ["eigenfunctions", "signatures", "fields"] {
        assert_eq!(tolerance(&[&format!("--write=nifti,{what}")]), eigenpairs, "{what}");
    }
    assert_eq!(tolerance(&["--write=eigenfunctions", "--tolerance=1e-3"]), 1e-3);
}

#[test]
fn a_folder_of_the_library_is_viewed_rendered_matched_exported_and_searched() {
    let folder = tempfile::tempdir().unwrap();
    let mut paths = Vec::new();
    for pose in ["rest", "walk"] {
        let mesh =
            read_mesh(&fixtures().join(format!("human_{pose}.off")), &Default::default()).unwrap().mesh;
        let features = Detector::new(parameters()).detect(Input::Volume(&mesh)).unwrap();
        let path = folder.path().join(pose);
        // Nothing but the mesh in memory and a word for it.
        Results::new(&features, Some(&mesh), pose).unwrap().write(&path).unwrap();
        paths.push(path);
    }
    let (rest, walk) = (paths[0].as_path(), paths[1].as_path());
    succeeds(&[&"view", &rest]);
    assert!(fs::read_to_string(rest.join("view.html")).unwrap().contains("Parts and stable regions of rest"));
    succeeds(&[&"render", &rest]);
    assert!(fs::read(rest.join("parts.png")).unwrap().starts_with(b"\x89PNG"));
    succeeds(&[&"export", &rest, &"-o", &rest.join("rest.glb")]);
    assert!(succeeds(&[&"match", &rest, &walk]).contains("regions matched"));
    let shapes = ["rest", "walk"].map(|pose| fixtures().join(format!("human_{pose}.off")));
    let collection = folder.path().join("collection");
    let (plan, batch) = (plan(&shapes, &PlanParameters::default()).unwrap(), BatchParameters::default());
    let detector = Detector::new(parameters());
    run_batch(&collection, &plan, Domain::Volume, &detector, &batch, &|_| {}).unwrap();
    let found = succeeds(&[&"query", &collection, &walk, &"-k", &"1"]);
    assert!(found.contains("human_walk"), "{found}");
}

#[test]
fn a_folder_of_the_program_is_read_into_the_same_record_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let runs = [
        ("human.glb", "--animation poses --time 1 --voxels 1500 --eigenpairs 20"),
        ("human_rest.off", "--surface --eigenpairs 20 --weight commute"),
        ("human_rest.off", "--voxels 1500 --lambda-max 30 --stability-rule baseline --descriptor hks"),
    ];
    for (number, (input, options)) in runs.into_iter().enumerate() {
        let out = folder.path().join(number.to_string());
        regions(&fixtures().join(input), &out, &format!("{options} --quiet"));
        let written = fs::read_to_string(out.join("regions.json")).unwrap();
        let results = Results::load(&out).unwrap();
        assert_eq!(results.record.to_json().unwrap(), written, "{input} {options}");
        // Written again, all files are the same.
        let again = folder.path().join("again");
        results.write(&again).unwrap();
        for name in ["regions.json", "features.npz", "surface.ply"] {
            assert_eq!(fs::read(again.join(name)).unwrap(), fs::read(out.join(name)).unwrap(), "{name}");
        }
    }
}

/// `regions` and `warnings` of the program's answer, and of the library's.
fn assert_alike(file: &Path, options: &str, features: &Features) {
    let folder = tempfile::tempdir().unwrap();
    let output = detect(file, folder.path(), &format!("{options} --quiet"));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let record = Record::load(folder.path()).unwrap();
    let shape = ShapeFile::read(file, &ShapeOptions::default());
    let ours = Record::new(features, shape.unwrap().identity(), &[]);
    let texts = |r: &Record| r.regions.iter().map(|r| format!("{r:?}")).collect::<Vec<_>>();
    assert_eq!(texts(&record), texts(&ours));
    assert_eq!((&record.spectrum, &record.trees), (&ours.spectrum, &ours.trees));
    assert_eq!(record.parameters, ours.parameters.without_limits());
    assert!(record.warnings.ends_with(&ours.warnings), "{:?}", record.warnings);
}

fn mask(dims: [usize; 3], inside: impl Fn(usize, usize, usize) -> bool) -> VoxelGrid {
    let mut bits = BitGrid::empty(dims).unwrap();
    for voxel @ [x, y, z] in BitGrid::full(dims).unwrap().ones() {
        bits.set(voxel, inside(x as usize, y as usize, z as usize));
    }
    // An array has its first voxel's centre at 0.
    VoxelGrid::solid(Frame::new(dims, [-0.5; 3], [1.0; 3]).unwrap(), bits).unwrap()
}

#[test]
fn a_mask_of_64_voxels_has_the_eigenpairs_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("few.npy");
    fs::write(&path, npy([4, 4, 4], |_, _, _| true)).unwrap();
    let features = Detector::default().detect(Input::Solid(&mask([4; 3], |_, _, _| true))).unwrap();
    assert_eq!(features.bodies[0].basis.eigenvalues().len(), 64);
    assert!(features.warnings[0].to_string().contains("only 64 eigenpairs"), "{:?}", features.warnings);
    assert_alike(&path, "", &features);
}

#[test]
fn of_two_bodies_in_a_mask_the_larger_is_searched() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.npy");
    let inside = |x: usize, y: usize, _: usize| x < 12 || (13..16).contains(&x) && y < 4;
    fs::write(&path, npy([16, 9, 9], inside)).unwrap();
    let features = Detector::default().detect(Input::Solid(&mask([16, 9, 9], inside))).unwrap();
    assert_eq!(features.shape.len(), 12 * 9 * 9);
    let said = features.warnings[0].to_string();
    assert!(said.contains("1 smaller body with 108 voxels (10.00 %) was dropped"), "{said}");
    assert_alike(&path, "", &features);
    // Both, for who wants them.
    let both = Parameters { bodies: Bodies::Join, ..Default::default() };
    let features = Detector::new(both).detect(Input::Solid(&mask([16, 9, 9], inside))).unwrap();
    assert_eq!((features.shape.len(), features.bodies[0].spectrum.zero_modes), (12 * 9 * 9 + 108, 2));
}

#[test]
fn an_animation_at_a_time_is_that_pose() {
    let path = fixtures().join("human.glb");
    let pose = ReadOptions { animation: Some("poses".to_owned()), time: 1.0, ..Default::default() };
    let file = ShapeFile::read(&path, &ShapeOptions { pose, ..Default::default() }).unwrap();
    let features = Detector::new(parameters()).detect(file.input(Domain::Volume).unwrap()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let library = folder.path().join("library");
    Results::of_file(&features, &file).unwrap().write(&library).unwrap();
    let program = folder.path().join("program");
    regions(&path, &program, "--animation poses --time 1 --voxels 3000 --eigenpairs 30 --quiet");
    for name in ["features.npz", "surface.ply", "volume.vti"] {
        assert!(fs::read(library.join(name)).unwrap() == fs::read(program.join(name)).unwrap(), "{name}");
    }
    let records = [&library, &program].map(|folder| Record::load(folder).unwrap());
    assert_eq!(records[0].input, records[1].input);
    assert_eq!((&records[0].regions, &records[0].parameters), (&records[1].regions, &records[1].parameters));
}

#[test]
fn poses_share_a_scale_in_the_library_too() {
    let read = |pose: &str| -> TriangleMesh {
        read_mesh(&fixtures().join(format!("human_{pose}.off")), &Default::default()).unwrap().mesh
    };
    let scaled = parameters().with_scale_of(Input::Volume(&read("rest"))).unwrap();
    let Pitch::Size(pitch) = scaled.voxelize.pitch else { panic!("{:?}", scaled.voxelize.pitch) };
    let features = Detector::new(scaled.clone()).detect(Input::Volume(&read("walk"))).unwrap();
    assert_eq!(features.voxelization.unwrap().grid.frame().spacing(), [pitch; 3]);
    let estimate = scaled.estimate(&Input::Volume(&read("walk")));
    assert!((estimate.elements as f64 / 3000.0 - 1.0).abs() < 0.05, "{estimate:?}");
}
