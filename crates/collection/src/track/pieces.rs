use std::collections::{BTreeMap, BTreeSet};

use mser3d_results::Results;

/// Of two regions of one piece the smaller has at least this share of the larger one's volume: more than half, so that a left and a
/// right limb are never both one with what holds them.
const LEAST_SHARE: f64 = 0.6;
/// And so much of its vertices are in the larger one, which may be of an earlier frame.
const INSIDE: f64 = 0.9;

/// Which tracks are the same piece of the body. A leg is found at several scales, as regions one in the other that hardly differ, and may
/// be found as a larger region for a while and as a smaller one later. Whoever looks at it sees one thing, so it has one colour.
#[derive(Default)]
pub(super) struct Pieces {
    /// The last sighting of each track: its volume and vertices.
    last: BTreeMap<u32, (f64, Vec<u32>)>,
    /// How often two tracks, the smaller number first, were one piece, and how often they were not.
    votes: BTreeMap<[u32; 2], [usize; 2]>,
    vertices: usize,
}

impl Pieces {
    /// Compares the regions of a frame with each other and with the last sightings of all other tracks. Of frames with other
    /// vertices only those of one frame are compared.
    pub fn add(&mut self, results: &Results, track_of: &[u32]) {
        let regions = results.record.regions.iter().zip(&results.region_vertices);
        let sightings = regions.zip(track_of).map(|((r, members), &track)| (track, r.volume, &members[..]));
        self.see(results.mesh.vertices().len(), &sightings.collect::<Vec<_>>());
    }

    /// The same of tracks with the volumes and vertices of their regions, on a mesh of so many vertices.
    fn see(&mut self, vertices: usize, sightings: &[(u32, f64, &[u32])]) {
        if vertices != self.vertices {
            (self.vertices, self.last) = (vertices, BTreeMap::new());
        }
        let here: BTreeSet<u32> = sightings.iter().map(|sighting| sighting.0).collect();
        self.last
            .extend(sightings.iter().map(|(track, volume, members)| (*track, (*volume, members.to_vec()))));
        let mut inside = vec![false; vertices];
        for &track in &here {
            let (volume, members) = &self.last[&track];
            members.iter().for_each(|&v| inside[v as usize] = true);
            for (&other, (other_volume, others)) in &self.last {
                // Two of this frame are compared once.
                if other == track || (here.contains(&other) && other < track) {
                    continue;
                }
                let both = others.iter().filter(|&&v| inside[v as usize]).count() as f64;
                let fewer = members.len().min(others.len()) as f64;
                let alike = volume.min(*other_volume) >= LEAST_SHARE * volume.max(*other_volume);
                let vote = usize::from(!(alike && fewer > 0.0 && both >= INSIDE * fewer));
                self.votes.entry([track.min(other), track.max(other)]).or_default()[vote] += 1;
            }
            members.iter().for_each(|&v| inside[v as usize] = false);
        }
    }

    /// For each track the first in `order` that is the same piece, mostly; itself if there is none before it. It is
    /// compared with such first ones only, so that no chain leads from a finger to the body.
    pub fn first_of_each(&self, order: &[usize]) -> Vec<u32> {
        let mut first: Vec<u32> = (0..order.len() as u32).collect();
        let mut firsts: Vec<u32> = Vec::new();
        for &track in order {
            let track = track as u32;
            let votes = |other: u32| self.votes.get(&[track.min(other), track.max(other)]);
            let same = |other: &&u32| votes(**other).is_some_and(|[yes, no]| yes > no);
            match firsts.iter().find(same) {
                Some(&piece) => first[track as usize] = piece,
                None => firsts.push(track),
            }
        }
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a chain of vertices, the first so many.
    fn leg(length: u32) -> Vec<u32> {
        (0..length).collect()
    }

    fn pieces(frames: &[&[(u32, f64, &[u32])]], tracks: usize) -> Vec<u32> {
        let mut pieces = Pieces::default();
        frames.iter().for_each(|frame| pieces.see(100, frame));
        pieces.first_of_each(&(0..tracks).collect::<Vec<_>>())
    }

    #[test]
    fn a_leg_is_one_piece_with_a_little_more_of_it_at_once_and_later() {
        let (short, long, other) = (leg(30), leg(45), (50..80).collect::<Vec<u32>>());
        let (short, long, other) = (&short[..], &long[..], &other[..]);
        assert_eq!(pieces(&[&[(0, 45.0, long), (1, 30.0, short), (2, 30.0, other)]], 3), [0, 0, 2]);
        let later: [&[(u32, f64, &[u32])]; 3] =
            [&[(0, 30.0, short)], &[(2, 30.0, other)], &[(1, 45.0, long), (2, 30.0, other)]];
        assert_eq!(pieces(&later, 3), [0, 0, 2]);
        // What is mostly beside it is not.
        let aside: Vec<u32> = (10..40).collect();
        assert_eq!(pieces(&[&[(0, 30.0, short)], &[(1, 30.0, &aside)]], 2), [0, 1]);
    }

    #[test]
    fn no_chain_leads_from_a_toe_to_the_body_and_two_legs_are_not_one() {
        let lengths = [20, 30, 45, 67];
        let legs = lengths.map(leg);
        let chain: Vec<(u32, f64, &[u32])> =
            (0..4).map(|i| (i as u32, f64::from(lengths[i]), &legs[i][..])).collect();
        // Each is in the next at more than 0.6 of it, but one after the next is too large for the first.
        assert_eq!(pieces(&[&chain], 4), [0, 0, 2, 2]);
        let (both, left, right) = (leg(60), leg(30), (30..60).collect::<Vec<u32>>());
        assert_eq!(pieces(&[&[(0, 60.0, &both), (1, 30.0, &left), (2, 30.0, &right)]], 3), [0, 1, 2]);
    }
}
