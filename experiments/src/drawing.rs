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

/// A colour for each region.
pub fn colours(mesh: &TriangleMesh, regions: &[IndexSet]) -> Vec<Rgb> {
    let around = |r: usize| {
        let larger = (0..regions.len()).filter(|&q| (regions[q].len(), r) > (regions[r].len(), q));
        let contains = |q: &usize| regions[r].members().all(|v| regions[*q].contains(v));
        larger.filter(contains).min_by_key(|&q| regions[q].len()).map(|q| q as u32)
    };
    let traits: Vec<RegionTraits> = (0..regions.len())
        .map(|r| RegionTraits { parent: around(r), family: Some(r as u32), side: None })
        .collect();
    region_colours(&traits, &innermost(mesh.vertices().len(), regions), &mesh.edge_graph())
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
