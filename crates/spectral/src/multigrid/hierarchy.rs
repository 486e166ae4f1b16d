//! Coarser and coarser levels of a grid: rows that are linked within a cell become one. Links are kept, so touching limbs stay apart.

use mser3d_shape::{DisjointSets, VoxelGrid};

use super::level::{Level, Link};
use super::transfer::Transfer;

/// Cells are doubled along an axis while they are no longer there than this times their shortest side: along the others rows are linked
/// too weakly for a smoother to do its work.
const LONG: f64 = 1.5;

/// The levels below the grid itself.
pub(super) struct Hierarchy {
    /// From the grid to the first level, from there to the second, and on.
    pub transfers: Vec<Transfer>,
    /// At least one.
    pub levels: Vec<Level>,
    /// The smallest weight of the grid along an axis along which its cells are doubled, over the largest: waves along it must be
    /// smoothed that the first level cannot show.
    pub weakest: f64,
}

/// What a level is made from, while the next one is.
#[derive(Default)]
struct Rows {
    /// The place of each row's cell.
    cells: Vec<[u32; 3]>,
    /// The centre of mass of each row, in voxels.
    centres: Vec<[f32; 3]>,
    mass: Vec<f32>,
    /// Links along each axis: what flows is the number over the distance of the centres along it.
    links: [Vec<Link>; 3],
}

impl Rows {
    fn level(&self) -> Level {
        let flow = |axis: usize| {
            let distance = |a: u32, b: u32| self.centres[b as usize][axis] - self.centres[a as usize][axis];
            self.links[axis].iter().map(|&(a, b, area)| (a, b, area / distance(a, b))).collect()
        };
        Level::new(self.mass.clone(), &std::array::from_fn(flow))
    }
}

impl Hierarchy {
    /// The last level.
    pub fn coarsest(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    /// Levels down to the first with less than `rows` rows times eight. `order` is the voxel of each row of the grid.
    pub fn new(grid: &VoxelGrid, order: &[u32], rows: usize) -> Self {
        let n = grid.len();
        let mut position = vec![0u32; n];
        order.iter().enumerate().for_each(|(row, &voxel)| position[voxel as usize] = row as u32);
        let mut cells = vec![[0u32; 3]; n];
        grid.voxels().zip(&position).for_each(|(place, &row)| cells[row as usize] = place);
        let mut sides = grid.frame().spacing();
        let shortest = sides.iter().copied().fold(f64::INFINITY, f64::min);
        let weights = sides.map(|h| (shortest / h).powi(2));
        let mut doubled = double(&mut sides);
        let weakest = (0..3).filter(|&axis| doubled[axis]).map(|axis| weights[axis]).fold(1.0, f64::min);
        let each = |axis: usize, found: &mut dyn FnMut(Link)| {
            for [u, v] in grid.linked_pairs(axis) {
                found((position[u as usize], position[v as usize], weights[axis] as f32));
            }
        };
        let (transfer, mut last) = coarsen(&cells, doubled, |row| (1.0, cells[row].map(|x| x as f32)), each);
        drop((cells, position));
        let mut hierarchy = Self { transfers: vec![transfer], levels: Vec::new(), weakest };
        loop {
            let n = last.cells.len();
            hierarchy.levels.push(last.level());
            if n < 8 * rows {
                return hierarchy;
            }
            doubled = double(&mut sides);
            let each = |axis: usize, found: &mut dyn FnMut(Link)| {
                last.links[axis].iter().for_each(|&link| found(link))
            };
            let (transfer, coarse) =
                coarsen(&last.cells, doubled, |row| (last.mass[row], last.centres[row]), each);
            if 4 * coarse.cells.len() > 3 * n {
                return hierarchy;
            }
            hierarchy.transfers.push(transfer);
            last = coarse;
        }
    }
}

/// Doubles the shorter sides of cells, and says which.
fn double(sides: &mut [f64; 3]) -> [bool; 3] {
    let shortest = sides.iter().copied().fold(f64::INFINITY, f64::min);
    let doubled = sides.map(|side| side <= LONG * shortest);
    (0..3).filter(|&axis| doubled[axis]).for_each(|axis| sides[axis] *= 2.0);
    doubled
}

/// Joins what is linked within each larger cell. Finite volumes: what flows between two aggregates is what flows through the faces between
/// them over the distance of their centres. Aggregates at the surface can be thin, so these are not where their cells' are.
fn coarsen(
    cells: &[[u32; 3]],
    doubled: [bool; 3],
    body: impl Fn(usize) -> (f32, [f32; 3]),
    each_link: impl Fn(usize, &mut dyn FnMut(Link)),
) -> (Transfer, Rows) {
    let n = cells.len();
    let parent = |row: u32| -> [u32; 3] {
        let cell = cells[row as usize];
        std::array::from_fn(|axis| cell[axis] >> u32::from(doubled[axis]))
    };
    let mut sets = DisjointSets::new(n);
    for axis in 0..3 {
        each_link(axis, &mut |(a, b, _)| {
            if parent(a)[axis] == parent(b)[axis] {
                sets.union(a, b);
            }
        });
    }
    let mut number = vec![u32::MAX; n];
    let mut aggregate = vec![0u32; n];
    let mut coarse = Rows::default();
    let mut moments: Vec<[f64; 3]> = Vec::new();
    let mut starts = vec![0u32];
    for row in 0..n {
        let slot = &mut number[sets.find(row as u32) as usize];
        if *slot == u32::MAX {
            *slot = coarse.cells.len() as u32;
            coarse.cells.push(parent(row as u32));
            coarse.mass.push(0.0);
            moments.push([0.0; 3]);
            starts.push(0);
        }
        aggregate[row] = *slot;
        let (mass, centre) = body(row);
        coarse.mass[*slot as usize] += mass;
        (0..3).for_each(|axis| moments[*slot as usize][axis] += f64::from(mass * centre[axis]));
        starts[*slot as usize + 1] += 1;
    }
    drop((number, sets));
    let m = coarse.cells.len();
    sum_up(&mut starts);
    let mut next = starts.clone();
    let mut children = vec![0u32; n];
    for (row, &a) in aggregate.iter().enumerate() {
        children[next[a as usize] as usize] = row as u32;
        next[a as usize] += 1;
    }
    let middles = moments.iter().zip(&coarse.mass);
    coarse.centres = middles.map(|(sum, &mass)| sum.map(|sum| (sum / f64::from(mass)) as f32)).collect();
    let side: Vec<u8> =
        cells.iter().map(|cell| (0..3).map(|axis| ((cell[axis] & 1) as u8) << axis).sum()).collect();
    let mut beside: Vec<[u32; 6]> = (0..m as u32).map(|row| [row; 6]).collect();
    for axis in 0..3 {
        coarse.links[axis] = coarse_links(m, &aggregate, |found| each_link(axis, found));
        if doubled[axis] {
            note_neighbours(&coarse.links[axis], axis, &mut beside);
        }
    }
    let weight = |row: usize| -> [i8; 3] {
        let (own, side, place) = (aggregate[row] as usize, side[row], body(row).1);
        std::array::from_fn(|axis| {
            let above = side >> axis & 1 == 1;
            let other = beside[own][2 * axis + usize::from(above)] as usize;
            if other == own {
                return 0;
            }
            let share = (place[axis] - coarse.centres[own][axis])
                / (coarse.centres[other][axis] - coarse.centres[own][axis]);
            let steps = (share.clamp(0.0, 1.0) * 127.0).round() as i8;
            if above { steps } else { -steps }
        })
    };
    let weights = (0..n).map(weight).collect();
    (Transfer { aggregate, weights, beside, starts, children }, coarse)
}

/// The links between different aggregates, those of a pair summed up.
fn coarse_links(aggregates: usize, aggregate: &[u32], each_link: impl Fn(&mut dyn FnMut(Link))) -> Vec<Link> {
    let each_between = |found: &mut dyn FnMut(Link)| {
        each_link(&mut |(a, b, flow)| {
            let (a, b) = (aggregate[a as usize], aggregate[b as usize]);
            if a != b {
                found((a, b, flow));
            }
        });
    };
    let mut starts = vec![0u32; aggregates + 1];
    each_between(&mut |(a, ..)| starts[a as usize + 1] += 1);
    sum_up(&mut starts);
    let mut next = starts.clone();
    let mut all = vec![(0u32, 0f32); starts[aggregates] as usize];
    each_between(&mut |(a, b, flow)| {
        all[next[a as usize] as usize] = (b, flow);
        next[a as usize] += 1;
    });
    let mut links: Vec<Link> = Vec::new();
    for (a, ends) in starts.windows(2).enumerate() {
        let mine = &mut all[ends[0] as usize..ends[1] as usize];
        mine.sort_by_key(|&(b, _)| b);
        for &(b, flow) in mine.iter() {
            match links.last_mut() {
                Some(last) if (last.0, last.1) == (a as u32, b) => last.2 += flow,
                _ => links.push((a as u32, b, flow)),
            }
        }
    }
    links
}

/// Enters the neighbours on both sides of each row along an axis to which most flows, the first of equals.
fn note_neighbours(links: &[Link], axis: usize, beside: &mut [[u32; 6]]) {
    for back in [true, false] {
        let mut most = vec![0f32; beside.len()];
        for &(a, b, flow) in links {
            let (from, to) = if back { (b, a) } else { (a, b) };
            if flow > most[from as usize] {
                most[from as usize] = flow;
                beside[from as usize][2 * axis + usize::from(!back)] = to;
            }
        }
    }
}

/// Counts to starts.
fn sum_up(counts: &mut [u32]) {
    for i in 1..counts.len() {
        counts[i] += counts[i - 1];
    }
}
