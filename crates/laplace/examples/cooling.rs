//! A hot spot spreads in a bent rod: the heat equation in explicit steps, with the matrix of a voxel grid.
//!
//! `cargo run -p mser3d-laplace --example cooling`

use std::error::Error;

use mser3d_laplace::shape::{BitGrid, Frame, VoxelGrid};
use mser3d_laplace::{GridStencil, grid_laplacian};

/// Prints the temperature at both ends of the U, and the heat in all of it.
pub fn main() -> Result<(), Box<dyn Error>> {
    // A U of voxels 0.5 wide: its two arms lie side by side, but only the voxels at the bottom join them.
    let frame = Frame::new([5, 20, 1], [0.0; 3], [0.5; 3])?;
    let mut inside = BitGrid::full(frame.dims())?;
    for y in 1..20 {
        inside.set([2, y, 0], false);
    }
    let rod = VoxelGrid::solid(frame, inside)?;
    let operator = grid_laplacian(&rod);

    // M du/dt = -W u, in steps that are stable: at most 2 / (largest eigenvalue).
    let step = 1.0 / GridStencil::new(&rod).spectral_bound();
    let mut heat = vec![0.0; rod.len()];
    let [start, across] = [[0, 19, 0], [4, 19, 0]].map(|voxel| rod.index(voxel).expect("inside") as usize);
    heat[start] = 1.0 / operator.mass()[start];
    let total = |heat: &[f64]| heat.iter().zip(operator.mass()).map(|(u, m)| u * m).sum::<f64>();
    println!("   time   start  across   total");
    for steps in 0..=4000 {
        if steps % 1000 == 0 {
            let time = f64::from(steps) * step;
            println!("{time:7.1} {:7.4} {:7.4} {:7.4}", heat[start], heat[across], total(&heat));
        }
        let mut flow = vec![0.0; heat.len()];
        for (&value, (row, column)) in operator.stiffness().iter() {
            flow[row] += value * heat[column];
        }
        for ((u, flow), m) in heat.iter_mut().zip(&flow).zip(operator.mass()) {
            *u -= step * flow / m;
        }
    }
    Ok(())
}
