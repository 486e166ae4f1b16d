//! What must hold of what is read, whoever wrote it: nobody who uses it walks in circles, reaches beyond a list, or takes memory that
//! no file stands for.

use std::path::Path;

use mser3d::available_memory;

use crate::msv::MsvRecord;
use crate::{Record, ResultsError, TracksRecord, TreeArrays};

/// What is wrong, in words that follow a file's name; nothing, mostly.
pub(crate) type Checked = Result<(), String>;

fn unless(good: bool, what: impl FnOnce() -> String) -> Checked {
    if good { Ok(()) } else { Err(what()) }
}

impl Record {
    /// Whether its lists fit each other, and its numbers are of their kind.
    pub(crate) fn check(&self) -> Checked {
        let (trees, bodies) = (self.trees.len(), self.bodies.len());
        unless(bodies > 0, || "it names no body that was searched".into())?;
        self.parameters.validate().map_err(|e| format!("its parameters are none: {e}"))?;
        for (number, tree) in self.trees.iter().enumerate() {
            unless((tree.body as usize) < bodies, || {
                format!("tree {number} is of a body that is not there")
            })?;
        }
        for (number, body) in self.bodies.iter().enumerate() {
            let good = body.measure > 0.0 && body.spectrum.eigenpairs > 0;
            unless(good, || format!("body {number} has no measure or no eigenpairs"))?;
        }
        let is_twin = |twin: u32, of: u32| {
            twin != of && self.regions.get(twin as usize).is_some_and(|region| region.twin == Some(of))
        };
        for (place, region) in self.regions.iter().enumerate() {
            let id = region.id;
            let known = id as usize == place
                && region.parent.is_none_or(|parent| parent < id)
                && (region.tree as usize) < trees
                && (region.body as usize) < bodies
                && region.twin.is_none_or(|twin| is_twin(twin, id));
            unless(known, || {
                format!("region {id} names a parent, tree, body or twin that is none of its own")
            })?;
            let share = |x: Option<f64>| x.is_none_or(|x| (0.0..=1.0).contains(&x));
            let good = region.volume >= 0.0
                && region.volume_fraction >= 0.0
                && share(region.reliability)
                && region.side.is_none_or(|side| (-1.0..=1.0).contains(&side));
            unless(good, || {
                format!("region {id} has a volume, reliability or side that is out of its range")
            })?;
        }
        let parts = self.parts.as_deref().unwrap_or_default();
        for (place, part) in parts.iter().enumerate() {
            let known = part.id as usize == place
                && (part.body as usize) < bodies
                && part.region.is_none_or(|region| (region as usize) < self.regions.len())
                && part.twins.iter().all(|&twin| (twin as usize) < parts.len());
            unless(known, || format!("part {} names a region, body or part that is not there", part.id))?;
        }
        Ok(())
    }
}

impl MsvRecord {
    /// As [`Record::check`].
    pub(crate) fn check(&self) -> Checked {
        self.parameters.validate().map_err(|e| format!("its parameters are none: {e}"))?;
        for search in &self.searches {
            for (place, region) in search.regions.iter().enumerate() {
                let known =
                    region.region as usize == place && region.parent.is_none_or(|p| p < region.region);
                unless(known, || {
                    format!(
                        "{} region {} names a parent that is none of its own",
                        search.contrast, region.region
                    )
                })?;
                let good = region.volume >= 0.0 && region.variation >= 0.0;
                unless(good, || {
                    format!("{} region {} has a negative volume or variation", search.contrast, region.region)
                })?;
            }
        }
        Ok(())
    }
}

impl TracksRecord {
    /// As [`Record::check`].
    pub(crate) fn check(&self) -> Checked {
        self.parameters.validate().map_err(|e| format!("its parameters are none: {e}"))?;
        let (frames, tracks) = (&self.frames, self.tracks.len());
        for frame in frames {
            // A folder in this one, not anywhere.
            let plain = Path::new(&frame.name).file_name().is_some_and(|own| *own == *frame.name);
            unless(plain, || format!("frame {:?} is no name of a folder", frame.name))?;
        }
        for (place, track) in self.tracks.iter().enumerate() {
            let seen = &track.sightings;
            let first = seen.first().map(|sighting| sighting.frame);
            let last = seen.last().map(|sighting| sighting.frame);
            let known = track.id as usize == place
                && (track.colour_of as usize) < tracks
                && track.found == seen.len()
                && (first, last) == (Some(track.first_frame), Some(track.last_frame))
                && seen.is_sorted_by(|a, b| a.frame < b.frame);
            unless(known, || format!("track {} does not fit its sightings or the other tracks", track.id))?;
            for sighting in seen {
                let regions = frames.get(sighting.frame).and_then(|frame| frame.regions).unwrap_or(0);
                unless((sighting.region as usize) < regions, || {
                    format!("track {} is seen where frame {} has no region", track.id, sighting.frame)
                })?;
            }
        }
        Ok(())
    }
}

impl TreeArrays {
    /// Whether it is a tree: whoever goes up comes to a root.
    pub(crate) fn check(&self) -> Checked {
        let nodes = self.parents.len();
        for (node, &parent) in self.parents.iter().enumerate() {
            let up = parent == u32::MAX || (parent as usize > node && (parent as usize) < nodes);
            unless(up, || format!("node {node} has the parent {parent}, which does not come after it"))?;
        }
        // A vertex without edges is a root of infinite altitude.
        unless(!self.altitudes.iter().any(|a| a.is_nan()), || "an altitude is not a number".into())?;
        let good = self.volumes.iter().all(|v| v.is_finite() && *v >= 0.0);
        unless(good, || "a volume is negative or not finite".into())
    }
}

/// Refuses work that needs more memory than there is.
pub(crate) fn afford(path: &Path, what: impl Into<String>, bytes: u128) -> Result<(), ResultsError> {
    // Where the system does not tell: as much as a small machine has.
    let available = available_memory().unwrap_or(4 << 30);
    match u64::try_from(bytes) {
        Ok(bytes) if bytes <= available => Ok(()),
        other => {
            let bytes = other.unwrap_or(u64::MAX);
            Err(ResultsError::TooLarge { path: path.to_owned(), what: what.into(), bytes, available })
        }
    }
}
