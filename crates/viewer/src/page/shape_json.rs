use mser3d_shape::innermost_regions;
use serde_json::{Value, json};

use super::{PagePart, PageParts, PageRegion, PageShape, PageTree};
use crate::page::branches::Branches;
use crate::page::pack::Pack;
use crate::page::thin::thin;
use crate::section::is_closed;
use crate::{normals, occlusion};

/// A finer mesh is thinned out: without a graphics card it would take a page of 500,000 vertices a minute to open.
const MOST_VERTICES: usize = 60_000;

/// A shape as the page's data; long arrays go into the pack.
pub(crate) fn shape_json(shape: &PageShape<'_>, pack: &mut Pack) -> Value {
    let thinned = thin(shape.mesh, &kinds(shape), MOST_VERTICES);
    let mesh = thinned.as_ref().map_or(shape.mesh, |thinned| &thinned.mesh);
    // The vertices that are drawn, by their numbers in the whole mesh.
    let drawn: Vec<u32> = match thinned.as_ref() {
        Some(thinned) => thinned.kept.clone(),
        None => (0..mesh.vertices().len() as u32).collect(),
    };
    let mut facts = shape.facts.clone();
    if thinned.is_some() {
        let (drawn, all) = (mesh.vertices().len(), shape.mesh.vertices().len());
        facts.push(["drawn".to_owned(), format!("{drawn} of {all} vertices; numbers are of all")]);
    }
    let centre = mesh.bounding_box().map_or([0.0; 3], |b| [0, 1, 2].map(|a| 0.5 * (b.min[a] + b.max[a])));
    // Relative to the centre, so that f32 keeps the detail of a shape far from the origin.
    let positions = mesh.vertices().iter().flat_map(|p| [0, 1, 2].map(|a| (p[a] - centre[a]) as f32));
    let normals = normals::smooth(mesh).vertices;
    let open = occlusion::openness(mesh.vertices(), mesh.triangles(), &normals);
    let open = open.iter().map(|o| (o * 255.0).round() as u8);
    let regions: Vec<Value> = shape.regions.iter().map(|r| region_json(r, shape, &drawn, pack)).collect();
    let grid = shape.grid.map(|grid| {
        let dims = grid.frame().dims();
        let place =
            |v: [u32; 3]| ((v[2] as usize * dims[1] + v[1] as usize) * dims[0] + v[0] as usize) as u32;
        let origin = grid.frame().origin();
        let origin = [0, 1, 2].map(|a| origin[a] - centre[a]);
        json!({
            "dims": dims,
            "origin": origin,
            "spacing": grid.frame().spacing(),
            "directions": grid.frame().directions(),
            "place": pack.u32(grid.voxels().map(place)),
            "label": pack.i16(innermost(&shape.regions, grid.len(), |r| r.voxels)),
            "part": shape.parts.as_ref().map(|parts| pack.i16(parts.voxels.iter().copied().map(label))),
        })
    });
    let trees: Vec<Value> =
        shape.trees.iter().enumerate().map(|(i, tree)| tree_json(tree, i, shape, &drawn, pack)).collect();
    let grey = shape.grey.as_ref().map(|grey| {
        let values = pack.u8(grey.values.iter().copied());
        json!({ "dims": grey.dims, "step": grey.step.max(1), "values": values })
    });
    let region_of_vertex: Vec<i16> =
        innermost(&shape.regions, shape.mesh.vertices().len(), |r| r.vertices).collect();
    // A vertex enters a tree with its voxel: 0 for none, else its number and 1.
    let voxel = |&v: &u32| shape.vertex_voxel[v as usize].checked_add(1).map_or(0, i32::unsigned_abs);
    let vertex_voxel = shape.grid.map(|_| pack.u32(drawn.iter().map(voxel)));
    json!({
        "name": shape.name,
        "front": shape.front,
        "facts": facts,
        "closed": is_closed(mesh.triangles()),
        "position": pack.f32(positions),
        "triangle": pack.u32(mesh.triangles().iter().flatten().copied()),
        "open": pack.u8(open),
        "label": pack.i16(drawn.iter().map(|&v| region_of_vertex[v as usize])),
        "part": shape.parts.as_ref().map(|parts| pack.i16(drawn.iter().map(|&v| label(parts.vertices[v as usize])))),
        "vertexVoxel": vertex_voxel,
        "regions": regions,
        "parts": shape.parts.as_ref().map(parts_json),
        "grid": grid,
        "grey": grey,
        "trees": trees,
    })
}

/// A number for each vertex that differs where its region or part does.
fn kinds(shape: &PageShape<'_>) -> Vec<u32> {
    let regions = innermost(&shape.regions, shape.mesh.vertices().len(), |r| r.vertices);
    let part = |v: usize| shape.parts.as_ref().map_or(-1, |parts| label(parts.vertices[v]));
    let both = |(v, region): (usize, i16)| (u32::from(region as u16) << 16) | u32::from(part(v) as u16);
    regions.enumerate().map(both).collect()
}

fn region_json(region: &PageRegion<'_>, shape: &PageShape<'_>, drawn: &[u32], pack: &mut Pack) -> Value {
    let mut inside = vec![false; shape.mesh.vertices().len()];
    region.vertices.iter().for_each(|&v| inside[v as usize] = true);
    let vertices: Vec<u32> =
        (0..drawn.len() as u32).filter(|&i| inside[drawn[i as usize] as usize]).collect();
    let voxels = shape.grid.map_or(0, |grid| grid.len());
    json!({
        "colour": region.colour.0,
        "parent": region.parent,
        "altitude": number(region.altitude),
        "stability": number(region.stability),
        "reliability": region.reliability,
        "lifetime": region.lifetime.map(number),
        "twin": region.twin,
        "side": region.side,
        "volume": number(region.volume),
        "fraction": number(region.volume_fraction),
        "vertices": region.vertices.len(),
        "voxels": region.voxels.len(),
        "tree": region.node.map(|n| n[0]),
        "vertexSet": pack.bits(&vertices, drawn.len()),
        "voxelSet": pack.bits(region.voxels, voxels),
    })
}

fn parts_json(parts: &PageParts<'_>) -> Value {
    let count = |labels: &[i32], part: usize| labels.iter().filter(|&&label| label == part as i32).count();
    let part = |(number_of_part, part): (usize, &PagePart)| {
        json!({
            "colour": part.colour.0,
            "trunk": part.trunk,
            "region": part.region,
            "twins": part.twins,
            "side": part.side,
            "volume": number(part.volume),
            "fraction": number(part.volume_fraction),
            "vertices": count(parts.vertices, number_of_part),
            "voxels": count(parts.voxels, number_of_part),
        })
    };
    parts.list.iter().enumerate().map(part).collect()
}

fn tree_json(
    tree: &PageTree<'_>,
    number_of_tree: usize,
    shape: &PageShape<'_>,
    drawn: &[u32],
    pack: &mut Pack,
) -> Value {
    let branches = Branches::new(tree, number_of_tree, &shape.regions);
    let share = |x: f32| (x * 65535.0).round() as u16;
    // Voxels, or the vertices that are drawn.
    let elements: Vec<usize> = match shape.grid {
        Some(grid) => (0..grid.len()).collect(),
        None => drawn.iter().map(|&v| v as usize).collect(),
    };
    let regions: Vec<Value> = branches.regions.iter().map(|r| json!(r.map(|(b, e)| (b, e)))).collect();
    json!({
        "name": tree.name,
        "superlevel": tree.superlevel,
        "parents": branches.parents,
        "starts": branches.starts,
        "ends": branches.ends,
        "volumes": branches.volumes,
        "quantiles": branches.quantiles.iter().map(|&q| number(q)).collect::<Vec<_>>(),
        "regions": regions,
        "branch": pack.indices(elements.iter().map(|&e| branches.branch[e]), branches.parents.len()),
        "entered": pack.u16(elements.iter().map(|&e| share(branches.entered[e]))),
    })
}

/// The smallest region around each vertex or voxel; -1 for none.
fn innermost(
    regions: &[PageRegion<'_>],
    count: usize,
    members: for<'r, 'd> fn(&'r PageRegion<'d>) -> &'d [u32],
) -> impl Iterator<Item = i16> {
    let mut order: Vec<usize> = (0..regions.len().min(i16::MAX as usize)).collect();
    order.sort_by(|&p, &q| regions[q].volume.total_cmp(&regions[p].volume));
    let innermost = innermost_regions(count, order.iter().map(|&r| members(&regions[r])));
    innermost.into_iter().map(move |place| place.map_or(-1, |place| order[place as usize] as i16))
}

/// A label as the page has it; a number beyond those that it knows is none.
fn label(label: i32) -> i16 {
    i16::try_from(label).unwrap_or(-1)
}

/// JSON has no infinity: a number that is not finite is null.
pub(crate) fn number(x: f64) -> Value {
    serde_json::Number::from_f64(x).map_or(Value::Null, Value::Number)
}
