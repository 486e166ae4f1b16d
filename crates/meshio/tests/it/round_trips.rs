//! What is written is read back.

use mser3d_meshio::{
    Moment, ReadOptions, VertexAttributes, VoxelField, VoxelValues, list_animations, read_mesh, write_glb,
    write_moving_glb, write_off, write_ply, write_vti, write_vtp,
};
use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use std::io::Write;
use std::path::PathBuf;

/// Duplicates, an unused vertex, coordinates that need 17 digits, a degenerate triangle.
fn mesh() -> TriangleMesh {
    let vertices = vec![
        [9.0, 9.0, 9.0],
        [0.1, -0.0, 1e-300],
        [1.0 / 3.0, 1e20, 0.0],
        [0.1, 0.0, 0.0],
        [0.0, 1.0, 16777217.0],
        [0.0, 1.0, 16777217.0],
    ];
    TriangleMesh::new(vertices, vec![[4, 3, 1], [1, 2, 5], [2, 2, 3]]).unwrap()
}

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_path_buf();
    (folder, move |name| path.join(name))
}

#[test]
fn off_and_ply_keep_every_bit_and_the_order() {
    let (_folder, path) = folder();
    let mesh = mesh();
    let colors = vec![[1, 2, 3]; 6];
    let regions: Vec<i32> = (-1..5).collect();
    let normals = vec![[0.0, 0.0, 1.0]; 6];
    let all = VertexAttributes { colors: Some(&colors), regions: Some(&regions), normals: Some(&normals) };
    write_off(&path("a.off"), &mesh).unwrap();
    write_ply(&path("plain.ply"), &mesh, &VertexAttributes::default()).unwrap();
    write_ply(&path("full.ply"), &mesh, &all).unwrap();
    for name in ["a.off", "plain.ply", "full.ply"] {
        let read = read_mesh(&path(name), &ReadOptions::default()).unwrap();
        assert_eq!(read.mesh, mesh, "{name}");
        let bits = |m: &TriangleMesh| m.vertices().iter().flatten().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(&read.mesh), bits(&mesh), "{name}");
        assert!(read.weld.is_none() && read.notes.is_empty());
    }
    let short = VertexAttributes { colors: Some(&colors[..5]), ..all };
    let error = write_ply(&path("short.ply"), &mesh, &short).unwrap_err();
    assert_eq!(error.to_string(), "vertex colors: 5 given, 6 needed");
    assert!(!path("short.ply").exists());
}

#[test]
fn glb_comes_back_welded_in_single_precision() {
    let (_folder, path) = folder();
    let mesh = mesh();
    let (colors, regions) = (vec![[255, 0, 128]; 6], vec![-1; 6]);
    let attributes = VertexAttributes { colors: Some(&colors), regions: Some(&regions), normals: None };
    let notes = write_glb(&path("a.glb"), &mesh, &attributes).unwrap();
    let read = read_mesh(&path("a.glb"), &ReadOptions::default()).unwrap();
    // 1e-300 is 0 in f32, so 1 and 3 meet; so do 4 and 5.
    assert_eq!(read.weld.as_deref(), Some(&[0, 1, 2, 1, 3, 3][..]));
    assert_eq!(read.mesh.triangles(), [[1, 2, 3]]);
    assert_eq!(read.notes, ["2 triangles with two equal corners left out"]);
    assert_eq!(read.mesh.vertices()[3], [0.0, 1.0, 16777216.0]);

    let note = "1 vertices fall on another one in the 32-bit numbers of glTF; write .ply to keep them apart";
    assert_eq!(notes, [note]);

    let huge = mesh.with_vertices(vec![[1e39; 3]; 6]).unwrap();
    assert!(write_glb(&path("b.glb"), &huge, &VertexAttributes::default()).is_err());
}

#[test]
fn glb_keeps_its_shape_wherever_it_is() {
    let (_folder, path) = folder();
    // A tetrahedron with odd digits, and a vertex at the origin that nothing uses.
    let shape = [[0.0; 3], [0.123456, 0.0, 0.1], [1.0, 0.3, 0.0], [0.2, 0.87654321, 0.4], [0.1, 0.25, 0.98]];
    for (size, place) in [
        (1.0, [0.0, 0.0, 0.0]),
        (1.0, [0.4, -0.5, 0.0]),
        (100.0, [512345.678, 4649776.22, 312.0]),
        (0.1, [512345.678, -4649776.22, 0.0]),
        (1e-3, [0.0, 1e6, 0.0]),
        (1e-3, [1e-2, 0.0, 0.0]),
        (1e20, [1e22, 0.0, 3e20]),
    ] {
        let mut vertices: Vec<[f64; 3]> =
            shape.iter().map(|p| std::array::from_fn(|a| size * p[a] + place[a])).collect();
        vertices[0] = [0.0; 3];
        let mesh = TriangleMesh::new(vertices, vec![[1, 3, 2], [1, 2, 4], [2, 3, 4], [1, 4, 3]]).unwrap();
        let notes = write_glb(&path("a.glb"), &mesh, &VertexAttributes::default()).unwrap();
        assert!(notes.is_empty(), "{notes:?}");
        let back = read_mesh(&path("a.glb"), &ReadOptions::default()).unwrap().mesh;
        assert_eq!(back.triangles(), mesh.triangles());
        for (a, b) in back.vertices().iter().zip(mesh.vertices()).skip(1) {
            // The second term is what f64 itself cuts off there.
            let allowed = |i: usize| 6e-8 * size + 4.0 * f64::EPSILON * b[i].abs();
            assert!((0..3).all(|i| (a[i] - b[i]).abs() <= allowed(i)), "{size} at {place:?}: {a:?} {b:?}");
        }
    }
}

#[test]
fn glb_tells_what_it_loses() {
    let (_folder, path) = folder();
    // Two tetrahedra so far apart that two corners of the second are one in f32.
    let corners = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    let far = corners.map(|[x, y, z]| [x + 4e9, y, z]);
    let sides = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
    let triangles = [sides, sides.map(|t| t.map(|v| v + 4))].concat();
    let mesh = TriangleMesh::new([corners, far].concat(), triangles).unwrap();
    let notes = write_glb(&path("a.glb"), &mesh, &VertexAttributes::default()).unwrap();
    assert_eq!(notes.len(), 1);
    assert!(notes[0].starts_with("1 vertices fall on another one"), "{notes:?}");
}

#[test]
fn vtp_is_read_back() {
    let (_folder, path) = folder();
    let (mesh, regions) = (mesh(), [-1, 0, 1, 2, 3, 4]);
    let attributes = VertexAttributes { regions: Some(&regions), ..Default::default() };
    write_vtp(&path("a.vtp"), &mesh, &attributes).unwrap();
    let read = read_mesh(&path("a.vtp"), &ReadOptions::default()).unwrap();
    assert_eq!((read.mesh, read.notes.len()), (mesh, 0));
}

#[test]
fn packed_files_are_read_as_what_is_in_them() {
    let (_folder, path) = folder();
    let mesh = mesh();
    let pack = |from: &str, to: &str| {
        let mut out = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        out.write_all(&std::fs::read(path(from)).unwrap()).unwrap();
        std::fs::write(path(to), out.finish().unwrap()).unwrap();
    };
    write_off(&path("a.off"), &mesh).unwrap();
    write_ply(&path("a.ply"), &mesh, &VertexAttributes::default()).unwrap();
    write_vtp(&path("a.vtp"), &mesh, &VertexAttributes::default()).unwrap();
    write_glb(&path("a.glb"), &mesh, &VertexAttributes::default()).unwrap();
    for name in ["a.off", "a.ply", "a.vtp", "a.glb"] {
        let plain = read_mesh(&path(name), &ReadOptions::default()).unwrap();
        // With the ending and without, as browsers and copying may change it.
        for packed in [format!("{name}.gz"), format!("{name}.GZ"), name.replace("a.", "b.")] {
            pack(name, &packed);
            assert_eq!(read_mesh(&path(&packed), &ReadOptions::default()).unwrap(), plain, "{packed}");
        }
        assert!(list_animations(&path(&format!("{name}.gz")), &Default::default()).unwrap().is_empty());
        std::fs::copy(path(name), path(&format!("{name}.gz"))).unwrap();
        assert_eq!(read_mesh(&path(&format!("{name}.gz")), &ReadOptions::default()).unwrap(), plain);
    }
}

#[test]
fn vtp_holds_points_triangles_and_regions() {
    let (_folder, path) = folder();
    let (mesh, regions) = (mesh(), [-1, 0, 1, 2, 3, 4]);
    let attributes = VertexAttributes { regions: Some(&regions), ..Default::default() };
    write_vtp(&path("a.vtp"), &mesh, &attributes).unwrap();
    let bytes = std::fs::read(path("a.vtp")).unwrap();
    let start = bytes.windows(2).position(|w| w == b"\n_").unwrap() + 2;
    let header = std::str::from_utf8(&bytes[..start]).unwrap();
    assert!(header.contains(r#"NumberOfPoints="6" NumberOfPolys="3""#));
    // Each array begins with its length in bytes, where the header says.
    let array = |name: &str| {
        let declared = header.lines().find(|line| line.contains(&format!("Name=\"{name}\""))).unwrap();
        let offset = declared.split("offset=\"").nth(1).unwrap().split('"').next().unwrap();
        let at = start + offset.parse::<usize>().unwrap();
        let length = u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap()) as usize;
        &bytes[at + 8..at + 8 + length]
    };
    let whole = |name: &str| -> Vec<i64> {
        array(name).as_chunks().0.iter().map(|&b| i64::from_le_bytes(b)).collect()
    };
    let region: Vec<i32> = array("region").as_chunks().0.iter().map(|&b| i32::from_le_bytes(b)).collect();
    let points: Vec<f64> = array("points").as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect();
    assert_eq!(region, regions);
    assert_eq!(points, mesh.vertices().as_flattened());
    assert_eq!(whole("connectivity"), [4, 3, 1, 1, 2, 5, 2, 2, 3]);
    assert_eq!(whole("offsets"), [3, 6, 9]);
    assert!(bytes.ends_with(b"\n</AppendedData>\n</VTKFile>\n"));
}

#[test]
fn vti_holds_the_box_x_fastest() {
    let (_folder, path) = folder();
    let dims = [3, 2, 2];
    let mut inside = BitGrid::empty(dims).unwrap();
    for voxel in [[0, 0, 0], [2, 1, 0], [1, 0, 1]] {
        inside.set(voxel, true);
    }
    let grid = VoxelGrid::solid(Frame::new(dims, [1.5, 0.0, -2.0], [0.5; 3]).unwrap(), inside).unwrap();
    let (labels, numbers) = ([7, -1, 9], [0.5, 1.5, 2.5]);
    let fields = [
        VoxelField { name: "region", values: VoxelValues::Labels(&labels) },
        VoxelField { name: "heat", values: VoxelValues::Numbers(&numbers) },
    ];
    write_vti(&path("a.vti"), &grid, &fields).unwrap();
    let bytes = std::fs::read(path("a.vti")).unwrap();
    let start = bytes.windows(2).position(|w| w == b"\n_").unwrap() + 2;
    let header = std::str::from_utf8(&bytes[..start]).unwrap();
    assert!(header.contains(r#"WholeExtent="0 3 0 2 0 2" Origin="1.5 0.0 -2.0" Spacing="0.5 0.5 0.5""#));
    let data = &bytes[start..];
    assert_eq!(data[..8], 48u64.to_le_bytes());
    let region: Vec<i32> = data[8..56].as_chunks().0.iter().map(|&b| i32::from_le_bytes(b)).collect();
    assert_eq!(region, [7, -2, -2, -2, -2, -1, -2, 9, -2, -2, -2, -2]);
    let at = header.find(r#"Name="heat""#).unwrap();
    assert!(header[at..].contains(r#"offset="56""#));
    let heat: Vec<f64> = data[64..160].as_chunks().0.iter().map(|&b| f64::from_le_bytes(b)).collect();
    assert_eq!((heat[0], heat[5], heat[7]), (0.5, 1.5, 2.5));
    assert_eq!(heat.iter().filter(|x| x.is_nan()).count(), 9);
    assert_eq!(data[168..180], [1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0, 0]);

    let short = [VoxelField { name: "region", values: VoxelValues::Labels(&labels[..2]) }];
    assert!(write_vti(&path("b.vti"), &grid, &short).is_err());
    let taken = [VoxelField { name: "inside", values: VoxelValues::Labels(&labels) }];
    assert!(write_vti(&path("b.vti"), &grid, &taken).is_err());
    assert!(!path("b.vti").exists());
}

#[test]
fn a_moving_glb_is_read_at_its_moments_and_between_them() {
    let (_folder, path) = folder();
    let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap();
    // Times that are sums of powers of two, and so exact in f32.
    let moment = |time: f64, bend: f64| {
        let vertices = mesh.vertices().iter().map(|p| [p[0] + bend * p[2], p[1] - bend, p[2]]).collect();
        Moment { time, vertices }
    };
    let moments = [moment(0.5, 0.0), moment(0.75, 1.0), moment(2.0, -2.0)];
    let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [9, 9, 9]];
    write_moving_glb(&path("a.glb"), &mesh, &moments, &colors).unwrap();
    let animations = list_animations(&path("a.glb"), &Default::default()).unwrap();
    assert_eq!((animations.len(), animations[0].start, animations[0].end), (1, 0.0, 1.5));
    let at = |time: f64| {
        let options = ReadOptions { animation: Some("sequence".into()), time, ..Default::default() };
        read_mesh(&path("a.glb"), &options).unwrap().mesh
    };
    for (time, expected) in [(0.0, &moments[0]), (0.25, &moments[1]), (1.5, &moments[2])] {
        assert_eq!(at(time).vertices(), expected.vertices, "{time}");
        assert_eq!(at(time).triangles(), mesh.triangles());
    }
    // Half way from the first moment to the second.
    assert_eq!(at(0.125).vertices(), moment(0.0, 0.5).vertices);

    let error = |moments: &[Moment], colors: &[[u8; 3]]| {
        write_moving_glb(&path("b.glb"), &mesh, moments, colors).unwrap_err().to_string()
    };
    assert!(error(&moments[..1], &colors).contains("at least 2"));
    assert!(error(&moments, &colors[1..]).contains("vertex colors"));
    assert!(error(&[moment(1.0, 0.0), moment(1.0, 1.0)], &colors).contains("later than"));
    let far = Moment { time: 1.0, vertices: vec![[1e300; 3]; 4] };
    assert!(error(&[moment(0.0, 0.0), far], &colors).contains("scale the mesh down"));
    assert!(!path("b.glb").exists());
}
