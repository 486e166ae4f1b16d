//! Runs the program and reads what it wrote.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

pub fn mser3d(arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mser3d")).args(arguments).output().unwrap()
}

pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures")
}

pub fn text(bytes: &[u8]) -> &str {
    std::str::from_utf8(bytes).unwrap()
}

/// `detect` with options separated by spaces; its result is in the folder.
pub fn detect(input: &Path, folder: &Path, options: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    command.arg("detect").arg(input).arg("-o").arg(folder).args(options.split_whitespace());
    command.output().unwrap()
}

/// As [`detect`], of a run that must succeed without a word on stderr: the parsed `regions.json`.
pub fn regions(input: &Path, folder: &Path, options: &str) -> Value {
    let output = detect(input, folder, options);
    assert!(output.status.success() && output.stderr.is_empty(), "{}", text(&output.stderr));
    json(&folder.join("regions.json"))
}

pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// The data of a page but for its arrays.
pub fn page_head(page: &str) -> Value {
    let head = page.split("id=\"head\">").nth(1).unwrap().split("</script>").next().unwrap();
    serde_json::from_str(head).unwrap()
}

/// Asserts a failure with this exit code and one line on stderr that contains all these words.
pub fn assert_fails(output: &Output, code: i32, words: &[&str]) {
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{stderr}");
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    // The argument parser adds hints in lines of their own.
    assert!(code == 2 || stderr.lines().count() == 1, "{stderr}");
    for word in words {
        assert!(stderr.contains(word), "{word:?} is not in: {stderr}");
    }
}

/// Whether the tests run where Ctrl-C is ignored, as in scripts with `&`: then what they start ignores it too.
#[cfg(unix)]
pub fn ignores(signal: u32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    u64::from_str_radix(mask.unwrap_or("0").trim(), 16).unwrap() >> (signal - 1) & 1 == 1
}

/// A box as OFF.
pub fn box_off(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::from("OFF\n8 12 0\n");
    for i in 0..8 {
        let [x, y, z] = std::array::from_fn(|a| if i >> a & 1 == 1 { high[a] } else { low[a] });
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c, d] in [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] {
        text += &format!("3 {a} {b} {c}\n3 {a} {c} {d}\n");
    }
    text
}

/// A NumPy file of bytes, indexed [x, y, z].
pub fn npy(shape: [usize; 3], inside: impl Fn(usize, usize, usize) -> bool) -> Vec<u8> {
    let [nx, ny, nz] = shape;
    let header = format!("{{'descr': '|b1', 'fortran_order': False, 'shape': ({nx}, {ny}, {nz}), }}");
    let header = format!("{header:<117}\n");
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    for x in 0..nx {
        for y in 0..ny {
            bytes.extend((0..nz).map(|z| u8::from(inside(x, y, z))));
        }
    }
    bytes
}
