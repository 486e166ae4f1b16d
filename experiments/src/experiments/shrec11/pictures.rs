//! Pictures of the shapes, in the colours of the regions that a detector found.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d::shape::TriangleMesh;
use mser3d_evaluation::shrec::{Benchmark, ShapeName};
use mser3d_evaluation::{Correspondence, DetectedRegions, EvaluationError, IndexSet, NullShape};
use mser3d_viewer::{Model, Panel, RenderOptions, Rgb, View, render};
use rayon::prelude::*;

use super::all_shapes::names;
use super::arguments::Arguments;
use super::one_shape::is_scaled;
use crate::drawing::{colours, colours_of_same, model, plain, write_png};

/// A picture of all strengths of a class, and one of the strongest of all classes. The files' names are
/// returned, with the classes that they show. Regions have the colour of the null shape's region that
/// they overlap most, grey if that is half or less.
pub fn draw(
    arguments: &Arguments,
    benchmark: &Benchmark,
    detector: &str,
) -> Result<Vec<(String, String)>, Box<dyn Error>> {
    let folder = arguments.output.join("pictures");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut made = Vec::new();
    for number in benchmark.null_numbers() {
        let Ok(null) = benchmark.null_shape(number) else { continue };
        let artist =
            Artist::new(benchmark, null, number, arguments.output.join("detections").join(detector))?;
        let names: Vec<&ShapeName> = names(arguments, benchmark, number).collect();
        let mut classes: Vec<&str> = names.iter().map(|n| n.class.as_str()).collect();
        classes.dedup();
        let mut sheets: Vec<(String, String, Vec<&ShapeName>)> = Vec::new();
        for class in &classes {
            let of_class = names.iter().copied().filter(|n| n.class == *class).collect();
            sheets.push((format!("{number:04}.{class}.png"), class.to_string(), of_class));
        }
        let strongest = |class: &&str| {
            let of_class = names.iter().copied().filter(|n| n.class == *class);
            of_class.max_by_key(|n| n.strength)
        };
        // All are drawn at one scale: beside one of double size the others would be too small.
        let strongest = classes.iter().filter(|c| !is_scaled(c)).filter_map(strongest).collect();
        sheets.push((format!("{number:04}.strongest.png"), "the strongest of each class".into(), strongest));
        let drawn = sheets.par_iter().map(|(file, title, names)| {
            let columns = if names.len() > 6 { 5 } else { 0 };
            artist.sheet(names, columns, &folder.join(file)).map_err(|e| format!("{file}: {e}"))?;
            Ok((format!("pictures/{file}"), title.clone()))
        });
        made.extend(drawn.collect::<Result<Vec<_>, String>>()?);
    }
    Ok(made)
}

struct Artist<'a> {
    benchmark: &'a Benchmark,
    null: NullShape,
    number: u32,
    detections: PathBuf,
    regions: Vec<IndexSet>,
    colours: Vec<Rgb>,
}

impl<'a> Artist<'a> {
    fn new(
        benchmark: &'a Benchmark,
        null: NullShape,
        number: u32,
        detections: PathBuf,
    ) -> Result<Self, EvaluationError> {
        let vertices = null.mesh().vertices().len();
        let found = DetectedRegions::read(&detections, ShapeName::null(number), vertices);
        let regions = found.map(|d| d.regions).unwrap_or_default();
        let colours = colours(&null, &regions)?;
        Ok(Self { benchmark, null, number, detections, regions, colours })
    }

    fn sheet(&self, names: &[&ShapeName], columns: usize, path: &Path) -> Result<(), Box<dyn Error>> {
        let mut models = vec![(ShapeName::null(self.number).to_string(), self.null_model()?)];
        for name in names {
            // One that cannot be read was named when it was to be detected on.
            if let Ok(model) = self.transformed(name) {
                models.push((format!("{} {}", name.class, name.strength), model));
            }
        }
        let panels: Vec<Panel<'_>> = models
            .iter()
            .map(|(caption, model)| Panel { model, view: View::THREE_QUARTER, caption: caption.clone() })
            .collect();
        let options = RenderOptions { height: 300, columns, caption_size: Some(11), ..Default::default() };
        write_png(&render(&panels, &options)?, path)
    }

    fn null_model(&self) -> Result<Model, Box<dyn Error>> {
        model(self.null.mesh(), &self.regions, &self.colours)
    }

    fn transformed(&self, name: &ShapeName) -> Result<Model, Box<dyn Error>> {
        let shape = self.benchmark.transformed(name, &self.null)?;
        let mesh: &TriangleMesh = &shape.mesh;
        let Ok(found) = DetectedRegions::read(&self.detections, name, mesh.vertices().len()) else {
            return plain(mesh);
        };
        let correspondence = Correspondence::new(self.null.mesh(), mesh, &shape.points)?;
        let colours =
            colours_of_same(&self.null, &self.regions, &self.colours, &found.regions, &correspondence)?;
        model(mesh, &found.regions, &colours)
    }
}
