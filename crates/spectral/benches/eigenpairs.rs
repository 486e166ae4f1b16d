//! The two solvers and what the filter starts from, at sizes that take milliseconds to a second.

use std::hint::black_box;
use std::ops::ControlFlow;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mser3d_laplace::{aggregate_grid, cotangent_laplacian, grid_laplacian};
use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d_spectral::{Eigensolver, SpectrumParameters, smallest_eigenpairs, smallest_eigenpairs_of_grid};

/// A solid cross of three bars: limbs, as bodies have them, with about `voxels` voxels.
fn cross(voxels: usize) -> VoxelGrid {
    // Three bars of w by w by 5 w that share a cube: 13 w^3 voxels.
    let w = ((voxels as f64 / 13.0).cbrt() as usize).max(2);
    let n = 5 * w;
    let middle = |x: u32| (2 * w..3 * w).contains(&(x as usize));
    let frame = Frame::new([n; 3], [0.0; 3], [1.0 / n as f64; 3]).expect("the frame is finite");
    let mut bits = BitGrid::empty([n; 3]).expect("the grid is small");
    for v in BitGrid::full([n; 3]).expect("the grid is small").ones() {
        bits.set(v, v.iter().filter(|&&x| middle(x)).count() >= 2);
    }
    VoxelGrid::solid(frame, bits).expect("the bits have the frame's size")
}

/// A wavy sheet of (n + 1)^2 vertices.
fn sheet(n: usize) -> TriangleMesh {
    let step = |i: usize| i as f64 / n as f64;
    let points = (0..=n).flat_map(|i| (0..=n).map(move |j| (step(i), step(j))));
    let vertices = points.map(|(u, v)| [u, v, 0.1 * (7.0 * u).sin() * (5.0 * v).cos()]).collect();
    let at = |i: usize, j: usize| (i * (n + 1) + j) as u32;
    let squares = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
    let triangles = squares.flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    TriangleMesh::new(vertices, triangles.collect()).expect("the triangles name vertices")
}

fn parameters(eigenpairs: usize, solver: Eigensolver) -> SpectrumParameters {
    SpectrumParameters { eigenpairs: eigenpairs.into(), solver, ..Default::default() }
}

fn grids(c: &mut Criterion) {
    let mut group = c.benchmark_group("grid");
    group.sample_size(10);
    for voxels in [6_000, 20_000] {
        let grid = cross(voxels);
        group.throughput(Throughput::Elements(grid.len() as u64));
        for eigenpairs in [20, 50] {
            let name = format!("{} voxels, {eigenpairs} pairs", grid.len());
            for (solver, title) in
                [(Eigensolver::Filter, "filter"), (Eigensolver::ShiftInvert, "shift-invert")]
            {
                let parameters = parameters(eigenpairs, solver);
                group.bench_function(BenchmarkId::new(title, &name), |b| {
                    b.iter(|| {
                        let found = smallest_eigenpairs_of_grid(black_box(&grid), &parameters, &|_| {
                            ControlFlow::Continue(())
                        });
                        found.expect("a connected solid has a spectrum")
                    });
                });
            }
        }
    }
    group.finish();
}

fn meshes(c: &mut Criterion) {
    let mut group = c.benchmark_group("mesh");
    group.sample_size(10);
    let operator = cotangent_laplacian(&sheet(80)).expect("the sheet has area");
    let parameters = parameters(50, Eigensolver::ShiftInvert);
    group.bench_function(format!("shift-invert/{} vertices, 50 pairs", operator.len()), |b| {
        b.iter(|| {
            let found =
                smallest_eigenpairs(black_box(&operator), &parameters, &|_| ControlFlow::Continue(()));
            found.expect("a connected sheet has a spectrum")
        });
    });
    group.finish();
}

fn operators(c: &mut Criterion) {
    let mut group = c.benchmark_group("operator");
    let grid = cross(20_000);
    group.throughput(Throughput::Elements(grid.len() as u64));
    group.bench_function("assemble", |b| b.iter(|| grid_laplacian(black_box(&grid))));
    for factor in [2, 4] {
        group.bench_function(BenchmarkId::new("aggregate", factor), |b| {
            b.iter(|| aggregate_grid(black_box(&grid), factor));
        });
    }
    group.finish();
}

criterion_group!(benches, grids, meshes, operators);
criterion_main!(benches);
