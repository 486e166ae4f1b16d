use mser3d_shape::{Domain, VoxelGrid};

/// The grid Laplacian without a matrix: the six neighbours of each voxel, and the weights of the three axes.
///
/// `(L x)(v) = sum_a (1/h_a^2) (2 x(v) - x(v - a) - x(v + a))`, units length^-2: the operator of
/// [`crate::grid_laplacian`] divided by the mass. A missing neighbour is the voxel itself, which the formula
/// cancels. 24 bytes a voxel.
///
/// ```
/// use mser3d_laplace::GridStencil;
/// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
///
/// let frame = Frame::new([4, 1, 1], [0.0; 3], [0.5, 1.0, 1.0])?;
/// let rod = VoxelGrid::solid(frame, BitGrid::full(frame.dims())?)?;
/// let stencil = GridStencil::new(&rod);
/// // L x at voxel 1: its neighbours along x are slots 2 and 3.
/// let x = [0.0, 1.0, 4.0, 9.0];
/// let around = stencil.neighbours()[1];
/// let value = stencil.weights()[0] * (2.0 * x[1] - x[around[2] as usize] - x[around[3] as usize]);
/// assert_eq!(value, -8.0);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
#[derive(Clone, Debug)]
pub struct GridStencil {
    neighbours: Vec<[u32; 6]>,
    weights: [f64; 3],
    voxel_volume: f64,
}

impl GridStencil {
    /// The stencil of a grid, links respected.
    pub fn new(grid: &VoxelGrid) -> Self {
        Self {
            neighbours: face_neighbours(grid),
            weights: grid.frame().spacing().map(|h| 1.0 / (h * h)),
            voxel_volume: grid.frame().voxel_volume(),
        }
    }

    /// Number of voxels, n.
    pub fn len(&self) -> usize {
        self.neighbours.len()
    }

    /// Whether there are no voxels.
    pub fn is_empty(&self) -> bool {
        self.neighbours.is_empty()
    }

    /// The neighbours of each voxel along -z, -y, -x, +x, +y and +z; the voxel itself where it has none.
    pub fn neighbours(&self) -> &[[u32; 6]] {
        &self.neighbours
    }

    /// 1/h^2 along x, y and z.
    pub fn weights(&self) -> [f64; 3] {
        self.weights
    }

    /// Volume of a voxel, the mass of each row.
    pub fn voxel_volume(&self) -> f64 {
        self.voxel_volume
    }

    /// The domain that its eigenbases belong to.
    pub fn domain(&self) -> Domain {
        Domain::Volume
    }

    /// An upper bound of the spectrum, 4 sum_a 1/h_a^2 (Gershgorin), in length^-2.
    pub fn spectral_bound(&self) -> f64 {
        4.0 * self.weights.iter().sum::<f64>()
    }
}

/// Neighbours along -z, -y, -x, +x, +y, +z (ascending voxel numbers); the voxel itself where none is linked.
pub(crate) fn face_neighbours(grid: &VoxelGrid) -> Vec<[u32; 6]> {
    let mut neighbours: Vec<[u32; 6]> = (0..grid.len() as u32).map(|v| [v; 6]).collect();
    for axis in 0..3 {
        for [u, v] in grid.linked_pairs(axis) {
            neighbours[u as usize][3 + axis] = v;
            neighbours[v as usize][2 - axis] = u;
        }
    }
    neighbours
}
