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

    /// The colours of the tracks: one for all that have the colour of one track. Those that come first in `order` choose first; `touching` lists
    /// tracks that touch in any frame.
    pub fn colours(
        &self,
        tracks: &[Track],
        order: &[usize],
        touching: &[[u32; 2]],
    ) -> Result<Vec<Rgb>, mser3d::Error> {
        let of: Vec<u32> = tracks.iter().map(|track| track.colour_of).collect();
        let pieces: Vec<u32> = order.iter().map(|&t| t as u32).filter(|&t| of[t as usize] == t).collect();
        let mut place = vec![0; tracks.len()];
        (0..).zip(&pieces).for_each(|(to, &piece)| place[piece as usize] = to);
        let (twins, parents) = (between(&self.twins, &of), between(&self.parents, &of));
        let members =
            |piece: u32| tracks.iter().filter(|track| of[track.id as usize] == piece).collect::<Vec<_>>();
        let traits = |&piece: &u32| {
            let twin = most(&twins, piece).filter(|&twin| most(&twins, twin) == Some(piece));
            let found: usize = members(piece).into_iter().map(|track| track.found).sum();
            let sides: Vec<f64> =
                members(piece).into_iter().filter_map(|track| self.sides.get(&track.id).copied()).collect();
            RegionTraits {
                parent: most(&parents, piece).map(|parent| place[parent as usize]),
                family: Some(twin.map_or(piece, |twin| twin.min(piece))),
                side: (!sides.is_empty()).then(|| sides.iter().sum::<f64>() / found.max(1) as f64),
            }
        };
        let traits: Vec<RegionTraits> = pieces.iter().map(traits).collect();
        // One label for each piece, which the graph joins; then as many as are seen of it.
        let frames = tracks.iter().map(|track| track.last_frame + 1).max().unwrap_or(1);
        let mut labels: Vec<i32> = (0..pieces.len() as i32).collect();
        for (label, &piece) in (0..).zip(&pieces) {
            let seen = |track: &Track| track.sightings.iter().map(|s| s.volume_fraction).sum::<f64>();
            let most = members(piece).into_iter().map(seen).fold(0.0, f64::max);
            let count = (LABELS_OF_A_FRAME * most / frames as f64) as usize;
            labels.extend(std::iter::repeat_n(label, count));
        }
        let edges = touching.iter().map(|pair| pair.map(|track| place[of[track as usize] as usize]));
        let edges: Vec<[u32; 2]> = edges.filter(|[a, b]| a != b).collect();
        let graph = Graph::from_edges(pieces.len(), &edges)?;
        let colours = region_colours(&traits, &labels, &graph);
        Ok(of.iter().map(|&piece| colours[place[piece as usize] as usize]).collect())
    }
}

/// Counts between tracks as counts between pieces.
fn between(counts: &BTreeMap<[u32; 2], usize>, of: &[u32]) -> BTreeMap<[u32; 2], usize> {
    let mut sums = BTreeMap::new();
    for (pair, count) in counts {
        let [a, b] = pair.map(|track| of[track as usize]);
        if a != b {
            *sums.entry([a, b]).or_insert(0) += count;
        }
    }
    sums
}

/// What a piece is most often counted with.
fn most(counts: &BTreeMap<[u32; 2], usize>, piece: u32) -> Option<u32> {
    let own = counts.range([piece, 0]..=[piece, u32::MAX]);
    own.max_by_key(|([_, other], count)| (**count, std::cmp::Reverse(*other))).map(|([_, other], _)| *other)
}
