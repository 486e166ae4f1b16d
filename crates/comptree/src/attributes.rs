//! Attributes of every node, each in one pass: boxes, moments (Chan, Golub and LeVeque 1983), persistence
//! (Edelsbrunner et al. 2002; dynamics: Grimaud 1992). For anything else there is
//! [`ComponentTree::accumulate`].
use crate::tree::NONE;
use crate::{ComponentTree, Volumes};

/// The smallest box that holds a set of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: [f64; 3],
    /// Largest coordinates.
    pub max: [f64; 3],
}

/// Volume, centroid and second moments of a set of points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Sum of the volumes.
    pub volume: f64,
    /// Volume-weighted mean of the positions.
    pub centroid: [f64; 3],
    /// Volume-weighted covariance of the positions: xx, xy, xz, yy, yz, zz, in length^2.
    pub covariance: [f64; 6],
}

/// Rows and columns of the six entries of a covariance.
const ENTRIES: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

impl Moments {
    /// The moments of some vertices, points of the given volumes.
    pub fn of<'v>(
        vertices: &[u32],
        position: impl Fn(u32) -> [f64; 3],
        volumes: impl Into<Volumes<'v>>,
    ) -> Self {
        let volumes = volumes.into();
        let mut sum = Self { volume: 0.0, centroid: [0.0; 3], covariance: [0.0; 6] };
        for &v in vertices {
            sum.join(Self { volume: volumes.of(v), centroid: position(v), covariance: [0.0; 6] });
        }
        sum
    }

    /// Adds another set (Chan, Golub and LeVeque 1983): no large sums are subtracted.
    fn join(&mut self, other: Self) {
        let volume = self.volume + other.volume;
        if volume > 0.0 {
            let share = other.volume / volume;
            let apart: [f64; 3] = std::array::from_fn(|i| other.centroid[i] - self.centroid[i]);
            for (entry, (i, j)) in ENTRIES.into_iter().enumerate() {
                let between = share * (1.0 - share) * apart[i] * apart[j];
                self.covariance[entry] =
                    (1.0 - share) * self.covariance[entry] + share * other.covariance[entry] + between;
            }
            (0..3).for_each(|i| self.centroid[i] += share * apart[i]);
        }
        self.volume = volume;
    }

    /// The full symmetric covariance matrix.
    pub fn matrix(&self) -> [[f64; 3]; 3] {
        let mut matrix = [[0.0; 3]; 3];
        for (entry, (i, j)) in ENTRIES.into_iter().enumerate() {
            (matrix[i][j], matrix[j][i]) = (self.covariance[entry], self.covariance[entry]);
        }
        matrix
    }
}

impl ComponentTree {
    /// The bounding box of each node's vertices.
    pub fn bounding_boxes(&self, position: impl Fn(u32) -> [f64; 3]) -> Vec<Bounds> {
        let point = |v| Bounds { min: position(v), max: position(v) };
        self.accumulate(point, |a, b| {
            for i in 0..3 {
                a.min[i] = a.min[i].min(b.min[i]);
                a.max[i] = a.max[i].max(b.max[i]);
            }
        })
    }

    /// Centroid and second moments of each node's vertices. `volumes` are those the tree was built with.
    pub fn moments<'v>(
        &self,
        position: impl Fn(u32) -> [f64; 3],
        volumes: impl Into<Volumes<'v>>,
    ) -> Vec<Moments> {
        let volumes = volumes.into();
        let point = |v| Moments { volume: volumes.of(v), centroid: position(v), covariance: [0.0; 6] };
        self.accumulate(point, Moments::join)
    }

    /// The persistence (dynamics) of each node: how far the level moves from the first altitude in the
    /// node to the merge with a component that began earlier; up to the root where no such component joins.
    /// Of two components that began at the same level, the one with the smaller vertex counts as earlier.
    ///
    /// The number is the same for all nodes from a minimum up to that merge (for superlevel sets, from a
    /// maximum). It is never negative. Every merge counts, however small; the lifetime of a
    /// [`Merge`](crate::Merge) counts only real merges.
    pub fn persistence(&self) -> Vec<f64> {
        self.persistence_of(|node| self.polarity().orient(self.altitude(node)))
    }

    /// The same on another scale: `level` rises towards the root.
    pub(crate) fn persistence_of(&self, level: impl Fn(u32) -> f64) -> Vec<f64> {
        // The lowest level in each node, and the child it comes from; of a node without children its own.
        let mut lowest = vec![0.0; self.len()];
        let mut from = vec![NONE; self.len()];
        for node in 0..self.len() {
            if from[node] == NONE {
                lowest[node] = level(node as u32);
            }
            let parent = self.parents[node];
            if parent != NONE && (from[parent as usize] == NONE || lowest[node] < lowest[parent as usize]) {
                lowest[parent as usize] = lowest[node];
                from[parent as usize] = node as u32;
            }
        }
        let mut persistence = vec![0.0; self.len()];
        for node in (0..self.len()).rev() {
            persistence[node] = match self.parents[node] {
                NONE => level(node as u32) - lowest[node],
                parent if from[parent as usize] == node as u32 => persistence[parent as usize],
                parent => level(parent) - lowest[node],
            };
        }
        persistence
    }
}
