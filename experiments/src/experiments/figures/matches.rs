//! Figure 3: regions of a human, and the closest region of every other shape.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::descriptors::{Descriptors, MatchParameters, match_descriptors};
use mser3d::shape::TriangleMesh;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_viewer::{Model, PALETTE, Panel, RenderOptions, View, render};

use super::fixture_shapes::fixture_path;
use crate::drawing::{highlighted, write_png};
use crate::solved::mesh;

/// The first is the one whose regions are looked for.
const FIXTURES: [&str; 5] = ["human_rest", "human_kick", "human_sit", "quadruped_rest", "quadruped_gallop"];
const QUERIES: usize = 5;

struct Shape {
    name: String,
    mesh: TriangleMesh,
    /// The vertices of each region.
    regions: Vec<Vec<u32>>,
    descriptors: Descriptors,
}

impl Shape {
    fn new(path: &Path, voxels: usize) -> Result<Self, Box<dyn Error>> {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let mesh = unit(&mesh(path)?)?;
        let mut parameters = Parameters::default();
        parameters.voxelize.pitch = Pitch::Voxels(voxels);
        let features = Detector::new(parameters)
            .detect(Input::Volume(&mesh))
            .map_err(|e| format!("{}: {e}", path.display()))?;
        let regions = features.regions.iter().map(|r| r.vertices.clone()).collect();
        Ok(Self { name, mesh, regions, descriptors: features.descriptors })
    }
}

/// Scaled to a bounding box of diagonal 1, to be drawn beside others.
fn unit(mesh: &TriangleMesh) -> Result<TriangleMesh, Box<dyn Error>> {
    let diagonal = mesh.bounding_box().map_or(0.0, |b| b.diagonal());
    Ok(mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(|x| x / diagonal)).collect())?)
}

pub fn draw(voxels: usize, more: &[PathBuf], path: &Path) -> Result<(), Box<dyn Error>> {
    let paths = FIXTURES.iter().map(|name| fixture_path(&format!("{name}.off")));
    let shapes: Vec<Shape> =
        paths.chain(more.iter().cloned()).map(|p| Shape::new(&p, voxels)).collect::<Result<_, _>>()?;
    let queries = different(&shapes[0].descriptors, QUERIES);
    let mut models: Vec<(String, Model)> = Vec::new();
    for (row, &query) in queries.iter().enumerate() {
        let colour = PALETTE[row % PALETTE.len()].middle;
        let wanted =
            Descriptors::new(shapes[0].descriptors.width(), shapes[0].descriptors.row(query).to_vec())?;
        let first = &shapes[0];
        models.push((first.name.clone(), highlighted(&first.mesh, &first.regions[query], colour)?));
        for shape in &shapes[1..] {
            let found = match_descriptors(&wanted, &shape.descriptors, &MatchParameters::default())?;
            let (region, caption) = match found.first() {
                Some(found) => (
                    &shape.regions[found.partner.reference][..],
                    format!("{} {:.1}", shape.name, found.partner.distance),
                ),
                None => (&[][..], format!("{}: no regions", shape.name)),
            };
            models.push((caption, highlighted(&shape.mesh, region, colour)?));
        }
    }
    let panels: Vec<Panel<'_>> = models
        .iter()
        .map(|(caption, model)| Panel { model, view: View::THREE_QUARTER, caption: caption.clone() })
        .collect();
    let options =
        RenderOptions { height: 160, columns: shapes.len(), caption_size: Some(9), ..Default::default() };
    write_png(&render(&panels, &options)?, path)
}

/// Regions as different from each other as can be: the first, then always the one that is farthest from
/// those before.
fn different(descriptors: &Descriptors, count: usize) -> Vec<usize> {
    let distance = |a: usize, b: usize| -> f64 {
        descriptors.row(a).iter().zip(descriptors.row(b)).map(|(x, y)| (x - y) * (x - y)).sum()
    };
    let mut chosen: Vec<usize> = (0..descriptors.len().min(1)).collect();
    while chosen.len() < count.min(descriptors.len()) {
        let gap = |r: usize| chosen.iter().map(|&c| distance(r, c)).fold(f64::INFINITY, f64::min);
        let left = (0..descriptors.len()).filter(|r| !chosen.contains(r));
        let Some(next) = left.max_by(|&a, &b| gap(a).total_cmp(&gap(b)).then(b.cmp(&a))) else { break };
        chosen.push(next);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_are_far_from_each_other() {
        let rows = Descriptors::new(1, vec![0.0, 1.0, 9.0, 10.0, 5.0]).unwrap();
        assert_eq!(different(&rows, 3), [0, 3, 4]);
        assert_eq!(different(&rows, 9).len(), 5);
    }
}
