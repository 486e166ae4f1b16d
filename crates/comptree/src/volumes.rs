//! The measure `vol` of eq. 5: how much each vertex adds to the volume of a region.
use crate::TreeError;

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
