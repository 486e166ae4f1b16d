//! The best regions of our detectors.

use std::error::Error;

use mser3d::Parameters;
use mser3d::comptree::StabilityRule;

use super::cases::Shape;
use super::{COUNTS, Parts};
use crate::repeats::{Score, best};

/// The best regions of a shape by a stability rule; all, where there are fewer than are asked for.
pub fn parts(shape: &Shape, rule: StabilityRule) -> Result<Parts, Box<dyn Error>> {
    let mut parameters = Parameters { reference_measure: shape.reference, ..Default::default() };
    parameters.stability.rule = rule;
    let regions = shape.solved.regions(&parameters)?;
    let sets = shape.solved.vertex_sets(&regions)?;
    Ok(COUNTS.map(|count| {
        best(&regions, Score::of(rule), count).into_iter().map(|region| sets[region].clone()).collect()
    }))
}
