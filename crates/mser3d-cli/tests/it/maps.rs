//! Maps from vertex to vertex: `detect --write eigenfunctions`, `match --write map`.

use std::fs;
use std::path::Path;

use crate::common::*;
use mser3d_fileio::{NpyValues, read_npy, read_npz};
use serde_json::Value;

const OPTIONS: &str = "--voxels 8000 --quiet --reliability 0 --write eigenfunctions";

/// The vertices of an OFF file, and the rest of its lines.
fn off(path: &Path) -> (Vec<[f64; 3]>, Vec<String>) {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().skip(1);
    let count: usize = lines.next().unwrap().split_whitespace().next().unwrap().parse().unwrap();
    let vertex = |line: &str| {
        let numbers: Vec<f64> = line.split_whitespace().map(|x| x.parse().unwrap()).collect();
        [numbers[0], numbers[1], numbers[2]]
    };
    let vertices = lines.by_ref().take(count).map(vertex).collect();
    (vertices, lines.map(str::to_owned).collect())
}

/// The map that `match --write map` writes.
fn map(first: &Path, second: &Path, out: &Path, options: &str) -> Vec<i32> {
    let mut arguments = vec!["match".as_ref(), first, second, "-o".as_ref(), out];
    arguments.extend(["--write", "map"].map(Path::new));
    arguments.extend(options.split_whitespace().map(Path::new));
    let output = mser3d(arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let (array, _) = read_npy(&out.join("map.npy"), &Default::default()).unwrap();
    let NpyValues::I32(map) = array.values() else { panic!("{array:?}") };
    map.to_vec()
}

/// The mean distance of where vertices are mapped to from where they should be.
fn error(map: &[i32], vertices: &[[f64; 3]], expected: impl Fn(usize) -> usize) -> f64 {
    assert_eq!(map.len(), vertices.len());
    let distance = |(vertex, &found): (usize, &i32)| {
        let (p, q) = (vertices[found as usize], vertices[expected(vertex)]);
        (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt()
    };
    map.iter().enumerate().map(distance).sum::<f64>() / map.len() as f64
}

#[test]
fn a_shape_is_mapped_to_itself_and_to_its_mirror_image() {
    let folder = tempfile::tempdir().unwrap();
    let input = fixtures().join("quadruped_gallop.off");
    let (vertices, rest) = off(&input);
    let mirrored = folder.path().join("mirrored.off");
    let lines = vertices.iter().map(|[x, y, z]| format!("{} {y} {z}\n", -x));
    let triangle = |line: &String| {
        let ids: Vec<&str> = line.split_whitespace().collect();
        format!("3 {} {} {}\n", ids[1], ids[3], ids[2])
    };
    let triangles: Vec<String> = rest.iter().map(triangle).collect();
    let head = format!("OFF\n{} {} 0\n", vertices.len(), triangles.len());
    fs::write(&mirrored, head + &lines.collect::<String>() + &triangles.concat()).unwrap();
    let [own, image, out] = ["own", "image", "out"].map(|name| folder.path().join(name));
    let record = regions(&input, &own, OPTIONS);
    let record_of_image = regions(&mirrored, &image, OPTIONS);
    let pitch = record["grid"]["affine"][0][0].as_f64().unwrap();
    assert_eq!(record["bodies"][0]["sidedness"]["kind"], Value::from("sided"));
    assert_eq!(record_of_image["bodies"][0]["sidedness"]["kind"], Value::from("sided"));

    // Vertices of one voxel go to one of them.
    let same = map(&own, &own, &out, "");
    let farthest = (0..same.len()).map(|v| {
        let (p, q) = (vertices[v], vertices[same[v] as usize]);
        (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt()
    });
    let farthest = farthest.fold(0.0, f64::max);
    assert!(farthest < 2.0 * 3f64.sqrt() * pitch, "{farthest}");
    assert!(error(&same, &vertices, |v| v) < pitch);

    // Left goes to left, or with --allow-mirror each vertex to its own image.
    let symmetry = fs::read_to_string(fixtures().join("quadruped_symmetry.txt")).unwrap();
    let symmetry: Vec<usize> = symmetry.split_whitespace().map(|v| v.parse().unwrap()).collect();
    let image_of = map(&own, &image, &out, "--allow-mirror");
    let sided = map(&own, &image, &out, "");
    assert!(error(&image_of, &vertices, |v| v) < pitch);
    assert!(error(&sided, &vertices, |v| symmetry[v]) < 1.5 * pitch);
    assert!(error(&sided, &vertices, |v| v) > 4.0 * pitch);
}

#[test]
fn eigenfunctions_are_orthonormal_and_needed() {
    let folder = tempfile::tempdir().unwrap();
    let input = fixtures().join("human_walk.off");
    let [own, bare, out] = ["own", "bare", "out"].map(|name| folder.path().join(name));
    regions(&input, &own, OPTIONS);
    let arrays = read_npz(&own.join("eigenfunctions.npz")).unwrap();
    let (NpyValues::F32(phi), NpyValues::F64(mass), NpyValues::F64(eigenvalues)) =
        (arrays["eigenfunctions"].values(), arrays["mass"].values(), arrays["eigenvalues"].values())
    else {
        panic!("{:?}", arrays.keys());
    };
    let k = eigenvalues.len();
    assert_eq!(arrays["eigenfunctions"].shape(), [mass.len(), k]);
    for (i, j) in [(0, 0), (1, 1), (1, 2), (3, 9), (k - 1, k - 1)] {
        let rows = phi.chunks_exact(k).zip(mass.iter());
        let product: f64 = rows.map(|(row, m)| m * f64::from(row[i]) * f64::from(row[j])).sum();
        assert!((product - f64::from(i == j)).abs() < 1e-5, "{i} {j}: {product}");
    }
    let NpyValues::I32(rows) = arrays["vertex_row"].values() else { panic!("vertex_row") };
    assert_eq!(rows.len(), off(&input).0.len());
    assert!(rows.iter().all(|&row| (0..mass.len() as i32).contains(&row)));

    regions(&input, &bare, &OPTIONS.replace("--write eigenfunctions", ""));
    assert!(!bare.join("eigenfunctions.npz").exists());
    let pair = |first: &Path, second: &Path| {
        let arguments = ["match".as_ref(), first, second, "-o".as_ref(), &out];
        mser3d(arguments.into_iter().chain(["--write", "map"].map(Path::new)))
    };
    for (first, second) in [(&own, &bare), (&bare, &own)] {
        assert_fails(&pair(first, second), 1, &["bare", "mser3d detect INPUT --write eigenfunctions"]);
        assert!(!out.exists());
    }
    // Those of another result are none of its own.
    let other = fixtures().join("human_kick.off");
    regions(&other, &bare, &OPTIONS.replace("--write eigenfunctions", ""));
    fs::copy(own.join("eigenfunctions.npz"), bare.join("eigenfunctions.npz")).unwrap();
    assert_fails(&pair(&own, &bare), 1, &["eigenfunctions.npz", "not that of features.npz"]);
    let output = mser3d(["match", "a", "b", "--write", "map"]);
    assert_fails(&output, 2, &["--output"]);
}

#[test]
fn of_a_mask_voxels_are_mapped() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("club.npy");
    let inside = |x: usize, y: usize, z: usize| {
        x < 12 || (x < 28 && (4..8).contains(&y) && (4..8).contains(&z) && (x < 20 || y < 6))
    };
    fs::write(&path, npy([30, 12, 12], inside)).unwrap();
    let [own, out] = ["own", "out"].map(|name| folder.path().join(name));
    regions(&path, &own, "--pitch 0.5 --quiet --write eigenfunctions");
    let map = map(&own, &own, &out, "");
    assert_eq!(map.len(), 12 * 12 * 12 + 16 * 4 * 4 - 8 * 2 * 4);
    // What is no mirror image of anything in it is mapped to itself.
    let moved = map.iter().enumerate().filter(|(voxel, to)| *voxel as i32 != **to).count();
    assert!(moved * 100 < map.len(), "{moved} of {}", map.len());
}
