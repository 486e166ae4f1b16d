use crate::bits::clear;
use crate::neighbours::{Connectivity, DIAGONALS, Faces};
use crate::numbering::Numbering;
use crate::{BitGrid, Bits, Frame, Graph, ShapeError};
use std::ops::Range;
use std::sync::Arc;

/// A solid as voxels and the links between them.
///
/// Occupancy alone glues limbs that come closer than a voxel. So each voxel carries, for +x, +y and
/// +z, one bit that says whether its neighbour there is *linked*: both are inside, and no surface
/// parts them. Operators, trees and components read the links, never the occupancy alone.
///
/// The occupied voxels are numbered from 0, x fastest, then y, then z.
///
/// A clone shares the voxels with what it was cloned from, until one of them changes.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelGrid {
    frame: Frame,
    occupancy: Arc<BitGrid>,
    links: Arc<[BitGrid; 3]>,
    cut_diagonals: Option<Arc<Vec<[u32; 2]>>>,
    numbering: Arc<Numbering>,
    len: usize,
}

impl VoxelGrid {
    /// A grid with the given links: bit v of `links[a]` links voxel v to its neighbour along +a.
    ///
    /// # Errors
    /// [`ShapeError::SizeMismatch`] for sizes that differ, [`ShapeError::DanglingLink`] for a link
    /// at an empty voxel, [`ShapeError::TooMany`] beyond 2^32 - 2 occupied voxels.
    pub fn new(frame: Frame, occupancy: BitGrid, links: [BitGrid; 3]) -> Result<Self, ShapeError> {
        links.iter().chain([&occupancy]).try_for_each(|bits| check_size(&frame, bits))?;
        for axis in 0..3 {
            let allowed = inner_neighbours(&occupancy, axis);
            let stray = links[axis].words().iter().zip(allowed.words()).position(|(l, a)| l & !a != 0);
            if let Some(word) = stray {
                let bit = (links[axis].words()[word] & !allowed.words()[word]).trailing_zeros();
                return Err(ShapeError::DanglingLink { voxel: occupancy.voxel(word, bit), axis });
            }
        }
        Self::unchecked(frame, occupancy, links, None)
    }

    /// A grid in which all neighbours inside are linked, diagonal ones too: a plain binary mask.
    ///
    /// # Errors
    /// As [`VoxelGrid::new`].
    pub fn solid(frame: Frame, occupancy: BitGrid) -> Result<Self, ShapeError> {
        check_size(&frame, &occupancy)?;
        let links = std::array::from_fn(|axis| inner_neighbours(&occupancy, axis));
        Self::unchecked(frame, occupancy, links, Some(Vec::new()))
    }

    /// The same grid with the links along an axis cut at these voxels, and how many of them there were.
    /// Diagonal links are unknown from then on.
    pub fn with_cut_links(mut self, axis: usize, voxels: &[[u32; 3]]) -> (Self, usize) {
        let mut cut = 0;
        let links = &mut Arc::make_mut(&mut self.links)[axis];
        for &voxel in voxels {
            if links.get(voxel) {
                links.set(voxel, false);
                cut += 1;
            }
        }
        self.cut_diagonals = None;
        (self, cut)
    }

    /// The same grid with its diagonal links determined: all diagonal neighbours are linked but
    /// these pairs of voxel numbers, each given with the smaller number first.
    ///
    /// # Errors
    /// [`ShapeError::IndexOutOfRange`] when a pair names a voxel that is not there.
    pub fn with_cut_diagonals(mut self, mut cut: Vec<[u32; 2]>) -> Result<Self, ShapeError> {
        for (number, pair) in cut.iter().enumerate() {
            if let Some(&index) = pair.iter().find(|&&v| v as usize >= self.len) {
                let vertices = self.len;
                return Err(ShapeError::IndexOutOfRange { element: "edge", number, index, vertices });
            }
        }
        cut.sort_unstable();
        cut.dedup();
        self.cut_diagonals = Some(Arc::new(cut));
        Ok(self)
    }

    fn unchecked(
        frame: Frame,
        occupancy: BitGrid,
        links: [BitGrid; 3],
        cut_diagonals: Option<Vec<[u32; 2]>>,
    ) -> Result<Self, ShapeError> {
        let len = occupancy.count_ones();
        if len >= u32::MAX as usize {
            let (count, limit) = (len as u128, u128::from(u32::MAX) - 1);
            return Err(ShapeError::TooMany { what: "occupied voxels", count, limit });
        }
        let numbering = Arc::new(Numbering::new(&occupancy));
        let (occupancy, links, cut_diagonals) =
            (Arc::new(occupancy), Arc::new(links), cut_diagonals.map(Arc::new));
        Ok(Self { frame, occupancy, links, cut_diagonals, numbering, len })
    }

    /// Size and place of the grid.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Which voxels are inside.
    pub fn occupancy(&self) -> &BitGrid {
        &self.occupancy
    }

    /// Links along +x, +y and +z.
    pub fn links(&self) -> &[BitGrid; 3] {
        &self.links
    }

    /// The pairs of diagonal neighbours that are not linked, ascending; `None` if never determined.
    pub fn cut_diagonals(&self) -> Option<&[[u32; 2]]> {
        self.cut_diagonals.as_deref().map(Vec::as_slice)
    }

    /// Number of occupied voxels.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether no voxel is occupied.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Volume of the occupied voxels, in length^3.
    pub fn volume(&self) -> f64 {
        self.len as f64 * self.frame.voxel_volume()
    }

    /// The number of an occupied voxel.
    #[inline]
    pub fn index(&self, voxel: [u32; 3]) -> Option<u32> {
        self.occupancy.get(voxel).then(|| {
            let (word, bit) = self.occupancy.position(voxel);
            self.numbering.number(&self.occupancy, word, bit)
        })
    }

    /// The occupied voxels in the order of their numbers.
    pub fn voxels(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.occupancy.ones()
    }

    /// The occupied voxel with a number, which must be below [`len`](Self::len).
    pub fn voxel(&self, number: u32) -> [u32; 3] {
        let (word, bit) = self.numbering.position(&self.occupancy, number);
        self.occupancy.voxel(word, bit)
    }

    /// The occupied voxels with these numbers, each below [`len`](Self::len). It is fast where they ascend.
    pub fn voxels_of<'a>(&'a self, numbers: &'a [u32]) -> impl Iterator<Item = [u32; 3]> + 'a {
        // The voxel of a word's first bit, its bits from the one with a number on, and that number.
        let (mut first, mut bits, mut next) = ([0; 3], Bits(0), 0);
        numbers.iter().map(move |&number| {
            if number < next || number - next >= bits.0.count_ones() {
                let word = self.numbering.word(number);
                first = self.occupancy.voxel(word, 0);
                (bits, next) = (Bits(self.occupancy.words()[word]), self.numbering.first(word));
            }
            let bit = bits.nth((number - next) as usize).unwrap_or_default();
            next = number + 1;
            [first[0] + bit, first[1], first[2]]
        })
    }

    /// The linked pairs of face neighbours along an axis, as voxel numbers, the smaller first,
    /// in ascending order of the first.
    pub fn linked_pairs(&self, axis: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
        let (links, inside) = (&self.links[axis], &self.occupancy);
        let stride = [0, inside.row_words(), inside.row_words() * inside.dims()[1]][axis];
        (0..links.words().len()).flat_map(move |word| {
            Bits(links.words()[word]).map(move |bit| {
                let u = self.numbering.number(inside, word, bit);
                let v = if axis == 0 { u + 1 } else { self.numbering.number(inside, word + stride, bit) };
                [u, v]
            })
        })
    }

    /// The graph of linked voxels.
    ///
    /// # Errors
    /// [`ShapeError::DiagonalsUnknown`] when 26 neighbours are asked of a grid without diagonal links.
    pub fn graph(&self, connectivity: Connectivity) -> Result<Graph, ShapeError> {
        if connectivity == Connectivity::Six {
            return Ok(self.graph_of_faces());
        }
        let cut = self.cut_diagonals().ok_or(ShapeError::DiagonalsUnknown)?;
        let mut edges: Vec<[u32; 2]> = (0..3).flat_map(|axis| self.linked_pairs(axis)).collect();
        edges.extend(self.diagonal_pairs().filter(|pair| cut.binary_search(pair).is_err()));
        Graph::from_edges(self.len, &edges)
    }

    /// The linked neighbours of each voxel of a range of numbers, from the bits: no list is made.
    ///
    /// ```
    /// # use mser3d_shape::{BitGrid, Frame, VoxelGrid};
    /// let frame = Frame::new([3, 2, 1], [0.0; 3], [1.0; 3])?;
    /// let grid = VoxelGrid::solid(frame, BitGrid::full([3, 2, 1])?)?;
    /// let along_x: Vec<_> = grid.faces(3..6).map(|faces| faces.0[0]).collect();
    /// assert_eq!(along_x, [[None, Some(4)], [Some(3), Some(5)], [Some(4), None]]);
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    #[inline]
    pub fn faces(&self, voxels: Range<u32>) -> impl Iterator<Item = Faces> + '_ {
        let words = self.occupancy.words().len();
        let (first, bit) = match voxels.is_empty() {
            true => (words, 0),
            false => self.numbering.position(&self.occupancy, voxels.start),
        };
        let bits_of = move |word: usize| {
            self.occupancy.words()[word] & if word == first { u64::MAX << bit } else { u64::MAX }
        };
        let of_word = move |word: usize| Bits(bits_of(word)).map(move |bit| (word, bit));
        let places = (first..words).flat_map(of_word);
        voxels.zip(places).map(|(voxel, (word, bit))| self.faces_at(voxel, word, bit))
    }

    /// The linked neighbours of one voxel.
    #[inline]
    pub fn faces_of(&self, voxel: u32) -> Faces {
        let (word, bit) = self.numbering.position(&self.occupancy, voxel);
        self.faces_at(voxel, word, bit)
    }

    #[inline]
    fn faces_at(&self, voxel: u32, word: usize, bit: u32) -> Faces {
        let [x, y, z] = self.links.each_ref().map(BitGrid::words);
        let (row, slab) = (self.occupancy.row_words(), self.occupancy.row_words() * self.occupancy.dims()[1]);
        let has = |links: u64| links >> bit & 1 == 1;
        let number = |word: usize| self.numbering.number(&self.occupancy, word, bit);
        let before = |links: &[u64], stride: usize| {
            (word >= stride && has(links[word - stride])).then(|| number(word - stride))
        };
        let after = |links: &[u64], stride: usize| has(links[word]).then(|| number(word + stride));
        // The link from the voxel before is its bit, or the last one of the word before in the row.
        let back = match bit {
            0 => !word.is_multiple_of(row) && x[word - 1] >> 63 == 1,
            _ => x[word] >> (bit - 1) & 1 == 1,
        };
        Faces([
            [back.then(|| voxel - 1), has(x[word]).then(|| voxel + 1)],
            [before(y, row), after(y, row)],
            [before(z, slab), after(z, slab)],
        ])
    }

    /// The graph of voxels that are linked through faces. Neighbours are met in order, so that nothing has to be sorted.
    fn graph_of_faces(&self) -> Graph {
        let links: usize = self.links.iter().map(BitGrid::count_ones).sum();
        let mut offsets = Vec::with_capacity(self.len + 1);
        offsets.push(0);
        let mut neighbours = Vec::with_capacity(2 * links);
        for faces in self.faces(0..self.len as u32) {
            faces.ascending().for_each(|(neighbour, _)| neighbours.push(neighbour));
            offsets.push(neighbours.len());
        }
        Graph::from_rows(offsets, neighbours)
    }

    /// All pairs of diagonal neighbours inside, linked or not, as voxel numbers, the smaller first.
    pub fn diagonal_pairs(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.voxels().enumerate().flat_map(move |(u, voxel)| {
            DIAGONALS.iter().filter_map(move |step| {
                // A step below zero wraps to a coordinate outside any box.
                let other = std::array::from_fn(|a| voxel[a].wrapping_add_signed(step[a]));
                self.index(other).map(|v| [u as u32, v])
            })
        })
    }

    /// The grid without some of its voxels and their links: in each row (k * ny + j), those of some ranges along x.
    /// In place, so that a large grid is there once.
    pub(crate) fn without<R: Iterator<Item = Range<u32>>>(self, dropped: impl Fn(usize) -> R) -> Self {
        let before = match self.cut_diagonals() {
            Some([_, ..]) => Some(self.clone()),
            _ => None,
        };
        let mut occupancy = Arc::unwrap_or_clone(self.occupancy);
        let width = occupancy.row_words();
        for (row, words) in occupancy.words_mut().chunks_mut(width.max(1)).enumerate() {
            dropped(row).for_each(|range| clear(words, range));
        }
        if let Some(before) = before {
            let kept: Vec<bool> = before.voxels().map(|v| occupancy.get(v)).collect();
            return before.restrict(|v| kept[v as usize]);
        }
        let mut links = Arc::unwrap_or_clone(self.links);
        for (axis, links) in links.iter_mut().enumerate() {
            for (at, word) in links.words_mut().iter_mut().enumerate() {
                *word &= inner_neighbours_of_word(&occupancy, axis, at);
            }
        }
        let cut = self.cut_diagonals.map(Arc::unwrap_or_clone);
        drop(self.numbering);
        Self::unchecked(self.frame, occupancy, links, cut).expect("fewer voxels than before")
    }

    /// The grid with only the voxels for which `keep` holds, and the links between them.
    pub fn restrict(&self, keep: impl Fn(u32) -> bool) -> Self {
        let (mut occupancy, mut links) =
            (BitGrid::clone(&self.occupancy), <[BitGrid; 3]>::clone(&self.links));
        let mut renumber = vec![u32::MAX; self.len];
        let (mut old, mut new) = (0u32, 0u32);
        for word in 0..self.occupancy.words().len() {
            let mut kept = 0;
            for bit in Bits(self.occupancy.words()[word]) {
                if keep(old) {
                    kept |= 1 << bit;
                    renumber[old as usize] = new;
                    new += 1;
                }
                old += 1;
            }
            occupancy.words_mut()[word] = kept;
        }
        for (axis, links) in links.iter_mut().enumerate() {
            let allowed = inner_neighbours(&occupancy, axis);
            for (link, allowed) in links.words_mut().iter_mut().zip(allowed.words()) {
                *link &= allowed;
            }
        }
        let renumbered = |pair: &[u32; 2]| pair.map(|v| renumber[v as usize]);
        let cut = self
            .cut_diagonals()
            .map(|cut| cut.iter().map(renumbered).filter(|pair| !pair.contains(&u32::MAX)).collect());
        Self::unchecked(self.frame, occupancy, links, cut).expect("fewer voxels than before")
    }
}

fn check_size(frame: &Frame, bits: &BitGrid) -> Result<(), ShapeError> {
    match (0..3).find(|&a| bits.dims()[a] != frame.dims()[a]) {
        Some(a) => Err(ShapeError::SizeMismatch {
            what: "voxels along an axis",
            found: bits.dims()[a],
            expected: frame.dims()[a],
        }),
        None => Ok(()),
    }
}

/// The voxels whose neighbour along +axis is inside too.
fn inner_neighbours(inside: &BitGrid, axis: usize) -> BitGrid {
    let mut result = inside.clone();
    for (at, bits) in result.words_mut().iter_mut().enumerate().filter(|(_, bits)| **bits != 0) {
        *bits = inner_neighbours_of_word(inside, axis, at);
    }
    result
}

#[inline]
fn inner_neighbours_of_word(inside: &BitGrid, axis: usize, at: usize) -> u64 {
    let (row, words) = (inside.row_words(), inside.words());
    let [_, ny, nz] = inside.dims();
    let next = match axis {
        0 => words[at] >> 1 | if at % row + 1 < row { words[at + 1] << 63 } else { 0 },
        1 if at / row % ny + 1 < ny => words[at + row],
        2 if at / (row * ny) + 1 < nz => words[at + row * ny],
        _ => 0,
    };
    words[at] & next
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(dims: [usize; 3]) -> Frame {
        Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap()
    }

    fn solid(dims: [usize; 3]) -> VoxelGrid {
        VoxelGrid::solid(frame(dims), BitGrid::full(dims).unwrap()).unwrap()
    }

    #[test]
    fn the_graph_of_faces_is_that_of_all_linked_pairs() {
        let mut random = crate::SplitMix64::new(7);
        for dims in [[1, 1, 1], [70, 3, 4], [5, 9, 6]] {
            let mut inside = BitGrid::empty(dims).unwrap();
            let all = solid(dims);
            all.voxels().filter(|_| random.uniform() < 0.7).for_each(|voxel| inside.set(voxel, true));
            let mut grid = VoxelGrid::solid(frame(dims), inside).unwrap();
            for axis in 0..3 {
                let cut: Vec<[u32; 3]> = grid.voxels().filter(|_| random.uniform() < 0.2).collect();
                grid = grid.with_cut_links(axis, &cut).0;
            }
            let edges: Vec<[u32; 2]> = (0..3).flat_map(|axis| grid.linked_pairs(axis)).collect();
            let expected = Graph::from_edges(grid.len(), &edges);
            assert_eq!(grid.graph(Connectivity::Six), expected);
            let all: Vec<_> = grid.faces(0..grid.len() as u32).collect();
            for voxel in 0..grid.len() as u32 {
                assert_eq!(grid.faces_of(voxel), all[voxel as usize]);
            }
            for range in [0..1, 0..0, 3..40, 20..grid.len() as u32] {
                let range = range.start.min(grid.len() as u32)..range.end.min(grid.len() as u32);
                let expected = &all[range.start as usize..range.end.max(range.start) as usize];
                assert_eq!(grid.faces(range).collect::<Vec<_>>(), expected);
            }
        }
    }

    #[test]
    fn a_box_has_the_links_of_a_grid_graph() {
        let grid = solid([67, 4, 3]);
        let counts: Vec<usize> = (0..3).map(|a| grid.linked_pairs(a).count()).collect();
        assert_eq!(counts, [66 * 4 * 3, 67 * 3 * 3, 67 * 4 * 2]);
        let graph = grid.graph(Connectivity::Six).unwrap();
        assert_eq!(graph.edge_count(), counts.iter().sum::<usize>());
        assert_eq!(graph.neighbours(1), [0, 2, 68, 67 * 4 + 1]);
    }

    #[test]
    fn a_cube_of_27_voxels_has_26_neighbours_in_its_middle() {
        let graph = solid([3, 3, 3]).graph(Connectivity::TwentySix).unwrap();
        assert_eq!(graph.neighbours(13).len(), 26);
        assert_eq!(graph.neighbours(0).len(), 7);
    }

    #[test]
    fn voxels_are_numbered_x_fastest() {
        let grid = solid([70, 2, 2]).restrict(|v| v % 3 == 1);
        for (number, voxel) in grid.voxels().enumerate() {
            assert_eq!(grid.index(voxel), Some(number as u32));
            assert_eq!(grid.voxel(number as u32), voxel);
        }
        let all: Vec<[u32; 3]> = grid.voxels().collect();
        let numbers = [0, 1, 2, 40, 41, 45, 90, 91, 3, 2, 2, 60];
        assert!(grid.voxels_of(&numbers).eq(numbers.iter().map(|&number| all[number as usize])));
        assert_eq!(grid.index([0, 0, 0]), None);
        assert_eq!(grid.index([70, 0, 0]), None);
    }

    #[test]
    fn a_cut_link_parts_two_components() {
        let mut links: [BitGrid; 3] = std::array::from_fn(|_| BitGrid::empty([4, 1, 1]).unwrap());
        links[0].set([0, 0, 0], true);
        links[0].set([2, 0, 0], true);
        let grid =
            VoxelGrid::new(frame([4, 1, 1]), BitGrid::full([4, 1, 1]).unwrap(), links.clone()).unwrap();
        assert_eq!(grid.components().labels, [0, 0, 1, 1]);
        let solid = VoxelGrid::solid(frame([4, 1, 1]), BitGrid::full([4, 1, 1]).unwrap()).unwrap();
        let (cut, count) = solid.with_cut_links(0, &[[1, 0, 0], [3, 0, 0]]);
        assert_eq!((cut, count), (grid.clone(), 1));
        let half = grid.restrict(|v| v >= 2);
        assert_eq!(half.linked_pairs(0).collect::<Vec<_>>(), [[0, 1]]);
        assert_eq!(grid.graph(Connectivity::TwentySix), Err(ShapeError::DiagonalsUnknown));

        links[0].set([3, 0, 0], true);
        let dangling = VoxelGrid::new(frame([4, 1, 1]), BitGrid::full([4, 1, 1]).unwrap(), links);
        assert_eq!(dangling, Err(ShapeError::DanglingLink { voxel: [3, 0, 0], axis: 0 }));
    }

    #[test]
    fn cut_diagonals_follow_a_restriction() {
        let grid = solid([2, 2, 1]).with_cut_diagonals(vec![[0, 3]]).unwrap();
        assert_eq!(grid.graph(Connectivity::TwentySix).unwrap().edge_count(), 5);
        let rest = grid.restrict(|v| v != 1);
        assert_eq!(rest.cut_diagonals(), Some(&[[0, 2]][..]));
    }
}
