//! Regions of several time scales as one set: not in the paper.
use std::borrow::Cow;
use std::ops::Range;

use mser3d_shape::{IndexSet, InvalidParameter};

use crate::{ComponentTree, Selection, StableRegion, TreeError, Volumes};

/// How regions of several trees become one set.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PoolParameters {
    /// A region is a duplicate, and dropped, if its overlap with a kept one, vol(A and B) / vol(A or B), is
    /// this or more. 0 to 1; anything above 1 keeps all. Default 0.9: below it, which of two regions is dropped
    /// differs from pose to pose.
    pub duplicate_overlap: f64,
}

impl Default for PoolParameters {
    fn default() -> Self {
        Self { duplicate_overlap: 0.9 }
    }
}

impl PoolParameters {
    /// Checks the range.
    ///
    /// # Errors
    /// [`TreeError::InvalidParameter`] unless the overlap is positive.
    pub fn validate(&self) -> Result<(), TreeError> {
        let value = self.duplicate_overlap;
        Ok(InvalidParameter::unless(value > 0.0, "duplicate_overlap", value, "positive")?)
    }
}

/// A region of the pooled set.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
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

/// The regions of a tree and their vertices: what pooling reads of it.
#[derive(Clone, Debug)]
pub struct TreeRegions<'t> {
    permutation: Cow<'t, [u32]>,
    /// The slice of the permutation that each region is, and how many times larger its merge is.
    regions: Vec<(Range<usize>, f64)>,
}

impl<'t> TreeRegions<'t> {
    /// Those of a tree that stays.
    pub fn of(tree: &'t ComponentTree, selection: &Selection) -> Self {
        Self { permutation: Cow::Borrowed(tree.permutation()), regions: slices(tree, selection) }
    }

    /// Those of a tree of which nothing else is needed, 4 bytes for each of its vertices.
    pub fn taken_from(tree: ComponentTree, selection: &Selection) -> Self {
        let regions = slices(&tree, selection);
        Self { permutation: Cow::Owned(tree.into_permutation()), regions }
    }
}

fn slices(tree: &ComponentTree, selection: &Selection) -> Vec<(Range<usize>, f64)> {
    let growth = |region: &StableRegion| region.merge.map_or(1.0, |merge| merge.growth);
    selection.regions.iter().map(|region| (tree.slice(region.node), growth(region))).collect()
}

/// Pools the regions of several trees on the same vertices, one tree for each time scale, and drops
/// duplicates.
///
/// Regions are taken in order of preference, and each one that overlaps a kept region too much is dropped:
///
/// 1. regions that a real merge ends, the sharpest merge first (the largest
///    [`growth`](crate::Merge::growth)): among nearly equal regions, these are found again best on a
///    deformed shape;
/// 2. all others, the largest first.
///
/// So a part is not lost to a somewhat larger region of another tree that only happens to be stable.
///
/// The result is sorted by descending volume; of equal volumes, the region of the earlier tree comes
/// first. Regions of different trees can overlap without being nested.
///
/// Cost: for each pair of regions of like volume, one look at the vertices of the smaller.
///
/// # Errors
/// [`TreeError::InvalidParameter`] from [`PoolParameters::validate`]; [`TreeError::SizeMismatch`] when the
/// trees or volumes differ in the number of vertices; [`TreeError::BadVolume`].
pub fn pool<'v>(
    trees: &[TreeRegions],
    volumes: impl Into<Volumes<'v>>,
    parameters: &PoolParameters,
) -> Result<Vec<PooledRegion>, TreeError> {
    parameters.validate()?;
    let volumes = volumes.into();
    let n = trees.first().map_or(0, |tree| tree.permutation.len());
    if let Some(tree) = trees.iter().find(|tree| tree.permutation.len() != n) {
        let (found, expected) = (tree.permutation.len(), n);
        return Err(TreeError::SizeMismatch { what: "vertices of a tree to pool", found, expected });
    }
    if n > 0 {
        volumes.check(n)?;
    }
    let mut candidates = Vec::new();
    for (number, tree) in trees.iter().enumerate() {
        candidates.extend(tree.regions.iter().enumerate().map(|(place, (slice, growth))| {
            let (vertices, growth) = (&tree.permutation[slice.clone()], *growth);
            let volume: f64 = vertices.iter().map(|&v| volumes.of(v)).sum();
            Candidate { tree: number, region: place, vertices, volume, growth }
        }));
    }
    // The sorts keep the order of equal ones: that of the trees, and of the regions in them.
    candidates.sort_by(|a, b| b.volume.total_cmp(&a.volume));
    candidates.sort_by(|a, b| b.growth.total_cmp(&a.growth));

    let mut kept: Vec<(Candidate<'_>, IndexSet)> = Vec::new();
    for candidate in candidates {
        let Candidate { vertices, volume, .. } = candidate;
        let duplicate = kept.iter().any(|(other, members)| {
            // An overlap is at most the ratio of the volumes.
            volume.min(other.volume) >= parameters.duplicate_overlap * volume.max(other.volume) && {
                let common: f64 =
                    vertices.iter().filter(|&&v| members.contains(v as usize)).map(|&v| volumes.of(v)).sum();
                common >= parameters.duplicate_overlap * (volume + other.volume - common)
            }
        });
        if !duplicate {
            kept.push((candidate, IndexSet::from_members(n, vertices.iter().copied())?));
        }
    }
    kept.sort_by_key(|(candidate, _)| (candidate.tree, candidate.region));
    kept.sort_by(|(a, _), (b, _)| b.volume.total_cmp(&a.volume));
    let pooled = kept.iter().enumerate().map(|(place, (candidate, members))| {
        let &Candidate { tree, region, vertices, volume, .. } = candidate;
        let contains = |(larger, members): &(Candidate<'_>, IndexSet)| {
            larger.volume > volume && vertices.iter().all(|&v| members.contains(v as usize))
        };
        let parent = kept[..place].iter().rposition(contains);
        let vertices = members.members().map(|v| v as u32).collect();
        PooledRegion { tree, region, volume, parent, vertices }
    });
    Ok(pooled.collect())
}

/// A region that may be kept: where it comes from, and what the order of preference depends on.
struct Candidate<'t> {
    tree: usize,
    region: usize,
    vertices: &'t [u32],
    volume: f64,
    growth: f64,
}
