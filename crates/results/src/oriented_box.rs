use mser3d::Positions;
use mser3d::comptree::{Ellipsoid, Moments};
use mser3d_shape::vector::{add, dot, scale, sub};
use serde::{Deserialize, Serialize};

/// The smallest box around a region along its principal axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OrientedBox {
    /// Its centre, which is not the region's centre of mass.
    pub centre: [f64; 3],
    /// Its edges' lengths.
    pub size: [f64; 3],
    /// Their directions, of length 1: those in which the region spreads most, second and least.
    pub axes: [[f64; 3]; 3],
}

impl OrientedBox {
    /// The box around elements, at their places among `positions` and each with its mass. `half_edges` are half of a voxel's edges: the box holds
    /// whole voxels. Of a surface they are none.
    pub(crate) fn around(
        elements: &[u32],
        positions: Positions,
        mass: &[f64],
        half_edges: [[f64; 3]; 3],
    ) -> Self {
        let [mut total, mut centroid, mut covariance] = [[0.0; 6]; 3];
        let mut placed: Vec<[f64; 3]> = Vec::with_capacity(elements.len());
        positions.for_each_of(elements, |_, position| placed.push(position));
        for (&e, p) in elements.iter().zip(&placed) {
            let m = mass[e as usize];
            total[0] += m;
            (0..3).for_each(|a| centroid[a] += m * p[a]);
        }
        let centroid: [f64; 3] = std::array::from_fn(|a| centroid[a] / total[0]);
        for (&e, &position) in elements.iter().zip(&placed) {
            let (m, p) = (mass[e as usize], sub(position, centroid));
            for (place, (a, b)) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate() {
                covariance[place] += m * p[a] * p[b] / total[0];
            }
        }
        let moments = Moments { volume: total[0], centroid, covariance };
        let axes = Ellipsoid::fit(&moments, 3).axes;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for &position in &placed {
            let from = sub(position, centroid);
            for a in 0..3 {
                let along = dot(from, axes[a]);
                (low[a], high[a]) = (low[a].min(along), high[a].max(along));
            }
        }
        let reach = axes.map(|axis| half_edges.iter().map(|&half| dot(axis, half).abs()).sum::<f64>());
        let middle = |a: usize| (low[a] + high[a]) / 2.0;
        let centre = (0..3).fold(centroid, |c, a| add(c, scale(axes[a], middle(a))));
        Self { centre, size: std::array::from_fn(|a| high[a] - low[a] + 2.0 * reach[a]), axes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_box_is_its_own() {
        let (s, c) = 0.4f64.sin_cos();
        let steps = [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]];
        let mut positions = Vec::new();
        for i in 0..12 {
            for j in 0..6 {
                for k in 0..3 {
                    let along = |axis: usize, n: i32| scale(steps[axis], f64::from(n) + 0.5);
                    positions.push(add(add(along(0, i), along(1, j)), along(2, k)));
                }
            }
        }
        let elements: Vec<u32> = (0..positions.len() as u32).collect();
        let mass = vec![2.0; positions.len()];
        let found = OrientedBox::around(
            &elements,
            Positions::of_vertices(&positions),
            &mass,
            steps.map(|step| scale(step, 0.5)),
        );
        let expected = add(add(scale(steps[0], 6.0), scale(steps[1], 3.0)), scale(steps[2], 1.5));
        for a in 0..3 {
            assert!((found.size[a] - [12.0, 6.0, 3.0][a]).abs() < 1e-9, "{found:?}");
            assert!((found.centre[a] - expected[a]).abs() < 1e-9, "{found:?}");
            assert!((dot(found.axes[a], steps[a]).abs() - 1.0).abs() < 1e-9, "{found:?}");
        }
    }
}
