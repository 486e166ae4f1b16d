use mser3d_shape::vector::{dot, sub};
use mser3d_shape::{Domain, TriangleMesh};
use sprs::{CsMat, TriMat};

use crate::{LaplaceError, Operator};

/// The cotangent Laplacian of a mesh with lumped (barycentric) masses, section 3.1 (Pinkall & Polthier 1993).
///
/// W_uv = -(cot a + cot b)/2 over the angles opposite to edge uv, the diagonal is minus the sum of the row's
/// other entries, and M_v is a third of the area of the triangles around v. W is the sum of the linear finite
/// elements' matrices, so it is positive semidefinite on any mesh: open, non-manifold (an edge sums over all
/// its triangles) or badly oriented.
///
/// ```
/// use mser3d_laplace::cotangent_laplacian;
/// use mser3d_shape::TriangleMesh;
///
/// // An equilateral triangle: each edge is opposite to one angle of 60 degrees.
/// let corners = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.75f64.sqrt(), 0.0]];
/// let operator = cotangent_laplacian(&TriangleMesh::new(corners, vec![[0, 1, 2]])?)?;
/// let weight = operator.stiffness().get(0, 1).copied().unwrap_or(0.0);
/// assert!((weight + 0.5 / 3f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A triangle whose area is below 1e-14 of its longest edge squared counts as degenerate and adds
/// nothing; a vertex with only such triangles, or none, has no mass and takes no part.
///
/// # Errors
/// [`LaplaceError::NoArea`] when every triangle is degenerate.
pub fn cotangent_laplacian(mesh: &TriangleMesh) -> Result<Operator, LaplaceError> {
    let n = mesh.vertices().len();
    let mut entries = TriMat::with_capacity((n, n), 12 * mesh.triangles().len());
    let mut mass = vec![0.0; n];
    let mut degenerate = 0;
    for (t, triangle) in mesh.triangles().iter().enumerate() {
        let corners = mesh.corners(t);
        let edge = |i: usize| -> [f64; 3] { sub(corners[(i + 2) % 3], corners[(i + 1) % 3]) };
        let edges: [[f64; 3]; 3] = std::array::from_fn(edge); // edge i lies opposite to corner i
        let area = mesh.triangle_area(t);
        let longest = edges.iter().map(|e| dot(*e, *e)).fold(0.0, f64::max);
        if area.is_nan() || area <= 1e-14 * longest {
            degenerate += 1;
            continue;
        }
        for i in 0..3 {
            mass[triangle[i] as usize] += area / 3.0;
            let (u, v) = (triangle[(i + 1) % 3] as usize, triangle[(i + 2) % 3] as usize);
            // Half the cotangent at corner i: the edges away from it are -edge(i+1) and edge(i+2).
            let half_cot = -dot(edges[(i + 1) % 3], edges[(i + 2) % 3]) / (4.0 * area);
            for (row, column, value) in
                [(u, u, half_cot), (v, v, half_cot), (u, v, -half_cot), (v, u, -half_cot)]
            {
                entries.add_triplet(row, column, value);
            }
        }
    }
    if degenerate == mesh.triangles().len() {
        return Err(LaplaceError::NoArea { triangles: degenerate });
    }
    let mut stiffness: CsMat<f64> = entries.to_csc();
    // Entries summed in another order differ in the last bit across the diagonal: make W exactly
    // symmetric, and its rows sum to zero as well as rounding allows.
    symmetrize(&mut stiffness);
    Ok(Operator::assembled(Domain::Surface, stiffness, mass))
}

/// Copies the lower triangle to the upper one and sets the diagonal to minus the rest of its column.
fn symmetrize(matrix: &mut CsMat<f64>) {
    let lower = matrix.clone();
    for (column, mut vector) in matrix.outer_iterator_mut().enumerate() {
        let mut sum = 0.0;
        for (row, value) in vector.iter_mut() {
            if row < column {
                *value = lower.get(column, row).copied().unwrap_or(0.0);
            }
            if row != column {
                sum += *value;
            }
        }
        for (row, value) in vector.iter_mut() {
            if row == column {
                *value = -sum;
            }
        }
    }
}
