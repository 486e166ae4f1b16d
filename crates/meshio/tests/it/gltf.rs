//! glTF against cases computed by hand.

use crate::common::{CORNERS, Gltf, SIDES, bar};
use mser3d_meshio::{LoadedMesh, MeshFormat, ReadOptions, read_mesh_from};
use std::path::Path;

fn read(bytes: &[u8], animation: Option<&str>, time: f64) -> LoadedMesh {
    let options = ReadOptions { animation: animation.map(str::to_owned), time, ..Default::default() };
    read_mesh_from(MeshFormat::Gltf, bytes, Path::new("made.gltf"), &options).unwrap()
}

fn assert_near(found: &[[f64; 3]], expected: &[[f64; 3]], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (f, e) in found.iter().zip(expected) {
        assert!((0..3).all(|a| (f[a] - e[a]).abs() <= tolerance), "{f:?} should be {e:?}");
    }
}

#[test]
fn node_transforms_place_each_primitive_and_keep_it_facing_outwards() {
    let mut g = Gltf::default();
    let (position, sides) = (g.points(&CORNERS), g.indices(&SIDES));
    // 90 degrees about z over a mirror in x; below a translation and a scale by two.
    let bytes = g.gltf(&format!(
        r#""scenes":[{{"nodes":[2]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}],
        "nodes":[{{"mesh":0,"rotation":[0,0,0.70710678,0.70710678],"scale":[-1,1,1]}},
                 {{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,10,1]}},
                 {{"children":[0,1,3],"translation":[5,0,0],"scale":[2,2,2]}},
                 {{"name":"empty"}}]"#
    ));
    let read = read(&bytes, None, 0.0);
    let first = [[5., 0., 0.], [5., -2., 0.], [3., 0., 0.], [5., 0., 2.]];
    let second = [[5., 0., 20.], [7., 0., 20.], [5., 2., 20.], [5., 0., 22.]];
    assert_near(read.mesh.vertices(), &[first, second].concat(), 1e-6);
    assert!((read.mesh.signed_volume() - 2.0 * 8.0 / 6.0).abs() < 1e-6);
}

#[test]
fn primitives_are_welded_where_they_meet() {
    let mut g = Gltf::default();
    // A tetrahedron as a strip of two sides and a fan of the other two; and a stray line.
    let (strip, fan) = (g.points(&[CORNERS[1], CORNERS[0], CORNERS[2], CORNERS[3]]), g.points(&CORNERS));
    let order = g.indices(&[3, 0, 1, 2]);
    let bytes = g.gltf(&format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[
        {{"attributes":{{"POSITION":{strip}}},"mode":5}},
        {{"attributes":{{"POSITION":{fan}}},"indices":{order},"mode":6}},
        {{"attributes":{{"POSITION":{fan}}},"mode":3}}]}}]"#
    ));
    let read = read(&bytes, None, 0.0);
    // First occurrence numbers the vertices: those of the strip.
    assert_eq!(read.mesh.vertices()[0], [1.0, 0.0, 0.0]);
    assert_eq!(read.weld.as_deref(), Some(&[0, 1, 2, 3, 1, 0, 2, 3][..]));
    assert_eq!(read.mesh.triangles(), [[0, 1, 2], [2, 1, 3], [3, 1, 0], [3, 0, 2]]);
    assert!((read.mesh.signed_volume().abs() - 1.0 / 6.0).abs() < 1e-12);
    assert_eq!(read.notes, ["1 primitives of points or lines left out"]);
    let values = read.per_file_vertex(&["a", "b", "c", "d"]).unwrap();
    assert_eq!(values, ["a", "b", "c", "d", "b", "a", "c", "d"]);
    assert!(read.per_file_vertex(&["a"]).is_err());
}

#[test]
fn a_skin_blends_its_joints_and_ignores_the_node_of_the_mesh() {
    let (g, members) = bar();
    let bytes = g.gltf(&members);
    let rest = [[0., 0., 5.], [1., 0.5, 5.], [2., 0., 5.], [0., 0., 5.5]];
    assert_near(read(&bytes, None, 0.0).mesh.vertices(), &rest, 1e-12);

    // An eighth of a turn about (1, 0, 5): the tip moves whole, the middle by four fifths.
    let (sin, cos) = std::f64::consts::FRAC_PI_4.sin_cos();
    let tip = [1. + cos, sin, 5.];
    let turned = [1. - 0.5 * sin, 0.5 * cos];
    let middle = [0.2 + 0.8 * turned[0], 0.1 + 0.8 * turned[1], 5.];
    let bent = [rest[0], middle, tip, rest[3]];
    assert_near(read(&bytes, Some("linear"), 1.0).mesh.vertices(), &bent, 1e-7);
    assert_near(read(&bytes, Some("step"), 1.999).mesh.vertices(), &rest, 1e-12);
    let quarter = [rest[0], [0.2 + 0.8 * 0.5, 0.1, 5.], [1., 1., 5.], rest[3]];
    assert_near(read(&bytes, Some("1"), 2.0).mesh.vertices(), &quarter, 1e-7);

    // The spline is y = t^2 (2 - t), 1.125 at 1.5 s.
    let lifted = [rest[0], [1., 0.5 + 0.8 * 1.125, 5.], [2., 1.125, 5.], rest[3]];
    assert_near(read(&bytes, Some("cubic"), 1.5).mesh.vertices(), &lifted, 1e-12);
}

#[test]
fn a_mirrored_skeleton_does_not_turn_the_figure_inside_out() {
    let (g, members) = bar();
    let mirrored = members.replace(r#""translation":[0,0,5]}"#, r#""translation":[0,0,5],"scale":[-1,1,1]}"#);
    assert_ne!(mirrored, members);
    let volumes = [&members, &mirrored].map(|m| read(&g.gltf(m), None, 0.0).mesh.signed_volume());
    assert!(volumes[0].abs() > 0.01 && (volumes[0] - volumes[1]).abs() < 1e-12, "{volumes:?}");
}

#[test]
fn a_hidden_node_keeps_its_vertices_apart() {
    let mut g = Gltf::default();
    let (position, sides) = (g.points(&CORNERS), g.indices(&SIDES));
    let bytes = g.gltf(&format!(
        r#""nodes":[{{"mesh":0}},{{"mesh":0,"scale":[0,0,0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}]"#
    ));
    let read = read(&bytes, None, 0.0);
    assert_eq!((read.mesh.vertices().len(), read.mesh.triangles().len()), (8, 8));
    assert_eq!(read.mesh.vertices()[4..], [[0.0; 3]; 4]);
}

#[test]
fn morph_targets_move_vertices_before_the_skin() {
    let (g, members) = bar();
    let moved = read(&g.gltf(&members), Some("weights"), 0.5);
    assert_near(&moved.mesh.vertices()[2..3], &[[2., 0., 5.25]], 1e-12);
    assert_near(&moved.mesh.vertices()[..1], &[[0., 0., 5.]], 1e-12);
}

#[test]
fn the_binary_file_is_the_same_mesh() {
    let (g, members) = bar();
    let options = ReadOptions { animation: Some("linear".into()), time: 0.7, ..Default::default() };
    let binary = read_mesh_from(MeshFormat::Glb, &g.glb(&members), Path::new("made.glb"), &options).unwrap();
    assert_eq!(binary.mesh, read(&g.gltf(&members), Some("linear"), 0.7).mesh);
}

#[test]
fn buffers_beside_the_file_are_found() {
    let folder = tempfile::tempdir().unwrap();
    let mut g = Gltf::default();
    let (position, sides) = (g.points(&CORNERS), g.indices(&SIDES));
    let members = format!(
        r#""nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}]"#
    );
    let text = String::from_utf8(g.gltf(&members)).unwrap();
    let (start, _) = text.split_once("data:").unwrap();
    let path = folder.path().join("a.gltf");
    std::fs::write(&path, format!("{start}my%20data.bin\"}}]}}")).unwrap();
    std::fs::write(folder.path().join("my data.bin"), &g.bytes).unwrap();
    let read = mser3d_meshio::read_mesh(&path, &ReadOptions::default()).unwrap();
    assert!((read.mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-12);
}

#[test]
fn a_time_or_an_animation_that_cannot_be_is_an_error() {
    let (g, members) = bar();
    let bytes = g.gltf(&members);
    let message = |format, bytes: &[u8], animation: Option<&str>, time| {
        let options = ReadOptions { animation: animation.map(str::to_owned), time, ..Default::default() };
        read_mesh_from(format, bytes, Path::new("a"), &options).unwrap_err().to_string()
    };
    for time in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(message(MeshFormat::Gltf, &bytes, Some("0"), time).contains("seconds"));
    }
    assert!(message(MeshFormat::Gltf, &bytes, None, 1.0).contains("choose an animation"));
    assert!(message(MeshFormat::Gltf, &bytes, Some("4"), 0.0).contains("3 \"weights\" (2.00 s)"));
    let beyond = message(MeshFormat::Gltf, &bytes, Some("weights"), 2.01);
    assert!(
        beyond.contains("a: animation 3 \"weights\" (2.00 s) ends at 2 s") && beyond.contains("2.01 s"),
        "{beyond}"
    );
    // The end, as it is shown to a hundredth of a second, is no time beyond it.
    assert_eq!(read(&bytes, Some("weights"), 2.004), read(&bytes, Some("weights"), 2.0));
    assert!(message(MeshFormat::Off, b"OFF", Some("0"), 0.0).contains("has no animations"));
}

#[test]
fn nodes_far_from_the_origin_keep_their_distance() {
    let mut g = Gltf::default();
    let (position, sides) = (g.points(&CORNERS), g.indices(&SIDES));
    // In f32 both would be half a unit from where they are.
    let bytes = g.gltf(&format!(
        r#""nodes":[{{"children":[1,2],"translation":[4512345.178,-4649776.22,0]}},
        {{"mesh":0}},{{"mesh":0,"translation":[1.5,0,0]}},{{"mesh":0,"translation":[4512349.178,-4649776.22,0]}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}]"#
    ));
    let vertices = read(&bytes, None, 0.0).mesh.vertices().to_vec();
    for (number, x) in [(0, 0.0), (1, 1.5), (2, 4.0)] {
        let near: Vec<[f64; 3]> = vertices[4 * number..][..4]
            .iter()
            .map(|p| [p[0] - 4512345.178 - x, p[1] + 4649776.22, p[2]])
            .collect();
        assert_near(&near, &CORNERS.map(|p| p.map(f64::from)), 2e-9);
    }
}

#[test]
fn instances_are_parts_of_the_mesh() {
    let mut g = Gltf::default();
    let (position, sides) = (g.points(&CORNERS), g.indices(&SIDES));
    let places = g.points(&[[10., 0., 0.], [0., 0., 0.], [0., 20., 0.]]);
    // No turn, a quarter turn about z, a half turn about x, as normalized 16-bit numbers.
    let turns: [[i16; 4]; 3] = [[0, 0, 0, 32767], [0, 0, 23170, 23170], [32767, 0, 0, 0]];
    let view = g.view(turns.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    let turns = g.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5122,"normalized":true,"count":3,"type":"VEC4"}}"#
    ));
    let sizes = g.points(&[[1., 1., 1.], [2., 2., 2.], [1., 1., -3.]]);
    let members = |attributes: &str| {
        format!(
            r#""extensionsUsed":["EXT_mesh_gpu_instancing"],"extensionsRequired":["EXT_mesh_gpu_instancing"],
            "nodes":[{{"mesh":0,"translation":[0,0,100],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}]"#
        )
    };
    let all = members(&format!(r#""TRANSLATION":{places},"ROTATION":{turns},"SCALE":{sizes},"_ID":9"#));
    let read_all = read(&g.gltf(&all), None, 0.0);
    let first = [[10., 0., 100.], [11., 0., 100.], [10., 1., 100.], [10., 0., 101.]];
    let second = [[0., 0., 100.], [0., 2., 100.], [-2., 0., 100.], [0., 0., 102.]];
    let third = [[0., 20., 100.], [1., 20., 100.], [0., 19., 100.], [0., 20., 103.]];
    assert_near(read_all.mesh.vertices(), &[first, second, third].concat(), 1e-9);
    // A mirrored instance is not inside out.
    assert!((read_all.mesh.signed_volume() - (1. + 8. + 3.) / 6.).abs() < 1e-9);
    let note = "3 instances of meshes (EXT_mesh_gpu_instancing) each read as a part of the mesh";
    assert_eq!(read_all.notes, [note]);
    let places_only = read(&g.gltf(&members(&format!(r#""TRANSLATION":{places}"#))), None, 0.0);
    assert!((places_only.mesh.signed_volume() - 0.5).abs() < 1e-9);

    let refused = |attributes: &str| {
        let bytes = g.gltf(&members(attributes));
        read_mesh_from(MeshFormat::Gltf, &bytes, Path::new("a"), &ReadOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert!(refused(r#""_ID":0"#).contains("without TRANSLATION"));
    assert!(refused(&format!(r#""TRANSLATION":{places},"SCALE":{position}"#)).contains("different counts"));
}

#[test]
fn quantized_positions_are_what_they_stand_for() {
    let mut g = Gltf::default();
    // Normalized 16-bit numbers, whose half is 0.5 but for rounding, in rows of 8 bytes.
    let rows: Vec<[u16; 4]> =
        CORNERS.iter().map(|p| [0, 1, 2, 3].map(|a| if a < 3 { p[a] as u16 * 65535 } else { 7 })).collect();
    let view = g.view(rows.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
    g.views[view] = g.views[view].replace('}', r#","byteStride":8}"#);
    let normalized = g.accessor(format!(
        r#"{{"bufferView":{view},"componentType":5123,"normalized":true,"count":4,"type":"VEC3"}}"#
    ));
    // Plain bytes, signed.
    let view = g.view(
        CORNERS
            .iter()
            .flat_map(|p| [p[0] as i8 * 100, p[1] as i8 * -100, p[2] as i8 * 50, 0])
            .map(|x| x as u8),
    );
    g.views[view] = g.views[view].replace('}', r#","byteStride":4}"#);
    let plain =
        g.accessor(format!(r#"{{"bufferView":{view},"componentType":5120,"count":4,"type":"VEC3"}}"#));
    let sides = g.indices(&SIDES);
    let primitive =
        |p: usize| format!(r#"{{"primitives":[{{"attributes":{{"POSITION":{p}}},"indices":{sides}}}]}}"#);
    let bytes = g.gltf(&format!(
        r#""extensionsRequired":["KHR_mesh_quantization","KHR_texture_transform","KHR_materials_unlit"],
        "nodes":[{{"mesh":0,"scale":[2,2,2]}},{{"mesh":1,"scale":[0.5,0.5,0.5],"translation":[0,0,-200]}}],
        "meshes":[{},{}]"#,
        primitive(normalized),
        primitive(plain)
    ));
    let read = read(&bytes, None, 0.0);
    let first = [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 2.]];
    let second = [[0., 0., -200.], [50., 0., -200.], [0., -50., -200.], [0., 0., -175.]];
    assert_near(read.mesh.vertices(), &[first, second].concat(), 0.0);
}

#[test]
fn packed_meshes_that_are_not_required_to_be_understood_are_refused_too() {
    let mut g = Gltf::default();
    let position = g.accessor(r#"{"componentType":5126,"count":4,"type":"VEC3"}"#.to_owned());
    let sides = g.indices(&SIDES);
    let bytes = g.gltf(&format!(
        r#""extensionsUsed":["KHR_draco_mesh_compression"],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position}}},"indices":{sides}}}]}}]"#
    ));
    let error =
        read_mesh_from(MeshFormat::Gltf, &bytes, Path::new("a"), &ReadOptions::default()).unwrap_err();
    assert!(error.to_string().contains("packed by KHR_draco_mesh_compression"), "{error}");
}
