//! A folder gives back what was written, and says what is wrong with it.

use std::path::Path;
use std::sync::LazyLock;

use mser3d::shape::{FunctionsView, TriangleMesh};
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_fileio::{NpyValues, read_npz};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_results::{
    Checksums, EXPORT_ENDINGS, Eigenfunctions, Extra, FORMAT, RegionPair, RenderOptions, Results,
    ResultsFolder, Up,
};
use mser3d_viewer::{NO_REGION, Rgb};

fn dumbbell() -> TriangleMesh {
    crate::example::dumbbell().unwrap()
}

fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(3000);
    parameters.spectrum.eigenpairs = 30.into();
    parameters
}

const PATH: &str = "shapes/dumbbell.off";

pub(crate) static VOLUME: LazyLock<Results> = LazyLock::new(|| {
    let mesh = dumbbell();
    let features = Detector::new(parameters()).detect(Input::Volume(&mesh)).unwrap();
    Results::new(&features, Some(&mesh), PATH).unwrap()
});

#[test]
fn a_volume_comes_back() {
    let results = &*VOLUME;
    assert!(results.record.regions.len() >= 2, "the balls are regions");
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path().join("new/out");
    results.write(&folder).unwrap();
    let read = Results::load(&folder).unwrap();
    // What differs by design: the grid's empty margin and the links that were cut.
    assert_eq!(read.record, results.record);
    assert_eq!(read.mesh, results.mesh);
    assert_eq!(read.region_vertices, results.region_vertices);
    assert_eq!(read.region_voxels, results.region_voxels);
    assert_eq!(read.trees, results.trees);
    assert_eq!((&read.eigenvalues, &read.descriptors), (&results.eigenvalues, &results.descriptors));
    let places = |r: &Results| -> Vec<[f64; 3]> {
        let grid = r.grid.as_ref().unwrap();
        grid.voxels().map(|v| grid.frame().centre(v)).collect()
    };
    assert_eq!(places(&read), places(results));
    assert_eq!(read.voxel_region(), results.voxel_region());
    assert!(folder.join("volume.vti").exists());
}

#[test]
fn parts_come_back_and_can_stand_for_regions() {
    let mesh = dumbbell();
    let asked = Parameters { parts: Some(mser3d::PartParameters::default()), ..parameters() };
    let features = Detector::new(asked).detect(Input::Volume(&mesh)).unwrap();
    let with_mesh = Results::new(&features, Some(&mesh), PATH).unwrap();
    let grid = features.shape.grid().unwrap();
    let solid = Detector::new(features.parameters.clone()).detect(Input::Solid(grid)).unwrap();
    for results in [with_mesh, Results::new(&solid, None, "mask").unwrap()] {
        let folder = tempfile::tempdir().unwrap();
        results.write(folder.path()).unwrap();
        let read = Results::load(folder.path()).unwrap();
        assert_eq!(read.record, results.record);
        assert_eq!((&read.vertex_part, &read.voxel_part), (&results.vertex_part, &results.voxel_part));
        let parts = results.record.parts.as_ref().unwrap();
        assert!(parts.len() >= 2 && results.vertex_part.len() == results.mesh.vertices().len());
        let shown = read.with_parts_as_regions().unwrap();
        assert_eq!(shown.voxel_region(), results.voxel_part);
        assert_eq!(shown.vertex_region(), results.vertex_part);
        assert!(shown.page("Parts", Up::Y).unwrap().contains("Parts"));
        assert!(shown.with_parts_as_regions().unwrap_err().to_string().contains("--parts"));
    }
}

#[test]
fn regions_name_their_nodes() {
    let results = &*VOLUME;
    for (id, region) in results.record.regions.iter().enumerate() {
        let tree = &results.trees[region.tree as usize];
        let top = results.node(id).unwrap();
        assert!((tree.volumes[top as usize] / region.volume - 1.0).abs() < 1e-9);
        assert_eq!(tree.altitudes[top as usize], region.altitude);
        let own = |mut node: u32| loop {
            if node == top {
                break true;
            }
            node = tree.parents[node as usize];
            if node == u32::MAX {
                break false;
            }
        };
        let inside = (0u32..).zip(&tree.entry).filter(|&(_, &n)| own(n)).map(|(e, _)| e);
        assert!(inside.eq(results.region_voxels[id].iter().copied()));
    }
}

#[test]
fn a_surface_and_a_mask_come_back() {
    let mesh = dumbbell();
    let surface = Detector::new(parameters()).detect(Input::Surface(&mesh)).unwrap();
    let surface = Results::new(&surface, Some(&mesh), PATH).unwrap();
    let grid = VOLUME.grid.clone().unwrap();
    let mask = Detector::new(parameters()).detect(Input::Solid(&grid)).unwrap();
    let mask = Results::new(&mask, None, "").unwrap();
    // The faces of the voxels stand for a mesh, and carry the regions.
    assert!(!mask.record.regions.is_empty() && mask.vertex_region().iter().any(|&l| l >= 0));
    for results in [surface, mask] {
        let folder = tempfile::tempdir().unwrap();
        results.write(folder.path()).unwrap();
        let read = Results::load(folder.path()).unwrap();
        assert_eq!(read.record, results.record);
        assert_eq!(read.vertex_region(), results.vertex_region());
        assert_eq!(read.grid.is_some(), folder.path().join("volume.vti").exists());
        read.page("t", Up::Y).unwrap();
        let options = RenderOptions { height: 60, ..Default::default() };
        assert_eq!(read.sheet(&options).unwrap(), results.sheet(&options).unwrap());
    }
}

#[test]
fn writing_twice_makes_the_same_bytes() {
    let [a, b] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    for folder in [&a, &b] {
        VOLUME.write(folder.path()).unwrap();
    }
    for name in ["regions.json", "features.npz", "surface.ply", "volume.vti"] {
        let read = |folder: &Path| std::fs::read(folder.join(name)).unwrap();
        assert_eq!(read(a.path()), read(b.path()), "{name}");
    }
}

#[test]
fn what_is_wrong_with_a_folder_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let error = |folder: &Path| Results::load(folder).map(|_| ()).unwrap_err().to_string();
    assert!(error(folder.path()).contains("no result; give the folder that `mser3d detect"));
    // As of an earlier version: what is read is checked without checksums too.
    let write = || {
        VOLUME.write(folder.path()).unwrap();
        std::fs::remove_file(folder.path().join(Checksums::FILE)).unwrap();
    };
    write();

    let json = folder.path().join("regions.json");
    let good = std::fs::read_to_string(&json).unwrap();
    let other = good.replacen(&format!("\"format\": {FORMAT}"), "\"format\": 7", 1);
    std::fs::write(&json, other).unwrap();
    assert!(error(folder.path()).contains(&format!("in format 7, this program reads format {FORMAT}")));
    // Not inside a number, which would be a number cut short.
    let half = good[..good.len() / 2].rfind(',').unwrap();
    std::fs::write(&json, &good[..half]).unwrap();
    assert!(error(folder.path()).contains("regions.json: EOF"));
    std::fs::write(&json, good.replacen("\"tree\": ", "\"tree\": 9", 1)).unwrap();
    assert!(
        error(folder.path()).contains("region 0 names a parent, tree, body or twin that is none of its own")
    );
    // Whoever follows parents comes to an end.
    std::fs::write(&json, good.replacen("\"parent\": null", "\"parent\": 0", 1)).unwrap();
    assert!(error(folder.path()).contains("region 0 names a parent"));

    // Twins are each other's.
    let (before, rest) = good.split_once("\"twin\": ").unwrap();
    let after = &rest[rest.find(',').unwrap()..];
    for twin in ["0", "999"] {
        std::fs::write(&json, format!("{before}\"twin\": {twin}{after}")).unwrap();
        assert!(error(folder.path()).contains("region 0 names a parent, tree, body or twin"));
    }

    // A result of one shape with the arrays of another.
    std::fs::write(&json, &good).unwrap();
    let mesh = dumbbell();
    let mut small = parameters();
    small.voxelize.pitch = Pitch::Voxels(1000);
    let other = Detector::new(small).detect(Input::Volume(&mesh)).unwrap();
    let other_folder = tempfile::tempdir().unwrap();
    Results::new(&other, Some(&mesh), PATH).unwrap().write(other_folder.path()).unwrap();
    let arrays = "features.npz";
    std::fs::copy(other_folder.path().join(arrays), folder.path().join(arrays)).unwrap();
    let text = error(folder.path());
    assert!(text.contains(arrays) && text.contains("run `mser3d detect` again"), "{text}");
    write();
    std::fs::remove_file(folder.path().join("surface.ply")).unwrap();
    assert!(error(folder.path()).contains("surface.ply"));
    write();
    let bytes = std::fs::read(folder.path().join(arrays)).unwrap();
    std::fs::write(folder.path().join(arrays), &bytes[..bytes.len() / 3]).unwrap();
    assert!(error(folder.path()).contains(arrays));
    std::fs::remove_file(&json).unwrap();
    std::fs::write(folder.path().join(arrays), bytes).unwrap();
    assert!(error(folder.path()).contains("there is no regions.json"));
}

#[test]
fn matched_regions_are_linked() {
    let results = &*VOLUME;
    let matches = [RegionPair { first: 0, second: 1, distance: 0.25, mistake: false }];
    let [first, second] = mser3d_results::matched_colours(results, results, &matches);
    let (others, matched) = (|r: &&Rgb| **r == NO_REGION, first[0]);
    assert_ne!(matched, NO_REGION);
    assert_eq!(second[1], matched);
    assert_eq!(first.iter().chain(&second).filter(others).count(), first.len() + second.len() - 2);
    let html = results.match_page(results, &matches, "pair", Up::Y).unwrap();
    assert!(html.contains("\"matches\":{\"parts\":[],\"regions\":[[0,1,0.25,false]]}"));
    let options = RenderOptions { height: 60, ..Default::default() };
    results.match_sheet(results, &matches, &options).unwrap();
    let beyond = [RegionPair { first: 0, second: 999, distance: 0.25, mistake: false }];
    assert!(results.match_page(results, &beyond, "pair", Up::Y).is_err());
}

#[test]
fn features_of_another_mesh_are_refused() {
    let mesh = dumbbell();
    let features = Detector::new(parameters()).detect(Input::Surface(&mesh)).unwrap();
    let other = TriangleMesh::new(mesh.vertices()[1..].to_vec(), vec![[0, 1, 2]]).unwrap();
    let error = Results::new(&features, Some(&other), PATH).unwrap_err();
    assert!(error.to_string().starts_with("the mesh has 1417 vertices, but the features"), "{error}");
}

#[test]
fn a_cut_opens_the_side_that_the_viewer_sees() {
    // The dumbbell lies along x, from -3 to 3; y and z span -1 to 1.
    let cut = |axis, kept, up| VOLUME.cut(axis, kept, up, 0.0).unwrap();
    assert_eq!(cut(None, Some(0.5), Up::Y).normal, [0.0, 0.0, 1.0]);
    assert_eq!(cut(None, Some(0.5), Up::Z).normal, [0.0, -1.0, 0.0]);
    let (front, side) = (cut(None, Some(0.75), Up::Z), cut(Some(0), Some(0.75), Up::Z));
    assert!((front.offset - 0.5).abs() < 0.02, "{front:?}");
    assert_eq!((side.normal, side.offset), ([1.0, 0.0, 0.0], 1.5));
    // From behind the other half goes.
    assert_eq!(VOLUME.cut(None, Some(0.5), Up::Y, 180.0).unwrap().normal, [0.0, 0.0, -1.0]);
}

#[test]
fn a_cut_leaves_half_of_the_volume_wherever_limbs_reach() {
    let grid = VOLUME.grid.as_ref().unwrap();
    let mut long = VOLUME.clone();
    // A vertex far away: the box is longer, the volume is where it was.
    let mut vertices = long.mesh.vertices().to_vec();
    vertices.push([40.0, 0.0, 0.0]);
    long.mesh = TriangleMesh::new(vertices, long.mesh.triangles().to_vec()).unwrap();
    for results in [&*VOLUME, &long] {
        let cut = results.cut(Some(0), None, Up::Y, 0.0).unwrap();
        let kept = grid.voxels().filter(|&voxel| grid.frame().centre(voxel)[0] <= cut.offset).count();
        let share = kept as f64 / grid.len() as f64;
        // A layer of voxels is a twentieth at most.
        assert!((share - 0.5).abs() < 0.06, "{share}");
    }
}

#[test]
fn the_ending_says_what_is_exported() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    for (name, begins) in [("a.glb", "glTF"), ("a.PLY", "ply"), ("a.vtp", "<?xml"), ("a.vti", "<?xml")] {
        VOLUME.export(&path(name)).unwrap();
        assert!(std::fs::read(path(name)).unwrap().starts_with(begins.as_bytes()), "{name}");
    }
    let read = read_mesh(&path("a.PLY"), &ReadOptions::default()).unwrap().mesh;
    assert_eq!(read, VOLUME.mesh);
    for ending in EXPORT_ENDINGS {
        let named = path(&format!("each{ending}"));
        VOLUME.export(&named).unwrap();
        assert!(named.is_file(), "{ending}");
    }
    let error = |name: &str| VOLUME.export(&path(name)).unwrap_err().to_string();
    for name in ["a.fbx", "a"] {
        assert!(
            error(name).ends_with(
                "no such format; end the name in .glb, .ply, .vtp, .vti, .nii.gz, .nii or .mrk.json"
            )
        );
    }
    let mut surface = VOLUME.clone();
    surface.grid = None;
    let error = surface.export(&path("b.vti")).unwrap_err().to_string();
    assert!(error.contains("write .vtp") && !path("b.vti").exists(), "{error}");
}

#[test]
fn eigenfunctions_come_back_in_single_precision_and_are_written_again_as_they_are() {
    let mesh = dumbbell();
    let features = Detector::new(parameters()).detect(Input::Volume(&mesh)).unwrap();
    let extras = [Extra::Eigenfunctions, Extra::Signatures, Extra::Fields];
    let results = Results::new(&features, Some(&mesh), PATH).unwrap().with_extras(&features, &extras);
    let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let write = |results: &Results, folder: &Path| {
        ResultsFolder::create(folder).unwrap().write(results, &extras).unwrap();
    };
    write(&results, first.path());
    let mut again = Results::load(first.path()).unwrap();
    let read = Eigenfunctions::load(first.path(), &again).unwrap();
    let rounded: Vec<f32> = features.bodies[0].basis.functions().values().map(|x| x as f32).collect();
    assert_eq!(read[0].basis.functions(), FunctionsView::Single(&rounded));

    again.eigenfunctions = Some(read);
    write(&again, second.path());
    let bytes = |folder: &Path, name: &str| std::fs::read(folder.join(name)).unwrap();
    let name = "eigenfunctions.npz";
    assert_eq!(bytes(first.path(), name), bytes(second.path(), name));
    let signatures = [&first, &second].map(|folder| {
        let arrays = read_npz(&folder.path().join("signatures.npz")).unwrap();
        let NpyValues::F64(values) = arrays["signature"].values().clone() else { panic!("no doubles") };
        values.into_owned()
    });
    let scale = signatures[0].iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    let differences = signatures[0].iter().zip(&signatures[1]).map(|(a, b)| (a - b).abs());
    assert!(differences.fold(0.0, f64::max) < 1e-6 * scale);
}
