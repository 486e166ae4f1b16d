use std::collections::BTreeMap;

use mser3d_shape::{DisjointSets, Domain, VoxelGrid};
use sprs::{CsMat, TriMat};

use crate::Operator;

/// A coarser Laplacian of a voxel grid: cells of `factor`^3 voxels become one row each.
///
/// Only voxels that are *linked within their cell* are joined, so touching limbs stay apart and the
/// coarse operator has the components of the fine one.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Aggregation {
    /// The coarse operator: masses are the aggregates' volumes.
    pub operator: Operator,
    /// The row of the coarse operator that each voxel belongs to.
    pub aggregate: Vec<u32>,
}

/// Aggregates a grid's Laplacian over cells of `factor` voxels along each axis.
///
/// Finite volumes: two aggregates joined by c links along axis a exchange c (voxel volume) /
/// (factor h_a^2), the flux through the c faces between them over a distance of `factor` voxels.
/// The low eigenvalues approximate the fine ones to second order in the cell size, away from walls.
///
/// ```
/// use mser3d_laplace::aggregate_grid;
/// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
///
/// let frame = Frame::new([6, 4, 4], [0.0; 3], [1.0; 3])?;
/// let solid = VoxelGrid::solid(frame, BitGrid::full(frame.dims())?)?;
/// let coarse = aggregate_grid(&solid, 2);
/// assert_eq!(coarse.operator.mass(), [8.0; 12]);
/// assert_eq!(coarse.aggregate[..6], [0, 0, 1, 1, 2, 2]);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn aggregate_grid(grid: &VoxelGrid, factor: u32) -> Aggregation {
    let factor = factor.max(1);
    let n = grid.len();
    let cells: Vec<[u32; 3]> = grid.voxels().map(|v| v.map(|x| x / factor)).collect();
    let pairs: [Vec<[u32; 2]>; 3] = std::array::from_fn(|axis| grid.linked_pairs(axis).collect());
    let mut sets = DisjointSets::new(n);
    for &[u, v] in pairs.iter().flatten() {
        if cells[u as usize] == cells[v as usize] {
            sets.union(u, v);
        }
    }
    let mut number = vec![u32::MAX; n];
    let mut mass: Vec<f64> = Vec::new();
    let aggregate: Vec<u32> = (0..n as u32)
        .map(|v| {
            let slot = &mut number[sets.find(v) as usize];
            if *slot == u32::MAX {
                *slot = mass.len() as u32;
                mass.push(0.0);
            }
            mass[*slot as usize] += grid.frame().voxel_volume();
            *slot
        })
        .collect();

    let spacing = grid.frame().spacing();
    let mut fluxes: BTreeMap<[u32; 2], f64> = BTreeMap::new();
    for (axis, pairs) in pairs.iter().enumerate() {
        let flux = grid.frame().voxel_volume() / (f64::from(factor) * spacing[axis] * spacing[axis]);
        for pair in pairs {
            let [a, b] = pair.map(|v| aggregate[v as usize]);
            if a != b {
                *fluxes.entry([a.min(b), a.max(b)]).or_default() += flux;
            }
        }
    }
    let rows = mass.len();
    let mut entries = TriMat::with_capacity((rows, rows), 2 * fluxes.len() + rows);
    let mut diagonal = vec![0.0; rows];
    for (&[a, b], &flux) in &fluxes {
        let (a, b) = (a as usize, b as usize);
        entries.add_triplet(a, b, -flux);
        entries.add_triplet(b, a, -flux);
        diagonal[a] += flux;
        diagonal[b] += flux;
    }
    for (row, &value) in diagonal.iter().enumerate() {
        entries.add_triplet(row, row, value);
    }
    let stiffness: CsMat<f64> = entries.to_csc();
    Aggregation { operator: Operator::assembled(Domain::Volume, stiffness, mass), aggregate }
}
