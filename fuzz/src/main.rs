//! Fuzz targets in one program: `cargo xtask fuzz` builds it with libFuzzer's instrumentation and runs it, a process for each target.
//!
//! `MSER3D_FUZZ_TARGET` names the target. `MSER3D_FUZZ_SEEDS` is a folder for the inputs to begin with, which are written there
//! before the first run. All other options are libFuzzer's.
#![no_main]

mod arguments;
mod arrays;
mod collections;
mod correspondences;
mod meshes;
mod patches;
mod results;
mod scratch;
mod soups;
mod spectra;
mod targets;
mod trees;
mod volumes;

use std::alloc::System;
use std::path::Path;
use std::sync::OnceLock;

use cap::Cap;
use libfuzzer_sys::fuzz_target;

use crate::targets::{TARGETS, Target};

/// More than this at once is a finding, whatever the input: the process ends.
const MEMORY_LIMIT: usize = 1 << 30;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, MEMORY_LIMIT);

static TARGET: OnceLock<&Target> = OnceLock::new();

/// Chooses the target and writes its seeds.
fn begin() {
    // What a library throws and its caller catches is no finding. What nobody catches ends the process all the same.
    let _ = std::panic::take_hook();
    let name = std::env::var("MSER3D_FUZZ_TARGET").unwrap_or_default();
    let Some(target) = TARGETS.iter().find(|target| target.name == name) else {
        let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
        println!("{}", names.join(" "));
        std::process::exit(if name == "list" { 0 } else { 2 });
    };
    if let Some(folder) = std::env::var_os("MSER3D_FUZZ_SEEDS") {
        for (number, seed) in (target.seeds)().into_iter().enumerate() {
            let path = Path::new(&folder).join(format!("seed-{number:04}"));
            std::fs::write(&path, seed).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        }
    }
    let _ = TARGET.set(target);
}

fuzz_target!(init: begin(), |data: &[u8]| {
    if let Some(target) = TARGET.get() {
        (target.run)(data);
    }
});
