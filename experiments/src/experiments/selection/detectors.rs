//! The choices that are compared: each differs from the defaults in one thing.

use mser3d::comptree::{AltitudeScale, StabilityRule};
use mser3d::descriptors::TimeScale;
use mser3d::{Parameters, Weight};

/// Parameters with a name.
pub struct Detector {
    /// What is varied.
    pub group: &'static str,
    /// The choice.
    pub title: String,
    pub parameters: Parameters,
    /// Whether the tree links 26 neighbours instead of 6.
    pub all_neighbours: bool,
}

/// All detectors; the first is the default, then the other stability rules.
pub fn all() -> Vec<Detector> {
    let mut all = Vec::new();
    let mut add = |group, title: &str, change: &dyn Fn(&mut Parameters)| {
        let mut parameters = Parameters::default();
        change(&mut parameters);
        all.push(Detector { group, title: title.into(), parameters, all_neighbours: group == NEIGHBOURS });
    };
    add("mode", "default", &|_| {});
    add("mode", "paper", &|p| p.stability.rule = StabilityRule::Paper);
    add("mode", "baseline", &|p| p.stability.rule = StabilityRule::Baseline);
    for window in [0.1, 0.2, 0.3, 0.4, 0.6] {
        let title = format!("window {window}");
        add("window", &title, &|p| p.stability.window = window);
    }
    for lifetime in [0.0, 0.05, 0.2] {
        let title = format!("least lifetime {lifetime}");
        add("parts", &title, &|p| p.stability.min_lifetime = Some(lifetime));
    }
    add("parts", "blunt borders too", &|p| p.stability.sharp_borders = false);
    add("weight", "commute time", &|p| p.weight = Weight::Commute);
    add("weight", "1/H(u,v) on links", &|p| p.weight = Weight::Edge);
    add("weight", "diffusion distance on links", &|p| p.weight = Weight::Diffusion);
    for (time, title) in [(None, "mean curvature"), (Some(0.002), "mean curvature, smoothed for 0.002")] {
        add("weight", title, &|p| {
            p.weight = Weight::Curvature;
            p.stability.altitude = p.weight.altitude();
            p.smooth_weight = time.map(TimeScale::Relative);
        });
    }
    add("weight", "H(v,v), smoothed for 0.01", &|p| p.smooth_weight = Some(TimeScale::Relative(0.01)));
    for scales in [
        &[0.25][..],
        &[0.5],
        &[1.0],
        &[2.0],
        &[0.25, 2.0],
        &[0.25, 0.7, 2.0],
        &[0.25, 0.5, 1.0],
        &[0.5, 1.0, 2.0],
        &[0.2, 0.45, 1.0, 2.2],
        &[0.35, 0.7, 1.4, 2.8],
        &[0.25, 0.5, 1.0, 2.0, 4.0],
        &[0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0],
    ] {
        let list: Vec<String> = scales.iter().map(f64::to_string).collect();
        add("time scales", &format!("t = {}", list.join(", ")), &|p| {
            p.time_scales = scales.iter().copied().map(TimeScale::Relative).collect();
        });
    }
    add(NEIGHBOURS, "26 neighbours", &|_| {});
    add("altitude", "linear altitude, window 0.2 of the root mean square", &|p| {
        p.stability.altitude = AltitudeScale::Linear;
    });
    for overlap in [0.7, 0.8, 0.95] {
        let title = format!("duplicates from {overlap}");
        add("pooling", &title, &|p| p.pool.duplicate_overlap = overlap);
    }
    for diversity in [0.1, 0.3] {
        let title = format!("diversity {diversity}");
        add("filters", &title, &|p| p.stability.min_diversity = diversity);
    }
    for fraction in [0.005, 0.02] {
        let title = format!("smallest volume {fraction}");
        add("filters", &title, &|p| p.stability.min_volume_fraction = fraction);
    }
    add("filters", "least stability 0.5", &|p| p.stability.min_stability = Some(0.5));
    all
}

const NEIGHBOURS: &str = "neighbours";
