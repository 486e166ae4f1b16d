use crate::order::Volumes;
use crate::{ComponentTree, Selection, TreeError};

/// How regions of several trees become one set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoolParameters {
    /// A region goes if its overlap with a kept one, vol(A and B) / vol(A or B), is this or more.
    /// 0 to 1; anything above 1 keeps all. Default 0.8.
    pub duplicate_overlap: f64,
}

impl Default for PoolParameters {
    fn default() -> Self {
        Self { duplicate_overlap: 0.8 }
    }
}

impl PoolParameters {
    /// Checks the range.
    ///
    /// # Errors
    /// [`TreeError::BadParameter`] unless the overlap is positive.
    pub fn validate(&self) -> Result<(), TreeError> {
        let value = self.duplicate_overlap;
        if value > 0.0 {
            return Ok(());
        }
        Err(TreeError::BadParameter { name: "duplicate_overlap", value, requirement: "positive" })
    }
}

/// A region of the pooled set.
#[derive(Clone, Debug, PartialEq)]
pub struct PooledRegion {
    /// Which of the trees it comes from.
    pub tree: usize,
    /// Its place in that tree's [`Selection::regions`].
    pub region: usize,
    /// Its volume.
    pub volume: f64,
    /// The smallest larger region of the pool, from any tree, that contains it.
    pub parent: Option<usize>,
    /// Its vertices, ascending.
    pub vertices: Vec<u32>,
}

/// Pools the regions of several trees on the same vertices, one tree for each time scale, and drops
/// duplicates: the largest region first, each one goes that overlaps a kept one too much.
///
/// Regions of different trees can overlap without being nested. Of equal volumes, the region of the
/// earlier tree comes first.
///
/// Cost: for each pair of regions of like volume, one look at the vertices of the smaller.
///
/// # Errors
/// [`TreeError::BadParameter`] from [`PoolParameters::validate`]; [`TreeError::SizeMismatch`] when the
/// trees or volumes differ in the number of vertices; [`TreeError::BadVolume`].
pub fn pool<'v>(
    trees: &[(&ComponentTree, &Selection)],
    volumes: impl Into<Volumes<'v>>,
    parameters: &PoolParameters,
) -> Result<Vec<PooledRegion>, TreeError> {
    parameters.validate()?;
    let volumes = volumes.into();
    let n = trees.first().map_or(0, |(tree, _)| tree.vertex_count());
    if let Some((tree, _)) = trees.iter().find(|(tree, _)| tree.vertex_count() != n) {
        let (found, expected) = (tree.vertex_count(), n);
        return Err(TreeError::SizeMismatch { what: "vertices of a tree to pool", found, expected });
    }
    if n > 0 {
        volumes.check(n)?;
    }
    let mut candidates: Vec<(usize, usize, f64)> = Vec::new();
    for (number, (_, selection)) in trees.iter().enumerate() {
        candidates.extend(selection.regions.iter().enumerate().map(|(place, region)| {
            let vertices = trees[number].0.vertices(region.node);
            (number, place, vertices.iter().map(|&v| volumes.of(v)).sum())
        }));
    }
    candidates.sort_by(|a, b| b.2.total_cmp(&a.2));

    let mut kept: Vec<PooledRegion> = Vec::new();
    let mut members: Vec<Members> = Vec::new();
    for (number, region, volume) in candidates {
        let (tree, selection) = trees[number];
        let slice = tree.vertices(selection.regions[region].node);
        let duplicate = kept.iter().zip(&members).any(|(larger, members)| {
            // An overlap is at most the ratio of the volumes.
            volume >= parameters.duplicate_overlap * larger.volume && {
                let common: f64 = slice.iter().filter(|&&v| members.has(v)).map(|&v| volumes.of(v)).sum();
                common >= parameters.duplicate_overlap * (volume + larger.volume - common)
            }
        });
        if duplicate {
            continue;
        }
        let contains = |i: &usize| kept[*i].volume > volume && slice.iter().all(|&v| members[*i].has(v));
        let parent = (0..kept.len()).rev().find(contains);
        let mut vertices = slice.to_vec();
        vertices.sort_unstable();
        members.push(Members::new(n, &vertices));
        kept.push(PooledRegion { tree: number, region, volume, parent, vertices });
    }
    Ok(kept)
}

/// A set of vertices, one bit each.
struct Members(Vec<u64>);

impl Members {
    fn new(n: usize, vertices: &[u32]) -> Self {
        let mut words = vec![0; n.div_ceil(64)];
        vertices.iter().for_each(|&v| words[v as usize / 64] |= 1 << (v % 64));
        Self(words)
    }

    #[inline]
    fn has(&self, v: u32) -> bool {
        self.0[v as usize / 64] >> (v % 64) & 1 == 1
    }
}
