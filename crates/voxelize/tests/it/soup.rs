//! Triangles that bound nothing, or hang together nowhere: an answer or a clear error, in time and in memory.

use crate::common::*;
use mser3d_shape::TriangleMesh;
use mser3d_voxelize::*;

/// Triangles with corners of their own, each within a box of the given size somewhere in the unit cube.
fn loose(count: usize, size: f64) -> TriangleMesh {
    let mut random = Random(29);
    let mut vertices: Vec<Vec3> = Vec::with_capacity(3 * count);
    for _ in 0..count {
        let place: Vec3 = std::array::from_fn(|_| random.next());
        vertices.extend((0..3).map(|_| place.map(|x| x + size * random.next())));
    }
    TriangleMesh::new(vertices, (0..count as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect()).unwrap()
}

/// Triangles over random vertices in the unit cube.
fn tangle(count: usize) -> TriangleMesh {
    let mut random = Random(31);
    let vertices = (0..count / 2).map(|_| std::array::from_fn(|_| random.next())).collect();
    let mut vertex = || (random.next() * (count / 2) as f64) as u32;
    TriangleMesh::new(vertices, (0..count).map(|_| std::array::from_fn(|_| vertex())).collect()).unwrap()
}

#[test]
fn a_soup_is_refused_and_a_vote_takes_it() {
    let pitches = [Pitch::Voxels(45_000), Pitch::Resolution(512), Pitch::Size(0.004)];
    // The last one is sparse: it takes a coarse grid to find out.
    for (soup, pitches) in
        [(tangle(20_000), &pitches[..]), (loose(20_000, 0.3), &pitches), (loose(2_000, 0.07), &pitches[..1])]
    {
        assert_eq!(diagnose(&soup).overlap_fraction, None);
        for &pitch in pitches {
            let parameters = VoxelizeParameters { pitch, ..Default::default() };
            let error = voxelize(&soup, &parameters).unwrap_err();
            assert!(matches!(error, VoxelizeError::Soup { .. }), "{error}");
        }
        let vote = VoxelizeParameters { inside: InsideTest::Vote, ..Default::default() };
        assert!(voxelize(&soup, &vote).unwrap().confidence < 0.5);
    }
}

/// n^3 cubes of six tetrahedra, each written as one face of four corners: a mesh of solids saved as a surface.
fn tetrahedra_as_faces(n: u32) -> TriangleMesh {
    let at = |[x, y, z]: [u32; 3]| x + (n + 1) * (y + (n + 1) * z);
    let cells = |n: u32| (0..n * n * n).map(move |i| [i % n, i / n % n, i / n / n]);
    let vertices = cells(n + 1).map(|p| p.map(|x| -f64::from(x))).collect();
    // From a corner to the opposite one, along each order of the axes.
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    let triangles = cells(n).flat_map(|cell| {
        orders.into_iter().flat_map(move |order| {
            let (mut corner, mut face) = (cell, [at(cell); 4]);
            for i in 0..3 {
                corner[order[i]] += 1;
                face[i + 1] = at(corner);
            }
            [[face[0], face[1], face[2]], [face[0], face[2], face[3]]]
        })
    });
    TriangleMesh::new(vertices, triangles.collect()).unwrap()
}

/// What a diagnosis says of a refusal is what comes, word by word; a large soup is refused at once.
#[test]
fn a_diagnosis_foretells_the_refusal() {
    let started = std::time::Instant::now();
    let large = tetrahedra_as_faces(12);
    assert_eq!(large.triangles().len(), 20_736);
    assert!(diagnose(&large).refused.is_some_and(|text| text.contains("bound no solid")));
    let seconds = started.elapsed().as_secs_f64();
    assert!(seconds < 5.0, "{seconds} s");
    let plane = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let mut meshes =
        vec![large, plane, tetrahedra_as_faces(2), tangle(300), loose(500, 0.1), sphere([0.0; 3], 1.0, 2)];
    meshes.extend(stl("cases/inspect_soup/soup.stl"));
    for mesh in meshes {
        let answer = voxelize(&mesh, &VoxelizeParameters::default());
        assert_eq!(diagnose(&mesh).refused, answer.err().map(|e| e.to_string()));
    }
}

/// Work that takes seconds ends soon after it is told to.
#[test]
fn long_work_can_be_cancelled() {
    let mesh = tetrahedra_as_faces(6);
    let parameters = VoxelizeParameters { pitch: Pitch::Resolution(150), ..Default::default() };
    let started = std::time::Instant::now();
    let check = || match started.elapsed().as_secs_f64() > 0.3 {
        true => std::ops::ControlFlow::Break(()),
        false => std::ops::ControlFlow::Continue(()),
    };
    assert_eq!(voxelize_with(&mesh, &parameters, &check).unwrap_err(), VoxelizeError::Cancelled);
    let at_once = || std::ops::ControlFlow::Break(());
    assert_eq!(diagnose_with(&mesh, &at_once), Err(VoxelizeError::Cancelled));
    let seconds = started.elapsed().as_secs_f64();
    assert!(seconds < 2.0, "{seconds} s");
    let ball = sphere([0.0; 3], 1.0, 3);
    let never = || std::ops::ControlFlow::Continue(());
    assert_eq!(diagnose_with(&ball, &never), Ok(diagnose(&ball)));
}

/// A binary STL file of the shared cases.
fn stl(path: &str) -> Option<TriangleMesh> {
    let file = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(path);
    let Ok(bytes) = std::fs::read(file) else {
        eprintln!("skipped: {path} is not there");
        return None;
    };
    let number = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let corner = |b: &[u8]| [number(b), number(&b[4..]), number(&b[8..])];
    let facets = bytes[84..].chunks_exact(50);
    let vertices: Vec<Vec3> = facets.flat_map(|f| [12, 24, 36].map(|at| corner(&f[at..]))).collect();
    let triangles = (0..vertices.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Some(TriangleMesh::new(vertices, triangles).unwrap())
}

/// Each triangle of a ball moved a little on its own: nothing can be merged, and yet there is a ball.
#[test]
fn triangles_that_hang_together_nowhere_still_bound_a_ball() {
    let ball = sphere([0.0; 3], 1.0, 4);
    let mut random = Random(37);
    let vertices = (0..ball.triangles().len())
        .flat_map(|t| {
            let shift: Vec3 = std::array::from_fn(|_| 2e-3 * (random.next() - 0.5));
            ball.corners(t).map(|p| std::array::from_fn(|a| p[a] + shift[a]))
        })
        .collect();
    let triangles = (0..ball.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let shaken = TriangleMesh::new(vertices, triangles).unwrap();
    assert_eq!(diagnose(&shaken).boundary_edges, 3 * ball.triangles().len());
    let pitch = Pitch::Voxels(10_000);
    let solid = voxelize(&shaken, &VoxelizeParameters { pitch, ..Default::default() }).unwrap();
    assert!((solid.grid.len() as f64 / 10_000.0 - 1.0).abs() < 0.02, "{}", solid.grid.len());
    let error = (solid.grid.volume() / ball.signed_volume() - 1.0).abs();
    assert!(error < 1e-2, "{error}");
    assert!(solid.confidence > 0.9, "{}", solid.confidence);
}

/// `cargo test --release -p mser3d-voxelize --test soup -- --ignored`: ten million triangles, of both kinds.
#[test]
#[ignore = "a minute and several gigabytes"]
fn ten_million_triangles() {
    for soup in [tangle(10_000_000), loose(10_000_000, 0.001)] {
        let error = voxelize(&soup, &VoxelizeParameters::default()).unwrap_err();
        assert!(matches!(error, VoxelizeError::Soup { .. } | VoxelizeError::NoVolume { .. }), "{error}");
        let vote = VoxelizeParameters { inside: InsideTest::Vote, ..Default::default() };
        assert!(voxelize(&soup, &vote).is_ok());
    }
}

#[test]
fn random_soup_and_extreme_coordinates_do_not_panic() {
    let mut random = Random(23);
    for scale in [1e-320, 1e-300, 1e-30, 1.0, 1e30, 1e300] {
        let vertices = (0..60).map(|_| std::array::from_fn(|_| (random.next() - 0.5) * scale)).collect();
        let triangles = (0..100).map(|_| std::array::from_fn(|_| (random.next() * 60.0) as u32)).collect();
        let soup = TriangleMesh::new(vertices, triangles).unwrap();
        diagnose(&soup);
        for test in [InsideTest::Auto, InsideTest::Parity, InsideTest::Vote, InsideTest::Winding] {
            for pitch in [Pitch::Voxels(500), Pitch::Resolution(12)] {
                let _ = voxelize(&soup, &VoxelizeParameters { inside: test, pitch, ..Default::default() });
            }
        }
    }
}
