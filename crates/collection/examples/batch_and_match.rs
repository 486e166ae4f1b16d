//! A batch over a folder of meshes, and which regions of two of them are the same.
//!
//! `cargo run --example batch_and_match -p mser3d-collection -- FOLDER`

use std::error::Error;
use std::path::Path;

use mser3d::voxelize::Pitch;
use mser3d::{Detector, Domain, Parameters};
use mser3d_collection::{BatchParameters, DescribedResult, PlanParameters, match_results, plan, run_batch};

/// Finds the regions of all shapes in a folder and matches those of the first two by name.
pub fn batch_and_match(shapes: &Path, collection: &Path) -> Result<usize, Box<dyn Error>> {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(8000);
    parameters.spectrum.eigenpairs = 60.into();
    let plan = plan(&[shapes.to_owned()], &PlanParameters::default())?;
    let names: Vec<String> = plan.jobs.iter().map(|job| job.name.clone()).collect();
    let [first, second, ..] = &names[..] else { return Err("two shapes are needed".into()) };
    let heard = |event: mser3d_collection::Event| {
        println!("{} of {}: {} {:?}", event.through, event.total, event.job.name, event.outcome);
    };
    run_batch(
        collection,
        &plan,
        Domain::Volume,
        &Detector::new(parameters),
        &BatchParameters::default(),
        &heard,
    )?;

    let load = |name: &String| DescribedResult::load(&collection.join(name));
    let matching = match_results(&load(first)?, &load(second)?, &Default::default())?;
    for found in &matching.matches {
        let note = if found.symmetric_partner.is_some() { ", or its mirror image" } else { "" };
        println!("region {} of {second} is region {} of {first}{note}", found.region, found.partner);
    }
    Ok(matching.matches.len())
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args().nth(1).ok_or("give a folder of meshes")?;
    batch_and_match(folder.as_ref(), &Path::new(&folder).join("results"))?;
    Ok(())
}
