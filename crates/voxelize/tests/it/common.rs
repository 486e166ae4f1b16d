//! Shapes with known answers.
#![allow(dead_code, missing_docs)]

use mser3d_shape::TriangleMesh;
use std::collections::HashMap;
use std::path::PathBuf;

pub type Vec3 = [f64; 3];

/// The box between two corners, 12 triangles facing outwards.
pub fn cuboid(min: Vec3, max: Vec3) -> TriangleMesh {
    let vertices = (0..8).map(|i| std::array::from_fn(|a| if i >> a & 1 == 1 { max[a] } else { min[a] }));
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh::new(vertices.collect(), triangles).unwrap()
}

/// An octahedron's faces, subdivided and pushed out to a sphere.
pub fn sphere(centre: Vec3, radius: f64, subdivisions: usize) -> TriangleMesh {
    let mut vertices: Vec<Vec3> =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..subdivisions {
        let mut middles = HashMap::new();
        let mut next = Vec::new();
        for [a, b, c] in triangles {
            let mut middle = |u: u32, v: u32| {
                *middles.entry((u.min(v), u.max(v))).or_insert_with(|| {
                    let (p, q) = (vertices[u as usize], vertices[v as usize]);
                    let sum: Vec3 = std::array::from_fn(|i| p[i] + q[i]);
                    let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
                    vertices.push(sum.map(|x| x / length));
                    vertices.len() as u32 - 1
                })
            };
            let (d, e, f) = (middle(a, b), middle(b, c), middle(c, a));
            next.extend([[a, d, f], [d, b, e], [f, e, c], [d, e, f]]);
        }
        triangles = next;
    }
    let vertices = vertices.iter().map(|p| std::array::from_fn(|a| centre[a] + radius * p[a])).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// A torus of radii 1 and 0.4 around z, m x n quads.
pub fn torus(m: u32, n: u32) -> TriangleMesh {
    let vertices = (0..m * n)
        .map(|i| {
            let (u, v) = (f64::from(i / n) / f64::from(m), f64::from(i % n) / f64::from(n));
            let (u, v) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
            let r = 1.0 + 0.4 * v.cos();
            [r * u.cos(), r * u.sin(), 0.4 * v.sin()]
        })
        .collect();
    let at = |i: u32, j: u32| i % m * n + j % n;
    let triangles = (0..m)
        .flat_map(|i| (0..n).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            [[a, b, c], [a, c, d]]
        })
        .collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// Several meshes as one.
pub fn together(meshes: &[TriangleMesh]) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for mesh in meshes {
        let shift = vertices.len() as u32;
        vertices.extend_from_slice(mesh.vertices());
        triangles.extend(mesh.triangles().iter().map(|t| t.map(|v| v + shift)));
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

pub fn inside_out(mesh: &TriangleMesh) -> TriangleMesh {
    let triangles = mesh.triangles().iter().map(|&[a, b, c]| [a, c, b]).collect();
    TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap()
}

pub fn moved(mesh: &TriangleMesh, place: impl Fn(Vec3) -> Vec3) -> TriangleMesh {
    mesh.with_vertices(mesh.vertices().iter().map(|&p| place(p)).collect()).unwrap()
}

/// The same mesh with its triangles chosen and turned.
pub fn altered(
    mesh: &TriangleMesh,
    mut alter: impl FnMut(usize, [u32; 3]) -> Option<[u32; 3]>,
) -> TriangleMesh {
    let triangles = mesh.triangles().iter().enumerate().filter_map(|(i, &t)| alter(i, t)).collect();
    TriangleMesh::new(mesh.vertices().to_vec(), triangles).unwrap()
}

/// A rotation about an axis through the origin (Rodrigues).
pub fn rotation(axis: Vec3, angle: f64) -> impl Fn(Vec3) -> Vec3 {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = angle.sin_cos();
    move |p| {
        let dot = x * p[0] + y * p[1] + z * p[2];
        let cross = [y * p[2] - z * p[1], z * p[0] - x * p[2], x * p[1] - y * p[0]];
        std::array::from_fn(|i| p[i] * c + cross[i] * s + [x, y, z][i] * dot * (1.0 - c))
    }
}

/// Numbers in [0, 1) that are the same every time.
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as f64 / (1u64 << 31) as f64
    }
}

/// Real shapes; none, and a word about it, where they are absent.
pub fn real_shapes() -> Vec<(String, TriangleMesh)> {
    let folder = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/makehuman"));
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .map(|entries| entries.flatten().map(|e| e.path()).collect())
        .unwrap_or_default();
    files.retain(|f| f.extension().is_some_and(|e| e == "off"));
    files.sort();
    if files.is_empty() {
        eprintln!("skipped: the shapes of MakeHuman are not there");
    }
    files
        .iter()
        .map(|f| {
            (
                f.file_stem().unwrap().to_string_lossy().into_owned(),
                read_off(&std::fs::read_to_string(f).unwrap()),
            )
        })
        .collect()
}

/// A file of the shared data, OFF or OBJ; `None`, and a word about it, where it is absent.
pub fn shared(path: &str) -> Option<TriangleMesh> {
    let file = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared")).join(path);
    let text = std::fs::read_to_string(&file).ok();
    if text.is_none() {
        eprintln!("skipped: {path} is not there");
    }
    let text = text?;
    Some(if path.ends_with(".obj") { read_obj(&text) } else { read_off(&text) })
}

/// The faces of an OBJ file, larger ones as fans.
fn read_obj(text: &str) -> TriangleMesh {
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let mut number = || words.next().unwrap().parse::<f64>().unwrap();
                vertices.push(std::array::from_fn(|_| number()));
            }
            Some("f") => {
                let corners: Vec<u32> =
                    words.map(|w| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1).collect();
                triangles.extend((2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]));
            }
            _ => {}
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// A shape of the project's own.
pub fn fixture(name: &str) -> TriangleMesh {
    let path = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures")).join(name);
    read_off(&std::fs::read_to_string(path).unwrap())
}

fn read_off(text: &str) -> TriangleMesh {
    let mut words = text.split_whitespace().skip(1);
    let counts: Vec<usize> = (0..3).map(|_| words.next().unwrap().parse().unwrap()).collect();
    let mut number = || words.next().unwrap().parse::<f64>().unwrap();
    let vertices = (0..counts[0]).map(|_| std::array::from_fn(|_| number())).collect();
    let triangles = (0..counts[1])
        .map(|_| {
            assert_eq!(number(), 3.0);
            std::array::from_fn(|_| number() as u32)
        })
        .collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}
