//! Shapes that nobody on this project made; where they are not at hand, the tests say that they were skipped.

use mser3d::Domain;
use mser3d::voxelize::diagnose;
use mser3d_meshio::{MeshFormat, ReadOptions, list_animations, read_mesh};
use mser3d_tests::{coarse, read, real_shapes, solid_features};

#[test]
fn every_shape_is_closed_and_has_regions() {
    let Some(data) = real_shapes() else { return };
    let mut shapes = 0;
    for folder in ["makehuman", "odedstein", "gltf"] {
        for entry in std::fs::read_dir(data.join(folder)).unwrap() {
            let path = entry.unwrap().path();
            let bytes = std::fs::read(&path).unwrap();
            if path.extension().is_some_and(|e| e == "txt" || e == "bin") {
                continue;
            }
            MeshFormat::of(&path, &bytes).unwrap();
            let mesh = read(&path);
            let diagnosis = diagnose(&mesh);
            assert!(diagnosis.closed && diagnosis.volume > 0.0, "{}: {diagnosis:?}", path.display());
            let features = solid_features(&mesh, &coarse(4000, 40));
            // A straight bar has no parts.
            let least = if path.ends_with("RiggedSimple.glb") { 0..=0 } else { 4..=40 };
            assert!(
                least.contains(&features.regions.len()),
                "{}: {}",
                path.display(),
                features.regions.len()
            );
            shapes += 1;
        }
    }
    assert!(shapes >= 13, "{shapes}");
}

#[test]
fn a_human_has_arms_legs_and_a_head() {
    let Some(data) = real_shapes() else { return };
    let mesh = read(&data.join("makehuman/00_rest.off"));
    let features = solid_features(&mesh, &coarse(12_000, 60));
    assert!(features.regions.len() >= 8, "{}", features.regions.len());
    // In decimetres; the figure's left is at x > 0, the ground at y = -8.5, the shoulders at y = 5.5.
    let has = |limb: &str, volume: std::ops::Range<f64>, there: &dyn Fn([f64; 3]) -> bool| {
        let found = features.regions.iter().any(|r| volume.contains(&r.volume_fraction) && there(r.centroid));
        assert!(found, "no {limb}");
    };
    for side in [-1.0, 1.0] {
        has("arm", 0.04..0.08, &|[x, y, _]| side * x > 1.8 && y > 3.0);
        has("leg", 0.12..0.25, &|[x, y, _]| side * x > 1.0 && y < -2.0);
    }
    has("head", 0.05..0.1, &|[x, y, _]| x.abs() < 0.3 && y > 6.5);
}

#[test]
fn an_animated_fox_keeps_its_vertices_and_has_regions_in_every_frame() {
    let Some(data) = real_shapes() else { return };
    let path = data.join("gltf/Fox.glb");
    let walk = list_animations(&path, &Default::default())
        .unwrap()
        .into_iter()
        .find(|a| a.name.as_deref() == Some("Walk"));
    let walk = walk.expect("the fox walks");
    let rest = read(&path);
    let mut previous = rest.vertices().to_vec();
    for time in walk.frame_times(3.0).unwrap() {
        let options = ReadOptions { animation: Some("Walk".into()), time, ..Default::default() };
        let mesh = read_mesh(&path, &options).unwrap().mesh;
        assert_eq!(mesh.triangles(), rest.triangles());
        assert_ne!(mesh.vertices(), previous);
        previous = mesh.vertices().to_vec();
        let features = solid_features(&mesh, &coarse(4000, 40));
        assert_eq!(features.shape.domain(), Domain::Volume);
        assert!(features.regions.len() >= 10, "{time} s: {}", features.regions.len());
    }
}
