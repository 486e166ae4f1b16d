//! From a mesh in memory to a folder of results, a picture and a page for the browser.
//!
//! `cargo run --example mesh_to_page -p mser3d-results`

use std::error::Error;

use mser3d::shape::TriangleMesh;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_results::{Record, RenderOptions, Results, Up};

/// Two balls on a bar along x, as it could have been read from a file.
pub fn dumbbell() -> Result<TriangleMesh, mser3d::shape::ShapeError> {
    let (rings, sectors) = (60u32, 24u32);
    let radius = |x: f64| {
        let ball = (1.0 - (x.abs() - 2.0).powi(2)).max(0.0).sqrt();
        if x.abs() > 2.0 { ball } else { ball.max(0.35) }
    };
    let mut points = vec![[-3.0, 0.0, 0.0]];
    for r in 1..rings {
        let x = -3.0 * (std::f64::consts::PI * f64::from(r) / f64::from(rings)).cos();
        for s in 0..sectors {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(s) / f64::from(sectors)).sin_cos();
            points.push([x, radius(x) * cos, radius(x) * sin]);
        }
    }
    points.push([3.0, 0.0, 0.0]);
    let last = points.len() as u32 - 1;
    let at = |r: u32, s: u32| 1 + (r - 1) * sectors + s % sectors;
    let mut triangles = Vec::new();
    for s in 0..sectors {
        triangles.push([0, at(1, s + 1), at(1, s)]);
        for r in 1..rings - 1 {
            triangles.push([at(r, s), at(r + 1, s + 1), at(r + 1, s)]);
            triangles.push([at(r, s), at(r, s + 1), at(r + 1, s + 1)]);
        }
        triangles.push([at(rings - 1, s), at(rings - 1, s + 1), last]);
    }
    TriangleMesh::new(points, triangles)
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let mesh = dumbbell()?;
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(3000);
    parameters.spectrum.eigenpairs = 30.into();
    let features = Detector::new(parameters).detect(Input::Volume(&mesh))?;

    let folder = std::env::temp_dir().join(format!("mser3d-mesh-to-page-{}", std::process::id()));
    let results = Results::new(&features, Some(&mesh), "dumbbell")?;
    results.write(&folder)?;
    let options = RenderOptions { height: 300, ..RenderOptions::default() };
    results.sheet(&options)?.write_png(&mut std::fs::File::create(folder.join("regions.png"))?)?;
    std::fs::write(folder.join("view.html"), results.page("A dumbbell", Up::Y)?)?;

    for region in Record::load(&folder)?.regions {
        println!("region {}: {:.1} % of the volume", region.id, 100.0 * region.volume_fraction);
    }
    for entry in std::fs::read_dir(&folder)? {
        println!("wrote {}", entry?.file_name().to_string_lossy());
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
