//! glTF 2.0: every triangle primitive of the scene, posed by node transforms, morph targets, skins
//! and animations.

mod accessor;
mod animation;
mod buffers;
mod exact;
mod extensions;
mod pose;
mod primitive;
mod scene;
mod skin;
mod transform;

use crate::budget::Budget;
use crate::error::Fault;
use crate::read::{Parsed, ReadOptions, note};
use crate::weld::{Weld, collapse};
use crate::{MeshFormat, MeshIoError, gzip};
use accessor::{Asset, get};
pub use animation::AnimationInfo;
use mser3d_fileio::{ReadLimits, read_bytes_within};
use scene::Scene;
use std::path::Path;

/// The animations of a glTF or GLB file; none for other formats.
///
/// # Errors
/// Those of [`read_mesh`](crate::read_mesh) that concern the file as a whole and its animations.
pub fn list_animations(path: &Path, limits: &ReadLimits) -> Result<Vec<AnimationInfo>, MeshIoError> {
    let bytes = read_bytes_within(path, limits, 1)?;
    // Of standard input only the contents tell.
    let format = MeshFormat::of(path, &bytes);
    match format.or_else(|error| MeshFormat::from_contents(&bytes).ok_or(error))? {
        format @ (MeshFormat::Gltf | MeshFormat::Glb) => {
            let budget = Budget::new(limits);
            let bytes = gzip::unpack(&bytes, &budget).map_err(|fault| fault.in_file(path))?;
            animation::list(&open(format, &bytes, path, &budget)?).map_err(|fault| broken(fault, path))
        }
        _ => Ok(Vec::new()),
    }
}

pub(crate) fn parse(
    format: MeshFormat,
    bytes: &[u8],
    path: &Path,
    options: &ReadOptions,
    budget: &Budget,
) -> Result<Parsed, MeshIoError> {
    let asset = open(format, bytes, path, budget)?;
    let animation = match &options.animation {
        None => None,
        Some(wanted) => Some(choose(&asset, wanted, options.time, path)?),
    };
    assemble(&asset, animation, options.time).map_err(|fault| broken(fault, path))
}

/// A program wrote the broken file. Its user can only find out more about it, or export it again.
fn broken(fault: Fault, path: &Path) -> MeshIoError {
    fault.advise("check the file with a glTF validator, or export it again").in_file(path)
}

fn open<'a>(
    format: MeshFormat,
    bytes: &'a [u8],
    path: &Path,
    budget: &'a Budget,
) -> Result<Asset<'a>, MeshIoError> {
    let (text, root, chunk) = buffers::split(format, bytes, budget).map_err(|fault| broken(fault, path))?;
    extensions::check(&root).map_err(|fault| fault.in_file(path))?;
    let exact = exact::nodes(&text).map_err(|fault| broken(fault, path))?;
    let buffers = buffers::load(&root, chunk, path, budget)?;
    Ok(Asset { root, buffers, nodes: exact, budget })
}

/// How far beyond its end, in seconds, an animation may be asked for: ends are shown to a hundredth.
const ROUNDED: f64 = 0.005;

/// The animation with this name, or else with this number. It must not end before the time.
fn choose(asset: &Asset, wanted: &str, time: f64, path: &Path) -> Result<usize, MeshIoError> {
    let animations = &asset.root.animations;
    let by_name = animations.iter().position(|a| a.name.as_deref() == Some(wanted));
    let by_number = || wanted.parse().ok().filter(|&n: &usize| n < animations.len());
    let available = || animation::list(asset).map_err(|fault| broken(fault, path));
    let Some(chosen) = by_name.or_else(by_number) else {
        let (path, wanted) = (path.to_path_buf(), wanted.to_owned());
        return Err(MeshIoError::NoAnimation { path, wanted, available: available()? });
    };
    if time > 0.0 {
        let mut available = available()?;
        let animation = available.swap_remove(chosen);
        if time > animation.end + ROUNDED {
            return Err(MeshIoError::BeyondAnimation { path: path.to_path_buf(), animation, time });
        }
    }
    Ok(chosen)
}

/// All triangles of the scene in world space, vertices at equal rest positions welded.
fn assemble(asset: &Asset, animation: Option<usize>, time: f64) -> Result<Parsed, Fault> {
    let scene = Scene::new(asset, animation, time)?;
    let mut parsed = Parsed::default();
    let mut weld = Weld::default();
    let mut corners: Vec<[u32; 3]> = Vec::new();
    let (mut others, mut repeated) = (0, 0);
    for &node in &scene.shown {
        let Some(mesh) = asset.root.nodes[node].mesh else { continue };
        let mesh = get(&asset.root.meshes, mesh.value(), "mesh")?;
        let instances = scene.instances(node)?;
        for primitive in &mesh.primitives {
            let Some(shape) = scene.shape(node, mesh, primitive)? else {
                others += 1;
                continue;
            };
            let shown = instances.as_ref().map_or(1, Vec::len) as u64;
            asset.budget.take(shape.memory().saturating_mul(shown), || {
                format!("node {node} shows a mesh of {} vertices {shown} times", shape.vertices())
            })?;
            for instance in 0..instances.as_ref().map_or(1, Vec::len) {
                let part =
                    scene.part(node, &shape, instances.as_ref().map(|all| (instance, &all[instance])))?;
                let first = weld.map.len();
                if first + part.keys.len() > u32::MAX as usize {
                    return Err(Fault::new("the scene shows more than 2^32 vertices"));
                }
                for (&key, &position) in part.keys.iter().zip(&part.positions) {
                    if weld.push(part.group, key) {
                        parsed.vertices.push(position);
                    }
                }
                corners.extend(part.triangles.into_iter().map(|t| t.map(|v| v + first as u32)));
            }
        }
        repeated += instances.map_or(0, |all| all.len());
    }
    let (triangles, dropped) = collapse(corners.into_iter(), &weld.map);
    parsed.triangles = triangles;
    parsed.weld = Some(weld.map);
    parsed.notes.extend(note(
        repeated,
        "instances of meshes (EXT_mesh_gpu_instancing) each read as a part of the mesh",
    ));
    parsed.notes.extend(note(dropped, "triangles with two equal corners left out"));
    parsed.notes.extend(note(others, "primitives of points or lines left out"));
    Ok(parsed)
}
