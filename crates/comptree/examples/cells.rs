//! Finds the dark cells of a noisy image: the component tree, specks removed from it, and its maximally
//! stable regions. `cargo run -p mser3d-comptree --example cells`
use std::error::Error;

use mser3d_comptree::shape::{Connectivity, SplitMix64};
use mser3d_comptree::{
    AltitudeScale, ComponentTree, Ellipsoid, Moments, Polarity, StabilityParameters, stable_regions,
};

const SIZE: usize = 96;

/// Three dark cells on a bright ground, with noise.
fn image() -> Vec<u8> {
    let cells = [([25.0, 30.0], 14.0), ([62.0, 40.0], 18.0), ([40.0, 72.0], 12.0)];
    let mut random = SplitMix64::new(1);
    let pixel = |i: usize| {
        let at = [(i % SIZE) as f64, (i / SIZE) as f64];
        let depth = |(centre, radius): ([f64; 2], f64)| {
            let distance = f64::hypot(at[0] - centre[0], at[1] - centre[1]);
            1.0 / (1.0 + (distance - radius).exp())
        };
        (200.0 - 120.0 * cells.map(depth).iter().sum::<f64>() + 12.0 * random.uniform()) as u8
    };
    (0..SIZE * SIZE).map(pixel).collect()
}

/// Prints each cell that is found.
pub fn main() -> Result<(), Box<dyn Error>> {
    let tree =
        ComponentTree::from_grid([SIZE, SIZE, 1], Connectivity::Six, &image(), 1.0, Polarity::Sublevel)?;
    // An area opening: specks of less than 20 pixels become part of what is around them.
    let opened = tree.filter(|node| tree.volume(node) >= 20.0, 1.0)?;
    println!("{} components, {} of 20 pixels or more", tree.len(), opened.len());

    let parameters = StabilityParameters {
        altitude: AltitudeScale::Linear,
        window: 40.0,
        min_volume_fraction: 0.03,
        max_volume_fraction: 0.25,
        ..Default::default()
    };
    let selection = stable_regions(&opened, &parameters)?;
    for region in &selection.regions {
        let position = |v: u32| [(v as usize % SIZE) as f64, (v as usize / SIZE) as f64, 0.0];
        let moments = Moments::of(opened.vertices(region.node), position, 1.0);
        let [x, y, _] = moments.centroid;
        let [a, b, _] = Ellipsoid::fit(&moments, 2).semi_axes;
        println!("{} pixels around ({x:.1}, {y:.1}), semi-axes {a:.1} and {b:.1}", region.volume);
    }
    println!("{:?}", selection.report);
    Ok(())
}
