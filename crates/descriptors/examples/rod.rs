//! Describes the two ends and the middle of a rod by its closed-form eigenfunctions, and matches them to
//! those of a rod twice as long. `cargo run -p mser3d-descriptors --example rod`
use std::error::Error;
use std::f64::consts::PI;

use mser3d_descriptors::shape::{Domain, Eigenbasis};
use mser3d_descriptors::{
    MatchParameters, SiHksParameters, TimeScale, auto_diffusivity, match_descriptors, region_descriptors,
    si_hks,
};

const CELLS: usize = 60;
const MODES: usize = 30;

/// A rod of the given length and of cross-section 1: cosines, and eigenvalues (pi i / length)^2.
fn rod(length: f64) -> Result<Eigenbasis, Box<dyn Error>> {
    let cell = length / CELLS as f64;
    let function = |v: usize, i: usize| {
        let amplitude = if i == 0 { 1.0 } else { 2.0 };
        (f64::sqrt(amplitude / length)) * (PI * i as f64 * (v as f64 + 0.5) / CELLS as f64).cos()
    };
    let functions: Vec<f64> = (0..CELLS).flat_map(|v| (0..MODES).map(move |i| function(v, i))).collect();
    let eigenvalues = (0..MODES).map(|i| (PI * i as f64 / length).powi(2)).collect();
    Ok(Eigenbasis::new(Domain::Volume, vec![cell; CELLS], eigenvalues, functions)?)
}

/// Prints where heat stays, and which part of one rod is most like which of the other.
pub fn main() -> Result<(), Box<dyn Error>> {
    let (short, long) = (rod(10.0)?, rod(20.0)?);
    let heat = auto_diffusivity(&short, TimeScale::Relative(0.5).on(&short)?)?;
    println!("heat that stays at an end: {:.4}, in the middle: {:.4}", heat[0], heat[CELLS / 2]);

    let parts: [(&str, Vec<u32>); 3] =
        [("one end", (0..10).collect()), ("middle", (25..35).collect()), ("other end", (50..60).collect())];
    let regions = parts.each_ref().map(|part| &part.1);
    let parameters = SiHksParameters::default();
    let describe = |basis: &Eigenbasis| {
        region_descriptors(&regions, basis.mass(), |cells| si_hks(basis, &parameters, Some(cells)))
    };
    for found in match_descriptors(&describe(&short)?, &describe(&long)?, &MatchParameters::default())? {
        let (part, partner) = (parts[found.query].0, parts[found.partner.reference].0);
        let note = if found.ambiguous { " (or its mirror image)" } else { "" };
        println!("{part} -> {partner}{note}, at distance {:.4}", found.partner.distance);
    }
    Ok(())
}
