//! Meshes with faults: the solid is that of the whole mesh, and the diagnosis names the fault.

use crate::common::*;
use mser3d_shape::{BitGrid, Frame, TriangleMesh};
use mser3d_voxelize::*;

/// A figure with limbs: a sphere pulled out along the diagonals; 8192 triangles.
fn figure() -> TriangleMesh {
    moved(&sphere([0.0; 3], 1.0, 5), |p| {
        let reach = 1.0 + 6.0 * (p[0] * p[1] * p[2]).abs().powi(2) * 27.0;
        p.map(|x| x * reach * 0.5 + 0.01)
    })
}

fn parameters(resolution: usize) -> VoxelizeParameters {
    VoxelizeParameters { pitch: Pitch::Resolution(resolution), largest_only: false, ..Default::default() }
}

fn differing(a: &BitGrid, b: &BitGrid) -> usize {
    a.words().iter().zip(b.words()).map(|(a, b)| (a ^ b).count_ones() as usize).sum()
}

/// The wrong voxels of a damaged mesh, as a part of all inside.
fn error_on(whole: &TriangleMesh, damaged: &TriangleMesh, test: InsideTest) -> f64 {
    let reference = voxelize(whole, &parameters(96)).unwrap();
    let frame = Some(*reference.grid.frame());
    let found = voxelize(damaged, &VoxelizeParameters { frame, inside: test, ..parameters(96) }).unwrap();
    differing(reference.grid.occupancy(), found.grid.occupancy()) as f64 / reference.grid.len() as f64
}

fn with_holes(mesh: &TriangleMesh, share: f64, seed: u64) -> TriangleMesh {
    let mut random = Random(seed);
    altered(mesh, |_, t| (random.next() >= share).then_some(t))
}

fn with_flips(mesh: &TriangleMesh, share: f64, seed: u64) -> TriangleMesh {
    let mut random = Random(seed);
    altered(mesh, |_, [a, b, c]| Some(if random.next() < share { [a, c, b] } else { [a, b, c] }))
}

#[test]
fn a_percent_of_the_triangles_missing() {
    for mesh in [figure(), sphere([0.0; 3], 1.0, 5)] {
        let open = with_holes(&mesh, 0.01, 3);
        let diagnosis = diagnose(&open);
        assert!(!diagnosis.closed && diagnosis.boundary_edges > 100 && diagnosis.boundary_loops > 30);
        assert!(matches!(diagnosis.reason, Reason::Open { turned: 0, .. }));
        let error = error_on(&mesh, &open, InsideTest::Auto);
        assert!(error < 1e-3, "{error}");
        let (parity, vote) =
            (error_on(&mesh, &open, InsideTest::Parity), error_on(&mesh, &open, InsideTest::Vote));
        assert!(parity > 10.0 * error && parity > 3.0 * vote, "{parity} {vote}");
    }
}

#[test]
fn a_fifth_of_the_triangles_flipped() {
    let mesh = figure();
    let flipped = with_flips(&mesh, 0.2, 5);
    let diagnosis = diagnose(&flipped);
    assert!(matches!(diagnosis.reason, Reason::ClosedAfterTurning { turned: 1400..1900 }));
    assert!(diagnosis.inconsistent_edges > 1000);
    assert_eq!(error_on(&mesh, &flipped, InsideTest::Auto), 0.0);
    assert_eq!(error_on(&mesh, &flipped, InsideTest::Parity), 0.0);
    assert!((diagnosis.volume / mesh.signed_volume() - 1.0).abs() < 1e-12);
}

#[test]
fn missing_and_flipped_triangles_together() {
    let mesh = figure();
    let damaged = with_flips(&with_holes(&mesh, 0.01, 7), 0.2, 9);
    let diagnosis = diagnose(&damaged);
    assert!(matches!(diagnosis.reason, Reason::Open { boundary_edges: 100.., turned: 1400..1900 }));
    let error = error_on(&mesh, &damaged, InsideTest::Auto);
    assert!(error < 1e-3, "{error}");
}

#[test]
fn the_pitch_for_a_count_holds_on_damaged_meshes() {
    let mesh = figure();
    let damaged = with_flips(&with_holes(&mesh, 0.01, 11), 0.2, 13);
    for mesh in [&mesh, &damaged, &inside_out(&mesh)] {
        let solid = voxelize(mesh, &VoxelizeParameters::default()).unwrap();
        assert!((solid.grid.len() as f64 / 45_000.0 - 1.0).abs() < 0.02, "{}", solid.grid.len());
    }
}

#[test]
fn faces_and_vertices_twice() {
    let mesh = figure();
    let mut random = Random(15);
    let mut triangles = mesh.triangles().to_vec();
    for &[a, b, c] in mesh.triangles() {
        if random.next() < 0.05 {
            triangles.push(if random.next() < 0.5 { [b, c, a] } else { [a, c, b] });
        }
    }
    let repeated = TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap();
    let diagnosis = diagnose(&repeated);
    assert!((300..520).contains(&diagnosis.duplicate_triangles));
    assert_eq!(error_on(&mesh, &repeated, InsideTest::Auto), 0.0);

    // Each triangle with vertices of its own, as in an STL file.
    let loose = mesh.triangles().iter().flatten().map(|&v| mesh.vertices()[v as usize]).collect();
    let triangles = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let loose = TriangleMesh::new(loose, triangles).unwrap();
    let diagnosis = diagnose(&loose);
    assert!(!diagnosis.closed && diagnosis.closed_when_merged);
    assert_eq!(error_on(&mesh, &loose, InsideTest::Auto), 0.0);

    let copies = together(&[mesh.clone(), mesh.clone()]);
    assert_eq!(error_on(&mesh, &copies, InsideTest::Auto), 0.0);
}

/// The faces of a mesh, then those that `again` makes of each.
fn repeated(mesh: &TriangleMesh, again: impl Fn(usize, [u32; 3]) -> Option<[u32; 3]>) -> TriangleMesh {
    let mut triangles = mesh.triangles().to_vec();
    triangles.extend(mesh.triangles().iter().enumerate().filter_map(|(i, &t)| again(i, t)));
    TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap()
}

#[test]
fn every_face_twice_is_counted_once() {
    let (mesh, open) = (figure(), with_holes(&figure(), 0.01, 25));
    let turned = |[a, b, c]: [u32; 3]| [a, c, b];
    let alternating = |i: usize, t: [u32; 3]| Some(if i.is_multiple_of(2) { t } else { turned(t) });
    for whole in [&mesh, &open] {
        let volume = diagnose(whole).volume;
        for twice in [
            repeated(whole, |_, t| Some(t)),
            repeated(whole, |_, t| Some(turned(t))),
            repeated(whole, alternating),
            repeated(&repeated(whole, |_, t| Some(t)), |i, t| (i < whole.triangles().len()).then_some(t)),
        ] {
            let diagnosis = diagnose(&twice);
            let extra = twice.triangles().len() - whole.triangles().len();
            assert_eq!(diagnosis.duplicate_triangles, extra);
            assert!((diagnosis.volume / volume - 1.0).abs() < 1e-9);
            let error = error_on(&mesh, &twice, InsideTest::Auto);
            assert!(error < if whole == &mesh { 1e-12 } else { 1e-3 }, "{error}");
            let solid = voxelize(&twice, &VoxelizeParameters::default()).unwrap();
            assert!((solid.grid.len() as f64 / 45_000.0 - 1.0).abs() < 0.02, "{}", solid.grid.len());
            assert!(solid.warnings.contains(&Warning::Duplicates { triangles: extra, dropped: true }));
        }
    }
    // One body of two.
    let ball = sphere([4.0, 0.0, 0.0], 1.0, 4);
    let both = together(&[mesh.clone(), ball.clone()]);
    let one_twice = together(&[repeated(&mesh, |_, t| Some(t)), ball]);
    assert_eq!(error_on(&both, &one_twice, InsideTest::Auto), 0.0);
}

/// Two boxes that share the corners of a wall have it twice, and need it twice.
#[test]
fn a_wall_between_rooms_is_no_repetition() {
    let (left, right) = (cuboid([-1.0; 3], [0.0, 1.0, 1.0]), cuboid([0.0, -1.0, -1.0], [1.0; 3]));
    let both = together(&[left, right]);
    let first = |v: u32| {
        let p = both.vertices()[v as usize];
        both.vertices().iter().position(|q| *q == p).unwrap() as u32
    };
    let shared = altered(&both, |_, t| Some(t.map(first)));
    // The wall's border, and the diagonal of its two faces.
    assert_eq!(diagnose(&shared).non_manifold_edges, 5);
    let solid = voxelize(&shared, &VoxelizeParameters { overlap: Overlap::Part, ..parameters(30) }).unwrap();
    assert_eq!((solid.grid.components().len(), solid.grid.volume()), (2, 8.0));
    assert!(solid.warnings.iter().all(|w| !matches!(w, Warning::Duplicates { dropped: true, .. })));
}

#[test]
fn a_solid_that_is_covered_twice_all_over_is_said_to_be() {
    let copies = together(&[figure(), figure()]);
    let parted = VoxelizeParameters { overlap: Overlap::Part, ..parameters(48) };
    let error = voxelize(&copies, &parted).unwrap_err();
    assert!(matches!(error, VoxelizeError::Doubled { voxels: 1000.. }), "{error}");
    assert!((diagnose(&copies).overlap_fraction.unwrap() - 1.0).abs() < 1e-12);
}

#[test]
fn overlapping_bodies_are_a_union_and_parity_cancels() {
    let (a, b) = (sphere([0.0; 3], 1.0, 5), sphere([0.8, 0.3, 0.1], 0.9, 5));
    let both = together(&[a.clone(), b.clone()]);
    let union = voxelize(&both, &parameters(96)).unwrap();
    let frame = Some(*union.grid.frame());
    let on = |mesh: &TriangleMesh, test, overlap| {
        let parameters = VoxelizeParameters { frame, inside: test, overlap, ..parameters(96) };
        voxelize(mesh, &parameters).unwrap()
    };
    let (a, b) = (on(&a, InsideTest::Auto, Overlap::Auto), on(&b, InsideTest::Auto, Overlap::Auto));
    let words = |f: fn(u64, u64) -> u64| -> Vec<u64> {
        a.grid.occupancy().words().iter().zip(b.grid.occupancy().words()).map(|(a, b)| f(*a, *b)).collect()
    };
    assert_eq!(union.grid.occupancy().words(), words(|a, b| a | b));
    // The crease between the bodies may part a few neighbours, but not the bodies.
    assert!(union.cut_links < 30 && union.grid.components().len() == 1);
    assert_eq!(on(&both, InsideTest::Winding, Overlap::Join).grid, union.grid);
    assert_eq!(on(&both, InsideTest::Winding, Overlap::Part).grid.occupancy().words(), words(|a, b| a ^ b));
    assert_eq!(on(&both, InsideTest::Parity, Overlap::Auto).grid.occupancy().words(), words(|a, b| a ^ b));
    let doubled: u32 = words(|a, b| a & b).iter().map(|w| w.count_ones()).sum();
    let volume = f64::from(doubled) * union.grid.frame().voxel_volume();
    assert!((union.overlap_volume / volume - 1.0).abs() < 1e-12);
    assert!(diagnose(&both).overlap_fraction.unwrap() > 0.1);
    assert_eq!(diagnose(&both).components, 2);
}

#[test]
fn overlapping_open_bodies_are_a_union_too() {
    let whole = together(&[sphere([0.0; 3], 1.0, 5), sphere([0.8, 0.3, 0.1], 0.9, 5)]);
    let error = error_on(&whole, &with_holes(&whole, 0.01, 17), InsideTest::Auto);
    assert!(error < 1e-3, "{error}");
}

#[test]
fn an_inner_shell_is_a_cavity() {
    let (outer, inner) = (sphere([0.0; 3], 1.0, 5), sphere([0.1, 0.0, 0.0], 0.6, 4));
    let volume = outer.signed_volume() - inner.signed_volume();
    let hollow = together(&[outer, inside_out(&inner)]);
    assert_eq!((diagnose(&hollow).cavities, diagnose(&hollow).inverted_bodies), (1, 0));
    for (mesh, test) in [
        (&hollow, InsideTest::Auto),
        (&inside_out(&hollow), InsideTest::Auto),
        (&hollow, InsideTest::Parity),
        (&with_holes(&hollow, 0.01, 19), InsideTest::Auto),
    ] {
        let solid = voxelize(mesh, &VoxelizeParameters { inside: test, ..parameters(96) }).unwrap();
        assert!((solid.grid.volume() / volume - 1.0).abs() < 5e-3);
        assert!(!solid.grid.occupancy().get(solid.grid.frame().locate([0.1, 0.0, 0.0]).map(|x| x as u32)));
    }
    // A body on its own that faces inwards is no cavity.
    let beside = together(&[sphere([0.0; 3], 1.0, 4), inside_out(&sphere([3.0, 0.0, 0.0], 0.7, 4))]);
    let solid = voxelize(&beside, &parameters(96)).unwrap();
    assert!(solid.warnings.contains(&Warning::Inverted { bodies: 1 }));
    assert!(solid.grid.occupancy().get(solid.grid.frame().locate([3.0, 0.0, 0.0]).map(|x| x as u32)));
}

#[test]
fn a_fin_and_a_sheet_add_nothing() {
    let mesh = figure();
    let [a, b, _] = mesh.triangles()[100];
    let mut vertices = mesh.vertices().to_vec();
    vertices.push(vertices[a as usize].map(|x| 1.4 * x));
    let mut triangles = mesh.triangles().to_vec();
    triangles.push([a, b, vertices.len() as u32 - 1]);
    let finned = TriangleMesh::new(vertices, triangles).unwrap();
    assert_eq!(diagnose(&finned).non_manifold_edges, 1);
    assert!(error_on(&mesh, &finned, InsideTest::Auto) < 1e-3);

    // A sheet of two faces back to back, through the inside and out.
    let corners = vec![[-1.1, -0.9, 0.013], [1.2, -0.8, 0.013], [0.1, 1.3, 0.013]];
    let sheet = TriangleMesh::new(corners, vec![[0, 1, 2], [0, 2, 1]]).unwrap();
    let both = together(&[mesh.clone(), sheet]);
    assert_eq!((diagnose(&mesh).flat_bodies, diagnose(&both).flat_bodies), (0, 1));
    assert_eq!(error_on(&mesh, &both, InsideTest::Auto), 0.0);
    assert_eq!(
        voxelize(&both, &parameters(96)).unwrap().cut_links,
        voxelize(&mesh, &parameters(96)).unwrap().cut_links
    );
}

#[test]
fn a_one_sided_surface_is_said_to_be_one() {
    // A Moebius strip of 24 quads.
    let vertices: Vec<Vec3> = (0..24)
        .flat_map(|i| {
            let (turn, twist) =
                (f64::from(i) / 24.0 * std::f64::consts::TAU, f64::from(i) / 24.0 * std::f64::consts::PI);
            [-0.3, 0.3].map(|w: f64| {
                let r = 1.0 + w * twist.cos();
                [r * turn.cos(), r * turn.sin(), w * twist.sin()]
            })
        })
        .collect();
    let triangles = (0..24u32)
        .flat_map(|i| {
            let (a, b) = (2 * i, 2 * i + 1);
            let (c, d) = if i < 23 { (a + 2, b + 2) } else { (1, 0) };
            [[a, b, c], [c, b, d]]
        })
        .collect();
    let diagnosis = diagnose(&TriangleMesh::new(vertices, triangles).unwrap());
    assert_eq!((diagnosis.one_sided_components, diagnosis.boundary_loops, diagnosis.genus), (1, 1, None));
    assert!(matches!(diagnosis.reason, Reason::OneSidedAndOpen { components: 1, .. }));
}

#[test]
fn euler_characteristic_and_genus() {
    assert_eq!((diagnose(&figure()).euler_characteristic, diagnose(&figure()).genus), (2, Some(0)));
    let diagnosis = diagnose(&torus(24, 12));
    assert_eq!((diagnosis.euler_characteristic, diagnosis.genus, diagnosis.closed), (0, Some(1), true));
}

#[test]
fn bad_input_is_a_clear_error() {
    let error =
        |mesh: &TriangleMesh, parameters: &VoxelizeParameters| voxelize(mesh, parameters).unwrap_err();
    let default = VoxelizeParameters::default();
    let empty = TriangleMesh::new(vec![], vec![]).unwrap();
    assert_eq!(error(&empty, &default), VoxelizeError::NoTriangles);
    assert_eq!((diagnose(&empty).closed, diagnose(&empty).bounding_box), (false, None));
    let one = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    assert!(matches!(error(&one, &default), VoxelizeError::NoVolume { triangles: 1, boundary_edges: 3 }));
    let point = TriangleMesh::new(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    assert!(matches!(error(&point, &default), VoxelizeError::NoVolume { .. }));

    let ball = sphere([0.0; 3], 1.0, 3);
    let fine = VoxelizeParameters { pitch: Pitch::Size(2e-4), ..Default::default() };
    let VoxelizeError::TooLarge { voxels, advice, .. } = error(&ball, &fine) else { panic!() };
    assert!(voxels > 1e12 && advice > 1e-3);
    let advised =
        VoxelizeParameters { pitch: Pitch::Size(advice), max_box_voxels: 1 << 32, ..Default::default() };
    assert!(!matches!(voxelize(&sphere([0.0; 3], 0.001, 1), &advised), Err(VoxelizeError::TooLarge { .. })));
    let finest = VoxelizeParameters { pitch: Pitch::Size(1e-300), ..Default::default() };
    assert!(matches!(error(&ball, &finest), VoxelizeError::TooLarge { .. }));
    let coarse = VoxelizeParameters { pitch: Pitch::Size(1.0), ..Default::default() };
    let plate = cuboid([0.0, 0.0, 0.3], [10.0, 10.0, 0.4]);
    let frame = Frame::new([12, 12, 3], [-1.0; 3], [1.0; 3]).unwrap();
    let VoxelizeError::Thin { advice, .. } =
        error(&plate, &VoxelizeParameters { frame: Some(frame), ..coarse })
    else {
        panic!()
    };
    assert!(advice < 0.1);
    assert!(
        voxelize(&plate, &VoxelizeParameters { pitch: Pitch::Size(advice), ..Default::default() }).is_ok()
    );
    let away = Frame::new([4; 3], [9.0; 3], [0.1; 3]).unwrap();
    assert_eq!(
        error(&ball, &VoxelizeParameters { frame: Some(away), ..Default::default() }),
        VoxelizeError::OutsideFrame
    );
    let far = moved(&ball, |p| p.map(|x| x + 1e16));
    assert!(matches!(
        error(&far, &default),
        VoxelizeError::Imprecise { .. } | VoxelizeError::NoVolume { .. }
    ));
    for pitch in [Pitch::Size(-1.0), Pitch::Size(f64::NAN), Pitch::Voxels(0), Pitch::Resolution(0)] {
        let bad = VoxelizeParameters { pitch, ..Default::default() };
        assert!(matches!(error(&ball, &bad), VoxelizeError::InvalidParameter(_)));
    }
}
