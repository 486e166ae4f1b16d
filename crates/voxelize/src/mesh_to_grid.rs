//! From a mesh to a solid of linked voxels: all stages in a row.

use crate::axis_sweep::MAX_TRIANGLES;
use crate::cancel::{CheckFn, NEVER, Stop};
use crate::centre_lattice::CentreLattice;
use crate::error::VoxelizeError;
use crate::grid_frame;
use crate::grid_topology::GridTopology;
use crate::inside_rule::InsideRule;
use crate::inside_test::{InsideTest, Reason, choose};
use crate::mesh_analysis::MeshAnalysis;
use crate::parameters::{Overlap, Pitch, VoxelizeParameters};
use crate::placed_surface::PlacedSurface;
use crate::surface::Surface;
use crate::voxel_fill::{Solid, solve, sweep};
use crate::voxelization::{Voxelization, warnings};
use mser3d_shape::{BitGrid, Connectivity, Frame, TriangleMesh, VoxelGrid};

/// Turns a mesh into a solid of linked voxels.
///
/// A voxel belongs to the solid when its centre lies inside; a centre exactly on the surface counts as
/// moved by an infinitesimal along +x (then +y, then +z). Neighbours inside are linked unless
/// the segment between their centres leaves the solid and comes back.
///
/// On closed meshes the result is that of exact arithmetic. Cost: O(triangles + crossings + box
/// voxels / 64), in parallel; the result does not depend on the number of threads. Memory: half a
/// byte for each voxel of the box, and about 40 bytes a triangle.
///
/// # Errors
/// [`VoxelizeError`]: a mesh without triangles or volume, a pitch too fine for the memory or for the
/// coordinates' precision, or so coarse that no centre lies inside.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// use mser3d_voxelize::{Pitch, VoxelizeParameters, voxelize};
///
/// let corners = vec![[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let parameters = VoxelizeParameters { pitch: Pitch::Voxels(10_000), ..Default::default() };
/// let solid = voxelize(&mesh, &parameters)?;
/// assert!((solid.grid.len() as f64 - 10_000.0).abs() < 200.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn voxelize(mesh: &TriangleMesh, parameters: &VoxelizeParameters) -> Result<Voxelization, VoxelizeError> {
    voxelize_with(mesh, parameters, NEVER)
}

/// As [`voxelize`], and stops when `check` breaks. It is asked often in all that takes long: sweeps, winding
/// numbers, links. Only the look at the triangles themselves is not interrupted, a second for some millions.
///
/// # Errors
/// As [`voxelize`], and [`VoxelizeError::Cancelled`].
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// use mser3d_voxelize::{VoxelizeError, VoxelizeParameters, voxelize_with};
/// use std::ops::ControlFlow;
///
/// let corners = vec![[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [0., 0., 4.]];
/// let mesh = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])?;
/// let stopped = voxelize_with(&mesh, &VoxelizeParameters::default(), &|| ControlFlow::Break(()));
/// assert_eq!(stopped, Err(VoxelizeError::Cancelled));
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn voxelize_with(
    mesh: &TriangleMesh,
    parameters: &VoxelizeParameters,
    check: CheckFn,
) -> Result<Voxelization, VoxelizeError> {
    let stop = &Stop::new(check);
    let Prepared { analysis, surface, frame, rule, inside_test, reason } = prepare(mesh, parameters, stop)?;
    let lattice = CentreLattice::new(&frame, surface.scale, surface.reach);
    let placed = PlacedSurface::new(&surface, &lattice, rule, parameters.cut_links, stop);
    let mut solid = solve(&placed, inside_test)?;
    if let Some(morphology) = parameters.morphology {
        crate::morphology::apply(&mut solid.occupancy, morphology);
    }
    let inside = solid.occupancy.count_ones();
    if inside == 0 {
        return Err(grid_frame::nothing_inside(mesh, &surface, &frame, solid.doubled, parameters));
    }
    let mut grid = VoxelGrid::solid(frame, solid.occupancy)?;
    let mut cut_links = 0;
    if parameters.cut_links {
        for axis in 0..3 {
            let (cut, count) = grid.with_cut_links(axis, &solid.cuts[axis]);
            (grid, cut_links) = (cut, cut_links + count);
        }
        if parameters.connectivity == Connectivity::TwentySix {
            let cut = placed.cut_diagonals(&grid);
            stop.check()?;
            grid = grid.with_cut_diagonals(cut)?;
        }
    }
    let (grid, dropped_components, dropped_voxels) = match parameters.connectivity {
        _ if !parameters.largest_only => (grid, 0, 0),
        Connectivity::Six => grid.largest_component(),
        Connectivity::TwentySix => largest_of_26(grid)?,
    };
    let topology = GridTopology::of(&grid);
    let overlap_volume = solid.doubled as f64 * frame.voxel_volume();
    let mesh_volume =
        (rule != InsideRule::Parity && surface.closed()).then(|| surface.volume() / surface.scale.powi(3));
    let confidence = 1.0 - (solid.ambiguous as f64 / inside as f64).min(1.0);
    let mut voxelization = Voxelization {
        grid,
        inside: inside_test,
        reason,
        confidence,
        ambiguous_voxels: solid.ambiguous,
        dropped_components,
        dropped_voxels,
        cut_links,
        mesh_volume,
        overlap_volume,
        vertex_normals: if rule == InsideRule::Parity {
            Vec::new()
        } else {
            surface.vertex_normals(mesh, analysis.welded)
        },
        topology,
        warnings: Vec::new(),
        mesh_euler: analysis.euler_characteristic().filter(|_| surface.shells.len() == 1),
    };
    voxelization.warnings = warnings(&analysis, &surface, &voxelization, inside, rule, parameters);
    Ok(voxelization)
}

/// The voxels inside a mesh as bits, without links or components: for those who only need a mask.
///
/// The parameters `cut_links`, `connectivity` and `largest_only` are ignored. Memory: an eighth of a byte
/// for each voxel of the box, and 40 bytes a vertex.
///
/// # Errors
/// As [`voxelize`].
pub fn inside(
    mesh: &TriangleMesh,
    parameters: &VoxelizeParameters,
) -> Result<(Frame, BitGrid), VoxelizeError> {
    let stop = &Stop::new(NEVER);
    let Prepared { surface, frame, rule, inside_test, .. } = prepare(mesh, parameters, stop)?;
    let Solid { mut occupancy, doubled, .. } = sweep(&surface, &frame, rule, inside_test, stop)?;
    if let Some(morphology) = parameters.morphology {
        crate::morphology::apply(&mut occupancy, morphology);
    }
    if occupancy.words().iter().all(|w| *w == 0) {
        return Err(grid_frame::nothing_inside(mesh, &surface, &frame, doubled, parameters));
    }
    Ok((frame, occupancy))
}

/// A mesh that has been examined, ready to be swept.
pub(crate) struct Prepared<'m> {
    pub analysis: MeshAnalysis<'m>,
    pub surface: Surface<'m>,
    pub frame: Frame,
    pub rule: InsideRule,
    pub inside_test: InsideTest,
    pub reason: Reason,
}

pub(crate) fn prepare<'m>(
    mesh: &'m TriangleMesh,
    parameters: &VoxelizeParameters,
    stop: &Stop,
) -> Result<Prepared<'m>, VoxelizeError> {
    parameters.validate()?;
    let triangles = mesh.triangles().len();
    if triangles == 0 {
        return Err(VoxelizeError::NoTriangles);
    }
    // Each triangle may need three caps.
    if triangles > MAX_TRIANGLES / 4 {
        return Err(VoxelizeError::TooManyTriangles { count: triangles, limit: MAX_TRIANGLES / 4 });
    }
    let counts_crossings = matches!(parameters.inside, InsideTest::Parity | InsideTest::Vote);
    let sized = parameters.frame.is_some() || !matches!(parameters.pitch, Pitch::Voxels(_));
    let analysis =
        if counts_crossings && sized { MeshAnalysis::unexamined(mesh) } else { MeshAnalysis::new(mesh) };
    let (inside_test, reason) = choose(parameters.inside, &analysis);
    stop.check()?;
    let surface = match inside_test {
        InsideTest::Parity | InsideTest::Vote => Surface::plain(mesh, analysis.triangles.clone()),
        InsideTest::Winding | InsideTest::Auto => Surface::oriented(mesh, &analysis),
    };
    stop.check()?;
    let rule = match (inside_test, parameters.overlap) {
        (InsideTest::Parity | InsideTest::Vote, _) => InsideRule::Parity,
        (_, Overlap::Part) => InsideRule::Total { join: false },
        (_, Overlap::Join) => InsideRule::Total { join: true },
        (_, Overlap::Auto) if surface.shells.len() == 1 => InsideRule::Total { join: false },
        (_, Overlap::Auto) => InsideRule::Shells,
    };
    let frame = grid_frame::frame(mesh, &surface, &analysis, rule, inside_test, parameters, stop)?;
    Ok(Prepared { analysis, surface, frame, rule, inside_test, reason })
}

/// The largest component under links to all 26 neighbours, and how many components and voxels were dropped.
fn largest_of_26(grid: VoxelGrid) -> Result<(VoxelGrid, usize, usize), VoxelizeError> {
    let parts = grid.graph(Connectivity::TwentySix)?.components();
    let Some(largest) = parts.largest().filter(|_| parts.len() > 1) else { return Ok((grid, 0, 0)) };
    let kept = grid.restrict(|v| parts.labels[v as usize] == largest);
    let dropped = grid.len() - kept.len();
    Ok((kept, parts.len() - 1, dropped))
}
