//! Figure 2: a figure that bends, and keeps surface and volume, against one that collapses and keeps
//! its surface alone.

use std::error::Error;
use std::fmt::Write;
use std::fs;
use std::path::Path;

use mser3d::shape::TriangleMesh;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d::{Domain, Parameters, Weight};
use mser3d_evaluation::{Correspondence, DetectedRegions, NullShape, Score, read_symmetry};
use mser3d_viewer::{Panel, RenderOptions, View, render};

use super::collapse::{CollapseParameters, collapse, strain};
use super::fixture_shapes::{fixture, fixture_path};
use crate::drawing::{colours, colours_of_same, model, write_png};
use crate::solved::Solved;

const POSES: [&str; 4] = ["walk", "kick", "sit", "wave"];
const SHARES: [f64; 4] = [0.9, 0.8, 0.7, 0.6];
/// Those drawn, with the rest pose before them.
const DRAWN: [&str; 4] = ["kick", "sit", "80 %", "60 %"];

/// Draws `figure_2.png` and writes `figure_2.md`.
pub fn draw(voxels: usize, output: &Path) -> Result<(), Box<dyn Error>> {
    let rest = fixture("human_rest.off")?;
    let mut stages: Vec<(String, TriangleMesh)> = Vec::new();
    for pose in POSES {
        stages.push((pose.into(), fixture(&format!("human_{pose}.off"))?));
    }
    let names = SHARES.map(|share| format!("{:.0} %", 100.0 * share));
    stages.extend(names.into_iter().zip(collapse(&rest, &SHARES, &CollapseParameters::default())?));

    let mirror = read_symmetry(&fixture_path("human_symmetry.txt"), rest.vertices().len())?;
    let null = NullShape::new(rest.clone()).with_symmetry(mirror)?;
    let correspondence = Correspondence::identity(rest.vertices().len());
    let mut table = String::from(
        "| shape | volume | edges: mean change | 95 % below | volume: regions | found again > .7 | > .8 | matched > .8 \
         | surface: regions | found again > .7 | > .8 | matched > .8 |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let sides = [Side::new(Domain::Volume, &rest, voxels)?, Side::new(Domain::Surface, &rest, voxels)?];
    let mut models = [Vec::new(), Vec::new()];
    for (side, models) in sides.iter().zip(&mut models) {
        models.push(model(&rest, &side.found.regions, &colours(&null, &side.found.regions)?)?);
    }
    for (name, mesh) in &stages {
        let (mean, most) = strain(&rest, mesh);
        let volume = mesh.signed_volume() / rest.signed_volume();
        let _ = write!(table, "| {name} | {volume:.2} | {:.1} % | {:.1} % |", 100.0 * mean, 100.0 * most);
        for (side, models) in sides.iter().zip(&mut models) {
            let found = side.detect(mesh)?;
            let score = Score::new(&null, &side.found, &found, &correspondence)?;
            let (low, high) = (score.repeatability(0.7), score.repeatability(0.8));
            let _ = write!(
                table,
                " {} | {low:.2} | {high:.2} | {:.2} |",
                score.regions(),
                score.matching_score(0.8)
            );
            if DRAWN.contains(&name.as_str()) {
                let first = colours(&null, &side.found.regions)?;
                let own =
                    colours_of_same(&null, &side.found.regions, &first, &found.regions, &correspondence)?;
                models.push(model(mesh, &found.regions, &own)?);
            }
        }
        table.push('\n');
    }
    fs::write(output.join("figure_2.md"), &table)?;
    print!("{table}");
    let captions = || std::iter::once("rest").chain(DRAWN);
    let panels: Vec<Panel<'_>> = models
        .iter()
        .zip(["volume", "surface"])
        .flat_map(|(models, side)| {
            models.iter().zip(captions()).map(move |(model, name)| (side, model, name))
        })
        .map(|(side, model, name)| {
            let caption = if name.ends_with('%') {
                format!("{side}, collapsed to {name}")
            } else {
                format!("{side}, {name}")
            };
            Panel { model, view: View::THREE_QUARTER, caption }
        })
        .collect();
    let options =
        RenderOptions { height: 340, columns: 1 + DRAWN.len(), caption_size: Some(11), ..Default::default() };
    write_png(&render(&panels, &options)?, &output.join("figure_2.png"))
}

/// The default detector in the volume, 1/h_t(u,v) on the surface.
struct Side {
    domain: Domain,
    parameters: Parameters,
    pitch: Pitch,
    /// What it finds at rest.
    found: DetectedRegions,
}

impl Side {
    fn new(domain: Domain, rest: &TriangleMesh, voxels: usize) -> Result<Self, Box<dyn Error>> {
        let weight = if domain == Domain::Volume { Weight::Heat } else { Weight::Edge };
        let parameters = Parameters { weight, ..Default::default() };
        let mut side =
            Self { domain, parameters, pitch: Pitch::Voxels(voxels), found: DetectedRegions::default() };
        let solved = side.solve(rest)?;
        side.pitch = solved.pitch().map_or(side.pitch, Pitch::Size);
        side.parameters.reference_measure = Some(solved.measure());
        side.found = solved.detect(&side.parameters)?;
        Ok(side)
    }

    fn solve(&self, mesh: &TriangleMesh) -> Result<Solved, Box<dyn Error>> {
        let spectrum = SpectrumParameters::default();
        match self.domain {
            Domain::Volume => Solved::volume(
                mesh,
                &VoxelizeParameters { pitch: self.pitch, ..Default::default() },
                &spectrum,
            ),
            Domain::Surface => Solved::surface(mesh, &spectrum),
        }
    }

    fn detect(&self, mesh: &TriangleMesh) -> Result<DetectedRegions, Box<dyn Error>> {
        self.solve(mesh)?.detect(&self.parameters)
    }
}
