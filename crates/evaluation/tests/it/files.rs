//! A benchmark written to disk, read again, and damaged.

use std::fs;

use mser3d_evaluation::shrec::{Benchmark, BenchmarkWriter, Class, ShapeName, transform};
use mser3d_evaluation::{Correspondence, DetectedRegions, IndexSet, NullShape, Score};
use mser3d_shape::TriangleMesh;

/// An octahedron with each face cut into 64: closed, symmetric, 258 vertices.
fn octahedron() -> TriangleMesh {
    let mut vertices =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let mut triangles: Vec<[u32; 3]> =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    for _ in 0..3 {
        let mut middles = std::collections::BTreeMap::new();
        let mut finer = Vec::new();
        for t in triangles {
            let m = [0, 1, 2].map(|i| {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    let (p, q): ([f64; 3], [f64; 3]) = (vertices[a as usize], vertices[b as usize]);
                    vertices.push([0, 1, 2].map(|x| (p[x] + q[x]) / 2.0));
                    vertices.len() as u32 - 1
                })
            });
            finer.extend([[t[0], m[0], m[2]], [m[0], t[1], m[1]], [m[2], m[1], t[2]], m]);
        }
        triangles = finer;
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

fn mirror(mesh: &TriangleMesh) -> Vec<u32> {
    let find = |p: [f64; 3]| mesh.vertices().iter().position(|q| *q == p).unwrap() as u32;
    mesh.vertices().iter().map(|&[x, y, z]| find([-x + 0.0, y, z])).collect()
}

#[test]
fn what_is_missing_or_wrong_is_named_and_the_rest_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let null = NullShape::new(octahedron());
    let null = null.clone().with_symmetry(mirror(null.mesh())).unwrap();
    let writer = BenchmarkWriter::create(folder.path()).unwrap();
    writer.null_shape(1, &null).unwrap();
    let name = |class: Class, strength| ShapeName { null: 1, class: class.to_string(), strength };
    let made = |class, strength| transform(null.mesh(), class, strength, 3).unwrap();
    for class in [Class::Affine, Class::Noise, Class::Rasterize] {
        for strength in 1..=5 {
            writer.transformed(&name(class, strength), &made(class, strength)).unwrap();
        }
    }

    let benchmark = Benchmark::open(folder.path()).unwrap();
    assert_eq!(benchmark.names().count(), 16);
    let read = benchmark.null_shape(1).unwrap();
    assert_eq!((read.mesh(), read.mirror()), (null.mesh(), null.mirror()));
    for shape in benchmark.names().filter(|n| !n.is_null()) {
        let class = shape.class.parse().unwrap();
        assert_eq!(benchmark.transformed(shape, &read).unwrap(), made(class, shape.strength));
    }
    assert!(benchmark.missing().iter().all(|m| m.starts_with("class ")));
    assert_eq!(benchmark.missing().len(), 11 - 3);

    fs::remove_file(folder.path().join("0001.noise.2.off")).unwrap();
    fs::remove_file(folder.path().join("corr/0001.noise.3.corr")).unwrap();
    fs::write(folder.path().join("corr/0001.noise.4.corr"), "1 1 0 0 99999 1 0 0\n").unwrap();
    let benchmark = Benchmark::open(folder.path()).unwrap();
    let missing = benchmark.missing().join("\n");
    assert!(missing.contains("0001.noise.2.off: not there"), "{missing}");
    assert!(missing.contains("0001.noise.3.corr: not there"), "{missing}");
    let error = |strength| {
        let shape = benchmark.transformed(&name(Class::Noise, strength), &read);
        shape.unwrap_err().to_string()
    };
    assert!(error(3).contains("0001.noise.3.corr: "));
    assert!(error(4).contains("0001.noise.4.corr:1: triangle 99999"));
    assert!(benchmark.transformed(&name(Class::Noise, 5), &read).is_ok());
}

#[test]
fn a_folder_without_shapes_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let error = Benchmark::open(folder.path()).unwrap_err().to_string();
    assert!(error.contains("NNNN.<class>.<strength>.off"));
    assert!(Benchmark::open(&folder.path().join("nowhere")).is_err());
}

#[test]
fn any_detector_is_scored_from_a_text() {
    let folder = tempfile::tempdir().unwrap();
    let null = NullShape::new(octahedron());
    let count = null.mesh().vertices().len();
    let (here, there) = (ShapeName::null(1), ShapeName { null: 1, class: "noise".into(), strength: 2 });
    let half = |sign: f64| IndexSet::from_fn(count, |v| sign * null.mesh().vertices()[v][2] > 0.0);
    let found = DetectedRegions {
        regions: vec![half(1.0), half(-1.0)],
        descriptors: vec![vec![0.0, 1.0], vec![1.0, 0.1]],
    };
    found.write(folder.path(), &here).unwrap();
    let read = DetectedRegions::read(folder.path(), &here, count).unwrap();
    assert_eq!(read, found);

    // Found again in the other order, and with descriptors that tell them apart.
    let text = |set: &IndexSet| set.members().map(|v| v.to_string()).collect::<Vec<_>>().join(" ");
    let lines = format!("# by hand\n{}\n{}\n\n", text(&half(-1.0)), text(&half(1.0)));
    fs::write(folder.path().join("0001.noise.2.regions"), lines).unwrap();
    fs::write(folder.path().join("0001.noise.2.descriptors"), "1 0\n0 0.9\n5 5\n").unwrap();
    let again = DetectedRegions::read(folder.path(), &there, count).unwrap();
    let score = Score::new(&null, &read, &again, &Correspondence::identity(count)).unwrap();
    assert_eq!((score.best, score.matched), (vec![1.0, 1.0, 0.0], vec![1.0, 1.0, 0.0]));

    let error = |regions: &str| {
        fs::write(folder.path().join("0001.noise.2.regions"), regions).unwrap();
        DetectedRegions::read(folder.path(), &there, count).unwrap_err().to_string()
    };
    assert!(error("0 1\n2 x\n\n").contains("0001.noise.2.regions:2: \"x\""));
    assert!(error("0 1\n2 258\n\n").contains("0001.noise.2.regions:2: "));
    assert!(error("0 1\n").contains("0001.noise.2.descriptors: 3 descriptors for 1 regions"));
}
