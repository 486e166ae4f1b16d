//! Figures whose limbs come close, and real shapes, when they are there.

use crate::common::*;
use mser3d_voxelize::*;

#[test]
fn bodies_in_all_poses_are_one_solid_with_few_cut_links() {
    for (name, mesh) in real_shapes() {
        let solid = voxelize(&mesh, &VoxelizeParameters::default()).unwrap();
        let links: usize = solid.grid.links().iter().map(|l| l.count_ones()).sum();
        let share = solid.cut_links as f64 / links as f64;
        eprintln!(
            "{name}: {} voxels, {links} links, {} cut, {:?}",
            solid.grid.len(),
            solid.cut_links,
            solid.warnings
        );
        assert_eq!(solid.reason, Reason::Closed, "{name}");
        assert!((solid.grid.len() as f64 / 45_000.0 - 1.0).abs() < 0.03, "{name}: {}", solid.grid.len());
        assert!(share < 0.006, "{name}: {share}");
        assert!(solid.dropped_voxels < 450, "{name}");
        assert_eq!(solid.confidence, 1.0);
    }
}

/// The figure whose hand comes within 3 mm of its thigh: no link leads from what is hand to what is thigh at
/// rest, at any pitch and rotation; without cut links some do.
#[test]
fn a_hand_at_a_thigh_is_not_linked_to_it() {
    let (rest, pose) = (fixture("human_rest.off"), fixture("human_touch.off"));
    let height = rest.bounding_box().unwrap().extent().into_iter().fold(0.0, f64::max);
    let mut glued = 0;
    let turns = [[1.0, 2.0, 3.0], [1.0, 0.0, 0.0], [-2.0, 1.0, 0.5]];
    for i in 0..10 {
        let (count, angle) = (9_000 + 1_300 * i, 0.3 * i as f64);
        let mesh = moved(&pose, rotation(turns[i % 3], angle));
        let bvh = Bvh::new(&mesh);
        for cut_links in [true, false] {
            let parameters =
                VoxelizeParameters { pitch: Pitch::Voxels(count), cut_links, ..Default::default() };
            let grid = voxelize(&mesh, &parameters).unwrap().grid;
            // Where the nearest triangle of the surface is at rest.
            let at_rest: Vec<Vec3> = grid
                .voxels()
                .map(|v| rest.corners(bvh.nearest(grid.frame().centre(v)).unwrap().triangle as usize)[0])
                .collect();
            let far = |[u, v]: [u32; 2]| {
                let (p, q) = (at_rest[u as usize], at_rest[v as usize]);
                // Farther apart than the two sides of the trunk.
                (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt() > 0.25 * height
            };
            let far = (0..3).flat_map(|axis| grid.linked_pairs(axis)).filter(|&pair| far(pair)).count();
            if cut_links {
                assert_eq!(far, 0, "{count} voxels, turned by {angle}");
            }
            glued += far;
        }
    }
    assert!(glued > 0);
}

/// The figure whose hand presses 19 mm into its thigh: what both cover is left out, or kept when joined.
#[test]
fn a_hand_in_a_thigh_leaves_out_what_both_cover() {
    let mesh = fixture("human_press.off");
    let tree = WindingTree::new(&mesh);
    let windings = |overlap: Overlap| -> Vec<f64> {
        let parameters = VoxelizeParameters { overlap, ..Default::default() };
        let solid = voxelize(&mesh, &parameters).unwrap();
        assert!(solid.overlap_volume > 1e-6 && solid.overlap_volume < 1e-3);
        let grid = &solid.grid;
        grid.voxels().map(|v| tree.winding_number(grid.frame().centre(v))).collect()
    };
    assert!(windings(Overlap::Auto).iter().all(|w| (w - 1.0).abs() < 0.02));
    let twice = windings(Overlap::Join).iter().filter(|w| (*w - 2.0).abs() < 0.02).count();
    assert!(twice > 30, "{twice}");
}

/// Cut where the hand touches the thigh, the figure is a ball to topology, as its surface is: one piece
/// without tunnels.
#[test]
fn a_figure_that_touches_itself_keeps_the_topology_of_its_surface() {
    let (rest, pose) = (fixture("human_rest.off"), fixture("human_touch.off"));
    for (name, mesh) in [("rest", &rest), ("touch", &pose)] {
        assert_eq!(diagnose(mesh).genus, Some(0));
        for (i, count) in [20_000, 45_000, 80_000, 120_000].into_iter().enumerate() {
            let mesh = moved(mesh, rotation([1.0, -2.0, 0.4], 0.4 * i as f64));
            let pitch = Pitch::Voxels(count);
            let solid = voxelize(&mesh, &VoxelizeParameters { pitch, ..Default::default() }).unwrap();
            let topology = solid.topology;
            assert_eq!(
                (topology.components, topology.tunnels, topology.cavities),
                (1, 0, 0),
                "{name}, {count}"
            );
            assert!(!solid.warnings.iter().any(|w| matches!(w, Warning::Topology { .. })));
        }
    }
}
