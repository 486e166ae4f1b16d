//! Builds the tree of a raw field and says how long it took: what `xtask/peers/tree.py` compares with
//! other libraries.
//!
//!     timed_tree FIELD f32|f64|u8|u16 NX NY NZ 4|8|6|18|26 vertex|edge REPEATS [OUT]
//!
//! FIELD holds NX NY NZ little-endian values, x fastest. Edge weights are absolute differences. Prints
//! seconds of each repeat, processor seconds of a repeat on average, nodes, and bytes at the peak beyond the input; writes (altitude, volume) of
//! all nodes as pairs of f64 to OUT.
use std::error::Error;
use std::time::Instant;

use mser3d_comptree::{ComponentTree, GreyValue, Polarity, Stencil};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, kind, nx, ny, nz, stencil, weights, repeats, out @ ..] = &arguments[..] else {
        return Err("usage: timed_tree FIELD TYPE NX NY NZ STENCIL vertex|edge REPEATS [OUT]".into());
    };
    let dims = [nx.parse()?, ny.parse()?, nz.parse()?];
    let stencil = match stencil.as_str() {
        "4" => Stencil::Four,
        "8" => Stencil::Eight,
        "6" => Stencil::Six,
        "18" => Stencil::Eighteen,
        "26" => Stencil::TwentySix,
        _ => return Err("the stencil is 4, 8, 6, 18 or 26".into()),
    };
    let job = Job { dims, stencil, edge: weights == "edge", repeats: repeats.parse()?, out: out.first() };
    let bytes = std::fs::read(path)?;
    match kind.as_str() {
        "u8" => job.run(bytes),
        "u16" => job.run(read(bytes, u16::from_le_bytes)),
        "f32" => job.run(read(bytes, f32::from_le_bytes)),
        "f64" => job.run(read(bytes, f64::from_le_bytes)),
        _ => Err("the type is u8, u16, f32 or f64".into()),
    }
}

fn read<T, const N: usize>(bytes: Vec<u8>, from: fn([u8; N]) -> T) -> Vec<T> {
    bytes.as_chunks::<N>().0.iter().map(|&chunk| from(chunk)).collect()
}

struct Job<'a> {
    dims: [usize; 3],
    stencil: Stencil,
    edge: bool,
    repeats: usize,
    out: Option<&'a String>,
}

impl Job<'_> {
    fn run<V: GreyValue>(&self, values: Vec<V>) -> Result<(), Box<dyn Error>> {
        let base = resident("VmRSS");
        let mut tree = None;
        let repeats = self.repeats.max(1);
        let worked = processor_seconds();
        for _ in 0..repeats {
            drop(tree.take());
            let start = Instant::now();
            tree = Some(if self.edge {
                let value = |v: u32| -> f64 { values[v as usize].into() };
                let difference = |u, v| (value(u) - value(v)).abs();
                ComponentTree::from_grid_edges(self.dims, self.stencil, difference, 1.0, Polarity::Sublevel)?
            } else {
                ComponentTree::from_grid(self.dims, self.stencil, &values, 1.0, Polarity::Sublevel)?
            });
            println!("seconds {:.5}", start.elapsed().as_secs_f64());
        }
        if let (Some(before), Some(after)) = (worked, processor_seconds()) {
            println!("cpu {:.5}", (after - before) / repeats as f64);
        }
        let Some(tree) = tree else { return Ok(()) };
        println!("nodes {}", tree.len());
        if let (Some(base), Some(peak)) = (base, resident("VmHWM")) {
            println!("bytes {}", peak - base);
        }
        if let Some(out) = self.out {
            let node = |i: u32| [tree.altitude(i), tree.volume(i)];
            let numbers = (0..tree.len() as u32).flat_map(node);
            std::fs::write(out, numbers.flat_map(f64::to_le_bytes).collect::<Vec<u8>>())?;
        }
        Ok(())
    }
}

/// Processor time of this process, all threads, to a hundredth of a second, by Linux's count.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = stat.rsplit_once(')')?.1.split_whitespace().collect();
    Some((fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?) / 100.0)
}

/// Memory of this process by Linux's count.
fn resident(field: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(field))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kilobytes| kilobytes * 1024)
}
