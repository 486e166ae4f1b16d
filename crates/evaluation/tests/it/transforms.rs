//! What each transform does to a figure of the project.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;

use mser3d_evaluation::shrec::{Class, Transformed, isometry, space_map, transform};
use mser3d_evaluation::{Correspondence, EvaluationError, IndexSet, NullShape, Overlaps, SurfacePoint};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shape::{Choice, TriangleMesh};

fn fixture(name: &str) -> TriangleMesh {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures").join(name);
    read_mesh(&path, &ReadOptions::default()).unwrap().mesh
}

static NULL: LazyLock<TriangleMesh> = LazyLock::new(|| fixture("human_rest.off"));

fn made(class: Class, strength: u32) -> Transformed {
    transform(&NULL, class, strength, 1).unwrap()
}

fn diagonal() -> f64 {
    NULL.bounding_box().unwrap().diagonal()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f64>().sqrt()
}

/// Each edge once in each direction; and the Euler characteristic.
fn closed_and_oriented(mesh: &TriangleMesh) -> (bool, i64) {
    let sides: Vec<(u32, u32)> =
        mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    let all: BTreeSet<_> = sides.iter().copied().collect();
    let closed = all.len() == sides.len() && sides.iter().all(|&(a, b)| all.contains(&(b, a)));
    (closed, mesh.vertices().len() as i64 - sides.len() as i64 / 2 + mesh.triangles().len() as i64)
}

const MADE: [Class; 12] = [
    Class::Affine,
    Class::Holes,
    Class::Localscale,
    Class::Microholes,
    Class::Noise,
    Class::Partial,
    Class::Rasterize,
    Class::Sampling,
    Class::Scaling,
    Class::Shotnoise,
    Class::Topology,
    Class::View,
];

#[test]
fn the_same_seed_gives_the_same_shape_and_another_another() {
    let fixed = [Class::Rasterize, Class::Sampling, Class::Scaling];
    for class in MADE {
        assert_eq!(made(class, 4), made(class, 4), "{class}");
        let other = transform(&NULL, class, 4, 2).unwrap();
        assert_eq!(made(class, 4) == other, fixed.contains(&class), "{class}");
        assert_ne!(made(class, 4).mesh, made(class, 5).mesh, "{class}");
    }
}

#[test]
fn the_ground_truth_is_on_the_null_shape() {
    for class in MADE {
        let shape = made(class, 5);
        assert_eq!(shape.points.len(), shape.mesh.vertices().len());
        assert!(shape.points.iter().all(Option::is_some));
        SurfacePoint::check(&shape.points, &NULL).unwrap();
        let moved = shape.points.iter().zip(shape.mesh.vertices());
        let moved =
            moved.map(|(p, &q)| distance(p.unwrap().position(&NULL), q)).fold(0.0, f64::max) / diagonal();
        match class {
            Class::Holes
            | Class::Microholes
            | Class::Partial
            | Class::View
            | Class::Sampling
            | Class::Topology => assert!(moved == 0.0, "{class} {moved}"),
            // A vertex lies within a voxel's diagonal of the surface.
            Class::Rasterize => assert!(moved < 0.015 * 3f64.sqrt(), "{moved}"),
            Class::Shotnoise => assert!((0.01..=0.03).contains(&moved), "{moved}"),
            // Six deviations are the most that the sum of twelve uniform numbers gives.
            Class::Noise => assert!((0.02..=0.06).contains(&moved), "{moved}"),
            _ => assert!(moved > 0.02, "{class} {moved}"),
        }
    }
}

#[test]
fn regions_are_carried_back() {
    let null = NullShape::new(NULL.clone());
    let height = |mesh: &TriangleMesh, v: usize| mesh.vertices()[v][1];
    let upper = IndexSet::from_fn(NULL.vertices().len(), |v| height(&NULL, v) > 1.0);
    for class in MADE {
        let shape = made(class, 5);
        let origin = |v: usize| shape.points[v].unwrap().position(&NULL)[1];
        let region = IndexSet::from_fn(shape.mesh.vertices().len(), |v| origin(v) > 1.0);
        let correspondence = Correspondence::new(&NULL, &shape.mesh, &shape.points).unwrap();
        let overlap =
            Overlaps::new(&null, std::slice::from_ref(&upper), &[region], &correspondence).unwrap().get(0, 0);
        // How much of the null shape's upper part has a counterpart at all.
        let left = correspondence
            .covered()
            .overlap(&IndexSet::from_fn(upper.universe(), |_| true), &NULL.vertex_areas());
        match class {
            Class::Partial | Class::View => assert!(left < 0.75, "{class} {left}"),
            Class::Holes | Class::Topology => {
                assert!(left > 0.6 && overlap > 0.6, "{class} {left} {overlap}")
            }
            Class::Sampling => assert!(left > 0.99 && overlap > 0.93, "{left} {overlap}"),
            _ => assert!(left > 0.97 && overlap > 0.97, "{class} {left} {overlap}"),
        }
    }
}

#[test]
fn sampling_keeps_the_solid() {
    for (strength, least) in [(1, 0.995), (2, 0.99), (3, 0.975), (4, 0.94), (5, 0.85)] {
        let mesh = made(Class::Sampling, strength).mesh;
        assert_eq!(closed_and_oriented(&mesh), (true, 2));
        let share = mesh.vertices().len() as f64 / NULL.vertices().len() as f64;
        assert!((share - [0.6, 0.35, 0.2, 0.1, 0.04][strength as usize - 1]).abs() < 1e-3);
        let volume = mesh.signed_volume() / NULL.signed_volume();
        assert!((least..1.0).contains(&volume), "{strength} {volume}");
    }
}

#[test]
fn every_tube_adds_a_handle() {
    for strength in 1..=5 {
        let (closed, euler) = closed_and_oriented(&made(Class::Topology, strength).mesh);
        assert!(closed);
        assert_eq!(euler, 2 - 2 * 2 * i64::from(strength));
    }
}

#[test]
fn rasterizing_keeps_a_closed_solid() {
    for strength in [1, 5] {
        let mesh = made(Class::Rasterize, strength).mesh;
        assert!((0.9..1.1).contains(&(mesh.signed_volume() / NULL.signed_volume())));
        // Edges in pairs; where voxels touch at an edge only, in two pairs.
        let mut balance = std::collections::BTreeMap::<(u32, u32), i32>::new();
        for &[a, b, c] in mesh.triangles() {
            for (p, q) in [(a, b), (b, c), (c, a)] {
                *balance.entry((p.min(q), p.max(q))).or_default() += if p < q { 1 } else { -1 };
            }
        }
        assert!(balance.values().all(|n| *n == 0));
    }
}

#[test]
fn partial_keeps_its_share_of_the_area_and_scaling_its_factor() {
    for strength in 1..=5 {
        let share = made(Class::Partial, strength).mesh.area() / NULL.area();
        assert!((share - (1.0 - 0.08 * f64::from(strength))).abs() < 0.001);
        let factor = [0.5, 0.875, 1.25, 1.625, 2.0][strength as usize - 1];
        let volume = made(Class::Scaling, strength).mesh.signed_volume() / NULL.signed_volume();
        assert!((volume / (factor * factor * factor) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_camera_sees_less_than_two_thirds_and_five_nearly_all() {
    let mut seen = vec![false; NULL.vertices().len()];
    for camera in 1..=5 {
        let shape = made(Class::View, camera);
        assert!(shape.mesh.area() < 0.67 * NULL.area() && shape.mesh.area() > 0.2 * NULL.area());
        for point in shape.points.iter().flatten() {
            let corner = point.weights.iter().position(|w| *w == 1.0).unwrap();
            seen[NULL.triangles()[point.triangle as usize][corner] as usize] = true;
        }
    }
    let share = seen.iter().filter(|s| **s).count() as f64 / seen.len() as f64;
    assert!(share > 0.85, "{share}");
}

#[test]
fn strong_holes_open_the_surface_in_as_many_places() {
    let mesh = made(Class::Holes, 5).mesh;
    let sides: BTreeSet<(u32, u32)> =
        mesh.triangles().iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
    let rims: Vec<[u32; 2]> =
        sides.iter().filter(|(a, b)| !sides.contains(&(*b, *a))).map(|&(a, b)| [a, b]).collect();
    let graph = mser3d_shape::Graph::from_edges(mesh.vertices().len(), &rims).unwrap();
    let on_rims = (0..mesh.vertices().len() as u32).filter(|&v| !graph.neighbours(v).is_empty());
    let components = graph.components();
    let loops: BTreeSet<u32> = on_rims.map(|v| components.labels[v as usize]).collect();
    // Ten discs, of which some may overlap.
    assert!((6..=12).contains(&loops.len()), "{}", loops.len());
}

#[test]
fn what_cannot_be_made_is_refused() {
    assert!(
        matches!(transform(&NULL, Class::Noise, 6, 1), Err(EvaluationError::InvalidParameter(p)) if p.name == "strength")
    );
    assert!(matches!(transform(&NULL, Class::Isometry, 1, 1), Err(EvaluationError::PoseNeeded)));
    let flat = TriangleMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    for class in MADE {
        assert!(matches!(transform(&flat, class, 1, 1), Err(EvaluationError::NoSurface { .. })), "{class}");
    }
    let pose = fixture("human_walk.off");
    assert_eq!(isometry(&NULL, &pose).unwrap().mesh, pose);
    assert!(isometry(&NULL, &fixture("quadruped_rest.off")).is_err());
    assert!("noize".parse::<Class>().unwrap_err().to_string().contains("shotnoise"));
    assert!(Class::ALL.iter().all(|c| c.name().parse::<Class>().unwrap() == *c));
}

#[test]
fn the_map_of_space_moves_the_vertices_as_the_transform_does() {
    for class in [Class::Affine, Class::Localscale, Class::Scaling] {
        let map = space_map(&NULL, class, 4, 1).unwrap().unwrap();
        let moved: Vec<[f64; 3]> = NULL.vertices().iter().map(|&p| map(p)).collect();
        assert_eq!(moved, made(class, 4).mesh.vertices(), "{class}");
    }
    for class in [Class::Holes, Class::Sampling, Class::Topology, Class::View] {
        let (map, shape) = (space_map(&NULL, class, 4, 1).unwrap().unwrap(), made(class, 4));
        for (point, &vertex) in shape.points.iter().zip(shape.mesh.vertices()) {
            assert_eq!(map(point.unwrap().position(&NULL)), vertex, "{class}");
        }
    }
    assert!(space_map(&NULL, Class::Isometry, 1, 1).unwrap().is_none());
    assert!(space_map(&NULL, Class::Noise, 0, 1).is_err());
}

/// FNV-1a over everything that a transform is.
fn fingerprint(hash: u64, shape: &Transformed) -> u64 {
    let vertices = shape.mesh.vertices().iter().flatten().map(|x| x.to_bits());
    let triangles = shape.mesh.triangles().iter().flatten().map(|&v| u64::from(v));
    let points = shape.points.iter().flatten();
    let points =
        points.flat_map(|p| std::iter::once(u64::from(p.triangle)).chain(p.weights.map(f64::to_bits)));
    let numbers = vertices.chain(triangles).chain(points);
    numbers.fold(hash, |hash, x| (hash ^ x).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn the_benchmark_is_the_same_for_ever() {
    let all = |class| (1..=5).fold(0xcbf2_9ce4_8422_2325, |hash, s| fingerprint(hash, &made(class, s)));
    let found: Vec<String> = MADE.iter().map(|&class| format!("{class} {:016x}", all(class))).collect();
    let expected = [
        "affine ac358ef9361b9069",
        "holes 69e3999967b5071d",
        "localscale 99f27d88dbb843e1",
        "microholes aa793224e4460b1f",
        "noise 24b2fc2ec96b26bb",
        "partial a43850ee73aba278",
        "rasterize 793065fe864382ed",
        "sampling f82069137325ce78",
        "scaling 4324accb00b3641b",
        "shotnoise b7dc950806ebf3ee",
        "topology 06c666fdd628ca54",
        "view 1195fd23a53745f5",
    ];
    assert_eq!(found, expected, "the numbers of published benchmarks would change");
}
