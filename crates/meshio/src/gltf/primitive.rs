//! A primitive's vertices and triangles.

use super::accessor::{Asset, Rows};
use super::extensions;
use crate::error::Fault;
use gltf::{Semantic, json};
use json::accessor::Type;
use json::mesh::{Mode, Primitive};
use json::validation::Checked;

pub(super) fn attribute(primitive: &Primitive, semantic: Semantic) -> Option<json::Index<json::Accessor>> {
    primitive.attributes.get(&Checked::Valid(semantic)).copied()
}

/// Positions before any transform, with the morph targets blended in.
pub(super) fn positions(asset: &Asset, primitive: &Primitive, morph: &[f64]) -> Result<Vec<[f64; 3]>, Fault> {
    let accessor = attribute(primitive, Semantic::Positions)
        .ok_or_else(|| Fault::new("a mesh primitive has no POSITION"))?;
    extensions::check_positions(asset, accessor)?;
    let mut positions: Vec<[f64; 3]> = asset.rows(accessor, Type::Vec3)?.iter().collect();
    for (target, &weight) in primitive.targets.iter().flatten().zip(morph) {
        let Some(accessor) = target.positions.filter(|_| weight != 0.0) else { continue };
        let moves = same_length(asset.rows(accessor, Type::Vec3)?, positions.len(), "a morph target")?;
        for (p, d) in positions.iter_mut().zip(moves.iter::<3>()) {
            *p = std::array::from_fn(|a| p[a] + weight * d[a]);
        }
    }
    Ok(positions)
}

pub(super) fn same_length(rows: Rows, vertices: usize, what: &str) -> Result<Rows, Fault> {
    if rows.len() == vertices {
        return Ok(rows);
    }
    Err(Fault::new(format!("{what} has {} rows for a primitive of {vertices} vertices", rows.len())))
}

/// The triangles of a primitive; `None` for points and lines.
pub(super) fn triangles(
    asset: &Asset,
    primitive: &Primitive,
    vertices: usize,
) -> Result<Option<Vec<[u32; 3]>>, Fault> {
    let Checked::Valid(mode) = primitive.mode else {
        return Err(Fault::new("a mesh primitive's mode is none of 0 to 6"));
    };
    if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
        return Ok(None);
    }
    let indices: Vec<u32> = match primitive.indices {
        None => (0..vertices as u32).collect(),
        Some(accessor) => {
            let number = accessor.value();
            let indices = asset.rows(accessor, Type::Scalar)?.values;
            if let Some(index) = indices.iter().find(|&&i| !(0.0..vertices as f64).contains(&i)) {
                return Err(Fault::new(format!(
                    "accessor {number}: a triangle names vertex {index}, but the primitive has {vertices} \
                     (numbered from 0)"
                )));
            }
            indices.iter().map(|&i| i as u32).collect()
        }
    };
    Ok(Some(assemble(mode, &indices)))
}

fn assemble(mode: Mode, indices: &[u32]) -> Vec<[u32; 3]> {
    let strip = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
    // Strips repeat vertices to jump; such triangles are not part of the surface.
    let whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
    match (mode, indices) {
        (Mode::TriangleStrip, _) => indices.windows(3).enumerate().map(strip).filter(whole).collect(),
        (Mode::TriangleFan, [first, rest @ ..]) => rest.windows(2).map(|w| [*first, w[0], w[1]]).collect(),
        _ => indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_orientation() {
        let indices = [0, 1, 2, 3, 3, 4];
        assert_eq!(assemble(Mode::TriangleStrip, &indices), [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(assemble(Mode::TriangleFan, &indices[..4]), [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(assemble(Mode::Triangles, &indices), [[0, 1, 2], [3, 3, 4]]);
        assert!(assemble(Mode::TriangleStrip, &indices[..2]).is_empty());
        assert!(assemble(Mode::TriangleFan, &[]).is_empty());
    }
}
