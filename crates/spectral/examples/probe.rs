//! Times the solvers on a figure of capsules.
use mser3d_shape::{BitGrid, Frame, VoxelGrid};
use mser3d_spectral::*;
use std::ops::ControlFlow;

fn figure(resolution: usize) -> VoxelGrid {
    let limbs: [([f64; 3], [f64; 3], f64); 8] = [
        ([0.5, 0.9, 0.5], [0.5, 0.9, 0.5], 0.08),
        ([0.5, 0.55, 0.5], [0.5, 0.75, 0.5], 0.11),
        ([0.45, 0.5, 0.5], [0.4, 0.06, 0.5], 0.055),
        ([0.55, 0.5, 0.5], [0.6, 0.06, 0.5], 0.055),
        ([0.45, 0.74, 0.5], [0.15, 0.6, 0.5], 0.04),
        ([0.55, 0.74, 0.5], [0.85, 0.6, 0.55], 0.04),
        ([0.5, 0.75, 0.5], [0.5, 0.9, 0.5], 0.045),
        ([0.4, 0.06, 0.5], [0.4, 0.05, 0.6], 0.04),
    ];
    let h = 1.0 / resolution as f64;
    let frame = Frame::new([resolution; 3], [0.0; 3], [h; 3]).unwrap();
    let mut bits = BitGrid::empty(frame.dims()).unwrap();
    for v in BitGrid::full(frame.dims()).unwrap().ones() {
        let p = frame.centre(v);
        let inside = limbs.iter().any(|(a, b, r)| {
            let d: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
            let dd: f64 = d.iter().map(|x| x * x).sum();
            let t = if dd > 0.0 {
                ((0..3).map(|i| (p[i] - a[i]) * d[i]).sum::<f64>() / dd).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (0..3).map(|i| (p[i] - a[i] - t * d[i]).powi(2)).sum::<f64>() <= r * r
        });
        bits.set(v, inside);
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let resolution: usize = args[1].parse().unwrap();
    let eigenpairs: usize = args[2].parse().unwrap();
    let solver = if args[3] == "filter" { Eigensolver::Filter } else { Eigensolver::ShiftInvert };
    let tolerance: f64 = args.get(4).map_or(1e-9, |t| t.parse().unwrap());
    let grid = figure(resolution);
    println!("voxels {}", grid.len());
    let parameters = SpectrumParameters { eigenpairs, solver, tolerance, ..Default::default() };
    let start = std::time::Instant::now();
    let s = smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(())).unwrap();
    println!("{:.3} s wall, {:?}", start.elapsed().as_secs_f64(), s.report);
    let l = s.basis.eigenvalues();
    println!("{:?} sum {:.12e}", &l[..5.min(l.len())], l.iter().sum::<f64>());
}
