use super::VertexAttributes;
use crate::MeshIoError;
use crate::error::Fault;
use mser3d_fileio::write_atomically;
use mser3d_shape::TriangleMesh;
use std::fmt::Write as _;
use std::io::Write;
use std::path::Path;

/// From this many widths from the origin on, f32 keeps too little of a mesh.
const FAR: f64 = 4.0;

/// Writes a mesh as binary glTF, for Blender and the web: positions in f32, triangles and, where
/// given, normals, colours (`COLOR_0`, linear as glTF wants them) and regions (`_REGION`).
///
/// Positions of a mesh whose centre is farther from the origin than four times its width are stored relative to its
/// centre, and the node's translation leads back, so that they err by at most 3e-7 of the mesh's width. Returns notes: what
/// a user should know of what f32 could not keep.
///
/// # Errors
/// [`MeshIoError::File`]; [`MeshIoError::Shape`] for attributes of another length;
/// [`MeshIoError::Unsupported`] for a mesh that is empty or beyond what f32 and GLB (4 GiB) hold.
pub fn write_glb(
    path: &Path,
    mesh: &TriangleMesh,
    attributes: &VertexAttributes,
) -> Result<Vec<String>, MeshIoError> {
    attributes.check(mesh)?;
    let placed = Placed::new(mesh);
    let glb =
        encode(mesh, &placed, attributes).map_err(|reason| Fault::unsupported(None, reason).in_file(path))?;
    write_atomically(path, |out| out.write_all(&glb))?;
    let mut used = vec![false; placed.positions.len()];
    mesh.triangles().iter().flatten().for_each(|&v| used[v as usize] = true);
    let merged = merged(mesh.vertices(), &placed.positions, &used);
    let what = "vertices fall on another one in the 32-bit numbers of glTF; write .ply to keep them apart";
    Ok(crate::read::note(merged, what).into_iter().collect())
}

/// Positions in f32, and where they are.
struct Placed {
    positions: Vec<[f32; 3]>,
    /// Translations of nodes, one in the other: a large one, and what it lacks of the mesh's centre.
    offsets: Vec<[f32; 3]>,
}

impl Placed {
    /// Vertices that no triangle uses may be anywhere, and don't count.
    fn new(mesh: &TriangleMesh) -> Self {
        let (low, high) = mesh.bounding_box().map_or(([0.0; 3], [0.0; 3]), |b| (b.min, b.max));
        let width = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
        let mut rest: [f64; 3] = std::array::from_fn(|a| low[a] / 2.0 + high[a] / 2.0);
        let mut offsets = Vec::new();
        // One step leaves 2^-24 of the distance, two 2^-48, which is as fine as f64 has it there.
        // A figure on its floor has its place in its vertices, as readers without nodes expect.
        let far = (0..3).any(|a| rest[a].abs() > FAR * width);
        while far && offsets.len() < 2 && (0..3).any(|a| 2.0 * rest[a].abs() > width) {
            let offset = rest.map(|x| x as f32);
            if offset.iter().any(|x| !x.is_finite()) || offset == [0.0; 3] {
                break;
            }
            rest = std::array::from_fn(|a| rest[a] - f64::from(offset[a]));
            offsets.push(offset);
        }
        let shift = |p: [f64; 3]| -> [f64; 3] {
            offsets.iter().fold(p, |p, o| std::array::from_fn(|a| p[a] - f64::from(o[a])))
        };
        let positions = mesh.vertices().iter().map(|&p| shift(p).map(|x| x as f32)).collect();
        Self { positions, offsets }
    }

    /// The nodes as JSON, of which the first is the scene's and the last has the mesh.
    fn nodes(&self) -> String {
        let mut nodes = String::new();
        for (number, [x, y, z]) in self.offsets.iter().enumerate() {
            let what = match number + 1 == self.offsets.len() {
                true => "\"mesh\":0".to_owned(),
                false => format!("\"children\":[{}]", number + 1),
            };
            let comma = if number > 0 { "," } else { "" };
            // All digits: readers may take them as f64.
            let [x, y, z] = [x, y, z].map(|&x| f64::from(x));
            let _ = write!(nodes, "{comma}{{{what},\"translation\":[{x:?},{y:?},{z:?}]}}");
        }
        if nodes.is_empty() { "{\"mesh\":0}".to_owned() } else { nodes }
    }
}

/// How many places of vertices are lost in f32.
fn merged(vertices: &[[f64; 3]], positions: &[[f32; 3]], used: &[bool]) -> usize {
    // -0.0 is 0.0.
    let places = vertices
        .iter()
        .zip(positions)
        .map(|(exact, stored)| (stored.map(|x| (x + 0.0).to_bits()), exact.map(|x| (x + 0.0).to_bits())));
    let mut places: Vec<_> = places.zip(used).filter(|(_, used)| **used).map(|(place, _)| place).collect();
    places.sort_unstable();
    places.dedup();
    places.windows(2).filter(|w| w[0].0 == w[1].0).count()
}

fn encode(
    mesh: &TriangleMesh,
    placed: &Placed,
    attributes: &VertexAttributes,
) -> Result<Vec<u8>, &'static str> {
    let positions = &placed.positions;
    if positions.is_empty() || mesh.triangles().is_empty() {
        return Err("glTF cannot hold a mesh without triangles");
    }
    if positions.iter().flatten().any(|x| !x.is_finite()) {
        return Err("coordinates beyond 3.4e38 do not fit the 32-bit numbers of glTF; scale the mesh down");
    }
    let mut arrays = Arrays::default();
    let mut names = String::from("\"POSITION\":0");
    arrays.push(
        &floats(positions.iter().flatten().copied()),
        "VEC3",
        5126,
        positions.len(),
        &bounds(positions),
    );
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
         \"nodes\":[{}],\"meshes\":[{{\"primitives\":[{{\"attributes\":{{{names}}},\
         \"indices\":{indices},\"material\":0}}]}}],{MATERIAL}",
        placed.nodes()
    );
    pack(json, arrays)
}

/// The material of all meshes, as a member of the root.
pub(super) const MATERIAL: &str = "\"materials\":[{\"doubleSided\":true,\
     \"pbrMetallicRoughness\":{\"metallicFactor\":0,\"roughnessFactor\":0.8}}]";

/// The members that accessors of positions must have.
pub(super) fn bounds(positions: &[[f32; 3]]) -> String {
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        let b = positions.iter().fold([start; 3], |b, p| std::array::from_fn(|a| pick(b[a], p[a])));
        format!("[{:?},{:?},{:?}]", b[0], b[1], b[2])
    };
    format!(",\"min\":{},\"max\":{}", bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY))
}

/// A file of a root that is complete but for its arrays, and of these.
pub(super) fn pack(root: String, arrays: Arrays) -> Result<Vec<u8>, &'static str> {
    let json = format!(
        "{root},\"accessors\":[{}],\"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
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
pub(super) struct Arrays {
    bytes: Vec<u8>,
    accessors: String,
    views: String,
    count: usize,
}

impl Arrays {
    /// Adds an array of `count` rows, a multiple of 4 bytes long; its number.
    pub fn push(&mut self, bytes: &[u8], kind: &str, component: u32, count: usize, extra: &str) -> usize {
        // 34963: triangle corners; 34962: vertices.
        let target = if component == 5125 { 34963 } else { 34962 };
        self.add(bytes, kind, component, count, extra, &format!(",\"target\":{target}"))
    }

    /// Adds numbers that are neither of vertices nor of triangles.
    pub fn push_plain(&mut self, bytes: &[u8], count: usize, extra: &str) -> usize {
        self.add(bytes, "SCALAR", 5126, count, extra, "")
    }

    fn add(
        &mut self,
        bytes: &[u8],
        kind: &str,
        component: u32,
        count: usize,
        extra: &str,
        target: &str,
    ) -> usize {
        let comma = if self.count > 0 { "," } else { "" };
        let number = self.count;
        let _ = write!(
            self.views,
            "{comma}{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}{target}}}",
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

pub(super) fn floats(values: impl Iterator<Item = f32>) -> Vec<u8> {
    values.flat_map(f32::to_le_bytes).collect()
}

/// An sRGB component as linear light (IEC 61966-2-1).
pub(super) fn linear(component: u8) -> u16 {
    let s = f64::from(component) / 255.0;
    let light = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    (light * 65535.0).round() as u16
}
