//! Regions in colours.

use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use mser3d::shape::TriangleMesh;
use mser3d_evaluation::{Correspondence, EvaluationError, IndexSet, NullShape, Overlaps};
use mser3d_viewer::{Colours, Image, Model, NO_REGION, RegionTraits, Rgb, linked_colours, region_colours};

/// A mesh in the colours of the innermost regions.
pub fn model(mesh: &TriangleMesh, regions: &[IndexSet], colours: &[Rgb]) -> Result<Model, Box<dyn Error>> {
    let labels = innermost(mesh.vertices().len(), regions);
    Ok(Model::from_mesh(mesh, Colours::Regions { labels: &labels, colours })?)
}

/// The smallest region of each vertex; -1 for none.
pub fn innermost(vertices: usize, regions: &[IndexSet]) -> Vec<i32> {
    let mut order: Vec<usize> = (0..regions.len()).collect();
    order.sort_by_key(|&r| (std::cmp::Reverse(regions[r].len()), r));
    let mut labels = vec![-1; vertices];
    for r in order {
        regions[r].members().for_each(|v| labels[v] = r as i32);
    }
    labels
}

/// How much of two regions together their mirror images must share to be twins.
const TWINS: f64 = 0.7;

/// A colour for each region of the null shape. Regions that are each other's mirror images have one hue, one light and one
/// dark.
pub fn colours(null: &NullShape, regions: &[IndexSet]) -> Result<Vec<Rgb>, EvaluationError> {
    let mesh = null.mesh();
    let around = |r: usize| {
        let larger = (0..regions.len()).filter(|&q| (regions[q].len(), r) > (regions[r].len(), q));
        let contains = |q: &usize| regions[r].members().all(|v| regions[*q].contains(v));
        larger.filter(contains).min_by_key(|&q| regions[q].len()).map(|q| q as u32)
    };
    let identity = Correspondence::identity(mesh.vertices().len());
    let mirrored = Overlaps::mirrored(null, regions, regions, &identity)?;
    let image = |r: usize| {
        let overlaps = mirrored.as_ref()?;
        let best = (0..regions.len()).max_by(|&a, &b| overlaps.get(r, a).total_cmp(&overlaps.get(r, b)))?;
        (overlaps.get(r, best) > TWINS).then_some(best)
    };
    let traits: Vec<RegionTraits> = (0..regions.len())
        .map(|r| {
            let twin = image(r).filter(|&twin| twin != r && image(twin) == Some(r));
            let family = twin.map_or(r, |twin| twin.min(r)) as u32;
            let side = twin.and_then(|_| side(null, &regions[r]));
            RegionTraits { parent: around(r), family: Some(family), side }
        })
        .collect();
    Ok(region_colours(&traits, &innermost(mesh.vertices().len(), regions), &mesh.edge_graph()))
}

/// On which side of the symmetry a region lies, from -1 to 1.
fn side(null: &NullShape, region: &IndexSet) -> Option<f64> {
    let (vertices, mirror) = (null.mesh().vertices(), null.mirror()?);
    let apart = |v: usize, axis: usize| vertices[v][axis] - vertices[mirror[v] as usize][axis];
    let width = |axis: usize| (0..vertices.len()).map(|v| apart(v, axis).abs()).sum::<f64>();
    let axis = (0..3).max_by(|&a, &b| width(a).total_cmp(&width(b)))?;
    let (sum, size) = region.members().fold((0.0, 0.0), |(sum, size), v| {
        let apart = apart(v, axis);
        (sum + apart, size + apart.abs())
    });
    (size > 0.0).then(|| sum / size)
}

/// The colours of another shape's regions: each has the colour of the null region that it overlaps most,
/// or, if that is half or less, whose mirror image it overlaps most; grey if that is half or less, too.
pub fn colours_of_same(
    null: &NullShape,
    null_regions: &[IndexSet],
    null_colours: &[Rgb],
    regions: &[IndexSet],
    correspondence: &Correspondence,
) -> Result<Vec<Rgb>, EvaluationError> {
    let best = |overlaps: &Overlaps, r: usize| {
        let all = (0..null_regions.len()).map(|n| (n as u32, overlaps.get(r, n)));
        all.max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, overlap)| *overlap > 0.5)
            .map(|(n, _)| [n, r as u32])
    };
    let direct = Overlaps::direct(null, null_regions, regions, correspondence)?;
    let either = Overlaps::new(null, null_regions, regions, correspondence)?;
    let pairs: Vec<[u32; 2]> =
        (0..regions.len()).filter_map(|r| best(&direct, r).or_else(|| best(&either, r))).collect();
    Ok(linked_colours(null_colours, &pairs, regions.len()))
}

/// One region in a colour, the rest grey.
pub fn highlighted(mesh: &TriangleMesh, region: &[u32], colour: Rgb) -> Result<Model, Box<dyn Error>> {
    let mut labels = vec![-1; mesh.vertices().len()];
    region.iter().for_each(|&v| labels[v as usize] = 0);
    Ok(Model::from_mesh(mesh, Colours::Regions { labels: &labels, colours: &[colour] })?)
}

/// The mesh without regions.
pub fn plain(mesh: &TriangleMesh) -> Result<Model, Box<dyn Error>> {
    Ok(Model::from_mesh(mesh, Colours::Uniform(NO_REGION))?)
}

/// Writes a picture as PNG.
pub fn write_png(image: &Image, path: &Path) -> Result<(), Box<dyn Error>> {
    let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(image.write_png(BufWriter::new(file)).map_err(|e| format!("{}: {e}", path.display()))?)
}

#[cfg(test)]
mod tests {
    use mser3d_viewer::PALETTE;

    use super::*;

    #[test]
    fn mirror_images_have_one_hue_dark_and_light() {
        let corners = vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap();
        let regions = [0, 1, 2].map(|v| IndexSet::from_members(4, [v]).unwrap());
        let hue = |colour: Rgb| PALETTE.iter().position(|hue| hue.tones().contains(&colour)).unwrap();
        let null = NullShape::new(mesh).with_symmetry(vec![1, 0, 2, 3]).unwrap();
        let found = colours(&null, &regions).unwrap();
        let twins = PALETTE[hue(found[0])];
        assert_eq!(found[..2], [twins.dark, twins.light]);
        assert_ne!(hue(found[2]), hue(found[0]));
        // Without a symmetry nobody knows of the twins.
        let null = NullShape::new(null.mesh().clone());
        let found = colours(&null, &regions).unwrap();
        assert_ne!(hue(found[0]), hue(found[1]));
    }
}
