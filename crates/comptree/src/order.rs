//! Which way the level moves, and how much each vertex weighs.
use crate::TreeError;

/// No node: the parent of a root.
pub(crate) const NONE: u32 = u32::MAX;

/// Which way the level moves.
///
/// Both are the same tree with the order of weights reversed, like MSER+ and MSER- in images.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Polarity {
    /// The level rises: components of `{ w <= level }`; leaves are minima, roots the highest.
    #[default]
    Sublevel,
    /// The level falls: components of `{ w >= level }`; leaves are maxima, roots the lowest.
    Superlevel,
}

impl Polarity {
    /// The weight as a level that rises; its own inverse. Both zeros are one.
    #[inline]
    pub(crate) fn orient(self, weight: f64) -> f64 {
        match self {
            Self::Sublevel => weight + 0.0,
            Self::Superlevel => 0.0 - weight,
        }
    }
}

/// The volume of each vertex: what a region is measured in.
///
/// A number is the volume of every vertex (a voxel's), a slice one volume for each vertex (the areas
/// of a mesh's vertices).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Volumes<'a> {
    /// Every vertex has this volume.
    Uniform(f64),
    /// Vertex v has the v-th volume.
    Each(&'a [f64]),
}

impl From<f64> for Volumes<'_> {
    fn from(volume: f64) -> Self {
        Self::Uniform(volume)
    }
}

impl<'a> From<&'a [f64]> for Volumes<'a> {
    fn from(volumes: &'a [f64]) -> Self {
        Self::Each(volumes)
    }
}

impl<'a> From<&'a Vec<f64>> for Volumes<'a> {
    fn from(volumes: &'a Vec<f64>) -> Self {
        Self::Each(volumes)
    }
}

impl Volumes<'_> {
    /// The volume of a vertex.
    #[inline]
    pub(crate) fn of(&self, vertex: u32) -> f64 {
        match self {
            Self::Uniform(volume) => *volume,
            Self::Each(volumes) => volumes[vertex as usize],
        }
    }

    pub(crate) fn check(&self, vertices: usize) -> Result<(), TreeError> {
        let bad = |v: f64| !(v.is_finite() && v >= 0.0);
        let each = match self {
            Self::Uniform(volume) => std::slice::from_ref(volume),
            Self::Each(volumes) if volumes.len() != vertices => {
                let (found, expected) = (volumes.len(), vertices);
                return Err(TreeError::SizeMismatch { what: "volumes of vertices", found, expected });
            }
            Self::Each(volumes) => volumes,
        };
        match each.iter().position(|&v| bad(v)) {
            Some(vertex) => Err(TreeError::BadVolume { vertex, volume: each[vertex] }),
            None => Ok(()),
        }
    }
}
