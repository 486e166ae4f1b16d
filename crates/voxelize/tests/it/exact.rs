//! The voxels of closed surfaces against answers in exact arithmetic.

use crate::common::*;
use mser3d_shape::{BitGrid, Connectivity, Frame, TriangleMesh, VoxelGrid};
use mser3d_voxelize::*;

fn on(frame: Frame, mesh: &TriangleMesh, test: InsideTest) -> VoxelGrid {
    let parameters =
        VoxelizeParameters { frame: Some(frame), inside: test, largest_only: false, ..Default::default() };
    match voxelize(mesh, &parameters) {
        Ok(solid) => solid.grid,
        Err(VoxelizeError::Thin { .. }) => {
            VoxelGrid::solid(frame, BitGrid::empty(frame.dims()).unwrap()).unwrap()
        }
        Err(error) => panic!("{error}"),
    }
}

/// All methods on all voxels against a predicate over voxel centres.
fn agrees(frame: Frame, mesh: &TriangleMesh, inside: impl Fn(Vec3) -> bool) {
    for test in [InsideTest::Auto, InsideTest::Winding, InsideTest::Parity, InsideTest::Vote] {
        let grid = on(frame, mesh, test);
        let [nx, ny, nz] = frame.dims().map(|n| n as u32);
        let mut count = 0;
        for voxel in (0..nz).flat_map(|k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k]))) {
            let expected = inside(frame.centre(voxel));
            assert_eq!(grid.occupancy().get(voxel), expected, "{test:?} at {:?}", frame.centre(voxel));
            count += usize::from(expected);
        }
        assert!(count > 0);
    }
}

#[test]
fn faces_through_voxel_centres_are_half_open() {
    // Centres at the integers 0..12; faces on integers pass through centres.
    let frame = Frame::new([12, 11, 10], [-0.5; 3], [1.0; 3]).unwrap();
    for (min, max) in [
        ([2.0, 3.0, 1.0], [7.0, 8.0, 9.0]),
        ([2.0, 3.0, 1.0], [3.0, 4.0, 2.0]),
        ([1.5, 3.0, 1.25], [7.0, 8.5, 6.0]),
        ([0.0, 0.0, 0.0], [11.0, 10.0, 9.0]),
        // Flat boxes with one layer of centres on a face.
        ([2.0, 3.0, 4.0], [9.0, 9.0, 4.5]),
        ([2.0, 2.75, 4.0], [9.0, 3.0 + 1e-12, 9.0]),
    ] {
        agrees(frame, &cuboid(min, max), |p| (0..3).all(|a| min[a] <= p[a] && p[a] < max[a]));
    }
}

/// A box with edges along the columns of an integer matrix, voxel centres on integers: inside or not is
/// decided in integers, ties by the first non-zero coordinate of the face's normal.
#[test]
fn rotated_boxes_match_integer_arithmetic() {
    let rotations: [[[i64; 3]; 3]; 3] = [
        [[2, 1, 2], [-2, 2, 1], [-1, -2, 2]],
        [[2, 3, 6], [3, -6, 2], [6, 2, -3]],
        [[3, 4, 0], [-4, 3, 0], [0, 0, 5]],
    ];
    for axes in rotations {
        for shift in [[20, 20, 20], [19, 21, 18]] {
            let half = [3i64, 2, 1];
            let unit = cuboid([-1.0; 3], [1.0; 3]);
            let mesh = moved(&unit, |p| {
                std::array::from_fn(|i| {
                    let edge = (0..3).map(|a| p[a] as i64 * half[a] * axes[a][i]).sum::<i64>();
                    (shift[i] + edge) as f64
                })
            });
            let mesh = if mesh.signed_volume() < 0.0 { inside_out(&mesh) } else { mesh };
            let frame = Frame::new([44, 42, 43], [-0.5; 3], [1.0; 3]).unwrap();
            let square: i64 = axes[0].iter().map(|x| x * x).sum();
            agrees(frame, &mesh, |p| {
                (0..3).all(|a| {
                    let along: i64 = (0..3).map(|i| (p[i] as i64 - shift[i]) * axes[a][i]).sum();
                    let first = axes[a].iter().find(|x| **x != 0).unwrap().signum();
                    // Displaced by an infinitesimal along +x, `along` moves in the direction of `first`.
                    let low = (along + half[a] * square, first) > (0, 0);
                    let high = (half[a] * square - along, -first) > (0, 0);
                    low && high
                })
            });
        }
    }
}

/// The octahedron |x| + |y| + |z| < r: vertices and edges on grid lines.
#[test]
fn vertices_on_grid_lines_are_counted_once() {
    let frame = Frame::new([15, 15, 15], [-7.5; 3], [1.0; 3]).unwrap();
    let mesh = sphere([0.0; 3], 6.0, 0);
    // A point on the surface is inside if +x leads in, that is, if x < 0; with x = 0, if y < 0; then z.
    agrees(frame, &mesh, |p| {
        let sum: f64 = p.iter().map(|x| x.abs()).sum();
        sum < 6.0 || sum == 6.0 && p[0] < 0.0
    });
}

/// Stretching the shape and the grid alike, by powers of two, changes no voxel and no link.
#[test]
fn voxels_may_be_longer_along_one_axis() {
    let stretch = [1.0, 0.25, 4.0];
    let mesh = together(&[sphere([6.0, 5.5, 5.0], 4.2, 4), sphere([7.0, 5.5, 13.4], 4.2, 4)]);
    let stretched = moved(&mesh, |p| std::array::from_fn(|a| p[a] * stretch[a]));
    let dims = [14, 12, 19];
    for connectivity in [Connectivity::Six, Connectivity::TwentySix] {
        let solid = |mesh: &TriangleMesh, spacing: Vec3| {
            let frame = Some(Frame::new(dims, [0.0; 3], spacing).unwrap());
            let parameters =
                VoxelizeParameters { frame, connectivity, largest_only: false, ..Default::default() };
            voxelize(mesh, &parameters).unwrap().grid
        };
        let (cubes, bars) = (solid(&mesh, [1.0; 3]), solid(&stretched, stretch));
        assert_eq!(cubes.occupancy(), bars.occupancy());
        assert_eq!((cubes.links(), cubes.cut_diagonals()), (bars.links(), bars.cut_diagonals()));
        assert!(cubes.len() > 500);
    }
}

/// Spacing and first corner as given: the grid that a frame with the same numbers makes.
#[test]
fn the_grid_starts_at_the_given_origin() {
    let mesh = sphere([1.0, 2.0, 3.0], 1.0, 4);
    let (spacing, origin) = ([0.1, 0.2, 0.05], [-0.5, 0.7, 1.9]);
    let parameters =
        VoxelizeParameters { pitch: Pitch::Spacing(spacing), origin: Some(origin), ..Default::default() };
    let solid = voxelize(&mesh, &parameters).unwrap();
    let frame = *solid.grid.frame();
    assert_eq!((frame.origin(), frame.spacing(), frame.dims()), (origin, spacing, [26, 13, 43]));
    assert_eq!(voxelize(&mesh, &VoxelizeParameters { frame: Some(frame), ..parameters.clone() }), Ok(solid));
    let around = voxelize(&mesh, &VoxelizeParameters { origin: None, ..parameters.clone() }).unwrap();
    assert!((around.grid.frame().origin()[1] - 0.8).abs() < 1e-12);
    let away = VoxelizeParameters { origin: Some([9.0; 3]), ..parameters.clone() };
    assert_eq!(voxelize(&mesh, &away), Err(VoxelizeError::OutsideFrame));
    for (pitch, origin) in [([0.1, 0.0, 0.1], [0.0; 3]), ([0.1; 3], [f64::NAN, 0.0, 0.0])] {
        let bad =
            VoxelizeParameters { pitch: Pitch::Spacing(pitch), origin: Some(origin), ..Default::default() };
        assert!(matches!(voxelize(&mesh, &bad), Err(VoxelizeError::InvalidParameter(_))));
    }
}

#[test]
fn opening_drops_thin_parts_and_closing_fills_slits() {
    let solid = |mesh: &TriangleMesh, morphology| {
        let frame = Some(Frame::new([24; 3], [0.0; 3], [1.0; 3]).unwrap());
        voxelize(mesh, &VoxelizeParameters { frame, morphology, ..Default::default() }).unwrap().grid.len()
    };
    let block = cuboid([4.0; 3], [14.0; 3]);
    assert_eq!(solid(&block, None), 1000);
    assert_eq!(solid(&block, Some(Morphology::Close)), 1000);
    // A block loses its edges and corners only.
    assert_eq!(solid(&block, Some(Morphology::Open)), 1000 - 12 * 8 - 8);
    let with_rod = together(&[block, cuboid([13.0, 8.0, 8.0], [20.0, 9.0, 9.0])]);
    assert_eq!(solid(&with_rod, None), 1006);
    // The rod's root has all its neighbours; the rest goes.
    assert_eq!(solid(&with_rod, Some(Morphology::Open)), 1000 - 12 * 8 - 8 + 1);
    let pair = together(&[cuboid([4.0; 3], [9.0, 14.0, 14.0]), cuboid([10.0, 4.0, 4.0], [14.0; 3])]);
    assert_eq!(solid(&pair, None), 500);
    // All of the slit but its rim, which is open to two sides.
    assert_eq!(solid(&pair, Some(Morphology::Close)), 1000 - 36);
}

#[test]
fn a_sphere_has_its_volume_and_methods_agree() {
    let mesh = sphere([0.1, -0.2, 0.3], 1.0, 5);
    let parameters = VoxelizeParameters { pitch: Pitch::Voxels(50_000), ..Default::default() };
    let solid = voxelize(&mesh, &parameters).unwrap();
    let pitch = (mesh.signed_volume() / 50_000.0).cbrt();
    assert_eq!(solid.grid.frame().spacing(), [pitch; 3]);
    assert!((solid.grid.len() as f64 / 50_000.0 - 1.0).abs() < 2e-3, "{}", solid.grid.len());
    assert_eq!((solid.inside, solid.reason), (InsideTest::Winding, Reason::Closed));
    assert_eq!((solid.confidence, solid.cut_links, solid.dropped_voxels), (1.0, 0, 0));
    let frame = *solid.grid.frame();
    for test in [InsideTest::Parity, InsideTest::Vote] {
        assert_eq!(on(frame, &mesh, test).occupancy(), solid.grid.occupancy());
    }
}

/// Random closed surfaces (tetrahedra with random corners on a coarse lattice, so that ties abound)
/// against exact rational tests of each centre.
#[test]
fn random_tetrahedra_match_exact_predicates() {
    let mut random = Random(7);
    for round in 0..200 {
        let corners: Vec<Vec3> =
            (0..4).map(|_| std::array::from_fn(|_| (random.next() * 9.0).floor())).collect();
        let faces = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        let mesh = TriangleMesh::new(corners.clone(), faces).unwrap();
        let volume = mesh.signed_volume();
        if volume == 0.0 {
            continue;
        }
        let mesh = if volume < 0.0 { inside_out(&mesh) } else { mesh };
        let frame = Frame::new([10; 3], [-0.5; 3], [1.0; 3]).unwrap();
        let occupancy = on(frame, &mesh, InsideTest::Winding).occupancy().clone();
        for test in [InsideTest::Parity, InsideTest::Vote] {
            assert_eq!(on(frame, &mesh, test).occupancy(), &occupancy, "round {round}");
        }
        for voxel in (0..1000).map(|i| [i % 10, i / 10 % 10, i / 100]) {
            let p = voxel.map(i64::from);
            let behind = mesh.triangles().iter().all(|t| {
                let [a, b, c] = t.map(|v| mesh.vertices()[v as usize].map(|x| x as i64));
                let (e, f): ([i64; 3], [i64; 3]) =
                    (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
                let normal =
                    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]];
                let height: i64 = (0..3).map(|i| normal[i] * (p[i] - a[i])).sum();
                (height, normal) < (0, [0; 3])
            });
            assert_eq!(occupancy.get(voxel), behind, "round {round}, voxel {voxel:?}");
        }
    }
}

#[test]
fn coordinates_far_from_one_and_far_from_the_origin() {
    let reference = sphere([0.0; 3], 1.0, 3);
    let parameters = VoxelizeParameters { pitch: Pitch::Resolution(32), ..Default::default() };
    let expected = voxelize(&reference, &parameters).unwrap().grid.len();
    for scale in [1e-30, 1e30, 2f64.powi(-300), 2f64.powi(200)] {
        let mesh = moved(&reference, |p| p.map(|x| x * scale));
        let found = voxelize(&mesh, &parameters).unwrap().grid.len();
        assert!(found.abs_diff(expected) < 20, "{scale}: {found} for {expected}");
    }
    let far = moved(&reference, |p| p.map(|x| x + 1e9));
    let found = voxelize(&far, &parameters).unwrap().grid.len();
    assert!(found.abs_diff(expected) < expected / 50);
}

#[test]
fn one_thread_and_many_give_the_same_bits() {
    let mesh = together(&[sphere([0.0; 3], 1.0, 4), sphere([0.7, 0.3, 0.1], 0.8, 4)]);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| voxelize(&mesh, &VoxelizeParameters::default()).unwrap())
    };
    assert_eq!(run(1), run(2));
    assert_eq!(run(1), run(5));
}

/// What is foretold of a grid comes true, and nothing of it depends on the machine.
#[test]
fn an_estimate_knows_the_box() {
    let whole = sphere([0.0; 3], 1.0, 4);
    let mut random = Random(41);
    let open = altered(&whole, |_, t| (random.next() > 0.05).then_some(t));
    let never = || std::ops::ControlFlow::Continue(());
    for mesh in [&whole, &open] {
        let mut last = 0.0;
        for n in [5_000, 45_000, 400_000] {
            let parameters = VoxelizeParameters { pitch: Pitch::Voxels(n), ..Default::default() };
            let cost = estimate(mesh, &parameters, &never).unwrap();
            assert_eq!(cost, estimate(mesh, &parameters, &never).unwrap());
            assert_eq!(cost.dims, voxelize(mesh, &parameters).unwrap().grid.frame().dims());
            assert!(cost.seconds > last && cost.seconds < 10.0 && cost.bytes > n as f64);
            last = cost.seconds;
        }
        let default = estimate(mesh, &VoxelizeParameters::default(), &never).unwrap();
        assert_eq!(diagnose(mesh).cost, Some(default));
    }
    let time = |mesh| estimate(mesh, &VoxelizeParameters::default(), &never).unwrap().seconds;
    assert!(time(&open) > 2.0 * time(&whole));
}
