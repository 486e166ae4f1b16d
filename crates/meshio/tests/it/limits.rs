//! What would take too much is refused before the memory is taken; what a file names lies in its folder.

use flate2::Compression;
use flate2::write::{GzEncoder, ZlibEncoder};
use mser3d_fileio::{FileError, ReadLimits};
use mser3d_meshio::{MeshFormat, MeshIoError, ReadOptions, list_animations, read_mesh, read_mesh_from};
use std::io::Write;
use std::path::Path;

const MB: u64 = 1_000_000;

fn within(megabytes: u64) -> ReadOptions {
    let limits = ReadLimits { memory: megabytes * MB, ..Default::default() };
    ReadOptions { limits, ..Default::default() }
}

/// The refusal of a file that is over the limit.
fn refusal(format: MeshFormat, bytes: &[u8], megabytes: u64) -> String {
    let error = read_mesh_from(format, bytes, Path::new("bomb"), &within(megabytes)).unwrap_err();
    assert!(matches!(&error, MeshIoError::File(FileError::OverLimit { .. })), "{error}");
    let message = error.to_string();
    assert!(message.starts_with("bomb: ") && message.contains("--memory-limit"), "{message}");
    assert!(message.contains(&format!("more than the limit of {megabytes} MB")), "{message}");
    message
}

#[test]
fn packed_files_are_unpacked_as_far_as_the_limit_allows() {
    // A member of 1 MB of white space, over and over: 300 MB in 300 kB.
    let mut packer = GzEncoder::new(Vec::new(), Compression::best());
    packer.write_all(&vec![b'\n'; MB as usize]).unwrap();
    let member = packer.finish().unwrap();
    let bomb = member.repeat(300);
    for format in MeshFormat::ALL {
        let message = refusal(format, &bomb, 40);
        assert!(message.contains(&format!("its {} bytes unpack to more than", bomb.len())), "{message}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gltf.gz");
    std::fs::write(&path, [&b"\x1f\x8b\x08"[..], &bomb[3..]].concat()).unwrap();
    let error = list_animations(&path, &within(40).limits).unwrap_err().to_string();
    assert!(error.contains("more than the limit of 40 MB"), "{error}");
}

#[test]
fn a_file_that_is_too_large_is_not_read() {
    let folder = tempfile::tempdir().unwrap();
    for format in MeshFormat::ALL {
        // Nothing is in it, and it takes no place.
        let path = folder.path().join(format!("a.{}", format.extension()));
        std::fs::File::create(&path).unwrap().set_len(8_000_000_000).unwrap();
        let error = read_mesh(&path, &within(100)).unwrap_err();
        assert!(matches!(&error, MeshIoError::File(FileError::OverLimit { .. })), "{error}");
        assert!(error.to_string().contains("it has 8000000000 bytes"), "{error}");
    }
    // A mesh that would take more than the limit when it is parsed.
    let text = format!(
        "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n{}",
        "#".repeat(1 << 20)
    );
    assert!(read_mesh_from(MeshFormat::Off, text.as_bytes(), Path::new("a"), &within(20)).is_ok());
    refusal(MeshFormat::Off, text.as_bytes(), 8);
}

/// A grid of VTK whose arrays are packed by zlib.
fn vtu(pieces: usize, zeros: usize) -> Vec<u8> {
    let mut packer = ZlibEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(&vec![0; zeros]).unwrap();
    let packed = packer.finish().unwrap();
    let points = zeros / 12;
    let piece = format!(
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"0\"><Points><DataArray type=\"Float32\" \
         NumberOfComponents=\"3\" format=\"appended\" offset=\"0\"/></Points></Piece>"
    );
    let mut bytes = format!(
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\">\
         <UnstructuredGrid>{}</UnstructuredGrid><AppendedData encoding=\"raw\">_",
        piece.repeat(pieces)
    )
    .into_bytes();
    for number in [1, zeros as u32, 0, packed.len() as u32] {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(packed);
    bytes.extend(b"</AppendedData></VTKFile>");
    bytes
}

#[test]
fn blocks_of_vtk_are_unpacked_as_far_as_the_limit_allows() {
    let message = refusal(MeshFormat::Vtu, &vtu(1, 24_000_000), 50);
    assert!(message.contains("an array has 24000000 bytes"), "{message}");
    // Many pieces that show the same array.
    refusal(MeshFormat::Vtu, &vtu(1000, 120_000), 50);
    // Declared, and not there at all.
    let mut bytes = vtu(1, 1200);
    let at = bytes.windows(2).position(|w| w == b">_").unwrap() + 2;
    bytes[at..at + 4].copy_from_slice(&2u32.to_le_bytes());
    bytes[at + 4..at + 8].copy_from_slice(&u32::MAX.to_le_bytes());
    refusal(MeshFormat::Vtu, &bytes, 50);
}

/// A glTF of one triangle at `nodes` nodes, with a buffer at this address.
fn gltf(nodes: usize, uri: &str) -> String {
    let shown: Vec<String> = (0..nodes).map(|i| i.to_string()).collect();
    format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[{}]}}],\"nodes\":[{}],\
         \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}}}}]}}],\
         \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\
         \"min\":[0,0,0],\"max\":[1,1,0]}}],\"bufferViews\":[{{\"buffer\":0,\"byteLength\":36}}],\
         \"buffers\":[{{\"byteLength\":36,\"uri\":\"{uri}\"}}]}}",
        shown.join(","),
        vec!["{\"mesh\":0}"; nodes].join(",")
    )
}

fn triangle() -> Vec<u8> {
    [0., 0., 0., 1., 0., 0., 0., 1., 0.].into_iter().flat_map(f32::to_le_bytes).collect()
}

#[test]
fn a_scene_that_shows_too_much_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.bin"), triangle()).unwrap();
    let path = folder.path().join("a.gltf");
    let read =
        |text: &str, options: &ReadOptions| read_mesh_from(MeshFormat::Gltf, text.as_bytes(), &path, options);
    assert_eq!(read(&gltf(1, "t.bin"), &within(1)).unwrap().mesh.vertices().len(), 3);
    // Objects of a few bytes that are far more in memory.
    let error = read(&gltf(100_000, "t.bin"), &within(20)).unwrap_err().to_string();
    assert!(error.contains("its JSON has 1000") && error.contains("limit of 20 MB"), "{error}");
    // One mesh of many vertices, shown often.
    let mesh = gltf(400, "t.bin").replace("\"count\":3,", "\"count\":30000,").replace(":36", ":360000");
    std::fs::write(folder.path().join("t.bin"), triangle().repeat(10_000)).unwrap();
    let error = read(&mesh, &within(100)).unwrap_err().to_string();
    assert!(error.contains("shows a mesh of 30000 vertices"), "{error}");
    // One file as many buffers.
    let buffer = "{\"byteLength\":36,\"uri\":\"t.bin\"}";
    let many = gltf(1, "t.bin").replace(
        &format!("\"buffers\":[{buffer}]"),
        &format!("\"buffers\":[{}]", vec![buffer; 200].join(",")),
    );
    let error = read(&many, &within(30)).unwrap_err().to_string();
    assert!(error.contains("is a file of 360000 bytes") && error.contains("limit of 30 MB"), "{error}");
}

#[cfg(unix)]
#[test]
fn buffers_lie_in_the_folder_of_the_file() {
    use std::os::unix::fs::symlink;
    let root = tempfile::tempdir().unwrap();
    let at = |name: &str| root.path().join(name);
    std::fs::create_dir_all(at("in/deep")).unwrap();
    for name in ["out.bin", "in/a.bin", "in/deep/b c.bin"] {
        std::fs::write(at(name), triangle()).unwrap();
    }
    symlink(at("out.bin"), at("in/link.bin")).unwrap();
    let read = |uri: &str, allow_outside: bool| {
        let path = at("in/a.gltf");
        std::fs::write(&path, gltf(1, uri)).unwrap();
        let limits = ReadLimits { allow_outside, ..Default::default() };
        read_mesh(&path, &ReadOptions { limits, ..Default::default() })
    };
    for good in ["a.bin", "./a.bin", "deep/b%20c.bin"] {
        assert_eq!(read(good, false).unwrap().mesh.triangles().len(), 1, "{good}");
    }
    let absolute = at("out.bin").display().to_string();
    for outside in
        ["../out.bin", "%2e%2e/out.bin", "deep/../../out.bin", "%2E%2E%2Fout.bin", "link.bin", &absolute]
    {
        let error = read(outside, false).unwrap_err().to_string();
        assert!(error.contains("outside of its folder") && error.contains("--allow-outside"), "{error}");
        assert_eq!(read(outside, true).unwrap().mesh.triangles().len(), 1, "{outside}");
    }
    // What is no regular file would be waited for, or never end.
    for special in ["/dev/zero", "/dev/null", "deep"] {
        let error = read(special, true).unwrap_err().to_string();
        assert!(error.contains("no regular file"), "{error}");
    }
    // One that says it is empty, and is not.
    let error = read("/proc/self/maps", true).unwrap_err().to_string();
    assert!(error.contains("36 bytes are declared, but there are 0"), "{error}");
}
