//! Damaged files are errors or other meshes, never panics, and never cost more memory than a small
//! multiple of their size.

use crate::common::bar;
use mser3d_meshio::{MeshFormat, ReadOptions, read_mesh_from};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRunner};
use std::io::Write;
use std::path::Path;

/// A good file of each format and variant.
fn good_files() -> Vec<(MeshFormat, Vec<u8>)> {
    let obj = b"# c\no a\nv 0 0 0\nv 1 0 0 1 0.5 0\nv 1 1 0 1\nvt 0 0\nvn 0 0 1\ng b\nv 0 1 0\nv 0 0 1e0\n\
        f 1/1/1 2//1 3/1 4\nf -5 -4 \\\n -1\nf 2 3 5\nl 1 2\nf 3 4 5 1 2\n";
    let off = b"COFF\n5 3 0\n0 0 0 1 1 1 1\n1 0 0\n1 1 0 # c\n0 1 0\n0 0 1\n4 0 1 2 3 255 0 0\n3 0 1 4\n5 0 1 2 3 4\n";
    let header = "element vertex 4\nproperty float x\nproperty double y\nproperty short z\nproperty list uchar int l\n\
        element face 2\nproperty list uchar uint vertex_indices\nproperty uchar red\nend_header\n";
    let ascii = format!(
        "ply\nformat ascii 1.0\n{header}0 0 0 1 7\n1 0 0 0\n0 1e0 0 2 1 1\n0 0 1 0\n3 0 1 2 9\n4 0 1 2 3 9\n"
    );
    let mut files = vec![
        (MeshFormat::Obj, obj.to_vec()),
        (MeshFormat::Off, off.to_vec()),
        (MeshFormat::Ply, ascii.into_bytes()),
    ];
    for big in [false, true] {
        let mut ply =
            format!("ply\nformat binary_{}_endian 1.0\n{header}", if big { "big" } else { "little" })
                .into_bytes();
        let mut put = |bytes: &[u8]| match big {
            true => ply.extend(bytes.iter().rev()),
            false => ply.extend(bytes),
        };
        for v in 0..4i16 {
            put(&f32::from(v).to_le_bytes());
            put(&f64::from(v * v).to_le_bytes());
            put(&(v * v * v).to_le_bytes());
            put(&[1]);
            put(&7i32.to_le_bytes());
        }
        for face in [&[0u32, 1, 2][..], &[0, 1, 2, 3]] {
            put(&[face.len() as u8]);
            face.iter().for_each(|v| put(&v.to_le_bytes()));
            put(&[255]);
        }
        files.push((MeshFormat::Ply, ply));
    }
    let mut stl = vec![b' '; 80];
    stl.extend(2u32.to_le_bytes());
    for k in 0..2 {
        stl.extend([0; 12]);
        stl.extend((0..9).flat_map(|i| ((i * i + k) as f32).to_le_bytes()));
        stl.extend([0; 2]);
    }
    files.push((MeshFormat::Stl, stl));
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1e0 0\nendloop\nendfacet\n";
    files.push((MeshFormat::Stl, format!("solid a\n{facet}{facet}endsolid a\n").into_bytes()));
    let strips = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\n\
        property list int int vertex_indices\nend_header\n";
    let strips = format!("ply\nformat ascii 1.0\n{strips}0 0 0\n1 0 0\n0 1 0\n0 0 1\n8 0 1 2 3 -1 1 2 0\n");
    files.push((MeshFormat::Ply, strips.into_bytes()));
    files.push((MeshFormat::Off, b"OFF 3 2 0\n0 0 0 1 0 0\n0 1 0\n3 0\n1 2\n3 0 2 1 9\n".to_vec()));
    let polygons = "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 0 0 1\n\
        POLYGONS 2 9\n4 0 1 2 3\n3 0 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 2 3\nLINES 1 3\n2 0 1\nCELL_DATA 4\n\
        SCALARS region int\nLOOKUP_TABLE default\n1 2 3 4\n";
    files.push((MeshFormat::Vtk, polygons.as_bytes().to_vec()));
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files");
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    names.sort();
    for path in names {
        if let Some(format) = MeshFormat::from_extension(&path) {
            files.push((format, std::fs::read(&path).unwrap()));
        }
    }
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    packed.write_all(off).unwrap();
    files.push((MeshFormat::Off, packed.finish().unwrap()));
    let (g, members) = bar();
    files.push((MeshFormat::Gltf, g.gltf(&members)));
    files.push((MeshFormat::Glb, g.glb(&members)));
    files
}

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
    let files = good_files();
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
