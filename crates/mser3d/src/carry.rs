//! From the vertices of a mesh to the elements of a shape.

use mser3d_laplace::grid_laplacian;
use mser3d_shape::vector::{add, dot, norm, scale, sub};
use mser3d_shape::{TriangleMesh, VoxelGrid};

use crate::{DiscreteShape, Elements, Error, Field};

/// Samples of the surface for each voxel of the solid, at most; each triangle may have one more.
const SAMPLES: f64 = 32.0;

impl DiscreteShape {
    /// A field on the elements from one on the vertices of the mesh that the shape is made of, in file order.
    ///
    /// * On a surface, elements are vertices. Vertices that were welded to one give their mean.
    /// * In a volume, the values lie on its boundary and are continued inside. The field is interpolated over each triangle and
    ///   sampled (two samples along a voxel or more); a voxel that is the nearest one to samples gets their mean, weighted
    ///   by area. All others get the harmonic function with these values, the temperature that a body would have whose surface
    ///   is kept at the field: smooth, without new extremes, and on the axis of a limb the mean of the skin around it.
    ///   (The nearest vertex alone would leave jumps along the middle of each limb, and voxels' worth of steps where
    ///   triangles are large.) Triangles of bodies that are not part of the shape count for nothing.
    ///
    /// ```
    /// use mser3d::{DiscreteShape, Field};
    /// # use mser3d::shape::TriangleMesh;
    /// # fn run(mesh: &TriangleMesh) -> Result<(), mser3d::Error> {
    /// let (solid, _) = DiscreteShape::volume(mesh, &Default::default())?;
    /// let heights = Field::scalar(mesh.vertices().iter().map(|p| p[2]).collect())?;
    /// // Height is harmonic: inside it is, nearly, the height of the voxels.
    /// let inside = solid.carry(&heights)?;
    /// assert_eq!(inside.len(), solid.len());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// [`Error::FieldLength`]; [`Error::NoMesh`] for a solid that never had one.
    pub fn carry(&self, field: &Field) -> Result<Field, Error> {
        let expected = self.element_of_vertex().len();
        match (self.elements(), self.mesh()) {
            (Elements::Voxels { .. }, None) => Err(Error::NoMesh),
            (Elements::Voxels { grid, .. }, Some(mesh)) => {
                field.expect("vertices in the mesh", expected)?;
                let sums = self.on_boundary(grid, mesh, field);
                let (operator, width) = (grid_laplacian(grid), field.width());
                field.with_components(|c| {
                    let mean = |sums: &[f64]| (sums[width] > 0.0).then(|| sums[c] / sums[width]);
                    Ok(operator.harmonic(&sums.chunks_exact(width + 1).map(mean).collect::<Vec<_>>())?)
                })
            }
            (Elements::Vertices { .. }, _) => {
                field.expect("vertices in the mesh", expected)?;
                field.with_components(|c| Ok(self.means_of_welded(&field.component(c))))
            }
        }
    }

    /// The mean value of the vertices that are one element.
    fn means_of_welded(&self, values: &[f64]) -> Vec<f64> {
        let (mut sums, mut counts) = (vec![0.0; self.len()], vec![0u32; self.len()]);
        for (element, value) in self.element_of_vertex().iter().zip(values) {
            if let Some(element) = *element {
                sums[element as usize] += value;
                counts[element as usize] += 1;
            }
        }
        sums.iter().zip(&counts).map(|(sum, &count)| sum / f64::from(count.max(1))).collect()
    }

    /// For each voxel the sum of the field over the part of the surface that is nearest to it, and the area of that part.
    fn on_boundary(&self, grid: &VoxelGrid, mesh: &TriangleMesh, field: &Field) -> Vec<f64> {
        let width = field.width();
        let mut sums = vec![0.0; grid.len() * (width + 1)];
        let nearest = grid.nearest();
        let step = sample_distance(grid, mesh);
        for (t, triangle) in mesh.triangles().iter().enumerate() {
            let searched = |&v: &u32| self.element_of_vertex()[v as usize].is_some();
            if !triangle.iter().all(searched) {
                continue;
            }
            for_each_sample(mesh.corners(t), step, |weights, place, area| {
                let Some(voxel) = nearest.voxel(place) else { return };
                let sums = &mut sums[voxel as usize * (width + 1)..][..=width];
                for (&v, share) in triangle.iter().zip(weights) {
                    for (sum, value) in sums.iter_mut().zip(field.at(v as usize)) {
                        *sum += share * area * value;
                    }
                }
                sums[width] += area;
            });
        }
        sums
    }
}

/// How far apart samples may lie: half a voxel, or farther where the surface is much larger than the solid.
fn sample_distance(grid: &VoxelGrid, mesh: &TriangleMesh) -> f64 {
    let finest = grid.frame().spacing().into_iter().fold(f64::INFINITY, f64::min);
    let most = SAMPLES * grid.len() as f64 + 2.0 * mesh.triangles().len() as f64;
    let mut step = finest / 2.0;
    let samples = |step: f64| -> f64 {
        (0..mesh.triangles().len()).map(|t| Strips::of(mesh.corners(t), step).samples()).sum()
    };
    while samples(step) > most {
        step *= 2.0;
    }
    step
}

/// A triangle cut into strips along its longest edge.
struct Strips {
    /// The corner opposite to the longest edge, and that edge's ends.
    order: [usize; 3],
    /// Length of the edge in steps.
    length: f64,
    count: f64,
}

impl Strips {
    fn of(corners: [[f64; 3]; 3], step: f64) -> Self {
        let edge = |i: usize| sub(corners[(i + 2) % 3], corners[(i + 1) % 3]);
        let length = |i: usize| norm(edge(i));
        let apex = (0..3).fold(0, |longest, i| if length(i) > length(longest) { i } else { longest });
        let (base, side) = (edge(apex), sub(corners[apex], corners[(apex + 1) % 3]));
        let along = dot(base, side) / dot(base, base).max(f64::MIN_POSITIVE);
        let height = norm(sub(side, scale(base, along)));
        Self {
            order: [apex, (apex + 1) % 3, (apex + 2) % 3],
            length: length(apex) / step,
            count: (height / step).ceil().max(1.0),
        }
    }

    /// Samples, not less than there will be.
    fn samples(&self) -> f64 {
        self.count * (self.length + 1.0)
    }
}

/// Points of a triangle, not farther than `step` from each other along its strips: how much of each corner is in a point, where it
/// lies, and the area it stands for.
fn for_each_sample(corners: [[f64; 3]; 3], step: f64, mut at: impl FnMut([f64; 3], [f64; 3], f64)) {
    let Strips { order: [apex, b, c], length, count } = Strips::of(corners, step);
    let normal = mser3d_shape::vector::cross(sub(corners[b], corners[apex]), sub(corners[c], corners[apex]));
    // What has no area has a place, and a value, all the same: next to nothing against any area.
    let area = (0.5 * norm(normal)).max(1e-12 * step * step);
    for strip in 0..count as usize {
        // From the base (0) to the apex (1).
        let (low, high) = (strip as f64 / count, (strip + 1) as f64 / count);
        // That of the strip's centroid, so that the samples' mean is the triangle's.
        let (wide, narrow) = (1.0 - low, 1.0 - high);
        let height = low + (high - low) * (wide + 2.0 * narrow) / (3.0 * (wide + narrow));
        let share = wide * wide - narrow * narrow;
        let across = ((1.0 - height) * length).ceil().max(1.0);
        for i in 0..across as usize {
            let x = (i as f64 + 0.5) / across * (1.0 - height);
            let mut weights = [0.0; 3];
            (weights[apex], weights[b], weights[c]) = (height, 1.0 - height - x, x);
            let place = (0..3).map(|k| scale(corners[k], weights[k])).fold([0.0; 3], add);
            at(weights, place, area * share / across);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_share_out_a_triangle() {
        let corners = [[0.0, 0.0, 1.0], [6.0, 0.0, 1.0], [1.0, 2.0, 1.0]];
        for step in [0.1, 0.7, 100.0] {
            let (mut area, mut centre, mut count) = (0.0, [0.0; 3], 0.0);
            for_each_sample(corners, step, |weights, place, part| {
                assert!(
                    (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12 && weights.iter().all(|w| *w >= 0.0)
                );
                area += part;
                centre = add(centre, scale(place, part));
                count += 1.0;
            });
            assert!((area - 6.0).abs() < 1e-9);
            let [x, y, z] = scale(centre, 1.0 / area);
            assert!((x - 7.0 / 3.0).abs() < 1e-9 && (y - 2.0 / 3.0).abs() < 1e-9 && (z - 1.0).abs() < 1e-9);
            assert!(count <= Strips::of(corners, step).samples() + 1.0);
        }
    }

    #[test]
    fn a_needle_has_few_samples_and_a_triangle_without_area_one_at_least() {
        let mut count = 0;
        for_each_sample([[0.0; 3], [100.0, 0.0, 0.0], [50.0, 1e-6, 0.0]], 1.0, |_, _, _| count += 1);
        assert!((50..=100).contains(&count));
        let mut areas = Vec::new();
        for_each_sample([[1.0; 3]; 3], 1.0, |_, place, area| areas.push((place, area)));
        assert!(areas.len() == 1 && (0..3).all(|a| (areas[0].0[a] - 1.0).abs() < 1e-12) && areas[0].1 > 0.0);
    }
}
