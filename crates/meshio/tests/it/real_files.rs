//! Real files, where they are at hand.

use mser3d_meshio::{ReadOptions, list_animations, read_mesh};
use mser3d_shape::TriangleMesh;
use std::collections::HashMap;
use std::path::PathBuf;

fn data(name: &str) -> Option<PathBuf> {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(name);
    if !path.exists() {
        eprintln!("skipped: {name} is not there");
        return None;
    }
    Some(path)
}

/// Every edge is used once in each direction.
fn is_closed(mesh: &TriangleMesh) -> bool {
    let mut edges: HashMap<[u32; 2], i32> = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            *edges.entry([u.min(v), u.max(v)]).or_default() += if u < v { 1 } else { -1 };
        }
    }
    edges.values().all(|&balance| balance == 0)
}

#[test]
fn skinned_figures_are_closed_and_move() {
    for (name, vertices, triangles) in
        [("Fox.glb", 290, 576), ("RiggedFigure.gltf", 130, 256), ("RiggedSimple.glb", 448, 892)]
    {
        let Some(path) = data(&format!("gltf/{name}")) else { continue };
        let rest = read_mesh(&path, &ReadOptions::default()).unwrap();
        assert_eq!(
            (rest.mesh.vertices().len(), rest.mesh.triangles().len()),
            (vertices, triangles),
            "{name}"
        );
        assert!(is_closed(&rest.mesh), "{name}");
        assert!(rest.mesh.signed_volume() > 0.0, "{name}");
        let animations = list_animations(&path, &Default::default()).unwrap();
        assert!(!animations.is_empty());
        for animation in &animations {
            assert!(animation.end > animation.start);
            let times = [0.0, 0.37 * animation.end];
            let poses = times.map(|time| {
                let animation = Some(animation.index.to_string());
                read_mesh(&path, &ReadOptions { animation, time, ..Default::default() }).unwrap()
            });
            for pose in &poses {
                assert_eq!(pose.mesh.triangles(), rest.mesh.triangles(), "{name}: frames correspond");
                assert_eq!(pose.weld, rest.weld);
                // Bending changes the volume a little, never by a third.
                let ratio = pose.mesh.signed_volume() / rest.mesh.signed_volume();
                assert!((0.67..1.5).contains(&ratio), "{name} {animation}: volume ratio {ratio}");
            }
            assert_ne!(poses[0].mesh.vertices(), poses[1].mesh.vertices(), "{name} {animation}");
        }
    }
}

#[test]
fn an_unknown_animation_lists_those_there_are() {
    let Some(path) = data("gltf/Fox.glb") else { return };
    let names: Vec<_> =
        list_animations(&path, &Default::default()).unwrap().into_iter().map(|a| a.name.unwrap()).collect();
    assert_eq!(names, ["Survey", "Walk", "Run"]);
    let options = ReadOptions { animation: Some("Fly".into()), time: 0.0, ..Default::default() };
    let message = read_mesh(&path, &options).unwrap_err().to_string();
    assert!(message.contains("\"Fly\"") && message.contains("1 \"Walk\" (0.71 s)"), "{message}");
    let by_name = ReadOptions { animation: Some("Run".into()), time: 0.3, ..Default::default() };
    let by_number = ReadOptions { animation: Some("2".into()), time: 0.3, ..Default::default() };
    assert_eq!(read_mesh(&path, &by_name).unwrap(), read_mesh(&path, &by_number).unwrap());
}

#[test]
fn bodies_and_animals_are_read_whole() {
    for name in ["00_rest", "01_tpose", "02_arms_up", "03_walk", "06_kick", "08_twist", "09_wave"] {
        let Some(path) = data(&format!("makehuman/{name}.off")) else { continue };
        let body = read_mesh(&path, &ReadOptions::default()).unwrap();
        assert_eq!((body.mesh.vertices().len(), body.mesh.triangles().len()), (13380, 26756));
        assert!(is_closed(&body.mesh) && body.weld.is_none() && body.notes.is_empty());
    }
    for name in ["spot", "spot_low_resolution", "fish"] {
        let Some(path) = data(&format!("odedstein/{name}.obj")) else { continue };
        let animal = read_mesh(&path, &ReadOptions::default()).unwrap();
        assert!(is_closed(&animal.mesh) && animal.mesh.signed_volume() > 0.0, "{name}");
        let text = std::fs::read_to_string(&path).unwrap();
        let lines: Vec<_> = text.lines().filter(|l| l.starts_with("v ")).collect();
        assert_eq!(animal.mesh.vertices().len(), lines.len());
        let last: Vec<f64> =
            lines[lines.len() - 1][2..].split_whitespace().map(|w| w.parse().unwrap()).collect();
        assert_eq!(animal.mesh.vertices()[lines.len() - 1][..], last[..3], "{name}");
    }
}
