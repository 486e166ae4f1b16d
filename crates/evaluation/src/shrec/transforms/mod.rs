//! The transforms of the benchmark, one file per class or family.

mod class;
mod decimate;
mod holes;
mod noise;
mod partial;
mod random;
mod rasterize;
mod topology;
mod transformed;
mod warp;

use mser3d_shape::{BoundingBox, InvalidParameter, TriangleMesh};

pub use class::Class;
pub use transformed::Transformed;
pub use warp::SpaceMap;

use random::Random;

use crate::EvaluationError;

/// The null shape under a transform. The same arguments give the same shape, on every machine.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// use mser3d_evaluation::shrec::{Class, transform};
///
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let null = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let twice = transform(&null, Class::Scaling, 5, 1)?;
/// assert_eq!(twice.mesh.signed_volume(), 8.0 * null.signed_volume());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EvaluationError::InvalidParameter`] for a strength beyond 1 to 5; [`EvaluationError::NoSurface`] for a mesh
/// without area, or of which nothing would be left; [`EvaluationError::PoseNeeded`] for
/// [`Class::Isometry`].
pub fn transform(
    null: &TriangleMesh,
    class: Class,
    strength: u32,
    seed: u64,
) -> Result<Transformed, EvaluationError> {
    let sizes = Sizes::new(null, class, strength)?;
    let (s, diagonal) = (sizes.strength, sizes.diagonal);
    let random = &mut Random::new(&[seed, class as u64, strength.into()]);
    let transformed = match class {
        Class::Affine | Class::Localscale | Class::Scaling => {
            let map = sizes.map(null, class, random).ok_or(EvaluationError::PoseNeeded)?;
            warp::mapped(null, &map)
        }
        Class::Holes => holes::holes(null, 2 * strength as usize, 0.04 * diagonal, random),
        Class::Isometry => return Err(EvaluationError::PoseNeeded),
        Class::Microholes => holes::microholes(null, 0.02 * s, random),
        Class::Noise => noise::noise(null, 0.002 * s * diagonal, random),
        Class::Partial => partial::partial(null, 1.0 - 0.08 * s, random),
        Class::Rasterize => rasterize::rasterize(null, 0.0025 * (s + 1.0) * diagonal),
        Class::Sampling => decimate::sampling(null, [0.6, 0.35, 0.2, 0.1, 0.04][strength as usize - 1]),
        Class::Shotnoise => noise::shotnoise(null, 0.004 * s, 0.02 * diagonal, random),
        Class::Topology => topology::topology(null, 2 * strength as usize, 0.012 * diagonal, random),
        Class::View => partial::view(null, strength, seed),
    }?;
    if transformed.mesh.triangles().is_empty() {
        return Err(EvaluationError::NoSurface { class });
    }
    Ok(transformed)
}

/// Where a point of the null shape's solid is on the transformed shape: the correspondence of volumes.
/// `None` for [`Class::Isometry`], which has none. All but [`Class::Affine`], [`Class::Localscale`] and
/// [`Class::Scaling`] leave every point where it is, even those next to the surface, which may then be
/// outside.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// use mser3d_evaluation::shrec::{Class, space_map};
///
/// # let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// # let null = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let twice = space_map(&null, Class::Scaling, 5, 1)?;
/// assert_eq!(twice.map(|map| map([0.1, 0.2, 0.3])), Some([0.2, 0.4, 0.6]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`transform`], but none for a pose.
pub fn space_map(
    null: &TriangleMesh,
    class: Class,
    strength: u32,
    seed: u64,
) -> Result<Option<SpaceMap>, EvaluationError> {
    let random = &mut Random::new(&[seed, class as u64, strength.into()]);
    Ok(Sizes::new(null, class, strength)?.map(null, class, random))
}

/// The sizes that a transform depends on.
struct Sizes {
    strength: f64,
    diagonal: f64,
}

impl Sizes {
    fn new(null: &TriangleMesh, class: Class, strength: u32) -> Result<Self, EvaluationError> {
        InvalidParameter::unless((1..=5).contains(&strength), "strength", strength, "1 to 5")?;
        let diagonal = null.bounding_box().as_ref().map_or(0.0, BoundingBox::diagonal);
        if !(null.area() > 0.0 && diagonal.is_finite()) {
            return Err(EvaluationError::NoSurface { class });
        }
        Ok(Self { strength: strength.into(), diagonal })
    }

    fn map(&self, null: &TriangleMesh, class: Class, random: &mut Random) -> Option<SpaceMap> {
        let s = self.strength;
        Some(match class {
            Class::Isometry => return None,
            Class::Affine => warp::affine(0.1 * s, random),
            Class::Localscale => warp::localscale(null, s, 0.15 * self.diagonal, random),
            Class::Scaling => warp::scaling([0.5, 0.875, 1.25, 1.625, 2.0][s as usize - 1]),
            _ => Box::new(|p| p),
        })
    }
}

/// Another pose of the null shape, with the same vertices in the same order.
///
/// # Errors
/// [`EvaluationError::SizeMismatch`] when the pose has other triangles.
pub fn isometry(null: &TriangleMesh, pose: &TriangleMesh) -> Result<Transformed, EvaluationError> {
    if pose.triangles() != null.triangles() {
        let (found, expected) = (pose.triangles().len(), null.triangles().len());
        return Err(EvaluationError::SizeMismatch {
            what: "triangles of a pose equal to the null shape's",
            found,
            expected,
        });
    }
    Transformed::moved(null, pose.vertices().to_vec())
}
