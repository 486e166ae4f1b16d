//! Small files, made in memory.
#![allow(dead_code)]

use base64::Engine;

/// A glTF file in the making: arrays with their accessors.
#[derive(Default)]
pub struct Gltf {
    pub bytes: Vec<u8>,
    pub views: Vec<String>,
    pub accessors: Vec<String>,
}

impl Gltf {
    pub fn view(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        let length = self.bytes.len() - start;
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{start},"byteLength":{length}}}"#));
        self.views.len() - 1
    }

    pub fn accessor(&mut self, fields: String) -> usize {
        self.accessors.push(fields);
        self.accessors.len() - 1
    }

    pub fn floats(&mut self, kind: &str, count: usize, values: &[f32]) -> usize {
        let view = self.view(values.iter().flat_map(|x| x.to_le_bytes()));
        self.accessor(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{count},"type":"{kind}"}}"#
        ))
    }

    pub fn points(&mut self, points: &[[f32; 3]]) -> usize {
        self.floats("VEC3", points.len(), points.as_flattened())
    }

    pub fn indices(&mut self, indices: &[u16]) -> usize {
        let view = self.view(indices.iter().flat_map(|x| x.to_le_bytes()));
        let count = indices.len();
        self.accessor(format!(
            r#"{{"bufferView":{view},"componentType":5123,"count":{count},"type":"SCALAR"}}"#
        ))
    }

    /// The JSON with the given members; the buffer's address is given as JSON too.
    fn json(&self, members: &str, address: &str) -> String {
        format!(
            r#"{{"asset":{{"version":"2.0"}},{members},"accessors":[{}],"bufferViews":[{}],"buffers":[{{"byteLength":{}{address}}}]}}"#,
            self.accessors.join(","),
            self.views.join(","),
            self.bytes.len(),
        )
    }

    pub fn gltf(&self, members: &str) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bytes);
        self.json(members, &format!(r#","uri":"data:application/octet-stream;base64,{data}""#)).into()
    }

    pub fn glb(&self, members: &str) -> Vec<u8> {
        let mut json = self.json(members, "").into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut data = self.bytes.clone();
        data.resize(data.len().next_multiple_of(4), 0);
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend((12 + 8 + json.len() as u32 + 8 + data.len() as u32).to_le_bytes());
        for (kind, chunk) in [(b"JSON", json), (b"BIN\0", data)] {
            out.extend((chunk.len() as u32).to_le_bytes());
            out.extend(kind);
            out.extend(chunk);
        }
        out
    }
}

/// A tetrahedron, its outside counter-clockwise.
pub const CORNERS: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
pub const SIDES: [u16; 12] = [0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];

/// A bar along x of four points, bent at (1, 0, 0) by an animation of each interpolation.
///
/// Joint 0 stands at (0, 0, 5) in the world, joint 1 one further along x. `linear` and `step` turn
/// joint 1 about z by a quarter turn from t = 0 to 2 s; `cubic` moves joint 1 along y by t^2 (2 - t);
/// `weights` blends in a morph target that lifts point 2 by 1 along z.
pub fn bar() -> (Gltf, String) {
    let mut g = Gltf::default();
    let position = g.points(&[[0., 0., 0.], [1., 0.5, 0.], [2., 0., 0.], [0., 0., 0.5]]);
    let sides = g.indices(&SIDES);
    let joints = g.view([[0u8, 1, 0, 0]; 4].as_flattened().iter().copied());
    let joints =
        g.accessor(format!(r#"{{"bufferView":{joints},"componentType":5121,"count":4,"type":"VEC4"}}"#));
    // As normalized bytes; those of the last point sum to a half.
    let weights = [[255u8, 0, 0, 0], [51, 204, 0, 0], [0, 255, 0, 0], [128, 0, 0, 0]];
    let weights = g.view(weights.as_flattened().iter().copied());
    let weights = g.accessor(format!(
        r#"{{"bufferView":{weights},"componentType":5121,"normalized":true,"count":4,"type":"VEC4"}}"#
    ));
    let mut binding = [0f32; 32];
    for i in [0, 5, 10, 15, 16, 21, 26, 31] {
        binding[i] = 1.0;
    }
    binding[16 + 12] = -1.0;
    let binding = g.floats("MAT4", 2, &binding);
    // A target of zeros but for row 2.
    let row = g.view([2u8]);
    let lift = g.view([0f32, 0., 1.].iter().flat_map(|x| x.to_le_bytes()));
    let target = g.accessor(format!(
        r#"{{"componentType":5126,"count":4,"type":"VEC3","sparse":{{"count":1,"indices":{{"bufferView":{row},"componentType":5121}},"values":{{"bufferView":{lift}}}}}}}"#
    ));
    let times = g.floats("SCALAR", 2, &[0., 2.]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = g.floats("VEC4", 2, &[0., 0., 0., 1., 0., 0., half, half]);
    // y = t^2 (2 - t) with y' = 4 t - 3 t^2; the tangents outside the keys are not used.
    let moves = [9., 9., 9., 1., 0., 0., 0., 0., 0., 0., -4., 0., 1., 0., 0., 9., 9., 9.];
    let moves = g.floats("VEC3", 6, &moves);
    let blends = g.floats("SCALAR", 2, &[0., 1.]);
    let animation = |name: &str, node: usize, path: &str, output: usize, interpolation: &str| {
        format!(
            r#"{{"name":"{name}","channels":[{{"sampler":0,"target":{{"node":{node},"path":"{path}"}}}}],"samplers":[{{"input":{times},"output":{output},"interpolation":"{interpolation}"}}]}}"#
        )
    };
    let animations = [
        animation("linear", 2, "rotation", turns, "LINEAR"),
        animation("step", 2, "rotation", turns, "STEP"),
        animation("cubic", 2, "translation", moves, "CUBICSPLINE"),
        animation("weights", 0, "weights", blends, "LINEAR"),
    ]
    .join(",");
    let members = format!(
        r#""scene":0,"scenes":[{{"nodes":[0,1]}}],
        "nodes":[{{"mesh":0,"skin":0,"translation":[100,0,0]}},{{"children":[2],"translation":[0,0,5]}},{{"translation":[1,0,0]}}],
        "skins":[{{"joints":[1,2],"inverseBindMatrices":{binding}}}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":{position},"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"indices":{sides},"targets":[{{"POSITION":{target}}}]}}]}}],
        "animations":[{animations}]"#
    );
    (g, members)
}
