//! Linear blend skinning.

use super::accessor::{Asset, get};
use super::primitive::{attribute, same_length};
use super::transform::Affine;
use crate::error::Fault;
use gltf::{Semantic, json};
use json::accessor::Type;
use json::mesh::Primitive;

/// A skin, ready to pose vertices.
pub(super) struct Skin {
    /// Bind space to the world, for each joint.
    pub joints: Vec<Affine>,
    /// A number for the joints and how they are bound. Skins with the same joints share it, and their
    /// vertices may be welded: body and clothes are often exported with a skin each.
    pub group: usize,
}

impl Skin {
    /// The mean of the joints' maps.
    pub(super) fn blend(&self, influences: &Influences) -> Affine {
        let mut map = Affine([[0.0; 4]; 3]);
        for &(joint, weight) in influences {
            map.add(weight, &self.joints[joint]);
        }
        map
    }
}

pub(super) fn all(asset: &Asset, globals: &[Affine]) -> Result<Vec<Skin>, Fault> {
    let mut bindings: Vec<(Vec<usize>, Vec<f64>)> = Vec::new();
    let mut skins = Vec::new();
    for (number, skin) in asset.root.skins.iter().enumerate() {
        let nodes: Vec<usize> = skin.joints.iter().map(|j| j.value()).collect();
        if nodes.is_empty() {
            return Err(Fault::new(format!("skin {number} has no joints")));
        }
        let inverse = match skin.inverse_bind_matrices {
            Some(accessor) => asset.rows(accessor, Type::Mat4)?.values,
            None => Vec::new(),
        };
        let mut joints = Vec::with_capacity(nodes.len());
        for (i, &node) in nodes.iter().enumerate() {
            let global = get(globals, node, "node")?;
            joints.push(match inverse.get(16 * i..16 * i + 16) {
                Some(matrix) => global.after(&Affine::from_columns(matrix)),
                None if inverse.is_empty() => *global,
                None => return Err(Fault::new(format!("skin {number} has fewer matrices than joints"))),
            });
        }
        let binding = (nodes, inverse);
        let group = bindings.iter().position(|b| *b == binding).unwrap_or_else(|| {
            bindings.push(binding);
            bindings.len() - 1
        });
        skins.push(Skin { joints, group });
    }
    Ok(skins)
}

/// How much each joint of a skin moves a vertex: joint numbers, and weights that sum to 1.
pub(super) type Influences = Vec<(usize, f64)>;

/// The influences at each vertex, from as many sets of four as there are.
pub(super) fn influences(
    asset: &Asset,
    primitive: &Primitive,
    vertices: usize,
    joints: usize,
) -> Result<Vec<Influences>, Fault> {
    let mut all = vec![Influences::new(); vertices];
    for set in 0.. {
        let accessors =
            attribute(primitive, Semantic::Joints(set)).zip(attribute(primitive, Semantic::Weights(set)));
        let Some((numbers, weights)) = accessors else { break };
        let numbers = same_length(asset.rows(numbers, Type::Vec4)?, vertices, "JOINTS")?;
        let weights = same_length(asset.rows(weights, Type::Vec4)?, vertices, "WEIGHTS")?;
        for ((influences, joint), weight) in all.iter_mut().zip(numbers.iter::<4>()).zip(weights.iter::<4>())
        {
            influences.extend((0..4).filter(|&i| weight[i] > 0.0).map(|i| (joint[i] as usize, weight[i])));
        }
    }
    for (vertex, influences) in all.iter_mut().enumerate() {
        if let Some((joint, _)) = influences.iter().find(|i| i.0 >= joints) {
            return Err(Fault::new(format!(
                "vertex {vertex} hangs on joint {joint} of a skin of {joints} joints"
            )));
        }
        // Files round weights. If they sum to less than 1, the rest would pull the vertex to the origin.
        let sum: f64 = influences.iter().map(|i| i.1).sum();
        influences.iter_mut().for_each(|i| i.1 /= sum);
        if influences.is_empty() {
            influences.push((0, 1.0));
        }
    }
    Ok(all)
}
