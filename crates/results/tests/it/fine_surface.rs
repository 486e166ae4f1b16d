use std::path::Path;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters, Warning};
use mser3d_results::{Extra, Results, ResultsError, ResultsFolder};

/// Two blocks and a thin bar between them, with vertices at its ends only.
fn bone() -> TriangleMesh {
    let stations = [(-3.0, 1.0), (-1.0, 1.0), (-1.0, 0.35), (1.0, 0.35), (1.0, 1.0), (3.0, 1.0)];
    let ring = |(x, r): (f64, f64)| [[x, -r, -r], [x, r, -r], [x, r, r], [x, -r, r]];
    let vertices: Vec<[f64; 3]> = stations.into_iter().flat_map(ring).collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2]];
    for ring in 0..5u32 {
        for side in 0..4 {
            let [a, b] = [4 * ring + side, 4 * ring + (side + 1) % 4];
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    triangles.extend([[20, 21, 22], [20, 22, 23]]);
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn results(input: Input<'_>, mesh: Option<&TriangleMesh>) -> (Results, Vec<Warning>) {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(6000);
    parameters.spectrum.eigenpairs = 40.into();
    parameters.reliability.deformations = Some(0);
    let features = Detector::new(parameters).detect(input).unwrap();
    (Results::new(&features, mesh, "bone.off").unwrap(), features.warnings)
}

#[test]
fn a_region_between_vertices_is_said_and_seen_on_the_fine_surface() {
    let mesh = bone();
    assert!(mesh.signed_volume() > 0.0);
    let (results, warnings) = results(Input::Volume(&mesh), Some(&mesh));
    let bare = results.record.regions.iter().filter(|region| region.vertices == 0).count();
    assert!(bare > 0, "the middle of the bar is a region");
    assert!(warnings.contains(&Warning::BetweenVertices { regions: bare }), "{warnings:?}");

    let (fine, labels) = results.fine_surface(Path::new("fine")).unwrap();
    assert_eq!(&labels[..24], results.vertex_region());
    let pitch = results.grid.as_ref().unwrap().frame().spacing()[0];
    for region in results.record.regions.iter().filter(|region| region.vertices == 0) {
        // On the surface it reaches as far along the bar as its voxels do.
        let own = fine.vertices().iter().zip(&labels).filter(|(_, label)| **label == region.id as i32);
        let ends = own.fold([f64::INFINITY, f64::NEG_INFINITY], |e, (p, _)| [e[0].min(p[0]), e[1].max(p[0])]);
        let voxels = results.region_voxels[region.id as usize].iter();
        let grid = results.grid.as_ref().unwrap();
        let centres: Vec<[f64; 3]> = grid.voxels().map(|v| grid.frame().centre(v)).collect();
        let inside = voxels.fold([f64::INFINITY, f64::NEG_INFINITY], |e, &v| {
            [e[0].min(centres[v as usize][0]), e[1].max(centres[v as usize][0])]
        });
        assert!((0..2).all(|i| (ends[i] - inside[i]).abs() < 1.5 * pitch), "{ends:?} {inside:?}");
    }

    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out");
    ResultsFolder::create(&out).unwrap().write(&results, &[Extra::FineSurface]).unwrap();
    let options = mser3d_meshio::ReadOptions::default();
    let read = mser3d_meshio::read_mesh(&out.join("fine_surface.ply"), &options).unwrap().mesh;
    assert_eq!(read.triangles(), fine.triangles());
    assert!(fine.triangles().len() > 1000);
}

#[test]
fn what_is_as_fine_as_can_be_is_refused() {
    let mesh = bone();
    let (whole, _) = results(Input::Volume(&mesh), Some(&mesh));
    let (solid, _) = results(Input::Solid(whole.grid.as_ref().unwrap()), None);
    let error = solid.fine_surface(Path::new("fine.ply")).unwrap_err();
    assert!(
        matches!(error, ResultsError::Export { .. }) && error.to_string().contains("fine.ply"),
        "{error}"
    );
}
