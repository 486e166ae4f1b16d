use mser3d_shape::{BitGrid, DisjointSets, VoxelGrid};
use rayon::prelude::*;

/// The topology of a solid of linked voxels.
///
/// The solid is read as a cell complex: its voxels are points, its links edges; four links around a
/// square carry the square, and twelve links of a cube the cube. For a solid without cut links this is the
/// topology of 6-connected voxels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct GridTopology {
    /// Linked components.
    pub components: usize,
    /// Voids that the solid surrounds on all sides.
    pub cavities: usize,
    /// Handles: loops that bound no surface in the solid.
    pub tunnels: usize,
    /// Points - edges + squares - cubes, which is components - tunnels + cavities. A closed surface around
    /// the solid has twice this Euler characteristic.
    pub euler_characteristic: i64,
}

impl GridTopology {
    /// Of a solid. Cost: O(words of the grid + runs of voxels along x).
    ///
    /// Cavities are counted as voids between voxels; where the surface parts neighbours, a slit within the
    /// solid surrounds no voxel and lowers the number of tunnels instead.
    ///
    /// ```
    /// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
    /// use mser3d_voxelize::GridTopology;
    ///
    /// // A ring of eight voxels.
    /// let mut ring = BitGrid::full([3, 3, 1])?;
    /// ring.set([1, 1, 0], false);
    /// let grid = VoxelGrid::solid(Frame::new([3, 3, 1], [0.0; 3], [1.0; 3])?, ring)?;
    /// let topology = GridTopology::of(&grid);
    /// assert_eq!((topology.components, topology.tunnels, topology.euler_characteristic), (1, 1, 0));
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    pub fn of(grid: &VoxelGrid) -> Self {
        let components = grid.component_count();
        let cavities = cavities(grid.occupancy());
        let euler_characteristic = euler_characteristic(grid);
        let tunnels = (components as i64 + cavities as i64 - euler_characteristic).max(0) as usize;
        Self { components, cavities, tunnels, euler_characteristic }
    }
}

/// The cells of a solid's complex, 64 at a time: bit v of a word stands for the cell whose lowest corner
/// is voxel v.
struct Cells<'a> {
    inside: &'a [u64],
    links: [&'a [u64]; 3],
    /// Words in a row and in a slice.
    width: usize,
    slice: usize,
}

impl<'a> Cells<'a> {
    fn of(grid: &'a VoxelGrid) -> Self {
        let inside = grid.occupancy();
        let width = inside.row_words();
        Self {
            inside: inside.words(),
            links: grid.links().each_ref().map(BitGrid::words),
            width,
            slice: width * inside.dims()[1],
        }
    }

    /// The bits of a word's neighbours along +x. Nothing lies beyond the end of a row.
    fn east(&self, words: &[u64], at: usize) -> u64 {
        words[at] >> 1 | if at % self.width + 1 < self.width { words[at + 1] << 63 } else { 0 }
    }

    /// In the last row or slice no links lead along +y or +z, so what is read beyond it meets zeros.
    fn beyond(words: &[u64], at: usize) -> u64 {
        words.get(at).copied().unwrap_or(0)
    }

    fn square_xy(&self, at: usize) -> u64 {
        let [lx, ly, _] = self.links;
        if ly[at] == 0 {
            return 0;
        }
        lx[at] & ly[at] & Self::beyond(lx, at + self.width) & self.east(ly, at)
    }

    fn square_xz(&self, at: usize) -> u64 {
        let [lx, _, lz] = self.links;
        lx[at] & lz[at] & Self::beyond(lx, at + self.slice) & self.east(lz, at)
    }

    fn square_yz(&self, at: usize) -> u64 {
        let [_, ly, lz] = self.links;
        ly[at] & lz[at] & Self::beyond(ly, at + self.slice) & Self::beyond(lz, at + self.width)
    }

    fn cube(&self, at: usize) -> u64 {
        let base = self.square_xy(at);
        let lz = self.links[2];
        if base & lz[at] == 0 {
            return 0;
        }
        let posts = lz[at] & self.east(lz, at) & lz[at + self.width] & self.east(lz, at + self.width);
        if posts == 0 { 0 } else { base & posts & self.square_xy(at + self.slice) }
    }

    /// The words of each slice that have voxels in them.
    fn occupied(&self, k: usize) -> impl Iterator<Item = usize> + '_ {
        (k * self.slice..(k + 1) * self.slice).filter(|&at| self.inside[at] != 0)
    }

    fn slices(&self) -> usize {
        self.inside.len() / self.slice.max(1)
    }
}

/// Points - edges + squares - cubes.
fn euler_characteristic(grid: &VoxelGrid) -> i64 {
    let cells = Cells::of(grid);
    let [lx, ly, lz] = cells.links;
    let count = |x: u64| i64::from(x.count_ones());
    let of_word = |at: usize| {
        count(cells.inside[at]) - count(lx[at]) - count(ly[at]) - count(lz[at])
            + count(cells.square_xy(at))
            + count(cells.square_xz(at))
            + count(cells.square_yz(at))
            - count(cells.cube(at))
    };
    (0..cells.slices()).into_par_iter().map(|k| cells.occupied(k).map(of_word).sum::<i64>()).sum()
}

/// Voxels that belong to no cube of 2 x 2 x 2 linked voxels: where the solid is thinner than two voxels.
pub(crate) fn thin_voxels(grid: &VoxelGrid) -> usize {
    let cells = Cells::of(grid);
    let (width, slice) = (cells.width, cells.slice);
    let covered = |at: usize| {
        // Cubes whose lowest corner is one row, one slice, or both, below.
        let corners = |at: usize| {
            let lower = if at >= slice { cells.cube(at - slice) } else { 0 };
            cells.cube(at) | lower
        };
        let columns = |at: usize| {
            let here = corners(at);
            let west = if at.is_multiple_of(width) { 0 } else { corners(at - 1) >> 63 };
            here | here << 1 | west
        };
        let south = if at % slice >= width { columns(at - width) } else { 0 };
        columns(at) | south
    };
    (0..cells.slices())
        .into_par_iter()
        .map(|k| {
            cells.occupied(k).map(|at| (cells.inside[at] & !covered(at)).count_ones() as usize).sum::<usize>()
        })
        .sum()
}

/// Components of the empty voxels, neighbours by face, edge or corner, that do not reach the box's sides.
fn cavities(inside: &BitGrid) -> usize {
    let ([nx, ny, nz], width) = (inside.dims(), inside.row_words());
    if nx == 0 || ny == 0 || nz == 0 {
        return 0;
    }
    // Gaps between voxels, row by row; number 0 stands for everything outside.
    let (mut rows, mut gaps) = (vec![0usize], Vec::new());
    for row in 0..ny * nz {
        let words = &inside.words()[row * width..(row + 1) * width];
        let mut start = 0;
        for (word, &bits) in words.iter().enumerate() {
            let mut rest = bits;
            while rest != 0 {
                let first = rest.trailing_zeros();
                let length = (rest >> first).trailing_ones();
                let at = word as u32 * 64 + first;
                if at > start {
                    gaps.push((start, at));
                }
                start = at + length;
                rest = if first + length == 64 { 0 } else { rest >> (first + length) << (first + length) };
            }
        }
        if start < nx as u32 {
            gaps.push((start, nx as u32));
        }
        rows.push(gaps.len());
    }
    let mut sets = DisjointSets::new(gaps.len() + 1);
    for row in 0..ny * nz {
        let (j, k) = (row % ny, row / ny);
        let border = j == 0 || k == 0 || j + 1 == ny || k + 1 == nz;
        for g in rows[row]..rows[row + 1] {
            if border || gaps[g].0 == 0 || gaps[g].1 == nx as u32 {
                sets.union(0, g as u32 + 1);
            }
        }
        let before = [(j > 0, 1), (k > 0 && j > 0, ny + 1), (k > 0, ny), (k > 0 && j + 1 < ny, ny - 1)];
        for (_, stride) in before.into_iter().filter(|b| b.0) {
            let (mut a, mut b) = (rows[row], rows[row - stride]);
            while a < rows[row + 1] && b < rows[row - stride + 1] {
                // Gaps that touch at their ends are neighbours by an edge or a corner.
                if gaps[a].0 <= gaps[b].1 && gaps[b].0 <= gaps[a].1 {
                    sets.union(a as u32 + 1, b as u32 + 1);
                }
                if gaps[a].1 < gaps[b].1 { a += 1 } else { b += 1 }
            }
        }
    }
    let outside = sets.find(0);
    (1..=gaps.len() as u32).filter(|&g| sets.find(g) == g && g != outside).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_shape::Frame;

    fn topology(dims: [usize; 3], inside: impl Fn([u32; 3]) -> bool) -> (usize, usize, usize, i64) {
        let mut bits = BitGrid::empty(dims).unwrap();
        for i in 0..dims.iter().product::<usize>() {
            let voxel = [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]].map(|x| x as u32);
            bits.set(voxel, inside(voxel));
        }
        let grid = VoxelGrid::solid(Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap(), bits).unwrap();
        let t = GridTopology::of(&grid);
        (t.components, t.tunnels, t.cavities, t.euler_characteristic)
    }

    #[test]
    fn balls_shells_rings_and_frames() {
        let square = |v: [u32; 3], c: f64| v.iter().map(|&x| (f64::from(x) - c).powi(2)).sum::<f64>();
        for n in [20, 64, 70] {
            let c = n as f64 / 2.0 - 0.3;
            assert_eq!(topology([n; 3], |v| square(v, c) < c * c), (1, 0, 0, 1));
            assert_eq!(topology([n; 3], |v| (0.3 * c * c..c * c).contains(&square(v, c))), (1, 0, 1, 2));
            let ring = |v: [u32; 3]| {
                let [x, y, z] = v.map(|x| f64::from(x) - c);
                (x.hypot(y) - 0.6 * c).powi(2) + z * z < (0.3 * c).powi(2)
            };
            assert_eq!(topology([n; 3], ring), (1, 1, 0, 0));
        }
        // The edges of a cube: 12 edges, 8 corners, so 5 loops.
        let frame = |v: [u32; 3]| v.iter().filter(|&&x| x == 0 || x == 9).count() >= 2;
        assert_eq!(topology([10; 3], frame), (1, 5, 0, -4));
        let plate = VoxelGrid::solid(
            Frame::new([70, 9, 5], [0.0; 3], [1.0; 3]).unwrap(),
            BitGrid::full([70, 9, 5]).unwrap(),
        );
        let plate = plate.unwrap();
        assert_eq!(thin_voxels(&plate), 0);
        // The cut above the first layer leaves it a voxel thick.
        let layer: Vec<[u32; 3]> = (0..630).map(|i| [i % 70, i / 70, 0]).collect();
        assert_eq!(thin_voxels(&plate.with_cut_links(2, &layer).0), 630);
        // Two voxels that share a corner only are two solids, and surround nothing.
        assert_eq!(topology([4; 3], |v| v == [1; 3] || v == [2; 3]), (2, 0, 0, 2));
        // Two cavities that touch at a corner are one.
        assert_eq!(topology([6; 3], |v| v != [2; 3] && v != [3; 3]).2, 1);
        assert_eq!(topology([6; 3], |v| v != [1; 3] && v != [3; 3]).2, 2);
    }
}
