//! The kernels of voxelization on a figure with limbs, closed and with a hundredth of its triangles missing.
#![allow(missing_docs)]

#[path = "../tests/it/common.rs"]
mod common;

use common::*;
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mser3d_shape::TriangleMesh;
use mser3d_voxelize::*;
use std::hint::black_box;

/// A sphere pulled out along the diagonals; 32,768 triangles.
fn figure() -> TriangleMesh {
    moved(&sphere([0.0; 3], 1.0, 6), |p| {
        let reach = 1.0 + 160.0 * (p[0] * p[1] * p[2]).powi(2);
        p.map(|x| x * reach * 0.5 + 0.01)
    })
}

fn open() -> TriangleMesh {
    let mut random = Random(1);
    altered(&figure(), |_, t| (random.next() > 0.01).then_some(t))
}

fn voxels(c: &mut Criterion) {
    let mut group = c.benchmark_group("voxels");
    for resolution in [128, 512] {
        let parameters = VoxelizeParameters { pitch: Pitch::Resolution(resolution), ..Default::default() };
        let parity = VoxelizeParameters { inside: InsideTest::Parity, ..parameters.clone() };
        let (closed, open) = (figure(), open());
        let mut run = |name: &str, mesh: &TriangleMesh, parameters: &VoxelizeParameters| {
            group.bench_function(BenchmarkId::new(name, resolution), |b| {
                b.iter(|| inside(black_box(mesh), parameters).unwrap());
            });
        };
        run("inside by parity", &closed, &parity);
        run("inside by diagnosis", &closed, &parameters);
        run("inside of the open mesh", &open, &parameters);
        group.bench_function(BenchmarkId::new("linked solid", resolution), |b| {
            b.iter(|| voxelize(black_box(&closed), &parameters).unwrap());
        });
    }
}

fn hierarchy(c: &mut Criterion) {
    let mesh = figure();
    let mut group = c.benchmark_group("hierarchy");
    group.throughput(Throughput::Elements(mesh.triangles().len() as u64));
    group.bench_function("build", |b| b.iter(|| Bvh::new(black_box(&mesh))));
    group.bench_function("build with expansions", |b| b.iter(|| WindingTree::new(black_box(&mesh))));
    let mut random = Random(2);
    let points: Vec<Vec3> = (0..1000).map(|_| std::array::from_fn(|_| 2.0 * random.next() - 1.0)).collect();
    let (bvh, tree) = (Bvh::new(&mesh), WindingTree::new(&mesh));
    group.throughput(Throughput::Elements(1000));
    group.bench_function("winding number", |b| {
        b.iter(|| points.iter().map(|&p| tree.winding_number(p)).sum::<f64>());
    });
    group.bench_function("nearest point", |b| {
        b.iter(|| points.iter().filter_map(|&p| bvh.nearest(p)).map(|n| n.distance).sum::<f64>());
    });
    group.bench_function("first hit", |b| {
        b.iter(|| points.iter().filter_map(|&p| bvh.first_hit(p, [0.3, 0.5, 0.8], f64::INFINITY)).count());
    });
}

fn examination(c: &mut Criterion) {
    let (closed, open) = (figure(), open());
    c.bench_function("diagnose the closed mesh", |b| b.iter(|| diagnose(black_box(&closed))));
    c.bench_function("diagnose the open mesh", |b| b.iter(|| diagnose(black_box(&open))));
}

criterion_group!(benches, voxels, hierarchy, examination);
criterion_main!(benches);
