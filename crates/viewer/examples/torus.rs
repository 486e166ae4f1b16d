//! Draws a torus with two regions, as a PNG and as a page to turn in a browser.
//! `cargo run -p mser3d-viewer --example torus`
use std::error::Error;
use std::f64::consts::TAU;
use std::fs;

use mser3d_viewer::shape::TriangleMesh;
use mser3d_viewer::{
    Colours, Model, NamedView, PageData, PageRegion, PageShape, Panel, RegionTraits, RenderOptions, Up, page,
    region_colours, render,
};

/// A torus around the y axis: radii 1 and 0.4.
fn torus() -> Result<TriangleMesh, Box<dyn Error>> {
    let (m, n) = (64u32, 32u32);
    let point = |v: u32| {
        let (around, across) = (TAU * f64::from(v / n) / f64::from(m), TAU * f64::from(v % n) / f64::from(n));
        let radius = 1.0 + 0.4 * across.cos();
        [radius * around.sin(), 0.4 * across.sin(), radius * around.cos()]
    };
    let at = |i: u32, j: u32| i % m * n + j % n;
    let triangles = (0..m * n).map(|v| (v / n, v % n)).flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    Ok(TriangleMesh::new((0..m * n).map(point).collect(), triangles.collect())?)
}

/// Prints where the picture and the page are.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mesh = torus()?;
    let regions: [Vec<u32>; 2] = [(0..640).collect(), (960..1600).collect()];
    let labels: Vec<i32> =
        (0..2048).map(|v| regions.iter().position(|r| r.contains(&v)).map_or(-1, |r| r as i32)).collect();
    let traits = [0, 1].map(|r| RegionTraits { family: Some(r), ..RegionTraits::default() });
    let colours = region_colours(&traits, &labels, &mesh.edge_graph());

    let model = Model::from_mesh(&mesh, Colours::Regions { labels: &labels, colours: &colours })?;
    let panels = [NamedView::Top, NamedView::ThreeQuarter].map(|view| Panel {
        model: &model,
        view: view.into(),
        caption: view.to_string(),
    });
    let sheet = render(&panels, &RenderOptions { height: 200, ..Default::default() })?;
    let folder = std::env::temp_dir();
    let picture = folder.join("mser3d-torus.png");
    sheet.write_png(fs::File::create(&picture)?)?;
    println!("{}: {} x {} pixels", picture.display(), sheet.width(), sheet.height());

    let regions = regions.iter().zip(&colours).map(|(vertices, &colour)| PageRegion {
        colour,
        parent: None,
        altitude: 0.5,
        stability: 10.0,
        reliability: None,
        lifetime: None,
        twin: None,
        side: None,
        volume: 1.0,
        volume_fraction: 0.3,
        vertices,
        voxels: &[],
        node: None,
    });
    let (name, regions) = ("torus".to_owned(), regions.collect());
    let shape = PageShape {
        name,
        front: None,
        mesh: &mesh,
        grid: None,
        vertex_voxel: &[],
        regions,
        parts: None,
        grey: None,
        trees: vec![],
        facts: vec![],
    };
    let (title, matches) = ("A torus".to_owned(), vec![]);
    let html = page(&PageData { title, shapes: vec![shape], matches, part_matches: vec![], up: Up::Y })?;
    fs::write(folder.join("mser3d-torus.html"), &html)?;
    println!("{}: {} kB", folder.join("mser3d-torus.html").display(), html.len() / 1000);
    Ok(())
}
