//! Components of linked voxels, found run by run along x: as many runs as the surface has voxels,
//! not as many as the solid.

use crate::bits::any;
use crate::{Bits, Components, DisjointSets, VoxelGrid};

/// Voxels of a row, each linked to the next.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: u32,
    end: u32,
}

/// The runs of all rows, with the component of each.
struct Runs {
    /// First run of each row (k * ny + j).
    rows: Vec<u32>,
    runs: Vec<Run>,
    components: DisjointSets,
}

impl Runs {
    fn of(grid: &VoxelGrid) -> Self {
        let (inside, links) = (grid.occupancy(), grid.links());
        let [_, ny, nz] = inside.dims();
        let width = inside.row_words();
        let (mut rows, mut runs, mut closed) = (vec![0], Vec::new(), 0);
        for row in 0..ny * nz {
            let mut carry = 0;
            for word in 0..width {
                let at = row * width + word;
                let (bits, linked) = (inside.words()[at], links[0].words()[at]);
                let place = word as u32 * 64;
                runs.extend(
                    Bits(bits & !(linked << 1 | carry)).map(|bit| Run { start: place + bit, end: 0 }),
                );
                // Runs end in the order in which they start.
                for bit in Bits(bits & !linked) {
                    runs[closed].end = place + bit + 1;
                    closed += 1;
                }
                carry = linked >> 63;
            }
            rows.push(runs.len() as u32);
        }
        let mut components = DisjointSets::new(runs.len());
        for (axis, stride) in [(1, 1), (2, ny)] {
            for row in 0..(ny * nz).saturating_sub(stride) {
                let across = &links[axis].words()[row * width..(row + 1) * width];
                let (mut a, a_end) = (rows[row] as usize, rows[row + 1] as usize);
                let (mut b, b_end) = (rows[row + stride] as usize, rows[row + stride + 1] as usize);
                while a < a_end && b < b_end {
                    let shared = runs[a].start.max(runs[b].start)..runs[a].end.min(runs[b].end);
                    if !shared.is_empty() && any(across, shared) {
                        components.union(a as u32, b as u32);
                    }
                    if runs[a].end < runs[b].end { a += 1 } else { b += 1 }
                }
            }
        }
        Self { rows, runs, components }
    }

    /// The component of each run, numbered by first voxel, and the voxels in each.
    fn labels(&mut self) -> (Vec<u32>, Vec<usize>) {
        let mut number = vec![u32::MAX; self.runs.len()];
        let (mut labels, mut sizes) = (Vec::with_capacity(self.runs.len()), Vec::new());
        for (r, run) in self.runs.iter().enumerate() {
            let root = self.components.find(r as u32) as usize;
            if number[root] == u32::MAX {
                number[root] = sizes.len() as u32;
                sizes.push(0);
            }
            labels.push(number[root]);
            sizes[number[root] as usize] += (run.end - run.start) as usize;
        }
        (labels, sizes)
    }
}

impl VoxelGrid {
    /// The component of each voxel under face links, and the number of voxels in each, numbered by
    /// the first voxel.
    pub fn components(&self) -> Components {
        let mut runs = Runs::of(self);
        let (labels, sizes) = runs.labels();
        let each = |(run, &label): (&Run, &u32)| std::iter::repeat_n(label, (run.end - run.start) as usize);
        Components { labels: runs.runs.iter().zip(&labels).flat_map(each).collect(), sizes }
    }

    /// The number of components under face links. Cost: O(words + runs).
    pub fn component_count(&self) -> usize {
        let mut runs = Runs::of(self);
        (0..runs.runs.len() as u32).filter(|&r| runs.components.find(r) == r).count()
    }

    /// The grid with only its largest component under face links (the first of several), and how many
    /// components and voxels were dropped. Cost: O(words + runs).
    pub fn largest_component(self) -> (Self, usize, usize) {
        let mut runs = Runs::of(&self);
        let (labels, sizes) = runs.labels();
        let parts = Components { labels, sizes };
        let Some(largest) = parts.largest().filter(|_| parts.len() > 1) else { return (self, 0, 0) };
        let count = self.len() - parts.sizes[largest as usize];
        let dropped = |row: usize| {
            let runs_of_row = runs.rows[row] as usize..runs.rows[row + 1] as usize;
            runs_of_row.filter(|&r| parts.labels[r] != largest).map(|r| {
                let Run { start, end } = runs.runs[r];
                start..end
            })
        };
        (self.without(dropped), parts.len() - 1, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BitGrid, Connectivity, Frame};

    /// Random solids with random links, against the graph's components.
    #[test]
    fn runs_find_the_components_of_the_graph() {
        let mut state = 3u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as f64 / (1u64 << 31) as f64
        };
        for (dims, density, linked) in [
            ([130, 5, 4], 0.9, 0.6),
            ([64, 3, 3], 1.0, 0.99),
            ([65, 4, 3], 0.5, 1.0),
            ([7, 9, 8], 0.6, 0.7),
            ([200, 2, 2], 1.0, 1.0),
        ] {
            let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
            let mut inside = BitGrid::empty(dims).unwrap();
            let mut cuts: [Vec<[u32; 3]>; 3] = Default::default();
            for i in 0..dims.iter().product::<usize>() {
                let voxel = [i % dims[0], i / dims[0] % dims[1], i / dims[0] / dims[1]].map(|x| x as u32);
                inside.set(voxel, random() < density);
                (0..3).filter(|_| random() > linked).for_each(|a| cuts[a].push(voxel));
            }
            let mut grid = VoxelGrid::solid(frame, inside).unwrap();
            for axis in 0..3 {
                grid = grid.with_cut_links(axis, &cuts[axis]).0;
            }
            let expected = grid.graph(Connectivity::Six).unwrap().components();
            assert_eq!(grid.components(), expected);
            assert_eq!(grid.component_count(), expected.len());
            let keep = expected.largest().unwrap();
            let kept = grid.restrict(|v| expected.labels[v as usize] == keep);
            let count = grid.len() - kept.len();
            assert_eq!(grid.largest_component(), (kept, expected.len() - 1, count));
        }
    }
}
