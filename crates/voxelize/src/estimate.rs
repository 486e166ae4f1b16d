//! What a voxelization will cost, before it is made.

use crate::cancel::{CheckFn, Stop};
use crate::centre_lattice::CentreLattice;
use crate::error::VoxelizeError;
use crate::hole_corrections::winding_work;
use crate::inside_rule::InsideRule;
use crate::inside_test::InsideTest;
use crate::mesh_to_grid::{Prepared, prepare};
use crate::parameters::VoxelizeParameters;
use crate::triangle_geometry::area_vector;
use mser3d_shape::{Connectivity, TriangleMesh};

/// What [`voxelize`](crate::voxelize) will take, on one core.
///
/// A formula of counts, so the same every time: triangles, grid lines that cross the surface, voxels of the box,
/// and, where there are holes, the solid angles that winding numbers take, counted on a sample of the box.
/// Its constants were fitted to the processor time of a release build with one thread on a server's core, for
/// eleven shapes of 12 to 27,000 triangles (plates, bodies, two far balls, a tangle of tetrahedra), each closed,
/// with 5 % of its triangles missing, and cut in half, at 45,000 and 300,000 voxels; those of triangles and solid angles again for
/// five (ball, figure with limbs, plate, torus, person), of 12 to 33,000 triangles. They are within a factor of 2 of all of these five.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Cost {
    /// Voxels of the box along x, y and z.
    pub dims: [usize; 3],
    /// Processor time, in seconds.
    pub seconds: f64,
    /// Memory, in bytes.
    pub bytes: f64,
}

/// Seconds a triangle: edges, orientation, shells.
const TRIANGLE: f64 = 2.5e-7;
/// Seconds a crossing of a grid line with the surface.
const CROSSING: f64 = 3.5e-8;
/// Seconds a voxel of the box: its bits, four at a time.
const VOXEL: f64 = 7e-10;
/// Seconds a solid angle of a triangle seen from a voxel.
const SOLID_ANGLE: f64 = 3e-9;
/// Seconds a diagonal segment, ten for each voxel inside.
const SEGMENT: f64 = 1e-6;

/// What [`voxelize`](crate::voxelize) will cost with these parameters. Cheap, but for tangled meshes, which
/// are looked at on a coarse grid first.
///
/// # Errors
/// As [`voxelize`](crate::voxelize): whatever it refuses before it makes the grid.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// use mser3d_voxelize::{VoxelizeParameters, estimate};
///
/// let corners = vec![[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let cost = estimate(&mesh, &VoxelizeParameters::default(), &|| std::ops::ControlFlow::Continue(()))?;
/// assert_eq!(cost.dims, [67; 3]);
/// assert!(cost.seconds < 0.1 && cost.bytes < 1e7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn estimate(
    mesh: &TriangleMesh,
    parameters: &VoxelizeParameters,
    check: CheckFn,
) -> Result<Cost, VoxelizeError> {
    let stop = Stop::new(check);
    let prepared = prepare(mesh, parameters, &stop)?;
    let cost = cost(&prepared, parameters);
    stop.check()?;
    Ok(cost)
}

/// The cost of what is prepared already.
pub(crate) fn cost(prepared: &Prepared, parameters: &VoxelizeParameters) -> Cost {
    let Prepared { surface, frame, inside_test, rule, .. } = prepared;
    let (dims, spacing) = (frame.dims(), frame.spacing().map(|h| h * surface.scale));
    let voxels: f64 = dims.iter().map(|&n| n as f64).product();
    let triangles = surface.triangles.len() as f64;
    let mut crossings = [0.0; 3];
    for t in 0..surface.triangles.len() {
        let area = area_vector(&surface.corners(t));
        for d in 0..3 {
            crossings[d] += area[d].abs() * spacing[d] / spacing.iter().product::<f64>();
        }
    }
    let all_axes = parameters.cut_links || *inside_test == InsideTest::Vote;
    let swept = if all_axes { crossings.iter().sum() } else { crossings[0] };
    let angles = if *rule == InsideRule::Parity {
        0.0
    } else {
        winding_work(surface, &CentreLattice::new(frame, surface.scale, surface.reach))
    };
    let mut seconds = TRIANGLE * triangles + CROSSING * swept + VOXEL * voxels + SOLID_ANGLE * angles;
    if parameters.connectivity == Connectivity::TwentySix {
        let inside = surface.volume().abs() / spacing.iter().product::<f64>();
        seconds += 10.0 * SEGMENT * inside;
    }
    let most = crossings.into_iter().fold(0.0, f64::max);
    let holes = if surface.closed() || *rule == InsideRule::Parity { 0.0 } else { 2.0 * voxels };
    Cost { dims, seconds, bytes: 0.6 * voxels + holes + 150.0 * triangles + 24.0 * most }
}
