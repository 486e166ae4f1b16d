use std::collections::BTreeMap;

use mser3d_results::{Results, Track};
use mser3d_shape::Graph;
use mser3d_viewer::{RegionTraits, Rgb, region_colours};

/// Labels that stand for a whole frame, by which it is judged how much of a track is seen.
const LABELS_OF_A_FRAME: f64 = 100.0;

/// What tracks are to each other over all frames: what their colours say.
#[derive(Default)]
pub(super) struct Kinship {
    /// How often the first track was the mirror image of the second.
    twins: BTreeMap<[u32; 2], usize>,
    /// How often the first was the next inside the second.
    parents: BTreeMap<[u32; 2], usize>,
    /// The sum of each track's sides.
    sides: BTreeMap<u32, f64>,
}

impl Kinship {
    /// What regions are to each other in one frame.
    pub fn add(&mut self, results: &Results, track_of: &[u32]) {
        for (region, &track) in results.record.regions.iter().zip(track_of) {
            for (counts, other) in [(&mut self.twins, region.twin), (&mut self.parents, region.parent)] {
                if let Some(&other) = other.and_then(|other| track_of.get(other as usize)) {
                    *counts.entry([track, other]).or_insert(0) += 1;
                }
            }
            *self.sides.entry(track).or_insert(0.0) += region.side.unwrap_or(0.0);
        }
    }

    /// The colours of the tracks. Those that come first in `order` choose first; `touching` lists tracks that touch in any frame.
    pub fn colours(
        &self,
        tracks: &[Track],
        order: &[usize],
        touching: &[[u32; 2]],
    ) -> Result<Vec<Rgb>, mser3d::Error> {
        let mut place = vec![0; tracks.len()];
        (0u32..).zip(order).for_each(|(to, &track)| place[track] = to);
        let most = |counts: &BTreeMap<[u32; 2], usize>, track: u32| {
            let own = counts.range([track, 0]..=[track, u32::MAX]);
            own.max_by_key(|([_, other], count)| (**count, std::cmp::Reverse(*other)))
                .map(|([_, other], _)| *other)
        };
        let traits = |&track: &usize| {
            let own = tracks[track].id;
            let twin =
                most(&self.twins, own).filter(|&twin| twin != own && most(&self.twins, twin) == Some(own));
            RegionTraits {
                parent: most(&self.parents, own)
                    .filter(|&parent| parent != own)
                    .map(|parent| place[parent as usize]),
                family: Some(twin.map_or(own, |twin| twin.min(own))),
                side: self.sides.get(&own).map(|sum| sum / tracks[track].found.max(1) as f64),
            }
        };
        let traits: Vec<RegionTraits> = order.iter().map(traits).collect();
        // One label for each track, which the graph joins; then as many as are seen of it.
        let frames = tracks.iter().map(|track| track.last_frame + 1).max().unwrap_or(1);
        let mut labels: Vec<i32> = (0..order.len() as i32).collect();
        for (label, &track) in (0..).zip(order) {
            let seen: f64 = tracks[track].sightings.iter().map(|sighting| sighting.volume_fraction).sum();
            let count = (LABELS_OF_A_FRAME * seen / frames as f64) as usize;
            labels.extend(std::iter::repeat_n(label, count));
        }
        let edges = touching.iter().map(|pair| pair.map(|track| place[track as usize]));
        let graph = Graph::from_edges(order.len(), &edges.collect::<Vec<_>>())?;
        let mut colours = vec![Rgb::WHITE; tracks.len()];
        for (&track, colour) in order.iter().zip(region_colours(&traits, &labels, &graph)) {
            colours[track] = colour;
        }
        Ok(colours)
    }
}
