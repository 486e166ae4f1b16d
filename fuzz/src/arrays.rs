//! NumPy's arrays, and the small tables and fields that users hand over.

use mser3d_fileio::{NpyArray, read_npy, read_npz, write_npz};
use mser3d_results::{FieldFile, ShapeFile, ShapeOptions};
use mser3d_shape::TriangleMesh;
use mser3d_volumeio::{read_affine, read_label_names};

use crate::scratch::{check_message, file, folder};

/// `.npz` and `.npy` as the results use them. What is read has as many values as its shape says, and survives being written.
pub fn npz(bytes: &[u8]) {
    let path = file("arrays.npz", bytes);
    match read_npz(&path) {
        Ok(arrays) => {
            arrays.values().for_each(check);
            if arrays.len() < 8 && bytes.len() < 4096 {
                let named: Vec<(&str, NpyArray)> =
                    arrays.iter().map(|(name, array)| (name.as_str(), array.clone())).collect();
                let again = folder().join("again.npz");
                if write_npz(&again, &named).is_ok() {
                    let read = read_npz(&again).unwrap_or_else(|error| panic!("{error}"));
                    assert_eq!(read.len(), arrays.len());
                }
            }
        }
        Err(error) => check_message(&error.to_string(), "arrays.npz"),
    }
    let path = file("array.npy", bytes);
    match read_npy(&path, &Default::default()) {
        Ok((array, _)) => check(&array),
        Err(error) => check_message(&error.to_string(), "array.npy"),
    }
}

fn check(array: &NpyArray) {
    assert_eq!(array.shape().iter().product::<usize>(), array.values().len());
}

/// Whole files of arrays, named ones and single ones.
pub fn npz_seeds() -> Vec<Vec<u8>> {
    let path = folder().join("seed.npz");
    let arrays = [
        ("vertex_region", NpyArray::flat(vec![-1i32, 0, 3])),
        ("eigenvalues", NpyArray::flat(vec![0.0, 0.25])),
        ("voxels", NpyArray::flat(vec![1u32, 2])),
    ];
    write_npz(&path, &arrays).unwrap_or_else(|error| panic!("{error}"));
    let whole = std::fs::read(&path).unwrap_or_default();
    let mut seeds = npy_files();
    seeds.push(whole);
    seeds
}

fn npy_files() -> Vec<Vec<u8>> {
    let path = folder().join("seed.npy");
    let arrays = [
        NpyArray::flat(vec![0.5, 0.25, 1.0, 7.0]),
        NpyArray::flat(vec![1i64, 2, 3, 4]),
        NpyArray::flat(vec![1u8, 2, 3, 4]),
        NpyArray::new(&[4, 2], vec![1f32; 8]).unwrap_or_else(|error| panic!("{error}")),
    ];
    let written = arrays.iter().map(|array| {
        mser3d_fileio::write_npy(&path, array).unwrap_or_else(|error| panic!("{error}"));
        std::fs::read(&path).unwrap_or_default()
    });
    let mut files: Vec<Vec<u8>> = written.collect();
    let fortran = files[3].iter().map(|&byte| byte as char).collect::<String>().replace("False", "True ");
    files.push(fortran.chars().map(|c| c as u8).collect());
    files
}

/// A field on a tetrahedron: a number or a vector for each vertex.
pub fn field(bytes: &[u8]) {
    thread_local! {
        static SHAPE: ShapeFile = {
            let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let mesh = TriangleMesh::new(vertices, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
            let mesh = mesh.unwrap_or_else(|error| panic!("{error}"));
            ShapeFile::of_mesh(mesh, "tetrahedron", &ShapeOptions::default()).unwrap_or_else(|error| panic!("{error}"))
        };
    }
    let path = file("field.npy", bytes);
    match FieldFile::read(&path, &Default::default()) {
        Ok(read) => SHAPE.with(|shape| {
            if let Err(error) = read.on(shape) {
                check_message(&error.to_string(), "field.npy");
            }
        }),
        Err(error) => check_message(&error.to_string(), "field.npy"),
    }
}

pub fn field_seeds() -> Vec<Vec<u8>> {
    npy_files()
}

/// Tables of labels, and affines as text.
pub fn tables(bytes: &[u8]) {
    let path = file("table.txt", bytes);
    match read_label_names(&path, &Default::default()) {
        Ok(names) => {
            let mut values: Vec<i64> = names.iter().map(|name| name.value).collect();
            values.sort_unstable();
            values.dedup();
            assert_eq!(values.len(), names.len());
        }
        Err(error) => check_message(&error.to_string(), "table.txt"),
    }
    match read_affine(&path, &Default::default()) {
        Ok(affine) => assert!(affine.matrix().as_flattened().iter().all(|x| x.is_finite())),
        Err(error) => check_message(&error.to_string(), "table.txt"),
    }
}

pub fn table_seeds() -> Vec<Vec<u8>> {
    let texts = [
        "# FreeSurfer\n2 Left-Cerebral-White-Matter 245 245 245 0\n3 Left-Cortex 205 62 78 0\n",
        "value,name\n1,\"liver, left\"\n2;spleen\n",
        "1\t0\t0\t0\t0\t\"Clear Label\"\n",
        "1 0 0 5\n0 1 0 6\n0 0 2 7\n0 0 0 1\n",
        "[[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 2, 7]]",
    ];
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}
