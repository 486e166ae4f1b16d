//! Which voxels are neighbours.

crate::choice! {
    /// Which voxels are neighbours.
    pub enum Connectivity("connectivity") {
        /// Voxels that share a face; in an image, 4 pixels
        #[default]
        Six = "6",
        /// Voxels that share a face, an edge or a corner; in an image, 8 pixels
        TwentySix = "26",
    }
}

/// One of each pair of opposite steps to the 20 neighbours that share only an edge or a corner;
/// each leads to a voxel with a greater number.
pub const DIAGONALS: [[i32; 3]; 10] = [
    [1, 1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, 1],
    [1, 1, 1],
    [-1, 1, 1],
    [1, -1, 1],
    [-1, -1, 1],
];

/// The linked neighbours of a voxel through its faces: along each axis the one before it and the one after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Faces(pub [[Option<u32>; 2]; 3]);

impl Faces {
    /// The neighbours in the order of their numbers, and the axis along which each lies.
    #[inline]
    pub fn ascending(self) -> impl Iterator<Item = (u32, usize)> {
        let [[x, x_after], [y, y_after], [z, z_after]] = self.0;
        let all = [(z, 2), (y, 1), (x, 0), (x_after, 0), (y_after, 1), (z_after, 2)];
        all.into_iter().filter_map(|(neighbour, axis)| Some((neighbour?, axis)))
    }
}
