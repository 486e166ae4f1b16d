//! How vectors go from a level to the next coarser one and back.

use std::ops::AddAssign;

use super::level::{Columns, rows};
use crate::row::{LANES, Lanes, Short};

/// Between the rows of a level and their aggregates.
pub(super) struct Transfer {
    /// The aggregate of each row.
    pub aggregate: Vec<u32>,
    /// How far each row lies from the centre of its aggregate to that of the neighbour along each axis, in 127ths; negative before
    /// the centre.
    pub weights: Vec<[i8; 3]>,
    /// The neighbours of each aggregate along -x, +x, -y, +y, -z and +z to which most flows; the aggregate itself where there is none, or
    /// where cells are as long as the rows'.
    pub beside: Vec<[u32; 6]>,
    /// Where the rows of each aggregate begin, and their number.
    pub starts: Vec<u32>,
    /// The rows, by aggregate.
    pub children: Vec<u32>,
}

/// A row of numbers of either precision.
pub(super) trait Interpolate: Copy + Send + Sync {
    /// The first and some of the differences to the others.
    fn between(own: &Self, others: [&Self; 3], weights: [f32; 3]) -> Self;
}

impl Interpolate for Short {
    #[inline(always)]
    fn between(own: &Self, [x, y, z]: [&Self; 3], weights: [f32; 3]) -> Self {
        let [a, b, c] = weights;
        let rest = 1.0 - a - b - c;
        Self(std::array::from_fn(|l| rest * own.0[l] + a * x.0[l] + b * y.0[l] + c * z.0[l]))
    }
}

impl Interpolate for Lanes {
    #[inline(always)]
    fn between(own: &Self, [x, y, z]: [&Self; 3], weights: [f32; 3]) -> Self {
        let [a, b, c] = weights.map(f64::from);
        let rest = 1.0 - a - b - c;
        Self(std::array::from_fn(|l| rest * own.0[l] + a * x.0[l] + b * y.0[l] + c * z.0[l]))
    }
}

impl Transfer {
    /// Adds up the rows of each aggregate: the transpose of the constant interpolation.
    pub fn restrict(&self, coarse: &mut [Short], value: impl Fn(usize) -> Columns + Sync) {
        rows(
            coarse,
            #[inline(always)]
            |row, target| *target = Short(self.sum(row, &value)),
        );
    }

    /// The average of the rows of each aggregate of these masses, from their values times their masses.
    pub fn average(&self, coarse: &mut [Lanes], mass: &[f32], value: impl Fn(usize) -> [f64; LANES] + Sync) {
        rows(
            coarse,
            #[inline(always)]
            |row, target| *target = Lanes(self.sum(row, &value).map(|sum| sum / f64::from(mass[row]))),
        );
    }

    /// The sum over the rows of an aggregate.
    #[inline(always)]
    fn sum<T: Copy + Default + AddAssign>(
        &self,
        aggregate: usize,
        value: impl Fn(usize) -> [T; LANES],
    ) -> [T; LANES] {
        let mut sum = [T::default(); LANES];
        for &child in &self.children[self.starts[aggregate] as usize..self.starts[aggregate + 1] as usize] {
            let value = value(child as usize);
            (0..LANES).for_each(|l| sum[l] += value[l]);
        }
        sum
    }

    /// Linear interpolation to each row, between the centre of its aggregate and that of the neighbour on the row's side, along each axis.
    /// Where there is no neighbour the derivative is 0, as at a wall.
    pub fn interpolate<R: Interpolate, T: Send>(
        &self,
        coarse: &[R],
        fine: &mut [T],
        set: impl Fn(&mut T, R) + Sync,
    ) {
        rows(
            fine,
            #[inline(always)]
            |row, target| {
                let (own, weights) = (self.aggregate[row] as usize, self.weights[row]);
                let beside = &self.beside[own];
                let others = std::array::from_fn(|axis| {
                    &coarse[beside[2 * axis + usize::from(weights[axis] > 0)] as usize]
                });
                set(
                    target,
                    R::between(&coarse[own], others, weights.map(|weight| f32::from(weight.abs()) / 127.0)),
                );
            },
        );
    }
}
