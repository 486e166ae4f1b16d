//! Chebyshev polynomials of the grid Laplacian, applied to blocks of vectors without a matrix.

use crate::row::Row;
use crate::stencil::{SlicedStencil, Step};
use crate::temporal_blocking::{self, Tiling};

/// A Chebyshev polynomial of degree `degree` in A, small on `[cutoff, bound]` and scaled to 1 at `target`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Polynomial {
    pub degree: usize,
    pub target: f64,
    pub cutoff: f64,
}

impl Polynomial {
    /// The growth of the polynomial from the cutoff to `lambda` below it, per degree, as a logarithm.
    pub fn rate(lambda: f64, cutoff: f64, bound: f64) -> f64 {
        let x = (bound + cutoff - 2.0 * lambda) / (bound - cutoff);
        if x > 1.0 { x.acosh() } else { 0.0 }
    }

    /// `x = p(A) x`; `work` is of the size of x and holds rubbish afterwards. Asks now and then whether
    /// it was `cancelled`, and then stops with rubbish in x. Up to `parts` threads share the rows.
    pub fn apply<R: Row>(
        self,
        stencil: &SlicedStencil,
        tiling: Tiling,
        parts: usize,
        x: &mut [R],
        work: &mut [R],
        cancelled: &(dyn Fn() -> bool + Sync),
    ) {
        // An even number of steps leaves the result in x.
        let (mut first, mut second) = (x, work);
        for steps in self.steps(stencil.bound()).chunks(tiling.steps) {
            if cancelled() {
                return;
            }
            temporal_blocking::run(stencil, tiling, parts, steps, first, second);
            if steps.len() % 2 == 1 {
                std::mem::swap(&mut first, &mut second);
            }
        }
    }

    /// The scaled recurrence (Zhou, Saad, Tiago & Chelikowsky 2006), an even number of steps.
    fn steps(self, bound: f64) -> Vec<Step> {
        let (e, c) = ((bound - self.cutoff) / 2.0, (bound + self.cutoff) / 2.0);
        let first = e / (self.target - c);
        let mut sigma = first;
        let mut steps = vec![Step { a: first / e, x: -c * first / e, previous: 0.0 }];
        for _ in 1..self.degree.next_multiple_of(2) {
            let next = 1.0 / (2.0 / first - sigma);
            steps.push(Step { a: 2.0 * next / e, x: -2.0 * next * c / e, previous: -sigma * next });
            sigma = next;
        }
        steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::row::{LANES, Lanes};
    use mser3d_shape::{BitGrid, Frame, VoxelGrid};

    #[test]
    fn filters_a_cosine_of_a_box_by_the_polynomials_value() {
        let dims = [23, 9, 70];
        let frame = Frame::new(dims, [0.0; 3], [0.5; 3]).unwrap();
        let grid = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
        let stencil = SlicedStencil::new(&grid);
        let voxels: Vec<_> = grid.voxels().collect();
        // Lane l holds the eigenvector of wave number l + 1 along x.
        let angle = |l: usize| std::f64::consts::PI * (l + 1) as f64 / 23.0;
        let lambda = |l: usize| (2.0 - 2.0 * angle(l).cos()) / 0.25;
        let value = |v: u32, l: usize| ((f64::from(voxels[v as usize][0]) + 0.5) * angle(l)).cos();
        let start: Vec<Lanes> =
            stencil.order.iter().map(|&v| Lanes(std::array::from_fn(|l| value(v, l)))).collect();
        let whole = Tiling::new::<Lanes>(&stencil);
        // Tiles narrower than a wave is long, of all widths that leave something over.
        let tiles = [(8, 1), (8, 3), (5, 4), (3, 8), (16, 9)].map(|(steps, lines)| Tiling { steps, lines });
        let plain = [(2, 1), (7, 1), (40, 1), (7, 2), (40, 2), (40, 3)].map(|(d, parts)| (d, parts, whole));
        let tiled = tiles.iter().flat_map(|&tiling| [1, 2].map(|parts| (40, parts, tiling)));
        let mut same: Vec<Vec<Lanes>> = Vec::new();
        for (degree, parts, tiling) in plain.into_iter().chain(tiled) {
            let p = Polynomial { degree, target: lambda(0), cutoff: 6.0 };
            let (mut x, mut work) = (start.clone(), vec![Lanes([1e3; LANES]); start.len()]);
            p.apply(&stencil, tiling, parts, &mut x, &mut work, &|| false);
            if degree == 40 {
                same.push(x.clone());
            }
            let (e, c) = ((48.0 - 6.0) / 2.0, 27.0);
            let chebyshev = |t: f64| -> f64 {
                let d = degree.next_multiple_of(2) as f64;
                if t.abs() <= 1.0 {
                    (d * t.acos()).cos()
                } else {
                    t.signum().powf(d) * (d * t.abs().acosh()).cosh()
                }
            };
            for l in 0..LANES {
                let factor = chebyshev((lambda(l) - c) / e) / chebyshev((lambda(0) - c) / e);
                for row in (0..x.len()).step_by(97) {
                    assert!(
                        (x[row].0[l] - factor * start[row].0[l]).abs() < 1e-11,
                        "degree {degree} lane {l}"
                    );
                }
            }
        }
        assert!(same.iter().all(|x| *x == same[0]), "tiles and threads change no bit");
    }
}
