//! The page: one HTML file with everything in it.

mod branches;
mod data;
mod pack;
mod shape_json;
mod thin;

use base64::Engine;
use mser3d_shape::Choice;
use serde_json::{Value, json};

pub use data::{PageData, PageGrey, PagePart, PageParts, PageRegion, PageShape, PageTree, RegionPair};

pub(crate) use crate::page::pack::Pack;
use crate::page::shape_json::{number, shape_json};
use crate::{NO_REGION, ViewerError};

const TEMPLATE: &str = include_str!("../../page/page.html");
const STYLE: &str = include_str!("../../page/page.css");
/// Concatenated in this order into one function scope.
const SCRIPTS: [&str; 20] = [
    include_str!("../../page/data.js"),
    include_str!("../../page/camera.js"),
    include_str!("../../page/shaders.js"),
    include_str!("../../page/surface.js"),
    include_str!("../../page/slice.js"),
    include_str!("../../page/pick.js"),
    include_str!("../../page/colouring.js"),
    include_str!("../../page/tree.js"),
    include_str!("../../page/words.js"),
    include_str!("../../page/table.js"),
    include_str!("../../page/panel.js"),
    include_str!("../../page/renderer.js"),
    include_str!("../../page/state.js"),
    include_str!("../../page/theme.js"),
    include_str!("../../page/overlay.js"),
    include_str!("../../page/link.js"),
    include_str!("../../page/point.js"),
    include_str!("../../page/grey.js"),
    include_str!("../../page/input.js"),
    include_str!("../../page/main.js"),
];

/// A self-contained HTML page: the shape and its regions to turn and explore in any browser with
/// WebGL2, without network.
///
/// Parts are shown first, where there are any, then regions, then level sets. They light up under the pointer and tell
/// their numbers; the twin of a chosen one is seen faintly; a slider lets the level of a component tree rise, which is drawn beside it; a plane cuts the solid open; two
/// shapes share one camera and the colours of their matches. Everything works by keyboard and touch too. A
/// browser without WebGL2 shows the table of regions and says what is missing.
///
/// Of a mesh of more than 60,000 vertices fewer are drawn: those that are connected and lie within about a pixel of each
/// other are one, unless a border of regions or parts runs between them. The page says so; its numbers are of the whole mesh.
///
/// Size: about 4/3 of 25 bytes per vertex drawn, 24 of its triangles, and 6 per voxel plus 4 per voxel
/// and tree. The same data give the same bytes.
///
/// # Errors
/// [`ViewerError::InvalidParameter`], [`ViewerError::OutOfRange`] or [`ViewerError::SizeMismatch`] for data
/// that do not fit each other, [`ViewerError::Empty`] for a mesh without triangles.
///
/// ```
/// use mser3d_shape::TriangleMesh;
/// use mser3d_viewer::{PALETTE, PageData, PageRegion, PageShape, Up, page};
///
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let region = PageRegion {
///     colour: PALETTE[0].middle,
///     parent: None,
///     altitude: 0.5,
///     stability: 12.0,
///     reliability: Some(0.9),
///     lifetime: Some(0.4),
///     twin: None,
///     side: None,
///     volume: 0.01,
///     volume_fraction: 0.06,
///     vertices: &[0, 3],
///     voxels: &[],
///     node: None,
/// };
/// let shape = PageShape {
///     name: "tetrahedron".into(),
///     front: None,
///     mesh: &mesh,
///     grid: None,
///     vertex_voxel: &[],
///     regions: vec![region],
///     parts: None,
///     grey: None,
///     trees: vec![],
///     facts: vec![],
/// };
/// let (title, matches) = ("A tetrahedron".into(), vec![]);
/// let data = PageData { title, shapes: vec![shape], matches, part_matches: vec![], up: Up::Y };
/// let html = page(&data)?;
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn page(data: &PageData<'_>) -> Result<String, ViewerError> {
    data.check()?;
    let mut pack = Pack::default();
    let shapes: Vec<Value> = data.shapes.iter().map(|shape| shape_json(shape, &mut pack)).collect();
    let pairs = |matches: &[RegionPair]| -> Vec<Value> {
        matches.iter().map(|m| json!([m.first, m.second, number(m.distance), m.mistake])).collect()
    };
    let head = json!({
        "title": data.title,
        "up": data.up.name(),
        "none": NO_REGION.0,
        "shapes": shapes,
        "matches": { "regions": pairs(&data.matches), "parts": pairs(&data.part_matches) },
    });
    // Inside a script element, only "<" could end it.
    let head = head.to_string().replace('<', "\\u003c");
    let parts = [
        ("{{title}}", escape(&data.title)),
        ("{{style}}", STYLE.to_owned()),
        ("{{script}}", SCRIPTS.concat()),
        ("{{head}}", head),
        ("{{arrays}}", base64::engine::general_purpose::STANDARD.encode(pack.bytes())),
    ];
    Ok(fill(TEMPLATE, &parts))
}

/// The template with each mark replaced by its part, in one pass: parts are never searched for marks.
pub(crate) fn fill(template: &str, parts: &[(&str, String)]) -> String {
    let mut out = String::with_capacity(template.len() + parts.iter().map(|p| p.1.len()).sum::<usize>());
    let mut rest = template;
    while let Some((at, (mark, text))) =
        parts.iter().filter_map(|part| rest.find(part.0).map(|at| (at, part))).min_by_key(|(at, _)| *at)
    {
        out.push_str(&rest[..at]);
        out.push_str(text);
        rest = &rest[at + mark.len()..];
    }
    out.push_str(rest);
    out
}

pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_not_searched_for_marks() {
        let parts = [("{{a}}", "<{{b}}>".to_owned()), ("{{b}}", "2".to_owned())];
        assert_eq!(fill("{{a}} {{b}}!", &parts), "<{{b}}> 2!");
    }

    #[test]
    fn titles_cannot_break_out() {
        assert_eq!(escape("a<b>&\"c\""), "a&lt;b&gt;&amp;&quot;c&quot;");
    }
}
