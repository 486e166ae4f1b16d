//! Figure 1: regions of one body in several poses, on its surface and inside.

use std::error::Error;
use std::path::Path;

use mser3d::Parameters;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::{Correspondence, NullShape, read_symmetry};
use mser3d_viewer::{Colours, Cut, Model, NO_REGION, Panel, RenderOptions, Rgb, View, render};

use super::fixture_shapes::{fixture, fixture_path, sets};
use crate::drawing::{colours, colours_of_same, innermost, write_png};
use crate::solved::Solved;

const POSES: [&str; 5] = ["rest", "walk", "kick", "sit", "wave"];

pub fn draw(voxels: usize, path: &Path) -> Result<(), Box<dyn Error>> {
    let rest = fixture("human_rest.off")?;
    let mirror = read_symmetry(&fixture_path("human_symmetry.txt"), rest.vertices().len())?;
    let null = NullShape::new(rest).with_symmetry(mirror)?;
    let correspondence = Correspondence::identity(null.mesh().vertices().len());
    let mut parameters = Parameters::default();
    let mut pitch = Pitch::Voxels(voxels);
    let mut on_null = None;
    let (mut outside, mut inside) = (Vec::new(), Vec::new());
    for pose in POSES {
        let mesh = fixture(&format!("human_{pose}.off"))?;
        let voxelize = VoxelizeParameters { pitch, ..Default::default() };
        let solved = Solved::volume(&mesh, &voxelize, &SpectrumParameters::default())?;
        // All poses get the voxels and the times of the first.
        if let (None, Some(size)) = (parameters.reference_measure, solved.pitch()) {
            pitch = Pitch::Size(size);
            parameters.reference_measure = Some(solved.measure());
        }
        let regions = solved.regions(&parameters)?;
        let sets = sets(&mesh, &regions)?;
        let (first, first_colours) = match on_null.take() {
            Some(known) => known,
            None => (sets.clone(), colours(&null, &sets)?),
        };
        let colours = colours_of_same(&null, &first, &first_colours, &sets, &correspondence)?;
        on_null = Some((first, first_colours));

        let labels = innermost(mesh.vertices().len(), &sets);
        let surface = Colours::Regions { labels: &labels, colours: &colours };
        outside.push(Model::from_mesh(&mesh, surface)?);
        let grid = solved.shape().grid().ok_or("a solid without voxels")?;
        let mut voxels: Vec<Rgb> = vec![NO_REGION; grid.len()];
        // By descending volume: the innermost is the last.
        for (region, colour) in regions.iter().zip(&colours) {
            region.elements.iter().for_each(|&e| voxels[e as usize] = *colour);
        }
        // Through the trunk, wherever limbs reach: half of the vertices lie before it.
        let mut depths: Vec<f64> = mesh.vertices().iter().map(|v| v[2]).collect();
        depths.sort_by(f64::total_cmp);
        let cut = Cut { normal: [0.0, 0.0, 1.0], offset: depths[depths.len() / 2] };
        let surface = Colours::Regions { labels: &labels, colours: &colours };
        inside.push(Model::from_section(&mesh, surface, grid, &voxels, &cut)?);
    }
    let above = POSES.iter().zip(&outside).map(|(pose, model)| (pose.to_string(), model));
    let below = POSES.iter().zip(&inside).map(|(pose, model)| (format!("{pose}, cut open"), model));
    let panels: Vec<Panel<'_>> = above
        .chain(below)
        .map(|(caption, model)| Panel { model, view: View::THREE_QUARTER, caption })
        .collect();
    let options =
        RenderOptions { height: 340, columns: POSES.len(), caption_size: Some(11), ..Default::default() };
    write_png(&render(&panels, &options)?, path)
}
