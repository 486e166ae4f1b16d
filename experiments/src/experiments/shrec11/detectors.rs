//! The detectors and descriptors that are compared.

use mser3d::comptree::StabilityRule;
use mser3d::descriptors::TimeScale;
use mser3d::{Domain, Parameters, Weight};

/// A detector, and the descriptors that its regions are matched by.
pub struct Detector {
    pub name: &'static str,
    pub medium: Medium,
    pub parameters: Parameters,
    pub descriptors: &'static [Description],
}

/// What heat flows on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Medium {
    /// Voxels; links that the surface crosses are cut.
    Volume,
    /// Voxels; all neighbours are linked, as in the paper.
    UncutVolume,
    /// The mesh.
    Surface,
}

impl Medium {
    pub fn domain(self) -> Domain {
        if self == Self::Surface { Domain::Surface } else { Domain::Volume }
    }
}

/// A way to describe regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Description {
    /// SI-vHKS in a volume, SI-HKS on a surface, the region's size and its side: the default.
    SidedSiHks,
    /// The same without the side.
    SizedSiHks,
    /// SI-vHKS alone, the paper's.
    SiHks,
    /// vHKS.
    Hks,
    /// Bags of SI-vHKS; the words are those of the null shape.
    Vocabulary,
    /// Shares of balls that lie in the solid.
    IntegralInvariants,
    /// SI-HKS of the mesh, over the vertices of a volumetric region.
    SurfaceSiHks,
}

impl Description {
    /// What the name of a detector is followed by: nothing for its usual descriptor.
    fn suffix(self) -> &'static str {
        match self {
            Self::SidedSiHks => "",
            Self::SizedSiHks => "+sized-si-hks",
            Self::SiHks => "+si-hks",
            Self::Hks => "+vhks",
            Self::Vocabulary => "+vocabulary",
            Self::IntegralInvariants => "+invariants",
            Self::SurfaceSiHks => "+surface-si-hks",
        }
    }
}

impl Detector {
    /// The names that it has in folders and tables, one for each descriptor.
    pub fn entries(&self) -> impl Iterator<Item = (String, Description)> + '_ {
        self.descriptors.iter().map(|d| (format!("{}{}", self.name, d.suffix()), *d))
    }
}

/// Those of ours whose names are given, all if none is; the default first.
pub fn chosen(names: &[String]) -> Result<Vec<Detector>, String> {
    let mut detectors = all();
    let known: Vec<&str> = detectors.iter().map(|d| d.name).collect();
    if let Some(unknown) = names.iter().find(|n| !known.contains(&n.as_str())) {
        return Err(format!("no detector is called {unknown}; there are {}", known.join(", ")));
    }
    detectors.retain(|d| names.is_empty() || names.iter().any(|n| n == d.name));
    Ok(detectors)
}

fn all() -> Vec<Detector> {
    use Description::{Hks, IntegralInvariants, SiHks, SidedSiHks, SizedSiHks, SurfaceSiHks, Vocabulary};
    use Medium::{Surface, UncutVolume, Volume};
    let detector = |name, medium, change: fn(&mut Parameters)| {
        let mut parameters = Parameters::default();
        change(&mut parameters);
        Detector { name, medium, parameters, descriptors: &[SidedSiHks] }
    };
    let mut default = detector("volume-heat", Volume, |_| {});
    default.descriptors = &[SidedSiHks, SizedSiHks, SiHks, Hks, Vocabulary, IntegralInvariants, SurfaceSiHks];
    let mut paper = detector("volume-heat-paper", Volume, |p| p.stability.rule = StabilityRule::Paper);
    paper.descriptors = &[SidedSiHks, SiHks];
    vec![
        default,
        paper,
        detector("volume-heat-baseline", Volume, |p| p.stability.rule = StabilityRule::Baseline),
        detector("volume-heat-uncut", UncutVolume, |_| {}),
        detector("volume-commute", Volume, |p| p.weight = Weight::Commute),
        detector("volume-edge", Volume, |p| p.weight = Weight::Edge),
        detector("volume-diffusion", Volume, |p| p.weight = Weight::Diffusion),
        detector("volume-curvature", Volume, |p| curvature(p, 0.002)),
        detector("surface-edge", Surface, |p| p.weight = Weight::Edge),
        detector("surface-diffusion", Surface, |p| p.weight = Weight::Diffusion),
        detector("surface-curvature", Surface, |p| curvature(p, 0.0003)),
    ]
}

/// Mean curvature, smoothed for a relative time: on noisy shapes it is noise.
fn curvature(parameters: &mut Parameters, time: f64) {
    parameters.weight = Weight::Curvature;
    parameters.stability.altitude = parameters.weight.altitude();
    parameters.smooth_weight = Some(TimeScale::Relative(time));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn detectors_are_chosen_by_name() {
        let names: Vec<String> = ["surface-edge", "volume-heat"].map(String::from).into();
        let chosen_names: Vec<&str> = chosen(&names).unwrap().iter().map(|d| d.name).collect();
        assert_eq!(chosen_names, ["volume-heat", "surface-edge"]);
        assert!(chosen(&["volume-hat".into()]).err().unwrap().contains("volume-commute"));
        let entries: Vec<String> = chosen(&[])
            .unwrap()
            .iter()
            .flat_map(|d| d.entries().map(|(n, _)| n).collect::<Vec<_>>())
            .collect();
        assert_eq!(entries.len(), entries.iter().collect::<std::collections::BTreeSet<_>>().len());
    }
}
