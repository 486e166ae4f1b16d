//! The stable regions of a solid made of voxels, and which of them match those of a bent copy.
//!
//! `cargo run --example parts_of_a_solid -p mser3d`

use std::error::Error;

use mser3d::descriptors::{MatchParameters, match_descriptors};
use mser3d::shape::{BitGrid, Frame, VoxelGrid};
use mser3d::{Detector, Features, Input, Parameters};

/// A block with two arms of different thickness; the thin one may be bent.
fn figure(bent: bool) -> Result<VoxelGrid, Box<dyn Error>> {
    let dims = [44, 40, 12];
    let mut inside = BitGrid::empty(dims)?;
    for [x, y, z] in BitGrid::full(dims)?.ones() {
        let block = (16..28).contains(&x) && y < 12;
        let thick = x >= 28 && (3..9).contains(&y) && (3..9).contains(&z);
        let thin = (4..7).contains(&z)
            && if bent {
                (16..19).contains(&x) && (12..28).contains(&y)
            } else {
                x < 16 && (4..7).contains(&y)
            };
        inside.set([x, y, z], block || thick || thin);
    }
    Ok(VoxelGrid::solid(Frame::new(dims, [0.0; 3], [0.5; 3])?, inside)?)
}

fn detect(solid: &VoxelGrid) -> Result<Features, mser3d::Error> {
    let mut parameters = Parameters::default();
    parameters.spectrum.eigenpairs = 40.into();
    Detector::new(parameters).detect(Input::Solid(solid))
}

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (straight, bent) = (detect(&figure(false)?)?, detect(&figure(true)?)?);
    for (number, region) in straight.regions.iter().enumerate() {
        println!("region {number}: {:.1} % around {:.1?}", 100.0 * region.volume_fraction, region.centroid);
    }
    let matches = match_descriptors(&bent.descriptors, &straight.descriptors, &MatchParameters::default())?;
    for found in matches {
        println!("region {} of the bent figure is region {}", found.query, found.partner.reference);
    }
    Ok(())
}
