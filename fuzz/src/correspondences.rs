//! What says which points of two shapes are the same, and which regions another detector found.

use mser3d_evaluation::shrec::{Benchmark, ShapeName};
use mser3d_evaluation::{DetectedRegions, NullShape, read_symmetry};

use crate::scratch::{check_message, file, folder};

const OFF: &[u8] = b"OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

/// The first byte says which kind of file the rest is.
pub fn run(input: &[u8]) {
    let Some((&kind, bytes)) = input.split_first() else { return };
    match kind % 4 {
        0 | 1 => {
            let name = ["map.txt", "map.mat"][usize::from(kind % 4)];
            let path = file(name, bytes);
            match read_symmetry(&path, 4) {
                Ok(mirror) => {
                    assert!(mirror.len() == 4 && mirror.iter().all(|&v| v < 4));
                    let mesh = mser3d_meshio::read_mesh(&file("null.off", OFF), &Default::default());
                    let null = NullShape::new(mesh.unwrap_or_else(|error| panic!("{error}")).mesh);
                    let _ = null.with_symmetry(mirror).map_err(|error| check_message(&error.to_string(), ""));
                }
                Err(error) => check_message(&error.to_string(), name),
            }
        }
        2 => {
            let folder = folder().join("shrec");
            let _ = std::fs::create_dir_all(folder.join("corr"));
            let write = |name: &str, bytes: &[u8]| {
                std::fs::write(folder.join(name), bytes).unwrap_or_else(|error| panic!("{error}"));
            };
            write("0001.null.0.off", OFF);
            write("0001.isometry.1.off", OFF);
            write("corr/0001.isometry.1.corr", bytes);
            let benchmark = Benchmark::open(&folder).unwrap_or_else(|error| panic!("{error}"));
            let null = benchmark.null_shape(1).unwrap_or_else(|error| panic!("{error}"));
            let name: ShapeName = "0001.isometry.1".parse().unwrap_or_else(|_| panic!("a name"));
            match benchmark.transformed(&name, &null) {
                Ok(shape) => assert_eq!(shape.points.len(), 4),
                Err(error) => check_message(&error.to_string(), ""),
            }
        }
        _ => {
            file("found.regions", bytes);
            file("found.descriptors", bytes);
            match DetectedRegions::read(folder(), "found", 4) {
                Ok(found) => assert_eq!(found.regions.len(), found.descriptors.len()),
                Err(error) => check_message(&error.to_string(), "found."),
            }
        }
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds: Vec<Vec<u8>> = [
        (0, "1\n0\n3\n2\n"),
        (0, "2 1 4 3"),
        (2, "1 1 0 0 1 1 0 0\n2 .5 .25 .25 2 0 1 0\n"),
        (3, "0 1\n2 3\n# remark\n\n1\n"),
    ]
    .iter()
    .map(|(kind, text)| [&[*kind][..], text.as_bytes()].concat())
    .collect();
    seeds.push([&[1][..], &mat()].concat());
    seeds
}

/// A MAT-file with a variable `isym` of four numbers.
fn mat() -> Vec<u8> {
    let mut bytes = b"MATLAB 5.0 MAT-file".to_vec();
    bytes.resize(124, b' ');
    bytes.extend([0, 1, b'I', b'M']);
    let element = |kind: u32, data: &[u8]| {
        let mut element = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        element.extend(data);
        element.resize(element.len().next_multiple_of(8), 0);
        element
    };
    let numbers: Vec<u8> = [2.0f64, 1.0, 4.0, 3.0].iter().flat_map(|x| x.to_le_bytes()).collect();
    let matrix = [
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
        element(5, &[4, 0, 0, 0, 1, 0, 0, 0]),
        element(1, b"isym"),
        element(9, &numbers),
    ];
    bytes.extend(element(14, &matrix.concat()));
    bytes
}
