//! The regions as a short table on stdout.

use std::io::Write;
use std::path::Path;

use mser3d::Features;

use crate::error::CliError;

pub fn print(features: &Features, folder: &Path) -> Result<(), CliError> {
    write(features, folder).map_err(CliError::Stdout)
}

fn write(features: &Features, folder: &Path) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let elements = match features.body.domain() {
        mser3d::Domain::Volume => "voxels",
        mser3d::Domain::Surface => "vertices",
    };
    writeln!(out, " id  parent  measure %  {elements:>8}  stability  time scale  centroid")?;
    for (id, region) in features.regions.iter().enumerate() {
        let parent = region.parent.map_or("-".into(), |p| p.to_string());
        let scale = match features.trees[region.tree].time_scale {
            Some(mser3d::descriptors::TimeScale::Relative(t)) => format!("{t}"),
            Some(mser3d::descriptors::TimeScale::Absolute(t)) => format!("t = {t}"),
            None => "-".into(),
        };
        let [x, y, z] = region.centroid;
        writeln!(
            out,
            "{id:>3}  {parent:>6}  {:>9.2}  {:>8}  {:>9.3}  {scale:>10}  ({x:.4}, {y:.4}, {z:.4})",
            100.0 * region.volume_fraction,
            region.elements.len(),
            region.stability,
        )?;
    }
    if features.regions.is_empty() {
        writeln!(
            out,
            "no stable regions: a shape without parts (a ball) has none; else try --min-volume 0.005, \
             --window 0.05 or other --time-scale"
        )?;
    }
    writeln!(
        out,
        "{} regions in {} {elements}; written to {}",
        features.regions.len(),
        features.body.len(),
        folder.display()
    )
}
