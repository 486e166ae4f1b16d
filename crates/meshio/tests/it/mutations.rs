//! Damaged files are errors or other meshes, never panics, and never cost more memory than a small
//! multiple of their size.

use crate::good_files::good_files;
use mser3d_meshio::{MeshFormat, ReadOptions, read_mesh_from};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::path::Path;

#[derive(Clone, Debug)]
enum Damage {
    Truncate(prop::sample::Index),
    Set(prop::sample::Index, u8),
    Flip(prop::sample::Index, u8),
    /// Replaces a digit by one of a kind that counts and indices dislike.
    Digit(prop::sample::Index, &'static str),
    Copy(prop::sample::Index, prop::sample::Index),
}

fn damage() -> impl Strategy<Value = Damage> {
    use prop::sample::Index;
    prop_oneof![
        1 => any::<Index>().prop_map(Damage::Truncate),
        3 => any::<(Index, u8)>().prop_map(|(i, b)| Damage::Set(i, b)),
        3 => (any::<Index>(), 0..8u8).prop_map(|(i, b)| Damage::Flip(i, b)),
        3 => (any::<Index>(), prop::sample::select(&["-1", "0", "99999999999999999999", "4294967295", "nan", "1e400", ""][..]))
            .prop_map(|(i, text)| Damage::Digit(i, text)),
        1 => any::<(Index, Index)>().prop_map(|(i, j)| Damage::Copy(i, j)),
    ]
}

fn apply(bytes: &mut Vec<u8>, damage: &Damage) {
    if bytes.is_empty() {
        return;
    }
    let n = bytes.len();
    match damage {
        Damage::Truncate(at) => bytes.truncate(at.index(n)),
        Damage::Set(at, byte) => bytes[at.index(n)] = *byte,
        Damage::Flip(at, bit) => bytes[at.index(n)] ^= 1 << bit,
        Damage::Digit(at, text) => {
            let digits: Vec<usize> = (0..n).filter(|&i| bytes[i].is_ascii_digit()).collect();
            if !digits.is_empty() {
                let at = digits[at.index(digits.len())];
                bytes.splice(at..=at, text.bytes());
            }
        }
        Damage::Copy(from, to) => {
            let piece: Vec<u8> = bytes[from.index(n)..].iter().take(16).copied().collect();
            let to = to.index(n);
            bytes.splice(to..to, piece);
        }
    }
}

/// The most address space that this process ever had, in bytes, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmPeak:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib * 1024)
}

// The only test of this program, so that the peak is its own.
#[test]
fn damaged_files_are_errors_or_other_meshes() {
    let files = good_files(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files").as_ref());
    let mut outcomes = [0usize; 2];
    let mut read = |format, bytes: &[u8], time: f64| {
        let animations: &[Option<&str>] = match format {
            MeshFormat::Gltf | MeshFormat::Glb => &[None, Some("0"), Some("2"), Some("3")],
            _ => &[None],
        };
        for animation in animations {
            let time = if animation.is_some() { time } else { 0.0 };
            let options = ReadOptions { animation: animation.map(str::to_owned), time, ..Default::default() };
            let result = read_mesh_from(format, bytes, Path::new("damaged"), &options);
            outcomes[usize::from(result.is_ok())] += 1;
            if let Err(error) = result {
                assert!(error.to_string().starts_with("damaged"), "{error}");
            }
        }
    };
    for (format, bytes) in &files {
        assert!(
            read_mesh_from(*format, bytes, Path::new("good"), &ReadOptions::default()).is_ok(),
            "the {format} file is good before it is damaged"
        );
        (0..bytes.len()).for_each(|end| read(*format, &bytes[..end], 0.5));
    }
    let before = peak_memory();
    let mut runner =
        TestRunner::new(Config { cases: 20_000, failure_persistence: None, ..Config::default() });
    let strategy = (0..files.len(), prop::collection::vec(damage(), 1..4), 0.0..3.0);
    let read = std::cell::RefCell::new(&mut read);
    let result = runner.run(&strategy, |(file, damages, time)| {
        let (format, mut bytes) = files[file].clone();
        damages.iter().for_each(|damage| apply(&mut bytes, damage));
        read.borrow_mut()(format, &bytes, time);
        Ok(())
    });
    result.unwrap();
    assert!(outcomes.iter().all(|&n| n > 1000), "both outcomes occur: {outcomes:?}");
    if let (Some(before), Some(after)) = (before, peak_memory()) {
        assert!(
            after - before < 32 << 20,
            "{} MiB of memory for files of a kilobyte",
            (after - before) >> 20
        );
    }
}
