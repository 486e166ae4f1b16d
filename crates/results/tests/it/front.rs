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
