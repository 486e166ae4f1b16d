//! Small files of all formats.

use std::io::Write;
use std::path::Path;

use mser3d_meshio::MeshFormat;

use super::common::bar;

/// A good file of each format and variant; `folder` has those by other programs.
pub fn good_files(folder: &Path) -> Vec<(MeshFormat, Vec<u8>)> {
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
    let points = "<Piece NumberOfPoints=\"4\" NumberOfPolys=\"2\" NumberOfStrips=\"1\"><Points><DataArray type=\"Float32\" \
        NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 1 1 0 0 1 1</DataArray></Points>";
    let cells = |name: &str, list: &str, ends: &str| {
        let array = |name: &str, values: &str| {
            format!("<DataArray type=\"Int64\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>")
        };
        format!("<{name}>{}{}</{name}>", array("connectivity", list), array("offsets", ends))
    };
    let (polys, strips) = (cells("Polys", "0 1 2 3 0 2 3", "4 7"), cells("Strips", "0 1 2 3", "4"));
    let vtp = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\">\
        <PolyData>{points}{polys}{strips}</Piece></PolyData></VTKFile>\n"
    );
    files.push((MeshFormat::Vtp, vtp.into_bytes()));
    let (g, members) = bar();
    files.push((MeshFormat::Gltf, g.gltf(&members)));
    files.push((MeshFormat::Glb, g.glb(&members)));
    files
}
