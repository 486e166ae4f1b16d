//! The hierarchy against all triangles, one by one.

use crate::common::*;
use mser3d_shape::TriangleMesh;
use mser3d_voxelize::*;

fn soup(triangles: usize, seed: u64) -> TriangleMesh {
    let mut random = Random(seed);
    let vertices = (0..3 * triangles)
        .map(|i| {
            let mut middle = Random(seed + i as u64 / 3);
            std::array::from_fn(|_| middle.next() + 0.25 * random.next())
        })
        .collect();
    let triangles = (0..triangles as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn one(mesh: &TriangleMesh, t: usize) -> TriangleMesh {
    TriangleMesh::new(mesh.corners(t).to_vec(), vec![[0, 1, 2]]).unwrap()
}

fn random_points(count: usize, seed: u64) -> impl Iterator<Item = Vec3> {
    let mut random = Random(seed);
    (0..count).map(move |_| std::array::from_fn(|_| 1.6 * random.next() - 0.3))
}

#[test]
fn rays_hit_what_each_triangle_says() {
    let mesh = soup(500, 1);
    let bvh = Bvh::new(&mesh);
    let single: Vec<Bvh> = (0..500).map(|t| Bvh::new(&one(&mesh, t))).collect();
    let mut total = 0;
    for (origin, to) in random_points(300, 2).zip(random_points(300, 3)) {
        let mut direction: Vec3 = std::array::from_fn(|a| to[a] - origin[a]);
        if total % 3 == 0 {
            // Along an axis: two coordinates of the direction are zero.
            direction = [0.0, 0.0, -0.7];
        }
        let hits = bvh.all_hits(origin, direction, 1.5);
        let mut expected: Vec<Hit> = (0..500u32)
            .flat_map(|t| {
                single[t as usize]
                    .all_hits(origin, direction, 1.5)
                    .into_iter()
                    .map(move |h| Hit { triangle: t, ..h })
            })
            .collect();
        expected.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        assert_eq!(hits, expected);
        assert_eq!(bvh.first_hit(origin, direction, 1.5), expected.first().copied());
        let end = std::array::from_fn(|a| origin[a] + 1.5 * direction[a]);
        assert_eq!(bvh.crossings(origin, end), expected.len());
        total += 1 + hits.len();
    }
    assert!(total > 500, "{total}");
}

#[test]
fn no_ray_slips_through_a_closed_surface() {
    let mesh = sphere([0.0; 3], 1.0, 3);
    let bvh = Bvh::new(&mesh);
    // Towards vertices and the middles of edges.
    for t in mesh.triangles() {
        for i in 0..3 {
            let (p, q) = (mesh.vertices()[t[i] as usize], mesh.vertices()[t[(i + 1) % 3] as usize]);
            let middle: Vec3 = std::array::from_fn(|a| 0.5 * (p[a] + q[a]));
            for direction in [p, middle] {
                let hit = bvh.first_hit([0.0; 3], direction, 10.0).expect("a way out");
                assert!(!hit.front && hit.t > 0.9);
                let outside = direction.map(|x| 3.0 * x);
                assert_eq!(bvh.crossings([0.0; 3], outside), 1);
                assert_eq!(bvh.crossings(direction.map(|x| -3.0 * x), outside) % 2, 0);
            }
        }
    }
}

#[test]
fn nearest_points_are_those_of_all_triangles() {
    let mesh = soup(400, 4);
    let bvh = Bvh::new(&mesh);
    let single: Vec<Bvh> = (0..400).map(|t| Bvh::new(&one(&mesh, t))).collect();
    for point in random_points(300, 5) {
        let found = bvh.nearest(point).unwrap();
        let best = single.iter().map(|b| b.nearest(point).unwrap().distance).fold(f64::INFINITY, f64::min);
        assert_eq!(found.distance, best);
        // The point lies on the triangle, and no corner is nearer.
        let corners = mesh.corners(found.triangle as usize);
        let again = single[found.triangle as usize].nearest(found.point).unwrap();
        assert!(again.distance < 1e-12);
        for corner in corners {
            let d = (0..3).map(|a| (corner[a] - point[a]).powi(2)).sum::<f64>().sqrt();
            assert!(found.distance <= d + 1e-12);
        }
    }
    assert_eq!(Bvh::new(&TriangleMesh::new(vec![], vec![]).unwrap()).nearest([0.0; 3]), None);
}

#[test]
fn winding_numbers_of_an_open_soup_are_sums_over_triangles() {
    let whole = sphere([0.5; 3], 0.6, 4);
    let mut random = Random(6);
    let open = altered(&whole, |_, t| (random.next() < 0.7).then_some(t));
    for mesh in [&whole, &open, &soup(300, 7)] {
        let tree = WindingTree::new(mesh);
        let mut worst = 0.0f64;
        for point in random_points(60, 8) {
            let exact: f64 = (0..mesh.triangles().len()).map(|t| solid_angle(&mesh.corners(t), point)).sum();
            worst = worst.max((tree.winding_number(point) - exact).abs());
        }
        assert!(worst < 4e-3, "{worst}");
    }
    let tree = WindingTree::new(&whole);
    assert!((tree.winding_number([0.5; 3]) - 1.0).abs() < 1e-3);
    // On the surface: displaced towards +x.
    let cube = WindingTree::new(&cuboid([0.0; 3], [1.0; 3]));
    assert_eq!(cube.winding_number([0.0, 0.4, 0.3]).round(), 1.0);
    assert_eq!(cube.winding_number([1.0, 0.4, 0.3]).round(), 0.0);
}

#[test]
fn voxels_of_open_meshes_are_those_of_the_sum_over_all_triangles() {
    let figure = moved(&sphere([0.0; 3], 1.0, 4), |p| {
        let reach = 1.0 + 160.0 * (p[0] * p[1] * p[2]).powi(2);
        p.map(|x| x * reach * 0.5 + 0.01)
    });
    // Each hole by itself: what comes off is a shell of its own, with an inside of its own.
    for every in [101, 43, 23] {
        let mesh = altered(&figure, |number, t| (number % every != 0).then_some(t));
        let parameters = VoxelizeParameters { pitch: Pitch::Resolution(45), ..Default::default() };
        let (frame, bits) = inside(&mesh, &parameters).unwrap();
        let [nx, ny, nz] = frame.dims().map(|n| n as u32);
        let tree = WindingTree::new(&mesh);
        let (mut clear, mut near_holes) = (0, 0);
        for [i, j, k] in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k]))) {
            let centre = frame.centre([i, j, k]);
            // Far from the holes an approximation decides.
            let rough = tree.winding_number(centre);
            if (rough - rough.round()).abs() < 0.05 && (rough - 0.5).abs() > 0.4 {
                assert_eq!(bits.get([i, j, k]), rough > 0.5, "{i} {j} {k}: {rough}");
                continue;
            }
            let exact: f64 = (0..mesh.triangles().len()).map(|t| solid_angle(&mesh.corners(t), centre)).sum();
            near_holes += 1;
            if (exact - 0.5).abs() > 1e-3 && exact < 1.5 - 1e-3 {
                clear += 1;
                assert_eq!(bits.get([i, j, k]), exact > 0.5, "{every}: {i} {j} {k}: {exact}");
            }
        }
        assert!(clear > 100 && clear > near_holes * 9 / 10, "{clear} of {near_holes}");
    }
}

/// Van Oosterom and Strackee's formula, over 4 pi.
fn solid_angle(corners: &[Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c] = corners.map(|q| std::array::from_fn::<f64, 3, _>(|i| q[i] - p[i]));
    let dot = |a: Vec3, b: Vec3| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let norm = |a: Vec3| dot(a, a).sqrt();
    let det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    let rest = norm(a) * norm(b) * norm(c) + dot(a, b) * norm(c) + dot(b, c) * norm(a) + dot(c, a) * norm(b);
    det.atan2(rest) / std::f64::consts::TAU
}

#[test]
fn the_hierarchy_does_not_depend_on_threads() {
    let mesh = sphere([0.0; 3], 1.0, 6);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let tree = WindingTree::new(&mesh);
            random_points(20, 9).map(|p| tree.winding_number(p).to_bits()).collect::<Vec<_>>()
        })
    };
    assert_eq!(run(1), run(3));
}
