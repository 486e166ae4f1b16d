//! The detectors and descriptors that are compared.

use mser3d::comptree::Mode;
use mser3d::descriptors::HksParameters;
use mser3d::{Descriptor, Domain, Parameters, Weight};

/// A detector with a descriptor, and its name in files and tables.
pub struct Detector {
    pub name: &'static str,
    pub domain: Domain,
    pub parameters: Parameters,
}

/// All of ours, the default first.
pub fn all() -> Vec<Detector> {
    let volume = |name, change: fn(&mut Parameters)| detector(name, Domain::Volume, change);
    vec![
        volume("volume-heat", |_| {}),
        volume("volume-heat-paper", |p| p.stability.mode = Mode::Paper),
        volume("volume-heat-baseline", |p| p.stability.mode = Mode::Baseline),
        volume("volume-heat-vhks", |p| p.descriptor = Descriptor::Hks(HksParameters::default())),
        volume("volume-commute", |p| p.weight = Weight::CommuteTime),
        volume("volume-edge", |p| p.weight = Weight::HeatEdge),
        detector("surface-edge", Domain::Surface, |p| p.weight = Weight::HeatEdge),
    ]
}

fn detector(name: &'static str, domain: Domain, change: fn(&mut Parameters)) -> Detector {
    let mut parameters = Parameters::default();
    change(&mut parameters);
    Detector { name, domain, parameters }
}
