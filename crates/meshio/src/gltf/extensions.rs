//! Extensions of glTF: which may be ignored, and instances of meshes.

use super::accessor::{Asset, get};
use super::exact::Instancing;
use super::transform::Affine;
use crate::error::Fault;
use gltf::json;
use json::accessor::Type;

/// Extensions that are read, or that say nothing of the shape.
const FINE: [&str; 8] = [
    "KHR_mesh_quantization",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_features",
    "EXT_instance_features",
    "EXT_structural_metadata",
    "CESIUM_primitive_outline",
    "MSFT_lod",
    "KHR_techniques_webgl",
];

/// What the names of extensions begin with that say nothing of the shape: looks, light, sound, notes, rigs.
const FINE_FAMILIES: [&str; 13] = [
    "KHR_materials_",
    "EXT_materials_",
    "ADOBE_materials_",
    "FB_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "EXT_lights_",
    "KHR_audio",
    "KHR_xmp",
    "VRM",
    "MSFT_packing_",
];

const COMPRESSIONS: [&str; 4] = [
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
    "MPEG_mesh_compression",
];

const UNPACK: &str = "export it without compression, or unpack it (gltf-transform copy)";

/// Refuses a file that cannot be understood without an extension that is not read.
pub(super) fn check(root: &json::Root) -> Result<(), Fault> {
    let is_fine = |name: &str| FINE.contains(&name) || FINE_FAMILIES.iter().any(|f| name.starts_with(f));
    let Some(name) = root.extensions_required.iter().find(|name| !is_fine(name)) else { return Ok(()) };
    let reason = if COMPRESSIONS.contains(&name.as_str()) {
        format!("the file needs {name}, which is not supported; {UNPACK}")
    } else {
        format!("the file needs the extension {name}, which is not supported; export it without")
    };
    Err(Fault::unsupported(None, reason))
}

/// Positions without data are those of a compressed mesh, which would be read as zeros.
pub(super) fn check_positions(asset: &Asset, positions: json::Index<json::Accessor>) -> Result<(), Fault> {
    let accessor = get(&asset.root.accessors, positions.value(), "accessor")?;
    let has_data = accessor.buffer_view.is_some() || accessor.sparse.is_some();
    let used = asset.root.extensions_used.iter().find(|name| COMPRESSIONS.contains(&name.as_str()));
    match used.filter(|_| !has_data) {
        Some(name) => Err(Fault::unsupported(
            None,
            format!("the mesh is packed by {name}, which is not supported; {UNPACK}"),
        )),
        None => Ok(()),
    }
}

/// The transform of each instance.
pub(super) fn instances(asset: &Asset, instancing: &Instancing) -> Result<Vec<Affine>, Fault> {
    let rows = |name: &str, kind: Type| {
        let accessor = instancing.attributes.get(name);
        accessor.map(|&number| asset.rows(json::Index::new(number), kind)).transpose()
    };
    let (translations, rotations, scales) =
        (rows("TRANSLATION", Type::Vec3)?, rows("ROTATION", Type::Vec4)?, rows("SCALE", Type::Vec3)?);
    let counts = [&translations, &rotations, &scales].map(|r| r.as_ref().map(|r| r.len()));
    let Some(count) = counts.into_iter().flatten().next() else {
        return Err(Fault::unsupported(
            None,
            "EXT_mesh_gpu_instancing without TRANSLATION, ROTATION or SCALE is not supported; export without instancing",
        ));
    };
    if counts.into_iter().flatten().any(|n| n != count) {
        return Err(Fault::new("the attributes of instances have different counts"));
    }
    let translations = translations.map_or_else(|| vec![[0.0; 3]; count], |r| r.iter().collect());
    let rotations = rotations.map_or_else(|| vec![[0., 0., 0., 1.]; count], |r| r.iter().collect());
    let scales = scales.map_or_else(|| vec![[1.0; 3]; count], |r| r.iter().collect());
    Ok((0..count).map(|i| Affine::from_parts(translations[i], rotations[i], scales[i])).collect())
}
