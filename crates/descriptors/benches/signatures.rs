//! `cargo bench -p mser3d-descriptors`: the weights and signatures of a slender box of 45,000 voxels with 100
//! eigenpairs, on one thread.

use criterion::{Criterion, criterion_group, criterion_main};
use mser3d_descriptors::*;
use mser3d_shape::{BitGrid, Domain, Eigenbasis, Frame, VoxelGrid};
use std::f64::consts::PI;
use std::hint::black_box;

const DIMS: [usize; 3] = [150, 20, 15];

/// The closed-form spectrum of the grid Laplacian, voxels of pitch 1.
fn basis(k: usize) -> Eigenbasis {
    let n: usize = DIMS.iter().product();
    let digits = |i: usize| [i % DIMS[0], i / DIMS[0] % DIMS[1], i / DIMS[0] / DIMS[1]];
    let angle = |p: usize, a: usize| PI * p as f64 / DIMS[a] as f64;
    let lambda = |i: usize| {
        let p = digits(i);
        (0..3).map(|a| 2.0 - 2.0 * angle(p[a], a).cos()).sum::<f64>()
    };
    let mut modes: Vec<usize> = (0..n).collect();
    modes.sort_by(|a, b| lambda(*a).total_cmp(&lambda(*b)));
    modes.truncate(k);
    let one = |p: usize, x: usize, a: usize| {
        let norm: f64 = if p == 0 { 1.0 } else { 2.0 };
        (norm / DIMS[a] as f64).sqrt() * (angle(p, a) * (x as f64 + 0.5)).cos()
    };
    let modes_at: Vec<[usize; 3]> = modes.iter().map(|&m| digits(m)).collect();
    let mut functions = Vec::with_capacity(n * k);
    for v in 0..n {
        let x = digits(v);
        functions.extend(modes_at.iter().map(|p| (0..3).map(|a| one(p[a], x[a], a)).product::<f64>()));
    }
    let values = modes.iter().map(|&m| lambda(m)).collect();
    Eigenbasis::new(Domain::Volume, vec![1.0; n], values, functions).expect("a sound basis")
}

fn signatures(c: &mut Criterion) {
    let double = basis(100);
    let functions: Vec<f32> = double.functions().values().map(|x| x as f32).collect();
    let (mass, values) = (double.mass().to_vec(), double.eigenvalues().to_vec());
    let single = Eigenbasis::new(Domain::Volume, mass, values, functions).expect("a sound basis");
    let n = double.len() as u32;
    let edges: Vec<[u32; 2]> =
        [1, 150, 3000].into_iter().flat_map(|step| (0..n - step).map(move |v| [v, v + step])).collect();
    let t = TimeScale::Relative(0.5).on(&double).expect("a positive time");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    for (precision, basis) in [("", &double), (" in single precision", &single)] {
        let mut group = c.benchmark_group(format!("45000 voxels, 100 eigenpairs{precision}"));
        group.sample_size(10);
        let mut bench = |name: &str, work: &(dyn Fn() + Sync)| {
            group.bench_function(name, |b| pool.install(|| b.iter(work)));
        };
        bench("auto_diffusivity", &|| drop(black_box(auto_diffusivity(basis, t))));
        bench("inverse_heat_kernel", &|| drop(black_box(inverse_heat_kernel(basis, t, &edges))));
        bench("commute_time", &|| drop(black_box(commute_time(basis))));
        bench("hks", &|| drop(black_box(hks(basis, &HksParameters::default(), None))));
        bench("si_hks", &|| drop(black_box(si_hks(basis, &SiHksParameters::default(), None))));
        group.finish();
    }
}

/// The paper's other descriptor on the same box, and a search among the regions of many shapes.
fn comparisons(c: &mut Criterion) {
    let frame = Frame::new(DIMS, [0.0; 3], [1.0; 3]).expect("a sound frame");
    let grid = VoxelGrid::solid(frame, BitGrid::full(DIMS).expect("a small grid")).expect("a sound grid");
    let value = |i: usize| (i as f64 * 0.618_034).fract();
    let regions = |n: usize| Descriptors::new(6, (0..6 * n).map(value).collect()).expect("finite values");
    let (queries, references) = (regions(20), regions(100_000));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut group = c.benchmark_group("comparisons");
    group.sample_size(10);
    let params = IntegralInvariantParameters::default();
    group.bench_function("integral invariants of 45000 voxels", |b| {
        pool.install(|| b.iter(|| integral_invariants(&grid, &params, None)))
    });
    group.bench_function("20 regions matched to 100000", |b| {
        pool.install(|| b.iter(|| match_descriptors(&queries, &references, &MatchParameters::default())))
    });
    group.finish();
}

/// 384 samples to 6 frequencies: all by FFT, or the six by their definition, which takes a third less time.
/// That is 5 of the signature's 60 ms, not worth a second transform in the library.
fn transforms(c: &mut Criterion) {
    let samples: Vec<f64> = (0..384).map(|j| (j as f64 * 0.1).sin()).collect();
    let mut group = c.benchmark_group("384 samples to 6 frequencies");
    let fft = realfft::RealFftPlanner::<f64>::new().plan_fft_forward(384);
    let (mut input, mut output, mut scratch) =
        (samples.clone(), fft.make_output_vec(), fft.make_scratch_vec());
    group.bench_function("realfft", |b| {
        b.iter(|| {
            input.copy_from_slice(&samples);
            fft.process_with_scratch(&mut input, &mut output, &mut scratch).expect("fitting buffers");
            output[5].norm()
        })
    });
    let matrix: Vec<[f64; 12]> = (0..384)
        .map(|j| {
            std::array::from_fn(|f| {
                let angle = 2.0 * PI * (j * (f / 2)) as f64 / 384.0;
                if f % 2 == 0 { angle.cos() } else { angle.sin() }
            })
        })
        .collect();
    let arch = pulp::Arch::new();
    group.bench_function("direct", |b| {
        b.iter(|| {
            arch.dispatch(|| {
                let mut sums = [0.0; 12];
                for (x, row) in black_box(&samples).iter().zip(&matrix) {
                    for f in 0..12 {
                        sums[f] += x * row[f];
                    }
                }
                sums
            })
        })
    });
    group.finish();
}

criterion_group!(benches, signatures, comparisons, transforms);
criterion_main!(benches);
