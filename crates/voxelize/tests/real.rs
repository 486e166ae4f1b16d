//! Real shapes, when they are there.

mod common;

use common::*;
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
