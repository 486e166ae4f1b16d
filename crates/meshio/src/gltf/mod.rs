//! glTF 2.0: every triangle primitive of the scene, posed by node transforms, morph targets, skins
//! and animations.

mod accessor;
mod animation;
mod buffers;
mod pose;
mod primitive;
mod skin;
mod transform;

use crate::error::Fault;
use crate::read::{Parsed, ReadOptions, note, read_bytes};
use crate::weld::{Weld, collapse};
use crate::{MeshFormat, MeshIoError};
use accessor::{Asset, get};
pub use animation::AnimationInfo;
use pose::{Hierarchy, Pose};
use std::path::Path;
use transform::Affine;

/// Extensions that hide the geometry from a reader that doesn't know them.
const UNREADABLE: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "EXT_mesh_gpu_instancing",
];

/// The animations of a glTF or GLB file; none for other formats.
///
/// # Errors
/// Those of [`read_mesh`](crate::read_mesh) that concern the file as a whole and its animations.
pub fn list_animations(path: &Path) -> Result<Vec<AnimationInfo>, MeshIoError> {
    let bytes = read_bytes(path)?;
    match MeshFormat::of(path, &bytes)? {
        format @ (MeshFormat::Gltf | MeshFormat::Glb) => {
            animation::list(&open(format, &bytes, path)?).map_err(|fault| broken(fault, path))
        }
        _ => Ok(Vec::new()),
    }
}

pub(crate) fn parse(
    format: MeshFormat,
    bytes: &[u8],
    path: &Path,
    options: &ReadOptions,
) -> Result<Parsed, MeshIoError> {
    let asset = open(format, bytes, path)?;
    let animation = match &options.animation {
        None => None,
        Some(wanted) => Some(choose(&asset, wanted, path)?),
    };
    assemble(&asset, animation, options.time).map_err(|fault| broken(fault, path))
}

/// The author of a broken file is a program; its user can only find out more, or try again.
fn broken(fault: Fault, path: &Path) -> MeshIoError {
    fault.advise("check the file with a glTF validator, or export it again").in_file(path)
}

fn open<'a>(format: MeshFormat, bytes: &'a [u8], path: &Path) -> Result<Asset<'a>, MeshIoError> {
    let (root, chunk) = buffers::split(format, bytes).map_err(|fault| broken(fault, path))?;
    if let Some(name) = root.extensions_required.iter().find(|e| UNREADABLE.contains(&e.as_str())) {
        let reason =
            format!("the file needs {name}, which is not supported; export it without (no compression)");
        return Err(Fault::unsupported(None, reason).in_file(path));
    }
    let buffers = buffers::load(&root, chunk, path)?;
    Ok(Asset { root, buffers })
}

/// The animation of a name, or else of a number.
fn choose(asset: &Asset, wanted: &str, path: &Path) -> Result<usize, MeshIoError> {
    let animations = &asset.root.animations;
    let by_name = animations.iter().position(|a| a.name.as_deref() == Some(wanted));
    let by_number = || wanted.parse().ok().filter(|&n: &usize| n < animations.len());
    by_name.or_else(by_number).map_or_else(
        || {
            let available = animation::list(asset).map_err(|fault| broken(fault, path))?;
            Err(MeshIoError::NoAnimation { path: path.to_path_buf(), wanted: wanted.to_owned(), available })
        },
        Ok,
    )
}

/// All triangles of the scene in world space, vertices at equal rest positions welded.
///
/// What is welded must not depend on the pose, or frames of an animation would differ in their
/// vertices. So unskinned vertices are compared where the rest pose puts them, skinned ones before
/// the skin moves them.
fn assemble(asset: &Asset, animation: Option<usize>, time: f64) -> Result<Parsed, Fault> {
    let root = &asset.root;
    let hierarchy = Hierarchy::new(root)?;
    let mut pose = Pose::rest(root);
    let rest = pose.clone();
    let rest_globals = rest.globals(&hierarchy);
    if let Some(animation) = animation {
        animation::apply(asset, animation, time, &mut pose)?;
    }
    let globals = pose.globals(&hierarchy);
    let skins = skin::all(asset, &globals)?;

    let mut parsed = Parsed::default();
    let mut weld = Weld::default();
    let mut corners: Vec<[u32; 3]> = Vec::new();
    let mut others = 0;
    for &node in &hierarchy.scene {
        let Some(mesh) = root.nodes[node].mesh else { continue };
        let mesh = get(&root.meshes, mesh.value(), "mesh")?;
        let skin = root.nodes[node].skin.map(|s| get(&skins, s.value(), "skin")).transpose()?;
        let weights = |pose: &Pose| {
            let of_mesh = || mesh.weights.iter().flatten().map(|&w| w.into()).collect();
            pose.locals[node].morph_weights.clone().unwrap_or_else(of_mesh)
        };
        let (morph, rest_morph): (Vec<f64>, Vec<f64>) = (weights(&pose), weights(&rest));
        for primitive in &mesh.primitives {
            let still = primitive::positions(asset, primitive, &rest_morph)?;
            let Some(triangles) = primitive::triangles(asset, primitive, still.len())? else {
                others += 1;
                continue;
            };
            let moved = if morph == rest_morph {
                still.clone()
            } else {
                primitive::positions(asset, primitive, &morph)?
            };
            let (keys, placed, group, mirrored) = match skin {
                Some(skin) => {
                    let influences = skin::influences(asset, primitive, still.len(), skin.joints.len())?;
                    let placed =
                        moved.iter().zip(&influences).map(|(&p, i)| skin.blend(i).apply(p)).collect();
                    (still, placed, skin.group + 1, false)
                }
                None => {
                    let place =
                        |map: &Affine, points: &[[f64; 3]]| points.iter().map(|&p| map.apply(p)).collect();
                    let keys = place(&rest_globals[node], &still);
                    let placed: Vec<[f64; 3]> = place(&globals[node], &moved);
                    (keys, placed, 0, globals[node].determinant() < 0.0)
                }
            };
            let first = u32::try_from(weld.map.len() + keys.len())
                .map_err(|_| Fault::new("too many vertices"))?
                - keys.len() as u32;
            for (&key, &position) in keys.iter().zip(&placed) {
                if weld.push(group, key) {
                    parsed.vertices.push(position);
                }
            }
            let turned = |[a, b, c]: [u32; 3]| if mirrored { [a, c, b] } else { [a, b, c] };
            corners.extend(triangles.into_iter().map(|t| turned(t.map(|v| v + first))));
        }
    }
    let (triangles, dropped) = collapse(corners.into_iter(), &weld.map);
    parsed.triangles = triangles;
    parsed.weld = Some(weld.map);
    parsed.notes.extend(note(dropped, "triangles with two equal corners left out"));
    parsed.notes.extend(note(others, "primitives of points or lines left out"));
    Ok(parsed)
}
