//! From a mesh to the solid that is searched, and back to the mesh's vertices.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use mser3d_shape::{BoundingBox, Domain, NearestVoxels, TriangleMesh, VoxelGrid};
use mser3d_voxelize::{Voxelization, VoxelizeError, VoxelizeParameters, voxelize_with};
use rayon::prelude::*;

use crate::bodies::{Bodies, Parts};
use crate::progress::{Progress, ProgressFn, Stage, report};
use crate::shells::shells;
use crate::sight::seen_from_inside;
use crate::{DiscreteShape, Error, Warning};

/// Vertices that a thread places before it asks whether to go on.
const VERTICES: usize = 1 << 10;

/// How near, in voxels, a vertex comes to the centre of a voxel of its solid, where parts are not too thin.
const REACH: f64 = 2.0;

/// The part of another body's surface that may come so close to what is searched that its own voxels are farther away.
const TOUCHED: f64 = 0.25;

/// The solid inside a mesh, or some bodies of it.
pub(crate) struct SolidOfMesh {
    pub shape: DiscreteShape,
    /// How the mesh was voxelized. Its grid is the shape's.
    pub voxelization: Voxelization,
    /// The voxels of each body that is searched on its own.
    pub bodies: Vec<Vec<u32>>,
    /// What the voxelizer says, and what was left out.
    pub warnings: Vec<Warning>,
}

/// Shares of the stage when the solid is filled, and when each vertex has its nearest voxel; the rest sees which of them
/// are seen.
const FILLED: f64 = 0.6;
pub(crate) const PLACED: f64 = 0.7;

impl SolidOfMesh {
    /// The solid of a mesh; without a choice of bodies everything inside, specks too.
    pub fn new(
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
        bodies: Option<Bodies>,
        progress: ProgressFn,
    ) -> Result<Self, Error> {
        let elements = |whole: &Voxelization, parts: &Parts, searched: &VoxelGrid| {
            elements_of_vertices(mesh, whole, parts, searched, progress)
        };
        Self::with_elements(mesh, parameters, bodies, progress, elements)
    }

    /// The same with a rule of its own for the voxels of the vertices: of the whole solid, its parts, and what is searched.
    pub fn with_elements(
        mesh: &TriangleMesh,
        parameters: &VoxelizeParameters,
        bodies: Option<Bodies>,
        progress: ProgressFn,
        elements: impl FnOnce(&Voxelization, &Parts, &VoxelGrid) -> Result<Vec<Option<u32>>, Error>,
    ) -> Result<Self, Error> {
        let connectivity = parameters.connectivity;
        let goes_on = || progress(Progress { stage: Stage::Voxelize, done: 0.0, overall: 0.0 });
        let everything = VoxelizeParameters { largest_only: false, ..parameters.clone() };
        let whole = voxelize_with(mesh, &everything, &goes_on).map_err(|error| match error {
            VoxelizeError::Cancelled => Error::Cancelled,
            error => error.into(),
        })?;
        report(progress, Stage::Voxelize, FILLED)?;
        let parts = Parts::of_grid(&whole.grid, connectivity, bodies.unwrap_or_default())?;
        let parts = if bodies.is_none() { parts.with_all() } else { parts };
        let (elements, voxelization) = if parts.keeps_all() {
            (elements(&whole, &parts, &whole.grid)?, whole)
        } else {
            let kept = whole.grid.restrict(|voxel| parts.keeps(voxel));
            let elements = elements(&whole, &parts, &kept)?;
            (elements, whole.keep(kept, parts.dropped()))
        };
        let warnings = warnings(&voxelization, parts.warning(Domain::Volume));
        let grid = voxelization.grid.clone();
        let shape = DiscreteShape::solid_in_mesh(grid, connectivity, elements, Some(Arc::new(mesh.clone())));
        Ok(Self { shape, voxelization, bodies: parts.searched(), warnings })
    }
}

/// What the voxelizer says, and in place of its word on dropped components our own, which knows bodies.
fn warnings(voxelization: &Voxelization, mut dropped: Option<Warning>) -> Vec<Warning> {
    let mut warnings = Vec::new();
    for warning in &voxelization.warnings {
        match warning {
            mser3d_voxelize::Warning::Dropped { .. } => warnings.extend(dropped.take()),
            other => warnings.push(Warning::Voxelize(other.clone())),
        }
    }
    // A few specks are not worth a word, a body is.
    let has_body = |w: &Warning| matches!(w, Warning::SmallerComponents { bodies, .. } if !bodies.is_empty());
    warnings.extend(dropped.filter(has_body));
    warnings
}

/// Where a vertex belongs.
#[derive(Clone, Copy)]
enum Place {
    /// A voxel that is searched, and how far away it is.
    Searched(u32, f64),
    /// A body that is not searched.
    OtherBody,
    /// A few voxels that are not searched, as a thin part leaves behind.
    Speck,
}

/// The voxel of each vertex of the mesh, numbered in `searched`, which holds some components of the whole solid.
///
/// A vertex takes its nearest voxel. If that one belongs to a body that is not searched, so does the vertex, and
/// it takes none. If it is a speck, the vertex takes the nearest voxel that is searched. But no vertex does whose
/// [`Shell`] is apart from what is searched. Of what is searched it takes the nearest that it sees from inside
/// ([`seen_from_inside`]).
fn elements_of_vertices(
    mesh: &TriangleMesh,
    whole: &Voxelization,
    parts: &Parts,
    searched: &VoxelGrid,
    progress: ProgressFn,
) -> Result<Vec<Option<u32>>, Error> {
    let inside = &whole.grid;
    let nearest = inside.nearest();
    let all = parts.keeps_all();
    let voxels: Vec<[u32; 3]> = if all { Vec::new() } else { inside.voxels().collect() };
    let place = |&vertex: &[f64; 3]| {
        let Some((voxel, distance)) = nearest.voxel_within(vertex, f64::INFINITY) else {
            return Place::Speck;
        };
        if all {
            return Place::Searched(voxel, distance);
        }
        match searched.index(voxels[voxel as usize]) {
            Some(number) => Place::Searched(number, distance),
            None if parts.in_body(voxel) => Place::OtherBody,
            None => Place::Speck,
        }
    };
    let places = by_chunks(mesh.vertices(), FILLED..PLACED, progress, place)?;
    let (shell_of, count) = shells(mesh)?;
    let mut shells = vec![Shell::default(); count];
    for (((&vertex, area), &place), &shell) in
        mesh.vertices().iter().zip(mesh.vertex_areas()).zip(&places).zip(&shell_of)
    {
        shells[shell as usize].add(vertex, area, place);
    }
    let reach = REACH * inside.frame().spacing().into_iter().fold(0.0, f64::max);
    let nearest: NearestVoxels = searched.nearest();
    let placed: Vec<([f64; 3], (Place, u32))> =
        mesh.vertices().iter().copied().zip(places.into_iter().zip(shell_of)).collect();
    let voxels = by_chunks(&placed, PLACED..PLACED, progress, |&(vertex, (place, shell))| match place {
        _ if shells[shell as usize].is_apart(reach) => None,
        Place::Searched(voxel, _) => Some(voxel),
        Place::OtherBody => None,
        Place::Speck => nearest.voxel(vertex),
    })?;
    seen_from_inside(mesh, &whole.vertex_normals, searched, voxels, progress)
}

/// A connected part of the mesh, and where its vertices belong.
#[derive(Clone, Default)]
struct Shell {
    bounds: Option<BoundingBox>,
    /// The least distance of a vertex to a searched voxel that is its nearest.
    distance: Option<f64>,
    /// Area around the vertices whose nearest voxel is searched, and around those of other bodies.
    searched: f64,
    other: f64,
}

impl Shell {
    fn add(&mut self, vertex: [f64; 3], area: f64, place: Place) {
        self.bounds = match self.bounds {
            None => BoundingBox::around([vertex]),
            Some(BoundingBox { min, max }) => BoundingBox::around([min, max, vertex]),
        };
        match place {
            Place::Searched(_, distance) => {
                self.searched += area;
                self.distance = Some(self.distance.map_or(distance, |least| least.min(distance)));
            }
            Place::OtherBody => self.other += area,
            Place::Speck => {}
        }
    }

    /// Whether nothing of it is searched: it lies farther from what is searched than `reach` and its own size, so
    /// that it cannot contain any of it; or it is the shell of another body, and the few vertices that belong to what
    /// is searched only happen to come close.
    fn is_apart(&self, reach: f64) -> bool {
        let size = self.bounds.map_or(0.0, |bounds| bounds.diagonal());
        self.distance.is_none_or(|distance| distance > reach + size) || self.searched < TOUCHED * self.other
    }
}

/// A value for each item, in parallel, that can be cancelled: from one share of the stage to another.
pub(crate) fn by_chunks<T: Sync, R: Send>(
    items: &[T],
    shares: Range<f64>,
    progress: ProgressFn,
    value: impl Fn(&T) -> R + Sync,
) -> Result<Vec<R>, Error> {
    let (done, all) = (AtomicUsize::new(0), items.len() as f64);
    let chunk = |items: &[T]| {
        let before = done.fetch_add(items.len(), Ordering::Relaxed) as f64 / all;
        report(progress, Stage::Voxelize, shares.start + (shares.end - shares.start) * before)?;
        Ok(items.iter().map(&value).collect::<Vec<R>>())
    };
    let chunks = items.par_chunks(VERTICES).map(chunk).collect::<Result<Vec<Vec<R>>, Error>>()?;
    Ok(chunks.into_iter().flatten().collect())
}
