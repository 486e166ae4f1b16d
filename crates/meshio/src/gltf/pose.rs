//! Where the nodes of a scene are.

use super::accessor::{Asset, get};
use super::transform::Affine;
use crate::error::Fault;
use gltf::json;

/// A node's transform relative to its parent.
#[derive(Clone, Debug)]
pub(super) struct Local {
    pub translation: [f64; 3],
    pub rotation: [f64; 4],
    pub scale: [f64; 3],
    /// Instead of the three above.
    pub matrix: Option<Affine>,
    /// Of the mesh at the node.
    pub morph_weights: Option<Vec<f64>>,
}

/// The transforms of all nodes.
#[derive(Clone, Debug)]
pub(super) struct Pose {
    pub locals: Vec<Local>,
}

impl Pose {
    /// The pose that the file's nodes are in.
    pub(super) fn rest(asset: &Asset) -> Self {
        let locals = asset
            .nodes
            .iter()
            .zip(&asset.root.nodes)
            .map(|(exact, node)| Local {
                translation: exact.translation.unwrap_or_default(),
                rotation: exact.rotation.unwrap_or([0., 0., 0., 1.]),
                scale: exact.scale.unwrap_or([1.0; 3]),
                matrix: exact.matrix.map(|m| Affine::from_columns(&m)),
                morph_weights: node.weights.as_ref().map(|w| w.iter().map(|&x| x.into()).collect()),
            })
            .collect();
        Self { locals }
    }

    /// The transform of each node to the world.
    pub(super) fn globals(&self, hierarchy: &Hierarchy) -> Vec<Affine> {
        let mut globals = vec![Affine::IDENTITY; self.locals.len()];
        for &(node, parent) in &hierarchy.order {
            let local = &self.locals[node];
            let map = local
                .matrix
                .unwrap_or_else(|| Affine::from_parts(local.translation, local.rotation, local.scale));
            globals[node] = parent.map_or(map, |p| globals[p].after(&map));
        }
        globals
    }
}

/// The trees of nodes.
pub(super) struct Hierarchy {
    /// Every node after its parent.
    order: Vec<(usize, Option<usize>)>,
    /// The nodes of the scene that is shown, depth first.
    pub scene: Vec<usize>,
}

impl Hierarchy {
    pub(super) fn new(root: &json::Root) -> Result<Self, Fault> {
        let mut is_child = vec![false; root.nodes.len()];
        for (number, node) in root.nodes.iter().enumerate() {
            for child in node.children.iter().flatten() {
                get(&root.nodes, child.value(), "node")?;
                if std::mem::replace(&mut is_child[child.value()], true) {
                    let child = child.value();
                    return Err(Fault::new(format!(
                        "node {child} has two parents, one of them node {number}"
                    )));
                }
            }
        }
        let roots: Vec<usize> = (0..root.nodes.len()).filter(|&n| !is_child[n]).collect();
        let order = descend(root, &roots);
        // Each node has one parent, so nodes that no root leads to form a cycle.
        if order.len() < root.nodes.len() {
            return Err(Fault::new("some nodes are their own ancestors"));
        }
        let scene = match root.scene.map_or(0, |s| s.value()) {
            0 if root.scenes.is_empty() => roots,
            number => {
                let nodes = &get(&root.scenes, number, "scene")?.nodes;
                nodes
                    .iter()
                    .map(|n| get(&root.nodes, n.value(), "node").map(|_| n.value()))
                    .collect::<Result<_, _>>()?
            }
        };
        let scene = descend(root, &scene).into_iter().map(|(node, _)| node).collect();
        Ok(Self { order, scene })
    }
}

/// Depth first, children in their order; each node once, with its parent.
fn descend(root: &json::Root, starts: &[usize]) -> Vec<(usize, Option<usize>)> {
    let mut order = Vec::new();
    let mut seen = vec![false; root.nodes.len()];
    let mut stack: Vec<(usize, Option<usize>)> = starts.iter().rev().map(|&n| (n, None)).collect();
    while let Some((node, parent)) = stack.pop() {
        if std::mem::replace(&mut seen[node], true) {
            continue;
        }
        order.push((node, parent));
        let children = root.nodes[node].children.iter().flatten();
        let before = stack.len();
        stack.extend(children.map(|c| (c.value(), Some(node))));
        stack[before..].reverse();
    }
    order
}
