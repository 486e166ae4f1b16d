use super::VertexAttributes;
use crate::MeshIoError;
use crate::error::Fault;
use mser3d_fileio::write_atomically;
use mser3d_shape::TriangleMesh;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// Writes a mesh as binary glTF, for Blender and the web: positions in f32, triangles and, where
/// given, normals, colours (`COLOR_0`, linear as glTF wants them) and regions (`_REGION`).
///
/// # Errors
/// [`MeshIoError::File`]; [`MeshIoError::Shape`] for attributes of another length;
/// [`MeshIoError::Unsupported`] for a mesh that is empty or beyond what f32 and GLB (4 GiB) hold.
pub fn write_glb(path: &Path, mesh: &TriangleMesh, attributes: &VertexAttributes) -> Result<(), MeshIoError> {
    attributes.check(mesh)?;
    let glb = encode(mesh, attributes).map_err(|reason| Fault::unsupported(None, reason).in_file(path))?;
    Ok(write_atomically(path, |out| out.write_all(&glb))?)
}

fn encode(mesh: &TriangleMesh, attributes: &VertexAttributes) -> Result<Vec<u8>, &'static str> {
    let positions: Vec<[f32; 3]> = mesh.vertices().iter().map(|p| p.map(|x| x as f32)).collect();
    if positions.is_empty() || mesh.triangles().is_empty() {
        return Err("glTF cannot hold a mesh without triangles");
    }
    if positions.iter().flatten().any(|x| !x.is_finite()) {
        return Err("coordinates beyond 3.4e38 do not fit the 32-bit numbers of glTF; scale the mesh down");
    }
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        let b = positions.iter().fold([start; 3], |b, p| std::array::from_fn(|a| pick(b[a], p[a])));
        format!("[{:?},{:?},{:?}]", b[0], b[1], b[2])
    };
    let bounds =
        format!(",\"min\":{},\"max\":{}", bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY));

    let mut arrays = Arrays::default();
    let mut names = String::from("\"POSITION\":0");
    arrays.push(&floats(positions.iter().flatten().copied()), "VEC3", 5126, positions.len(), &bounds);
    let mut attribute = |name: &str, bytes: Vec<u8>, kind: &str, component: u32, extra: &str| {
        let number = arrays.push(&bytes, kind, component, positions.len(), extra);
        let _ = write!(names, ",\"{name}\":{number}");
    };
    if let Some(normals) = attributes.normals {
        attribute("NORMAL", floats(normals.iter().flatten().map(|&x| x as f32)), "VEC3", 5126, "");
    }
    if let Some(colors) = attributes.colors {
        let bytes = colors
            .iter()
            .flat_map(|c| [linear(c[0]), linear(c[1]), linear(c[2]), u16::MAX])
            .flat_map(u16::to_le_bytes)
            .collect();
        attribute("COLOR_0", bytes, "VEC4", 5123, ",\"normalized\":true");
    }
    if let Some(regions) = attributes.regions {
        attribute("_REGION", floats(regions.iter().map(|&r| r as f32)), "SCALAR", 5126, "");
    }
    let indices: Vec<u8> = mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let indices = arrays.push(&indices, "SCALAR", 5125, 3 * mesh.triangles().len(), "");

    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"mser3d\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\
         \"nodes\":[{{\"mesh\":0}}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{{names}}},\
         \"indices\":{indices},\"material\":0}}]}}],\"materials\":[{{\"doubleSided\":true,\
         \"pbrMetallicRoughness\":{{\"metallicFactor\":0,\"roughnessFactor\":0.8}}}}],\
         \"accessors\":[{}],\"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
        arrays.accessors,
        arrays.views,
        arrays.bytes.len()
    );
    if json.len() as u64 + arrays.bytes.len() as u64 + 64 > u64::from(u32::MAX) {
        return Err("GLB files are limited to 4 GiB; write PLY");
    }
    let header = gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 };
    let glb = gltf::Glb { header, json: json.into_bytes().into(), bin: Some(arrays.bytes.into()) };
    glb.to_vec().map_err(|_| "it does not fit a GLB file")
}

/// The binary chunk, and what describes it.
#[derive(Default)]
struct Arrays {
    bytes: Vec<u8>,
    accessors: String,
    views: String,
    count: usize,
}

impl Arrays {
    /// Adds an array of `count` rows, a multiple of 4 bytes long; its number.
    fn push(&mut self, bytes: &[u8], kind: &str, component: u32, count: usize, extra: &str) -> usize {
        let comma = if self.count > 0 { "," } else { "" };
        let number = self.count;
        // 34963: triangle corners; 34962: vertices.
        let target = if component == 5125 { 34963 } else { 34962 };
        let _ = write!(
            self.views,
            "{comma}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{},\"target\":{target}}}",
            self.bytes.len(),
            bytes.len()
        );
        let _ = write!(
            self.accessors,
            "{comma}{{\"bufferView\":{number},\"componentType\":{component},\"count\":{count},\"type\":\"{kind}\"{extra}}}"
        );
        self.bytes.extend_from_slice(bytes);
        self.count += 1;
        number
    }
}

fn floats(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

/// An sRGB component as linear light (IEC 61966-2-1).
fn linear(component: u8) -> u16 {
    let s = f64::from(component) / 255.0;
    let light = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    (light * 65535.0).round() as u16
}
