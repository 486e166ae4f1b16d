//! Regions drawn as ellipses, as MSER of images are (Matas et al. 2002), and as ellipsoids.
use crate::Moments;

/// The ellipsoid with the volume's centroid and second moments: what a region is drawn as.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ellipsoid {
    /// Its centre: the centroid.
    pub centre: [f64; 3],
    /// Orthonormal directions of the axes, longest first.
    pub axes: [[f64; 3]; 3],
    /// Lengths of the semi-axes, longest first. Of a solid ellipsoid the very ones it has.
    pub semi_axes: [f64; 3],
}

impl Ellipsoid {
    /// The ellipsoid of a volume. A solid ellipsoid of semi-axis a has the variance a^2/5 along it, an
    /// ellipse in the plane a^2/4: `dimensions` is 3 or 2.
    ///
    /// ```
    /// use mser3d_comptree::{Ellipsoid, Moments};
    ///
    /// // A box of 8 x 2 x 2 has the variances of an ellipsoid of semi-axes sqrt(5/3) times half of that.
    /// let moments = Moments { volume: 32.0, centroid: [0.0; 3], covariance: [64. / 12., 0., 0., 4. / 12., 0., 4. / 12.] };
    /// let fit = Ellipsoid::fit(&moments, 3);
    /// assert!((fit.semi_axes[0] - 4.0 * (5.0f64 / 3.0).sqrt()).abs() < 1e-12);
    /// assert_eq!(fit.axes[0].map(f64::abs), [1.0, 0.0, 0.0]);
    /// ```
    pub fn fit(moments: &Moments, dimensions: u32) -> Self {
        let (values, vectors) = eigen(moments.matrix());
        let factor = f64::from(dimensions + 2);
        Self {
            centre: moments.centroid,
            axes: vectors,
            semi_axes: values.map(|variance| (factor * variance.max(0.0)).sqrt()),
        }
    }
}

/// Eigenvalues, largest first, and eigenvectors of a symmetric matrix by Jacobi's rotations.
fn eigen(mut a: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Convergence is quadratic: a handful of sweeps reach the last bit.
    for _ in 0..16 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q] == 0.0 {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for k in 0..3 {
                (a[p][k], a[q][k]) = (c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]);
                (rows[p][k], rows[q][k]) = (c * rows[p][k] - s * rows[q][k], s * rows[p][k] + c * rows[q][k]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[j][j].total_cmp(&a[i][i]));
    (order.map(|i| a[i][i]), order.map(|i| rows[i]))
}
