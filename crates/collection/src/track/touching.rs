use std::collections::BTreeSet;

use mser3d_results::Results;

/// Which tracks touch each other, or contain each other, in any frame: they need different colours.
#[derive(Default)]
pub(super) struct Touching {
    pairs: BTreeSet<[u32; 2]>,
}

impl Touching {
    /// Adds those of a frame, of whose regions each belongs to a track.
    pub fn add(&mut self, results: &Results, track_of: &[u32]) {
        let labels = results.vertex_region();
        let track = |vertex: u32| {
            let region = usize::try_from(labels[vertex as usize]).ok()?;
            track_of.get(region).copied()
        };
        let mut add = |a: Option<u32>, b: Option<u32>| {
            if let (Some(a), Some(b)) = (a, b)
                && a != b
            {
                self.pairs.insert([a.min(b), a.max(b)]);
            }
        };
        for &[a, b, c] in results.mesh.triangles() {
            let [a, b, c] = [a, b, c].map(track);
            [(a, b), (b, c), (c, a)].into_iter().for_each(|(a, b)| add(a, b));
        }
        for region in &results.record.regions {
            let parent = region.parent.and_then(|parent| track_of.get(parent as usize));
            add(parent.copied(), track_of.get(region.id as usize).copied());
        }
    }

    pub fn pairs(&self) -> Vec<[u32; 2]> {
        self.pairs.iter().copied().collect()
    }
}
