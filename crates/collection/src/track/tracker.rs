use std::collections::VecDeque;

use mser3d::descriptors::assign;
use mser3d_results::{Identity, Results, Sighting, Track, TrackParameters, TrackedFrame, TracksRecord};

use super::kinship::Kinship;
use super::likeness::{Likeness, Seen, Surfaces};
use super::pieces::Pieces;
use super::reliability::pooled;
use super::touching::Touching;
use crate::CollectionError;

/// Follows regions through a sequence, frame by frame.
///
/// The regions of a frame are compared with the last sightings of all tracks that were found in the frame before, or are
/// missing for no more than [`TrackParameters::max_gap`] frames. The assignment is one to one, with the largest sum of what
/// each pair has above the minimum. A region without a partner begins a track.
///
/// * Between frames with the same triangles it goes by overlap: points spread over the first one's surface each take the
///   voxel that they see, as a vertex does, and the overlap of two regions is the number of points in both over that in either.
/// * Between others it goes by likeness: half of the overlap in space, and half of `exp(-d / 8)`, where d is the distance of
///   the descriptors. In space, bodies are laid with their centres of mass on each other, and both regions counted in cells
///   of 1/40 of the diagonal of the first frame's body.
pub(super) struct Tracker {
    parameters: TrackParameters,
    surfaces: Surfaces,
    frames: Vec<TrackedFrame>,
    tracks: Vec<Track>,
    /// The frames in which regions may have been seen last, and their numbers.
    recent: VecDeque<(usize, Seen)>,
    touching: Touching,
    kinship: Kinship,
    pieces: Pieces,
}

/// The partner of a region on an earlier frame.
type Partner = (usize, Likeness);

impl Tracker {
    pub fn new(parameters: TrackParameters) -> Result<Self, CollectionError> {
        parameters.validate()?;
        Ok(Self {
            parameters,
            surfaces: Surfaces::new(parameters.points),
            frames: Vec::new(),
            tracks: Vec::new(),
            recent: VecDeque::new(),
            touching: Touching::default(),
            kinship: Kinship::default(),
            pieces: Pieces::default(),
        })
    }

    /// A frame that has no result.
    pub fn push_missing(&mut self, name: &str, path: &str, time: Option<f64>) {
        let (name, path) = (name.to_owned(), path.to_owned());
        self.frames.push(TrackedFrame { name, path, time, regions: None, identity: None });
    }

    /// The next frame.
    pub fn push(&mut self, name: &str, results: &Results) -> Result<(), CollectionError> {
        let frame = self.frames.len();
        while self.recent.front().is_some_and(|(at, _)| at + self.parameters.max_gap + 1 < frame) {
            self.recent.pop_front();
        }
        let seen = self.surfaces.see(name, results)?;
        let partners = self.partners(&seen)?;
        let regions = &results.record.regions;
        let mut track_of = Vec::with_capacity(regions.len());
        for (region, partner) in regions.iter().zip(&partners) {
            let (track, likeness) = match *partner {
                Some((track, likeness)) => (track, Some(likeness)),
                None => (self.tracks.len(), None),
            };
            let value = |wanted: Identity| likeness.filter(|l| l.identity == wanted).map(|l| l.value);
            let sighting = Sighting {
                frame,
                region: region.id,
                overlap: value(Identity::Vertices),
                likeness: value(Identity::Descriptors),
                reliability: region.reliability,
                volume: region.volume,
                volume_fraction: region.volume_fraction,
                centroid: region.centroid,
            };
            if likeness.is_none() {
                self.tracks.push(Track {
                    id: track as u32,
                    colour: [0; 3],
                    colour_of: track as u32,
                    first_frame: frame,
                    last_frame: frame,
                    found: 0,
                    mean_overlap: None,
                    reliability: None,
                    sightings: Vec::new(),
                });
            }
            let own = &mut self.tracks[track];
            own.last_frame = frame;
            own.found += 1;
            own.sightings.push(sighting);
            track_of.push(track as u32);
        }
        self.touching.add(results, &track_of);
        self.kinship.add(results, &track_of);
        self.pieces.add(results, &track_of);
        let before = self.recent.back().map(|(_, before)| seen.identity(before));
        self.frames.push(TrackedFrame {
            name: name.to_owned(),
            path: results.record.input.path.clone(),
            time: results.record.input.animation.as_ref().map(|_| results.record.input.time),
            regions: Some(regions.len()),
            identity: before,
        });
        self.recent.push_back((frame, seen));
        Ok(())
    }

    /// For each region of a frame the track that it belongs to, if there is one.
    fn partners(&self, seen: &Seen) -> Result<Vec<Option<Partner>>, CollectionError> {
        let mut rows: Vec<(usize, Vec<Likeness>)> = Vec::new();
        for (frame, before) in &self.recent {
            let last_here = |track: &&Track| track.last_frame == *frame;
            let tracks: Vec<(usize, usize)> = (self.tracks.iter().filter(last_here))
                .filter_map(|track| Some((track.id as usize, track.sightings.last()?.region as usize)))
                .collect();
            if tracks.is_empty() {
                continue;
            }
            let likeness = before.likeness(seen)?;
            rows.extend(tracks.into_iter().map(|(track, region)| (track, likeness[region].clone())));
        }
        let mut partners = vec![None; seen.regions()];
        if rows.is_empty() || seen.regions() == 0 {
            return Ok(partners);
        }
        let gain = |likeness: &Likeness| {
            let least = match likeness.identity {
                Identity::Vertices => self.parameters.min_overlap,
                Identity::Descriptors => self.parameters.min_likeness,
            };
            // A pair at the minimum itself is better than none.
            if likeness.value >= least { likeness.value - least + 1e-9 } else { 0.0 }
        };
        let costs: Vec<f64> = rows.iter().flat_map(|(_, row)| row.iter().map(|l| -gain(l))).collect();
        for ((track, row), region) in rows.iter().zip(assign(&costs, rows.len(), seen.regions())?) {
            if let Some(region) = region.filter(|&region| gain(&row[region]) > 0.0) {
                partners[region] = Some((*track, row[region]));
            }
        }
        Ok(partners)
    }

    /// The tracks of all frames.
    pub fn finish(mut self) -> Result<TracksRecord, CollectionError> {
        // Those that are found longest choose first.
        let mut order: Vec<usize> = (0..self.tracks.len()).collect();
        order.sort_by_key(|&track| std::cmp::Reverse(self.tracks[track].found));
        for (track, piece) in self.tracks.iter_mut().zip(self.pieces.first_of_each(&order)) {
            track.colour_of = piece;
        }
        let colours = self.kinship.colours(&self.tracks, &order, &self.touching.pairs())?;
        for (track, colour) in self.tracks.iter_mut().zip(colours) {
            track.colour = colour.0;
            pooled(&mut track.sightings, self.parameters.reliability_frames);
            let mean = |value: &dyn Fn(&Sighting) -> Option<f64>| {
                let values: Vec<f64> = track.sightings.iter().filter_map(value).collect();
                (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
            };
            (track.mean_overlap, track.reliability) = (mean(&|s| s.overlap), mean(&|s| s.reliability));
        }
        let mut record = TracksRecord::new(self.parameters, self.frames, self.tracks);
        record.warnings = warnings(&record, self.surfaces.unseen());
        Ok(record)
    }
}

fn warnings(record: &TracksRecord, unseen: usize) -> Vec<String> {
    let mut warnings = Vec::new();
    let missing = record.frames.iter().filter(|frame| frame.regions.is_none()).count();
    if missing > 0 {
        warnings.push(format!("{missing} frames have no result; their regions count as missing there"));
    }
    if unseen > 0 {
        warnings.push(format!(
            "{unseen} regions reach no point of the surface, so they were not followed; each is a track of its own"
        ));
    }
    let by = |wanted| record.frames.iter().filter(|frame| frame.identity == Some(wanted)).count();
    let others = by(Identity::Descriptors);
    if others > 0 {
        warnings.push(format!(
            "{others} frames have other triangles than the frame before; there regions were followed by descriptor and place"
        ));
    }
    warnings
}
