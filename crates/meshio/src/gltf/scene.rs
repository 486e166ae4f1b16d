//! What a scene shows at a time.

use super::accessor::{Asset, get};
use super::pose::{Hierarchy, Pose};
use super::skin::{self, Influences, Skin};
use super::transform::Affine;
use super::{animation, extensions, primitive};
use crate::error::Fault;
use gltf::json;
use json::mesh::{Mesh, Primitive};

/// Nodes and skins in their rest pose and in the pose asked for.
///
/// Triangles and welding come from the rest pose, so that the frames of an animation differ in their
/// positions only.
pub(super) struct Scene<'a> {
    asset: &'a Asset<'a>,
    /// The nodes that are shown, depth first.
    pub shown: Vec<usize>,
    rest: State,
    posed: State,
}

struct State {
    pose: Pose,
    /// The transform of each node to the world.
    globals: Vec<Affine>,
    skins: Vec<Skin>,
}

impl State {
    fn new(asset: &Asset, hierarchy: &Hierarchy, pose: Pose) -> Result<Self, Fault> {
        let globals = pose.globals(hierarchy);
        let skins = skin::all(asset, &globals)?;
        Ok(Self { pose, globals, skins })
    }
}

/// A primitive at a node, in the coordinates of its mesh.
pub(super) struct Shape {
    /// Positions in the rest pose, and in the one asked for.
    still: Vec<[f64; 3]>,
    moved: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Of the node's skin, if it has one.
    influences: Vec<Influences>,
}

impl Shape {
    pub(super) fn vertices(&self) -> usize {
        self.still.len()
    }

    /// Bytes that the mesh grows by where it is shown: positions, keys and their table, and triangles, some of them twice.
    pub(super) fn memory(&self) -> u64 {
        const VERTEX: u64 = 180;
        const TRIANGLE: u64 = 40;
        VERTEX * self.still.len() as u64 + TRIANGLE * self.triangles.len() as u64
    }
}

/// A primitive at a node or an instance of it.
pub(super) struct Part {
    /// Positions in the world.
    pub positions: Vec<[f64; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Vertices with the same group and key are welded.
    pub group: usize,
    pub keys: Vec<[f64; 3]>,
}

impl<'a> Scene<'a> {
    pub(super) fn new(asset: &'a Asset, animation: Option<usize>, time: f64) -> Result<Self, Fault> {
        let hierarchy = Hierarchy::new(&asset.root)?;
        let rest = Pose::rest(asset);
        let mut pose = rest.clone();
        if let Some(animation) = animation {
            animation::apply(asset, animation, time, &mut pose)?;
        }
        let rest = State::new(asset, &hierarchy, rest)?;
        let posed = State::new(asset, &hierarchy, pose)?;
        Ok(Self { asset, shown: hierarchy.scene, rest, posed })
    }

    /// The transforms of a node's instances, which come before its own; `None` for a node without them.
    pub(super) fn instances(&self, node: usize) -> Result<Option<Vec<Affine>>, Fault> {
        let Some(instancing) = self.asset.nodes[node].instancing() else { return Ok(None) };
        if self.asset.root.nodes[node].skin.is_some() {
            return Err(Fault::unsupported(
                None,
                format!(
                    "node {node} has a skin and instances, which has no defined meaning; export it without instancing"
                ),
            ));
        }
        extensions::instances(self.asset, instancing).map(Some)
    }

    /// The primitive of a mesh at a node, before it is placed; `None` for points and lines.
    pub(super) fn shape(
        &self,
        node: usize,
        mesh: &Mesh,
        primitive: &Primitive,
    ) -> Result<Option<Shape>, Fault> {
        let Self { asset, rest, posed, .. } = self;
        let weights = |pose: &Pose| -> Vec<f64> {
            let of_mesh = || mesh.weights.iter().flatten().map(|&w| w.into()).collect();
            pose.locals[node].morph_weights.clone().unwrap_or_else(of_mesh)
        };
        let (rest_weights, weights) = (weights(&rest.pose), weights(&posed.pose));
        let still = primitive::positions(asset, primitive, &rest_weights)?;
        let Some(triangles) = primitive::triangles(asset, primitive, still.len())? else {
            return Ok(None);
        };
        let moved = match weights == rest_weights {
            true => still.clone(),
            false => primitive::positions(asset, primitive, &weights)?,
        };
        let influences = match asset.root.nodes[node].skin {
            Some(number) => {
                let skin = get(&posed.skins, number.value(), "skin")?;
                skin::influences(asset, primitive, still.len(), skin.joints.len())?
            }
            None => Vec::new(),
        };
        Ok(Some(Shape { still, moved, triangles, influences }))
    }

    /// The shape in the world, as a node or an instance of it shows it.
    pub(super) fn part(
        &self,
        node: usize,
        shape: &Shape,
        instance: Option<(usize, &Affine)>,
    ) -> Result<Part, Fault> {
        let Self { asset, rest, posed, .. } = self;
        let Shape { still, moved, influences, .. } = shape;
        let mut triangles = shape.triangles.clone();
        let place = |map: &Affine, points: &[[f64; 3]]| points.iter().map(|&p| map.apply(p)).collect();
        let global = |state: &State| match instance {
            Some((_, instance)) => state.globals[node].after(instance),
            None => state.globals[node],
        };
        let (positions, group, keys, orientation) = match asset.root.nodes[node].skin {
            // A skin ignores the transform of its node. Vertices are compared for welding before it moves
            // them.
            Some(number) => {
                let skin = get(&posed.skins, number.value(), "skin")?;
                let positions = moved.iter().zip(influences).map(|(&p, i)| skin.blend(i).apply(p)).collect();
                let orientation = rest.skins[number.value()].joints[0].determinant();
                (positions, 1 + skin.group, still.clone(), orientation)
            }
            None => {
                let map = global(rest);
                let orientation = map.determinant();
                let number = instance.map_or(0, |i| i.0);
                // What is hidden by a scale of zero has all its vertices in one place.
                let (group, keys) = match orientation == 0.0 {
                    true => (usize::MAX - node - number * posed.globals.len(), still.clone()),
                    false => (0, place(&map, still)),
                };
                (place(&global(posed), moved), group, keys, orientation)
            }
        };
        // A mirrored surface would be inside out.
        if orientation < 0.0 {
            triangles.iter_mut().for_each(|t| t.swap(1, 2));
        }
        Ok(Part { positions, triangles, group, keys })
    }
}
