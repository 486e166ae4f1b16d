use mser3d::shape::TriangleMesh;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_results::{Results, Up};

pub fn fixture(name: &str) -> TriangleMesh {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name);
    read_mesh(&path, &ReadOptions::default()).unwrap().mesh
}

pub fn detected(mesh: &TriangleMesh) -> Results {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(8000);
    parameters.spectrum.eigenpairs = 50.into();
    parameters.reliability.deformations = Some(0);
    let features = Detector::new(parameters).detect(Input::Volume(mesh)).unwrap();
    Results::new(&features, Some(mesh), "shape.off").unwrap()
}

fn front(mesh: &TriangleMesh, up: Up) -> Option<f64> {
    detected(mesh).front(up)
}

/// Turned about y so that what was seen from the front is seen from this azimuth.
pub fn turned(mesh: &TriangleMesh, azimuth: f64) -> TriangleMesh {
    let (sin, cos) = azimuth.to_radians().sin_cos();
    let turn = |[x, y, z]: &[f64; 3]| [cos * x + sin * z, *y, cos * z - sin * x];
    mesh.with_vertices(mesh.vertices().iter().map(turn).collect()).unwrap()
}

#[track_caller]
fn near(found: Option<f64>, wanted: f64) {
    let off = (found.expect("a front") - wanted + 540.0).rem_euclid(360.0) - 180.0;
    assert!(off.abs() < 12.0, "{found:?}, not {wanted}");
}

#[test]
fn a_figure_looks_where_its_toes_point_and_an_animal_where_its_head_is() {
    for name in ["human_rest.off", "human_kick.off", "quadruped_rest.off"] {
        let mesh = fixture(name);
        for azimuth in [0.0, 130.0, -75.0] {
            near(front(&turned(&mesh, azimuth), Up::Y), azimuth);
        }
    }
}

#[test]
fn up_is_what_it_is_said_to_be() {
    // The quarter turn that makes y z, and z -y.
    let mesh = fixture("quadruped_rest.off");
    let lying = mesh.vertices().iter().map(|&[x, y, z]| [x, -z, y]).collect();
    near(front(&mesh.with_vertices(lying).unwrap(), Up::Z), 0.0);
}

#[test]
fn what_has_no_twins_has_no_front() {
    assert_eq!(front(&crate::example::dumbbell().unwrap(), Up::Y), None);
}

#[test]
fn a_figure_that_leans_looks_where_it_did() {
    let mesh = fixture("human_rest.off");
    for lean in [-15.0_f64, 15.0] {
        let (sin, cos) = lean.to_radians().sin_cos();
        let leaning = mesh.vertices().iter().map(|&[x, y, z]| [x, cos * y - sin * z, sin * y + cos * z]);
        near(front(&mesh.with_vertices(leaning.collect()).unwrap(), Up::Y), 0.0);
    }
}

#[test]
fn scanned_people_look_ahead_in_every_pose() {
    let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let poses = ["00_rest", "01_tpose", "02_arms_up", "03_walk", "06_kick", "09_wave"];
    let people = ["child_rest", "man_rest", "woman_rest"];
    let paths = poses.map(|pose| data.join(format!("makehuman/{pose}.off")));
    let paths = paths.into_iter().chain(people.map(|name| data.join(format!("people/{name}.off"))));
    for path in paths {
        if !path.exists() {
            println!("skipped: {} is not there", path.display());
            continue;
        }
        let mesh = read_mesh(&path, &ReadOptions::default()).unwrap().mesh;
        let found = front(&mesh, Up::Y).unwrap_or_else(|| panic!("{} has no front", path.display()));
        // Shoulders and hips turn while walking and kicking.
        assert!(found.abs() < 45.0, "{}: {found}", path.display());
    }
}

#[test]
fn twins_without_a_region_have_the_sides_of_the_others() {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(20_000);
    parameters.reliability.deformations = Some(0);
    let mesh = fixture("quadruped_rest.off");
    let features = Detector::new(parameters).detect(Input::Volume(&mesh)).unwrap();
    let mut results = Results::new(&features, Some(&mesh), "quadruped.off").unwrap();
    let sides = |results: &Results| -> Vec<Option<f64>> {
        results.with_parts_as_regions().unwrap().record.regions.iter().map(|part| part.side).collect()
    };
    let known = sides(&results);
    // Four legs.
    let legs: Vec<usize> =
        (0..known.len()).filter(|&part| known[part].is_some_and(|s| s.abs() > 0.3)).collect();
    assert_eq!(legs.len(), 4, "{known:?}");
    // A pair of legs forgets, then one leg only.
    let twin =
        |results: &Results, part: usize| results.record.parts.as_ref().unwrap()[part].twins[0] as usize;
    for forgotten in [vec![legs[0], twin(&results, legs[0])], vec![legs[0]]] {
        let mut poorer = results.clone();
        for &part in &forgotten {
            let region = poorer.record.parts.as_ref().unwrap()[part].region.unwrap() as usize;
            poorer.record.regions[region].side = None;
        }
        for (found, known) in sides(&poorer).iter().zip(&known) {
            assert_eq!(found.map(f64::signum), known.map(f64::signum));
        }
    }
    // Nobody knows.
    results.record.regions.iter_mut().for_each(|region| region.side = None);
    assert_eq!(sides(&results), vec![None; known.len()]);
}
