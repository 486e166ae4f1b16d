//! `cargo bench -p mser3d-comptree`: trees of a smooth field, and the selection of stable regions.
use std::hint::black_box;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use mser3d_comptree::shape::Connectivity;
use mser3d_comptree::{ComponentTree, Polarity, StabilityParameters, stable_regions};

/// Waves in three directions, always positive.
fn field(dims: [usize; 3]) -> Vec<f64> {
    let n = dims.iter().product::<usize>();
    let at = |v: usize| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]];
    let wave = |v: usize| {
        let [x, y, z] = std::array::from_fn(|a| at(v)[a] as f64 / dims[a] as f64);
        (17.0 * x + 3.0 * y).sin() + (11.0 * y - 5.0 * z).cos() + (13.0 * z + 7.0 * x * y).sin()
    };
    (0..n).map(|v| 4.0 + wave(v)).collect()
}

fn trees(c: &mut Criterion) {
    let mut group = c.benchmark_group("tree");
    group.sample_size(10);
    for dims in [[36, 36, 35], [100, 100, 100]] {
        let values = field(dims);
        let n = values.len();
        group.throughput(Throughput::Elements(n as u64));
        group.bench_function(BenchmarkId::new("vertex", n), |b| {
            b.iter(|| {
                ComponentTree::from_grid(dims, Connectivity::Six, black_box(&values), 1.0, Polarity::Sublevel)
            })
        });
        let grey: Vec<u8> = values.iter().map(|v| (v * 30.0) as u8).collect();
        group.bench_function(BenchmarkId::new("vertex u8", n), |b| {
            b.iter(|| {
                ComponentTree::from_grid(dims, Connectivity::Six, black_box(&grey), 1.0, Polarity::Sublevel)
            })
        });
        let difference = |u: u32, v: u32| (values[u as usize] - values[v as usize]).abs();
        group.bench_function(BenchmarkId::new("edge", n), |b| {
            b.iter(|| {
                ComponentTree::from_grid_edges(dims, Connectivity::Six, difference, 1.0, Polarity::Sublevel)
            })
        });
        let tree = ComponentTree::from_grid(dims, Connectivity::Six, &values, 1.0, Polarity::Superlevel);
        if let Ok(tree) = tree {
            group.bench_function(BenchmarkId::new("selection", n), |b| {
                b.iter(|| stable_regions(black_box(&tree), &StabilityParameters::default()))
            });
        }
    }
    group.finish();
}

criterion_group!(benches, trees);
criterion_main!(benches);
