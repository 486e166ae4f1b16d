//! `cargo xtask bench roofline`: how near the stencil comes to what the machine's memory and arithmetic allow (the roofline of
//! Williams, Waterman & Patterson 2009).

use std::error::Error;
use std::fmt::Write;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use mser3d::spectral::{Eigensolver, SpectrumParameters, smallest_eigenpairs_of_grid};
use mser3d::voxelize::{Pitch, VoxelizeParameters, voxelize};
use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::program::body;
use super::resources::processor;
use crate::solved::mesh;

/// What `cargo xtask bench roofline` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// The body by its name: human, makehuman, people
    #[arg(long, default_value = "human")]
    body: String,
    /// Voxels of each problem
    #[arg(long, value_delimiter = ',', default_values_t = [45_000, 1_000_000, 4_000_000])]
    voxels: Vec<usize>,
    /// Folder for roofline.md [default: docs/results]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// Eigenpairs: a single block of vectors for the most part, so that next to nothing but the stencil takes time.
const EIGENPAIRS: usize = 7;
const TOLERANCE: f64 = 1e-4;
/// What a step of the stencil does for a number, a voxel of a vector: 4 products, 3 of them with a sum, and 5 sums more.
const FLOPS: f64 = 12.0;
/// And what it reads and writes in memory, where nothing is kept in a cache between two steps: x, and y before and after.
const BYTES: f64 = 24.0;
/// How often each limit is measured; the best counts.
const RUNS: usize = 5;
/// Solvers run again until so much time has passed.
const LONG_ENOUGH: Duration = Duration::from_secs(3);

/// What some threads of the machine can do.
struct Limits {
    /// Bytes a second that are read and written by y <- a x + b y on numbers that no cache holds.
    bytes: f64,
    /// Operations a second of products with sums on numbers in registers.
    flops: f64,
}

impl Limits {
    /// Measures them with the threads of the pool that this runs in.
    fn measure() -> Self {
        let n = 1 << 25;
        let (x, mut y) = (vec![1.0f64; n], vec![2.0f64; n]);
        let chunk = n.div_ceil(rayon::current_num_threads());
        let bytes = (0..RUNS).map(|_| {
            let start = Instant::now();
            y.par_chunks_mut(chunk).zip(x.par_chunks(chunk)).for_each(|(y, x)| {
                y.iter_mut().zip(x).for_each(|(y, x)| *y = 0.5 * x + 0.25 * *y);
            });
            black_box(&mut y);
            BYTES * n as f64 / start.elapsed().as_secs_f64()
        });
        let bytes = bytes.fold(0.0, f64::max);
        let flops = (0..RUNS).map(|_| {
            let start = Instant::now();
            let done = rayon::broadcast(|_| pulp::Arch::new().dispatch(Products));
            done.iter().sum::<f64>() / start.elapsed().as_secs_f64()
        });
        Self { bytes, flops: flops.fold(0.0, f64::max) }
    }
}

/// Products with sums that don't wait for each other; the operations that they were.
struct Products;

impl WithSimd for Products {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        const TIMES: usize = 1 << 25;
        let factor = simd.splat_f64s(black_box(0.999));
        let mut sums = [simd.splat_f64s(black_box(1.0)); 12];
        for _ in 0..TIMES {
            for sum in &mut sums {
                *sum = simd.mul_add_f64s(*sum, factor, factor);
            }
        }
        black_box(sums.map(|sum| simd.reduce_sum_f64s(sum)));
        (2 * TIMES * sums.len() * S::F64_LANES) as f64
    }
}

/// Measures, and prints and writes the page.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let path = body(&arguments.body).ok_or_else(|| format!("the mesh of {} is not here", arguments.body))?;
    let mesh = mesh(&path)?;
    let mut page = format!(
        "# How near the stencil is to the machine's limits\n\n\
         Made by `cargo xtask bench roofline`. A step of the stencil does {FLOPS} operations for a number (a voxel of a vector), and moves \
         {BYTES} bytes if nothing stays in a cache from one step to the next. Measured is the filter with {EIGENPAIRS} eigenpairs, which is \
         hardly more than that: its wall time over voxels, vectors and steps, the least of some runs where they are short. All that it does beside the stencil \
         counts, so the stencil itself is a little faster. The limits are measured in the same run: bytes of y <- a x + b y on arrays \
         of 256 MB, operations of products with sums on numbers in registers.\n\nMachine: {}.\n\n\
         | voxels | threads | ns a number | its bytes at the memory's limit, ns | its operations at the limit, ns | times as fast as through memory | share of the operations' limit |\n\
         |---|---|---|---|---|---|---|\n",
        processor()
    );
    for threads in [1, std::thread::available_parallelism()?.get()] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build()?;
        let limits = pool.install(Limits::measure);
        println!("{threads} threads: {:.1} GB/s, {:.1} Gflop/s", limits.bytes / 1e9, limits.flops / 1e9);
        let [memory, arithmetic] = [BYTES / limits.bytes, FLOPS / limits.flops].map(|seconds| 1e9 * seconds);
        for &voxels in &arguments.voxels {
            let parameters = VoxelizeParameters { pitch: Pitch::Voxels(voxels), ..Default::default() };
            let grid = voxelize(&mesh, &parameters)?.grid;
            let parameters = SpectrumParameters {
                eigenpairs: EIGENPAIRS.into(),
                tolerance: TOLERANCE,
                solver: Eigensolver::Filter,
                ..Default::default()
            };
            let (mut least, all) = (f64::INFINITY, Instant::now());
            while least.is_infinite() || all.elapsed() < LONG_ENOUGH {
                let start = Instant::now();
                let spectrum = pool.install(|| {
                    smallest_eigenpairs_of_grid(&grid, &parameters, &|_| ControlFlow::Continue(()))
                })?;
                let numbers = grid.len() as f64 * spectrum.report.applications as f64;
                least = least.min(1e9 * start.elapsed().as_secs_f64() / numbers);
            }
            let line = format!(
                "| {} | {threads} | {least:.2} | {memory:.2} | {arithmetic:.2} | {:.1} x | {:.0} % |",
                grid.len(),
                memory / least,
                100.0 * arithmetic / least
            );
            println!("{line}");
            writeln!(page, "{line}")?;
        }
    }
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    std::fs::write(arguments.output.as_deref().unwrap_or(&default).join("roofline.md"), page)?;
    Ok(())
}
