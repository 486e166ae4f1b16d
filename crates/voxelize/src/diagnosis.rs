use crate::cancel::{CheckFn, NEVER, Stop};
use crate::coarse_estimate::CoarseEstimate;
use crate::error::VoxelizeError;
use crate::estimate::{Cost, cost};
use crate::inside_rule::InsideRule;
use crate::inside_test::{InsideTest, Reason, choose};
use crate::mesh_analysis::MeshAnalysis;
use crate::mesh_to_grid::{Prepared, prepare};
use crate::parameters::VoxelizeParameters;
use crate::surface::{Shell, Surface};
use crate::triangle_geometry::area_vector;
use mser3d_shape::vector::{norm, sub};
use mser3d_shape::{BoundingBox, DisjointSets, TriangleMesh};

/// What a mesh is like, and what that means for voxelization.
///
/// Edges are counted as the file has them, before vertices are merged or triangles turned over.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct Diagnosis {
    /// Vertices, used or not.
    pub vertices: usize,
    /// Vertices that no triangle uses.
    pub unreferenced_vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Edges.
    pub edges: usize,
    /// Whether every edge has as many triangles on one side as on the other: no holes, one orientation.
    pub closed: bool,
    /// Whether it is so once vertices at equal positions are merged.
    pub closed_when_merged: bool,
    /// Edges with one triangle.
    pub boundary_edges: usize,
    /// Connected sets of boundary edges: simple holes are one loop each.
    pub boundary_loops: usize,
    /// Edges with more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles are oriented against each other.
    pub inconsistent_edges: usize,
    /// Triangles to turn over so that neighbours agree.
    pub flipped_triangles: usize,
    /// Components without any consistent orientation.
    pub one_sided_components: usize,
    /// Connected components of vertices and triangles.
    pub components: usize,
    /// Bodies that face inwards although no other surrounds them.
    pub inverted_bodies: usize,
    /// Bodies that face inwards because another surrounds them: holes in it.
    pub cavities: usize,
    /// Closed bodies that enclose nothing, like a sheet of two faces back to back.
    pub flat_bodies: usize,
    /// Triangles with a repeated vertex or without area.
    pub degenerate_triangles: usize,
    /// Triangles that repeat the vertices of an earlier one.
    pub duplicate_triangles: usize,
    /// Volume by the divergence theorem as the file orients it, in length^3.
    pub signed_volume: f64,
    /// Volume once oriented, with holes closed by cones, in length^3.
    pub volume: f64,
    /// Total area, in length^2.
    pub area: f64,
    /// The box around all triangles; `None` without triangles.
    pub bounding_box: Option<BoundingBox>,
    /// V - E + F over referenced vertices.
    pub euler_characteristic: i64,
    /// Sum of the genera of the components: handles. `None` where it is not defined (not manifold or not
    /// closed).
    pub genus: Option<i64>,
    /// Fraction of the volume that is covered more than once, found on a coarse grid; `None` where nothing
    /// is enclosed.
    pub overlap_fraction: Option<f64>,
    /// The inside test that [`InsideTest::Auto`] stands for.
    pub inside: InsideTest,
    /// Why that test suits the mesh.
    pub reason: Reason,
    /// Why [`voxelize`](crate::voxelize) refuses the mesh with the default parameters: the message of its
    /// error. `None` if it makes a solid.
    pub refused: Option<String>,
    /// What [`voxelize`](crate::voxelize) takes with the default parameters; `None` if it refuses.
    pub cost: Option<Cost>,
}

/// Examines a mesh: O(n) time for n triangles, and a coarse voxelization for the overlap.
///
/// ```
/// # use mser3d_shape::TriangleMesh;
/// let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
/// let open = TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3]])?;
/// let diagnosis = mser3d_voxelize::diagnose(&open);
/// assert!(!diagnosis.closed);
/// assert_eq!((diagnosis.boundary_edges, diagnosis.boundary_loops), (3, 1));
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn diagnose(mesh: &TriangleMesh) -> Diagnosis {
    examine(mesh, &Stop::new(NEVER))
}

/// As [`diagnose`], and stops when `check` breaks, as [`voxelize_with`](crate::voxelize_with) does.
///
/// # Errors
/// [`VoxelizeError::Cancelled`].
pub fn diagnose_with(mesh: &TriangleMesh, check: CheckFn) -> Result<Diagnosis, VoxelizeError> {
    let stop = Stop::new(check);
    let diagnosis = examine(mesh, &stop);
    stop.check()?;
    Ok(diagnosis)
}

fn examine(mesh: &TriangleMesh, stop: &Stop) -> Diagnosis {
    let prepared = prepare(mesh, &VoxelizeParameters::default(), stop);
    let refused = prepared.as_ref().err().map(ToString::to_string);
    let cost = prepared.as_ref().ok().map(|prepared| cost(prepared, &VoxelizeParameters::default()));
    let (analysis, surface) = match prepared {
        Ok(Prepared { analysis, surface, inside_test: InsideTest::Winding, .. }) => (analysis, surface),
        _ => {
            let analysis = MeshAnalysis::new(mesh);
            let surface = Surface::oriented(mesh, &analysis);
            (analysis, surface)
        }
    };
    let (inside_test, reason) = choose(InsideTest::Auto, &analysis);
    let mut used = DisjointSets::new(mesh.vertices().len());
    let mut referenced = vec![false; mesh.vertices().len()];
    for &[a, b, c] in mesh.triangles() {
        used.union(a, b);
        used.union(b, c);
        [a, b, c].iter().for_each(|&v| referenced[v as usize] = true);
    }
    let roots = |sets: &mut DisjointSets| {
        (0..referenced.len() as u32).filter(|&v| referenced[v as usize] && sets.find(v) == v).count()
    };
    let components = roots(&mut used);
    let unreferenced_vertices = referenced.iter().filter(|r| !**r).count();
    // A soup has no inside of which a part could be covered twice.
    let coarse = if refused.is_some() && surface.tangled() {
        None
    } else {
        CoarseEstimate::of(&surface, InsideRule::Total { join: true }, InsideTest::Winding, stop)
            .ok()
            .flatten()
    };
    let bodies = |test: fn(&Shell) -> bool| surface.shells.iter().filter(|b| test(b)).count();
    let file = &analysis.file;
    let characteristic =
        (referenced.len() - unreferenced_vertices) as i64 - file.total as i64 + mesh.triangles().len() as i64;
    let manifold = file.boundary == 0 && file.non_manifold == 0 && analysis.one_sided == 0;
    let genus =
        (manifold && !mesh.triangles().is_empty() && (2 * components as i64 - characteristic) % 2 == 0)
            .then_some((2 * components as i64 - characteristic) / 2);
    Diagnosis {
        vertices: mesh.vertices().len(),
        unreferenced_vertices,
        triangles: mesh.triangles().len(),
        edges: file.total,
        closed: file.unbalanced == 0 && !mesh.triangles().is_empty(),
        closed_when_merged: analysis.counts.boundary == 0 && !mesh.triangles().is_empty(),
        boundary_edges: file.boundary,
        boundary_loops: boundary_loops(mesh),
        non_manifold_edges: file.non_manifold,
        inconsistent_edges: file.inconsistent,
        flipped_triangles: analysis.turned,
        one_sided_components: analysis.one_sided,
        components,
        inverted_bodies: surface.inverted,
        cavities: bodies(|b| !b.scattered && !b.is_flat() && b.volume < 0.0),
        flat_bodies: bodies(Shell::is_flat),
        degenerate_triangles: degenerate_triangles(mesh),
        duplicate_triangles: analysis.duplicates.len(),
        signed_volume: mesh.signed_volume(),
        volume: surface.volume() / surface.scale.powi(3),
        area: mesh.area(),
        bounding_box: (!mesh.triangles().is_empty()).then_some(surface.bounds),
        euler_characteristic: characteristic,
        genus,
        overlap_fraction: coarse.map(|coarse| coarse.overlap),
        inside: inside_test,
        reason,
        refused,
        cost,
    }
}

fn boundary_loops(mesh: &TriangleMesh) -> usize {
    let edges = crate::mesh_edges::Edges::new(mesh.vertices().len(), mesh.triangles(), |_| true);
    let mut sets = DisjointSets::new(mesh.vertices().len());
    let mut ends = Vec::new();
    edges.for_each(|u, v, sides| {
        if sides.len() == 1 {
            sets.union(u, v);
            ends.push(u);
        }
    });
    let mut loops: Vec<u32> = ends.into_iter().map(|v| sets.find(v)).collect();
    loops.sort_unstable();
    loops.dedup();
    loops.len()
}

/// Triangles whose area is zero up to rounding, or that use a vertex twice.
fn degenerate_triangles(mesh: &TriangleMesh) -> usize {
    (0..mesh.triangles().len())
        .filter(|&t| {
            let corners = mesh.corners(t);
            let longest = (0..3).map(|i| norm(sub(corners[(i + 1) % 3], corners[i]))).fold(0.0, f64::max);
            norm(area_vector(&corners)) <= 1e-14 * longest * longest
        })
        .count()
}
