//! Which solver `auto` takes, and whether it is the faster one.

use std::fs;
use std::ops::ControlFlow;

use mser3d_shape::{BitGrid, Frame, VoxelGrid};
use mser3d_spectral::{Eigensolver, SolverUsed, SpectrumParameters, smallest_eigenpairs_of_grid};

fn solid(dims: [usize; 3], mut inside: impl FnMut([u32; 3]) -> bool) -> VoxelGrid {
    let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let mut bits = BitGrid::empty(dims).unwrap();
    for v in BitGrid::full(dims).unwrap().ones() {
        bits.set(v, inside(v));
    }
    VoxelGrid::solid(frame, bits).unwrap()
}

fn brick(dims: [usize; 3]) -> VoxelGrid {
    solid(dims, |_| true)
}

/// A tube in a plane that goes to and fro: `legs` of `length`, `width` voxels across.
fn serpentine(legs: usize, length: usize, width: usize) -> VoxelGrid {
    let pitch = width + 1;
    solid([length, legs * pitch - 1, width], |[x, y, _]| {
        let (x, leg, row) = (x as usize, y as usize / pitch, y as usize % pitch);
        let turn = if leg % 2 == 0 { x >= length - width } else { x < width };
        row < width || turn
    })
}

/// A coil of a radius and a tube's radius, in voxels.
fn coil(turns: f64, radius: f64, tube: f64, rise: f64) -> VoxelGrid {
    let side = (2.0 * (radius + tube) + 2.0) as usize;
    let height = (turns * rise + 2.0 * tube + 2.0) as usize;
    let mut bits = BitGrid::empty([side, side, height]).unwrap();
    let steps = (turns * radius * 8.0 * std::f64::consts::TAU) as usize / 4;
    for i in 0..=steps {
        let turn = turns * i as f64 / steps as f64;
        let angle = turn * std::f64::consts::TAU;
        let c = [
            side as f64 / 2.0 + radius * angle.cos(),
            side as f64 / 2.0 + radius * angle.sin(),
            tube + 1.0 + turn * rise,
        ];
        let range = |c: f64, n: usize| (c - tube).max(0.0) as u32..=((c + tube) as u32).min(n as u32 - 1);
        for x in range(c[0], side) {
            for y in range(c[1], side) {
                for z in range(c[2], height) {
                    let d =
                        [x, y, z].iter().zip(c).map(|(&v, c)| (f64::from(v) + 0.5 - c).powi(2)).sum::<f64>();
                    if d <= tube * tube {
                        bits.set([x, y, z], true);
                    }
                }
            }
        }
    }
    let frame = Frame::new([side, side, height], [0.0; 3], [1.0; 3]).unwrap();
    VoxelGrid::solid(frame, bits).unwrap()
}

/// Rods along the axes on a lattice: a scaffold.
fn scaffold(cells: usize, gap: usize, width: usize) -> VoxelGrid {
    let side = cells * (gap + width) + width;
    solid([side; 3], |v| v.iter().filter(|&&c| (c as usize) % (gap + width) < width).count() >= 2)
}

/// A star of six arms.
fn star(arm: usize, width: usize) -> VoxelGrid {
    let side = 2 * arm + width;
    solid([side; 3], |v| v.iter().filter(|&&c| (arm..arm + width).contains(&(c as usize))).count() >= 2)
}

/// Seconds of CPU that this process took.
fn cpu() -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    (fields[11].parse::<f64>().unwrap() + fields[12].parse::<f64>().unwrap()) / 100.0
}

#[test]
#[ignore = "measures: cargo test --release -p mser3d-spectral --test it choice -- --ignored --nocapture"]
fn auto_takes_the_faster_solver() {
    let shapes: Vec<(String, VoxelGrid)> = vec![
        ("rod 1x1x10000".into(), brick([1, 1, 10000])),
        ("rod 1x1x40000".into(), brick([1, 1, 40000])),
        ("rod 2x2x10000".into(), brick([2, 2, 10000])),
        ("rod 3x3x5000".into(), brick([3, 3, 5000])),
        ("rod 5x5x1800".into(), brick([5, 5, 1800])),
        ("rod 8x8x700".into(), brick([8, 8, 700])),
        ("rod 12x12x300".into(), brick([12, 12, 300])),
        ("rod 16x16x180".into(), brick([16, 16, 180])),
        ("rod 24x24x80".into(), brick([24, 24, 80])),
        ("cube 36".into(), brick([36, 36, 36])),
        ("plate 1x212x212".into(), brick([1, 212, 212])),
        ("plate 2x150x150".into(), brick([2, 150, 150])),
        ("plate 4x106x106".into(), brick([4, 106, 106])),
        ("plate 8x75x75".into(), brick([8, 75, 75])),
        ("plate 1x100x450".into(), brick([1, 100, 450])),
        ("plate 1x40x1100".into(), brick([1, 40, 1100])),
        ("plate 2x20x1100".into(), brick([2, 20, 1100])),
        ("serpentine 20x200x3".into(), serpentine(20, 200, 3)),
        ("serpentine 12x150x5".into(), serpentine(12, 150, 5)),
        ("coil r30 t2".into(), coil(8.0, 30.0, 2.0, 8.0)),
        ("coil r40 t4".into(), coil(4.0, 40.0, 4.0, 14.0)),
        ("scaffold 6,10,2".into(), scaffold(6, 10, 2)),
        ("scaffold 3,24,4".into(), scaffold(3, 24, 4)),
        ("star 600,3".into(), star(600, 3)),
        ("star 150,7".into(), star(150, 7)),
        ("star 40,14".into(), star(40, 14)),
    ];
    let mut slow = Vec::new();
    println!("shape\tvoxels\tpairs\tauto takes\tinverse s\tfilter s");
    for (name, grid) in &shapes {
        // With fewer voxels for each pair it is the inverse for another reason.
        for k in [20usize, 100, 300].into_iter().filter(|k| grid.len() > 100 * k) {
            let time = |solver| {
                let start = cpu();
                let used = solved_by(grid, k, solver);
                (cpu() - start, used)
            };
            let (_, chosen) = time(Eigensolver::Auto);
            let (inverse, _) = time(Eigensolver::ShiftInvert);
            let (filter, _) = time(Eigensolver::Filter);
            println!("{name}\t{}\t{k}\t{chosen}\t{inverse:.2}\t{filter:.2}", grid.len());
            let own = if chosen == SolverUsed::Filter { filter } else { inverse };
            // Clocks of the system count hundredths.
            if own > 1.2 * inverse.min(filter) + 0.05 {
                slow.push(format!("{name}, k = {k}"));
            }
        }
    }
    assert!(slow.is_empty(), "{slow:?}");
}

#[test]
fn long_thin_bodies_are_solved_by_the_inverse_and_others_by_the_filter() {
    let inverse = [
        ("rod", brick([1, 1, 4000]), 20),
        ("turned rod", brick([4000, 1, 1]), 20),
        ("thick rod", brick([3, 3, 2500]), 40),
        ("serpentine", serpentine(12, 120, 3), 20),
        ("coil", coil(8.0, 30.0, 2.0, 8.0), 20),
        ("star", star(600, 3), 50),
    ];
    for (name, grid, k) in inverse {
        assert_eq!(solved_by(&grid, k, Eigensolver::Auto), SolverUsed::ShiftInvert, "{name}");
    }
    let filter = [
        ("cube", brick([20, 20, 20]), 20),
        ("plate", brick([1, 90, 90]), 20),
        ("beam", brick([12, 12, 100]), 40),
        ("star", star(40, 14), 20),
    ];
    for (name, grid, k) in filter {
        assert_eq!(solved_by(&grid, k, Eigensolver::Auto), SolverUsed::Filter, "{name}");
    }
}

fn solved_by(grid: &VoxelGrid, k: usize, solver: Eigensolver) -> SolverUsed {
    let parameters = SpectrumParameters { eigenpairs: k.into(), solver, ..Default::default() };
    smallest_eigenpairs_of_grid(grid, &parameters, &|_| ControlFlow::Continue(())).unwrap().report.solver
}
