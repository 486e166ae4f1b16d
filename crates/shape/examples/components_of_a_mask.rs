//! A voxel mask, its connected components, and which region of it each point of space is nearest to.
//!
//! `cargo run --example components_of_a_mask -p mser3d-shape`

use std::error::Error;

use mser3d_shape::{BitGrid, Frame, IndexSet, VoxelGrid};

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    // Two balls in a box of 30 x 14 x 14 voxels of 2 mm.
    let frame = Frame::new([30, 14, 14], [0.0; 3], [2.0; 3])?;
    let mut inside = BitGrid::empty(frame.dims())?;
    let near = |[x, y, z]: [u32; 3], centre: i64, radius: i64| {
        let square = |a: u32, b: i64| (i64::from(a) - b).pow(2);
        square(x, centre) + square(y, 7) + square(z, 7) < radius * radius
    };
    for voxel in BitGrid::full(frame.dims())?.ones() {
        inside.set(voxel, near(voxel, 7, 6) || near(voxel, 22, 5));
    }
    let grid = VoxelGrid::solid(frame, inside)?;
    println!("{} voxels, {:.1} mm^3", grid.len(), grid.volume());

    // The half of the first ball that looks at the second.
    let places: Vec<[u32; 3]> = grid.voxels().collect();
    let half = IndexSet::from_fn(grid.len(), |v| (7..15).contains(&places[v][0]));
    for point in [[18.0, 14.0, 14.0], [44.0, 14.0, 14.0]] {
        let voxel = grid.nearest_voxels(&[point])[0];
        println!("{point:?} is nearest to voxel {voxel}, in the half: {}", half.contains(voxel as usize));
    }
    let (largest, dropped, voxels) = grid.largest_component();
    println!("the largest component has {} voxels; {dropped} with {voxels} were dropped", largest.len());
    Ok(())
}
