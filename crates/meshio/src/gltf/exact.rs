//! What nodes say of their place, with all digits: the crate gltf keeps 24 bits of each number, too few far
//! from the origin.

use crate::error::Fault;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A node's transform.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    /// Column by column.
    pub matrix: Option<[f64; 16]>,
    extensions: Option<Extensions>,
}

impl Node {
    pub(super) fn instancing(&self) -> Option<&Instancing> {
        self.extensions.as_ref()?.instancing.as_ref()
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct Extensions {
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    instancing: Option<Instancing>,
}

/// Accessors with a row for each instance of a node's mesh.
#[derive(Debug, Deserialize)]
pub(super) struct Instancing {
    pub attributes: BTreeMap<String, u32>,
}

#[derive(Default, Deserialize)]
#[serde(default)]
struct Root {
    nodes: Vec<Node>,
}

/// The nodes of a file's JSON.
pub(super) fn nodes(json: &[u8]) -> Result<Vec<Node>, Fault> {
    let root: Root =
        serde_json::from_slice(json).map_err(|e| Fault::new(format!("not the JSON of glTF 2.0: {e}")))?;
    let mut nodes = root.nodes;
    for node in &mut nodes {
        let Node { translation, rotation, scale, matrix, .. } = node;
        let small = translation.iter_mut().chain(scale).flatten().chain(rotation.iter_mut().flatten());
        small.chain(matrix.iter_mut().flatten()).for_each(|x| *x = intended(*x));
    }
    Ok(nodes)
}

/// Beyond this, what f32 cuts off may be larger than details of a mesh.
const FAR: f64 = 65536.0;

/// The number that a file means. Most programs hold f32 and write as few digits as tell it from its neighbours:
/// then it is that f32, so that parts that meet in f32 meet here.
fn intended(x: f64) -> f64 {
    let short = x as f32;
    let is_short = x.abs() < FAR && short.to_string().parse() == Ok(x);
    if is_short { short.into() } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transforms_keep_their_digits() {
        let json = br#"{"nodes":[{"translation":[4512345.678,0,1],"name":"a"},{"mesh":0,"extensions":{"X":{},
            "EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":3}}}}],"asset":{"version":"2.0"}}"#;
        let nodes = nodes(json).unwrap();
        assert_eq!(nodes[0].translation, Some([4512345.678, 0.0, 1.0]));
        assert_eq!([0.1, 0.123456789, 1234567.1].map(intended), [f64::from(0.1f32), 0.123456789, 1234567.1]);
        assert_eq!(nodes[1].instancing().unwrap().attributes["TRANSLATION"], 3);
    }
}
