//! A solid taken apart into solids of their own.

use crate::{BitGrid, ShapeError, VoxelGrid};

/// A part under way: its box, then its voxels and links.
struct Part {
    low: [u32; 3],
    high: [u32; 3],
    len: u32,
}

impl VoxelGrid {
    /// The voxels of each label as a solid on its own, which fills its box: label l is the l-th solid. Labels of
    /// `count` and above belong to none. Voxels keep their order, and links within a label stay.
    ///
    /// # Errors
    /// [`ShapeError::SizeMismatch`] unless there is a label for each voxel.
    ///
    /// ```
    /// use mser3d_shape::{BitGrid, Frame, VoxelGrid};
    ///
    /// // A rod of six voxels, broken in two.
    /// let rod = VoxelGrid::solid(Frame::new([6, 1, 1], [0.0; 3], [0.5; 3])?, BitGrid::full([6, 1, 1])?)?;
    /// let halves = rod.split(&[0, 0, 0, 0, 1, 1], 2)?;
    /// assert_eq!((halves[0].len(), halves[1].len()), (4, 2));
    /// assert_eq!(halves[1].frame().origin(), [2.0, 0.0, 0.0]);
    /// # Ok::<(), mser3d_shape::ShapeError>(())
    /// ```
    pub fn split(&self, labels: &[u32], count: usize) -> Result<Vec<Self>, ShapeError> {
        if labels.len() != self.len() {
            let (found, expected) = (labels.len(), self.len());
            return Err(ShapeError::SizeMismatch { what: "labels of voxels", found, expected });
        }
        let mut parts: Vec<Part> =
            (0..count).map(|_| Part { low: [u32::MAX; 3], high: [0; 3], len: 0 }).collect();
        // The number of each voxel within its part.
        let mut numbers = vec![0u32; self.len()];
        for ((voxel, &label), number) in self.voxels().zip(labels).zip(&mut numbers) {
            let Some(part) = parts.get_mut(label as usize) else { continue };
            *number = part.len;
            part.len += 1;
            for a in 0..3 {
                (part.low[a], part.high[a]) = (part.low[a].min(voxel[a]), part.high[a].max(voxel[a]));
            }
        }
        let dims = |part: &Part| -> [usize; 3] {
            std::array::from_fn(|a| if part.len == 0 { 0 } else { (part.high[a] - part.low[a] + 1) as usize })
        };
        let empty = |part: &Part| BitGrid::empty(dims(part));
        let mut bits: Vec<[BitGrid; 4]> = Vec::with_capacity(count);
        for part in &parts {
            bits.push([empty(part)?, empty(part)?, empty(part)?, empty(part)?]);
        }
        for ((voxel, &label), number) in self.voxels().zip(labels).zip(0u32..) {
            let Some(part) = parts.get(label as usize) else { continue };
            let place = std::array::from_fn(|a| voxel[a] - part.low[a]);
            let [inside, links @ ..] = &mut bits[label as usize];
            inside.set(place, true);
            for axis in 0..3 {
                if self.links()[axis].get(voxel) {
                    let mut next = voxel;
                    next[axis] += 1;
                    let other = if axis == 0 { Some(number + 1) } else { self.index(next) };
                    let stays = other.is_some_and(|v| labels[v as usize] == label);
                    links[axis].set(place, stays);
                }
            }
        }
        let mut cut: Option<Vec<Vec<[u32; 2]>>> = self.cut_diagonals().map(|_| vec![Vec::new(); count]);
        if let (Some(lists), Some(pairs)) = (&mut cut, self.cut_diagonals()) {
            for &[u, v] in pairs {
                let label = labels[u as usize];
                if label == labels[v as usize]
                    && let Some(list) = lists.get_mut(label as usize)
                {
                    list.push([numbers[u as usize], numbers[v as usize]]);
                }
            }
        }
        let made = parts.iter().zip(bits).enumerate().map(|(label, (part, [inside, x, y, z]))| {
            let corner = if part.len == 0 { [0; 3] } else { part.low };
            let grid = Self::new(self.frame().part(corner, dims(part)), inside, [x, y, z])?;
            match &mut cut {
                Some(lists) => grid.with_cut_diagonals(std::mem::take(&mut lists[label])),
                None => Ok(grid),
            }
        });
        made.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Affine, Connectivity, Frame, SplitMix64};

    #[test]
    fn parts_have_the_links_of_the_whole() {
        let dims = [70, 6, 5];
        let mut random = SplitMix64::new(3);
        let mut inside = BitGrid::empty(dims).unwrap();
        let mut cuts: [Vec<[u32; 3]>; 3] = Default::default();
        for voxel in BitGrid::full(dims).unwrap().ones() {
            inside.set(voxel, random.uniform() < 0.8);
            (0..3).filter(|_| random.uniform() < 0.3).for_each(|a| cuts[a].push(voxel));
        }
        // Axes along -y, z and -x.
        let affine =
            Affine::new([[0.0, 0.0, -2.0, 1.0], [-0.5, 0.0, 0.0, -2.0], [0.0, 1.0, 0.0, 0.5]]).unwrap();
        let frame = Frame::placed(dims, &affine).unwrap();
        let mut grid = VoxelGrid::solid(frame, inside).unwrap();
        for axis in 0..3 {
            grid = grid.with_cut_links(axis, &cuts[axis]).0;
        }
        let pairs: Vec<[u32; 2]> = grid.diagonal_pairs().step_by(3).collect();
        let grid = grid.with_cut_diagonals(pairs).unwrap();
        let labels: Vec<u32> = (0..grid.len()).map(|_| (4.0 * random.uniform()) as u32).collect();
        let parts = grid.split(&labels, 3).unwrap();
        for (label, part) in (0..).zip(&parts) {
            let expected = grid.restrict(|v| labels[v as usize] == label);
            for connectivity in [Connectivity::Six, Connectivity::TwentySix] {
                assert_eq!(part.graph(connectivity), expected.graph(connectivity));
            }
            for (a, b) in part.voxels().zip(expected.voxels()) {
                assert_eq!(part.frame().centre(a), frame.centre(b));
            }
        }
        assert!(grid.split(&labels[1..], 3).is_err());
        assert_eq!(grid.split(&vec![9; grid.len()], 1).unwrap()[0].len(), 0);
    }
}
