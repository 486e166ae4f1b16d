//! Neighbours that the surface parts are not linked; all others are.

use crate::common::*;
use mser3d_shape::{Connectivity, Frame, TriangleMesh, VoxelGrid};
use mser3d_voxelize::*;

fn solid(mesh: &TriangleMesh, parameters: VoxelizeParameters) -> Voxelization {
    voxelize(mesh, &VoxelizeParameters { largest_only: false, ..parameters }).unwrap()
}

fn at(pitch: f64, origin: Vec3, reach: f64) -> VoxelizeParameters {
    let dims = origin.map(|x| ((reach - x) / pitch).ceil() as usize);
    VoxelizeParameters {
        frame: Some(Frame::new(dims, origin, [pitch; 3]).unwrap()),
        largest_only: false,
        ..Default::default()
    }
}

fn offsets(seed: u64) -> impl Iterator<Item = (f64, Vec3)> {
    let mut random = Random(seed);
    (0..12).map(move |i| {
        let pitch = 0.07 + 0.11 * random.next();
        let shift: Vec3 = std::array::from_fn(|_| random.next() * pitch);
        // The first ones put centres onto the lattice of the shapes' own coordinates.
        if i < 3 { ([0.125, 0.25, 0.0625][i], [-3.0; 3]) } else { (pitch, shift.map(|x| x - 3.0)) }
    })
}

/// Two boxes that share a face are one solid, as those that overlap are; with a gap, or when overlaps are
/// parted, they are two.
#[test]
fn bodies_in_contact_are_one_solid() {
    let boxes = |gap: f64| {
        together(&[cuboid([-1.0; 3], [0.0, 1.0, 1.0]), cuboid([gap, -0.7, -1.0], [1.0, 1.0, 0.6])])
    };
    for (pitch, origin) in offsets(1) {
        for (axis, angle) in [
            ([0.0, 0.0, 1.0], 0.0),
            ([0.0, 0.0, 1.0], std::f64::consts::FRAC_PI_2),
            ([0.0, 1.0, 0.0], std::f64::consts::FRAC_PI_4),
            ([1.0, 2.0, 3.0], 0.7),
            ([-3.0, 1.0, 1.0], 2.3),
        ] {
            let solid_at = |gap: f64, parameters: VoxelizeParameters| {
                solid(&moved(&boxes(gap), rotation(axis, angle)), parameters)
            };
            // A turned box may leave a voxel at its corner that no face joins.
            let parts = |gap: f64, parameters: VoxelizeParameters| {
                solid_at(gap, parameters).grid.components().sizes.iter().filter(|&&n| n > 2).count()
            };
            let what = format!("pitch {pitch}, rotation {axis:?} by {angle}");
            assert_eq!(parts(0.0, at(pitch, origin, 3.0)), 1, "{what}");
            let touching = solid_at(0.0, at(pitch, origin, 3.0));
            let glued = solid_at(0.0, VoxelizeParameters { cut_links: false, ..at(pitch, origin, 3.0) });
            // At the contact's rim a link may pass from one body by the outside to the other.
            let links = |grid: &VoxelGrid| grid.links().iter().map(|l| l.count_ones()).sum::<usize>();
            assert!(touching.cut_links < 20, "{what}: {} cut", touching.cut_links);
            assert_eq!(links(&touching.grid) + touching.cut_links, links(&glued.grid), "{what}");
            assert_eq!(parts(1e-6, at(pitch, origin, 3.0)), 2, "{what}");
            let part = VoxelizeParameters { overlap: Overlap::Part, ..at(pitch, origin, 3.0) };
            assert_eq!(parts(0.0, part), 2, "{what}");
        }
    }
}

/// Files of bodies that touch, overlap or nearly touch: volume and number of components.
#[test]
fn files_of_bodies_in_contact() {
    for (file, volume, components) in [
        ("same_face", 2.0, 1),
        ("same_face_welded", 2.0, 1),
        ("small_on_large", 4.64, 1),
        ("overlap", 2.0, 1),
        ("gap", 1.8, 2),
        ("gap_tiny", 1.9999, 2),
    ] {
        let Some(mesh) = shared(&format!("cases/touching/{file}.off")) else { continue };
        let solid = solid(&mesh, VoxelizeParameters::default());
        assert_eq!(solid.grid.component_count(), components, "{file}");
        assert!((solid.grid.volume() / volume - 1.0).abs() < 0.03, "{file}: {}", solid.grid.volume());
        assert_eq!(solid.cut_links > 0, file == "gap_tiny", "{file}");
    }
}

/// Two balls that touch in a point, and that come closer than a voxel.
#[test]
fn balls_in_contact_are_parted() {
    for gap in [0.0, 1e-13, 1e-6, 0.01] {
        let balls = together(&[
            sphere([-1.0 - gap / 2.0, 0.0, 0.0], 1.0, 4),
            sphere([1.0 + gap / 2.0, 0.0, 0.0], 1.0, 4),
        ]);
        for (pitch, origin) in offsets(2) {
            for angle in [0.0, 0.3, 1.1, std::f64::consts::FRAC_PI_4, 2.6] {
                let mesh = moved(&balls, rotation([1.0, 3.0, 2.0], angle));
                let result = solid(&mesh, at(pitch, origin, 3.0));
                let large = result.grid.components().sizes.iter().filter(|&&n| n > 50).count();
                assert_eq!(large, 2, "gap {gap}, pitch {pitch}, angle {angle}");
            }
        }
    }
}

/// One connected surface: a slab folded like a U, its arms a hundredth of a voxel apart.
fn folded(gap: f64) -> TriangleMesh {
    let (outer, inner) = (1.0, gap / 2.0);
    // Outline in the xz plane, counter-clockwise seen from -y; the slot is open at +x.
    let outline = [
        [-1.5, -outer],
        [1.5, -outer],
        [1.5, -inner],
        [-0.7, -inner],
        [-0.7, inner],
        [1.5, inner],
        [1.5, outer],
        [-1.5, outer],
    ];
    let ring = |y: f64| outline.map(|[x, z]| [x, y, z]);
    let vertices: Vec<Vec3> = ring(-1.0).into_iter().chain(ring(1.0)).collect();
    // The cross-section in triangles.
    let section = [[0u32, 1, 2], [0, 2, 3], [0, 3, 7], [3, 4, 7], [4, 5, 6], [4, 6, 7]];
    let mut triangles: Vec<[u32; 3]> = section.to_vec();
    triangles.extend(section.map(|[a, b, c]| [a + 8, c + 8, b + 8]));
    for i in 0..8 {
        let j = (i + 1) % 8;
        triangles.extend([[j, i, i + 8], [j, i + 8, j + 8]]);
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn a_slot_of_a_hundredth_of_a_voxel_parts_the_arms() {
    for (pitch, origin) in offsets(3) {
        for angle in [0.0, 0.4, 1.3, 2.2] {
            let mesh = moved(&folded(0.01 * pitch), rotation([0.0, 1.0, 0.3], angle));
            let diagnosis = diagnose(&mesh);
            assert!(diagnosis.closed && diagnosis.signed_volume > 0.0 && diagnosis.genus == Some(0));
            let result = solid(&mesh, at(pitch, origin, 3.0));
            let turn = rotation([0.0, 1.0, 0.3], -angle);
            let grid = &result.grid;
            let centres: Vec<Vec3> = grid.voxels().map(|v| turn(grid.frame().centre(v))).collect();
            // No link leads from arm to arm through the slot.
            for axis in 0..3 {
                for [u, v] in grid.linked_pairs(axis) {
                    let (p, q) = (centres[u as usize], centres[v as usize]);
                    assert!(p[0].min(q[0]) < -0.7 || p[2] * q[2] > 0.0, "{p:?} to {q:?} at pitch {pitch}");
                }
            }
            assert_eq!(grid.components().sizes.iter().filter(|&&n| n > 20).count(), 1);
            assert!(result.cut_links > 0);
        }
    }
}

/// The definition, link by link: cut if and only if the segment crosses the surface twice or more.
/// Crossings are counted with another algorithm, for centres in general position.
#[test]
fn links_follow_the_definition_for_one_body() {
    let mesh = moved(&folded(0.02), rotation([1.0, 2.0, 0.5], 0.9));
    let parameters = at(0.11, [-3.0, -2.99, -3.01], 3.0);
    let grid = solid(&mesh, parameters).grid;
    let bvh = Bvh::new(&mesh);
    for axis in 0..3 {
        for (number, voxel) in grid.voxels().enumerate() {
            let mut next = voxel;
            next[axis] += 1;
            let Some(other) = grid.index(next) else { continue };
            let count = bvh.crossings(grid.frame().centre(voxel), grid.frame().centre(next));
            let linked = grid.links()[axis].get(voxel);
            assert_eq!(linked, count < 2, "{number} to {other}: {count} crossings");
        }
    }
}

/// The same for all 26 neighbours, and the 6-neighbour links are those of the plain grid.
#[test]
fn diagonal_links_follow_the_definition() {
    let mesh = moved(&folded(0.02), rotation([1.0, 2.0, 0.5], 0.9));
    let plain = at(0.11, [-3.0, -2.99, -3.01], 3.0);
    let parameters = VoxelizeParameters { connectivity: Connectivity::TwentySix, ..plain.clone() };
    let grid = solid(&mesh, parameters).grid;
    assert_eq!(grid.links(), solid(&mesh, plain).grid.links());
    let bvh = Bvh::new(&mesh);
    let voxels: Vec<[u32; 3]> = grid.voxels().collect();
    let cut = grid.cut_diagonals().unwrap();
    let mut seen = 0;
    for [u, v] in grid.diagonal_pairs() {
        let [p, q] = [u, v].map(|w| grid.frame().centre(voxels[w as usize]));
        let direction = std::array::from_fn(|a| q[a] - p[a]);
        let parted = bvh.all_hits(p, direction, 1.0).len() >= 2;
        assert_eq!(cut.binary_search(&[u, v]).is_ok(), parted);
        seen += usize::from(parted);
    }
    assert!(seen > 100 && seen == cut.len());

    // Boxes with a gap fall apart; in contact or overlapping they do not.
    for (x, parts) in [(1e-4, 2), (0.0, 1), (-0.02, 1)] {
        let boxes = together(&[cuboid([-1.0; 3], [0.0, 1.0, 1.0]), cuboid([x, -1.0, -1.0], [1.0; 3])]);
        for (pitch, origin) in offsets(8) {
            let parameters =
                VoxelizeParameters { connectivity: Connectivity::TwentySix, ..at(pitch, origin, 3.0) };
            let grid = solid(&boxes, parameters).grid;
            assert_eq!(
                grid.graph(Connectivity::TwentySix).unwrap().components().len(),
                parts,
                "pitch {pitch}"
            );
        }
    }
}

/// A surface that overlaps itself: two crossing arms of one ring-like band.
#[test]
fn a_body_that_overlaps_itself_is_parted_there() {
    // A ball and a displaced copy, joined by a thin tube, so that they are one connected surface.
    let mesh = self_overlapping();
    let diagnosis = diagnose(&mesh);
    assert!(diagnosis.closed && diagnosis.components == 1 && diagnosis.overlap_fraction.unwrap() > 0.02);
    let parted = solid(&mesh, VoxelizeParameters { pitch: Pitch::Resolution(64), ..Default::default() });
    let frame = Some(*parted.grid.frame());
    let joined = solid(&mesh, VoxelizeParameters { frame, overlap: Overlap::Join, ..Default::default() });
    assert!(parted.overlap_volume > 0.0);
    assert_eq!(parted.overlap_volume, joined.overlap_volume);
    let doubled = (parted.overlap_volume / parted.grid.frame().voxel_volume()).round() as usize;
    assert_eq!(joined.grid.len() - parted.grid.len(), doubled);
    assert!(parted.grid.len() > 5 * doubled);
    assert!(joined.grid.components().sizes.iter().filter(|&&n| n > 20).count() == 1);
}

/// A closed tube of square cross-section along a curve whose ends run through each other.
fn self_overlapping() -> TriangleMesh {
    let steps = 120u32;
    let mut vertices: Vec<Vec3> = Vec::new();
    for i in 0..=steps {
        let t = (f64::from(i) / f64::from(steps) - 0.5) * 6.6;
        // An arc of more than a full turn in the plane, with no pitch: its ends overlap.
        let (s, c) = t.sin_cos();
        for [a, b] in [[-0.3, -0.3], [0.3, -0.3], [0.3, 0.3], [-0.3, 0.3]] {
            vertices.push([(1.0 + a) * c, (1.0 + a) * s, b + 0.013 * t]);
        }
    }
    let mut triangles = Vec::new();
    for i in 0..steps {
        for j in 0..4 {
            let (a, b) = (4 * i + j, 4 * i + (j + 1) % 4);
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    let end = 4 * steps;
    triangles.extend([[0, 3, 2], [0, 2, 1], [end, end + 1, end + 2], [end, end + 2, end + 3]]);
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    if mesh.signed_volume() < 0.0 { inside_out(&mesh) } else { mesh }
}

#[test]
fn different_bodies_that_overlap_stay_joined() {
    for (pitch, origin) in offsets(4) {
        let mesh =
            together(&[cuboid([-1.0; 3], [0.02, 1.0, 1.0]), cuboid([-0.02, -0.9, -0.9], [1.0, 0.9, 0.9])]);
        let joined = solid(&mesh, at(pitch, origin, 3.0));
        assert_eq!((joined.grid.components().len(), joined.cut_links), (1, 0), "pitch {pitch}");
        let parted = solid(&mesh, VoxelizeParameters { overlap: Overlap::Part, ..at(pitch, origin, 3.0) });
        assert_eq!(parted.grid.components().len(), 2);
    }
}

/// Where the pitch resolves a shape, its solid has half the Euler characteristic of its surface.
#[test]
fn the_solid_has_the_topology_of_the_mesh() {
    let shell = together(&[sphere([0.0; 3], 1.0, 5), inside_out(&sphere([0.0; 3], 0.6, 5))]);
    let shapes = [
        (sphere([0.0; 3], 1.0, 5), 2),
        (torus(48, 24), 0),
        (shell, 4),
        (cuboid([-1.0; 3], [0.9, 0.8, 0.7]), 2),
    ];
    for (mesh, characteristic) in shapes {
        assert_eq!(diagnose(&mesh).euler_characteristic, characteristic);
        for (pitch, origin) in offsets(9) {
            for angle in [0.0, 0.8, 1.9] {
                let mesh = moved(&mesh, rotation([3.0, 1.0, 2.0], angle));
                // A rotated box may leave a voxel at its corner that no face joins.
                let parameters = VoxelizeParameters { largest_only: true, ..at(pitch / 2.0, origin, 3.0) };
                let result = voxelize(&mesh, &parameters).unwrap();
                assert!(result.dropped_voxels < 5);
                assert_eq!(2 * result.topology.euler_characteristic, characteristic, "{pitch} {angle}");
                assert!(!result.warnings.iter().any(|w| matches!(w, Warning::Topology { .. })));
            }
        }
    }
    // Too coarse for the hole of the torus, or for its tube.
    let coarse = solid(&torus(48, 24), VoxelizeParameters { pitch: Pitch::Size(1.1), ..Default::default() });
    assert!(
        coarse.warnings.iter().any(|w| matches!(w, Warning::Topology { mesh: 0, .. } | Warning::Thin { .. }))
    );
}

/// The same links from an open mesh as from the closed one, away from the holes.
#[test]
fn links_of_an_open_mesh() {
    let whole =
        moved(&together(&[sphere([-1.005, 0.0, 0.0], 1.0, 5), sphere([1.005, 0.0, 0.0], 1.0, 5)]), |p| p);
    let mut random = Random(5);
    let open = altered(&whole, |_, t| (random.next() > 0.005).then_some(t));
    for (pitch, origin) in offsets(6) {
        let (a, b) = (solid(&whole, at(pitch, origin, 3.0)), solid(&open, at(pitch, origin, 3.0)));
        let links = |grid: &VoxelGrid| grid.links().iter().map(|l| l.count_ones()).sum::<usize>();
        assert!(links(&a.grid).abs_diff(links(&b.grid)) * 500 < links(&a.grid));
        assert_eq!(b.grid.components().sizes.iter().filter(|&&n| n > 50).count(), 2, "pitch {pitch}");
    }
}
