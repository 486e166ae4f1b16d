use mser3d_shape::vector::Vec3;
use mser3d_shape::{BitGrid, BoundingBox, Frame, IndexSet, TriangleMesh, VoxelGrid};
use mser3d_voxelize::Pitch;
use rayon::prelude::*;

use super::warp::Warp;
use crate::input::Prepared;
use crate::progress::ProgressFn;
use crate::{DiscreteShape, Error, Input, Parameters};

/// What is deformed: the mesh or the mask that a shape was made of.
#[derive(Clone, Copy)]
pub(crate) enum Original<'a> {
    Volume(&'a TriangleMesh),
    Surface(&'a TriangleMesh),
    Solid(&'a VoxelGrid),
}

/// A deformed copy of a shape, and where the original's elements are in it.
pub(super) struct Deformed {
    pub prepared: Prepared,
    /// The element of the copy that each element of the original became, as far as there is one.
    became: Vec<Option<u32>>,
    /// The measure of each element of the original.
    measures: Vec<f64>,
}

/// How many times longer the voxels of a copy are: 0.58 of the voxels, in less than half of the time.
pub(crate) const COARSER: f64 = 1.2;

/// How far, in voxels, an element may be from the voxel that it became.
const REACH: f64 = 2.0;

impl<'a> Original<'a> {
    /// Nothing where the input is a shape that was made before: what it was made of is not known.
    pub fn of(input: &Input<'a>) -> Option<Self> {
        match input {
            Input::Volume(mesh) => Some(Self::Volume(mesh)),
            Input::Surface(mesh) => Some(Self::Surface(mesh)),
            Input::Solid(grid) => Some(Self::Solid(grid)),
            Input::Shape(_) => None,
        }
    }

    /// The same as an input.
    pub fn input(self) -> Input<'a> {
        match self {
            Self::Volume(mesh) => Input::Volume(mesh),
            Self::Surface(mesh) => Input::Surface(mesh),
            Self::Solid(grid) => Input::Solid(grid),
        }
    }

    /// The copy that a deformation makes. A mesh is moved, and its solid divided into somewhat larger voxels. A mask is
    /// sampled anew on the same grid made wider: a voxel is in the copy if its centre is moved into the original. So a mask is
    /// deformed by the inverse, which is as random.
    pub(super) fn deform(
        self,
        shape: &DiscreteShape,
        parameters: &Parameters,
        amplitude: f64,
        number: u64,
        progress: ProgressFn,
    ) -> Result<Deformed, Error> {
        let bounds = BoundingBox::around(shape.positions().iter().copied())
            .unwrap_or(BoundingBox { min: [0.0; 3], max: [0.0; 3] });
        let warp = Warp::new(&bounds, amplitude, number);
        match self {
            Self::Volume(mesh) => {
                let mut parameters = parameters.clone();
                if let Some(grid) = shape.grid() {
                    parameters.voxelize.pitch = Pitch::Spacing(grid.frame().spacing().map(|h| COARSER * h));
                }
                parameters.voxelize.frame = None;
                let moved = moved(mesh, &warp)?;
                let prepared = Input::Volume(&moved).prepare(&parameters, progress)?;
                Deformed::of_solid(shape, |place| warp.apply(place), prepared)
            }
            Self::Surface(mesh) => {
                let moved = moved(mesh, &warp)?;
                Deformed::of_surface(mesh, shape, Input::Surface(&moved).prepare(parameters, progress)?)
            }
            Self::Solid(grid) => {
                let solid = sampled(grid, &warp)?;
                let prepared = Input::Solid(&solid).prepare(parameters, progress)?;
                Deformed::of_solid(shape, |place| warp.origin_of(place), prepared)
            }
        }
    }
}

fn moved(mesh: &TriangleMesh, warp: &Warp) -> Result<TriangleMesh, Error> {
    let vertices = mesh.vertices().iter().map(|&p| warp.apply(p)).collect();
    Ok(TriangleMesh::new(vertices, mesh.triangles().to_vec())?)
}

/// The solid of all places that are moved into a voxel of another one.
fn sampled(grid: &VoxelGrid, warp: &Warp) -> Result<VoxelGrid, Error> {
    let frame = grid.frame();
    let margin = frame.spacing().map(|h| (warp.reach() / h).ceil() as u32 + 1);
    // Of a label map only the box around the label.
    let (low, extent) = occupied(grid);
    let dims = extent.map(|n| n as usize);
    let affine = frame.part(low, dims).affine();
    let dims = std::array::from_fn(|a| dims[a] + 2 * margin[a] as usize);
    let wider = Frame::placed(dims, &affine.with_origin(affine.position(margin.map(|n| -f64::from(n)))))?;
    let is_inside = |voxel: [u32; 3]| {
        let place = frame.locate(warp.apply(wider.centre(voxel)));
        let in_box = (0..3).all(|a| place[a] >= 0.0 && place[a] < frame.dims()[a] as f64);
        in_box && grid.occupancy().get(place.map(|x| x as u32))
    };
    let layer = |k: u32| -> Vec<[u32; 3]> {
        let row = |j| (0..dims[0] as u32).map(move |i| [i, j, k]);
        (0..dims[1] as u32).flat_map(row).filter(|&voxel| is_inside(voxel)).collect()
    };
    let layers: Vec<Vec<[u32; 3]>> = (0..dims[2] as u32).into_par_iter().map(layer).collect();
    let mut occupancy = BitGrid::empty(dims)?;
    layers.into_iter().flatten().for_each(|voxel| occupancy.set(voxel, true));
    Ok(VoxelGrid::solid(wider, occupancy)?)
}

/// The box of the voxels that are inside: its first one, and how many there are along each axis.
pub(crate) fn occupied(grid: &VoxelGrid) -> ([u32; 3], [u32; 3]) {
    let (low, high) = grid.voxels().fold(([u32::MAX; 3], [0; 3]), |(low, high), voxel| {
        (std::array::from_fn(|a| voxel[a].min(low[a])), std::array::from_fn(|a| voxel[a].max(high[a])))
    });
    if grid.is_empty() { ([0; 3], [0; 3]) } else { (low, std::array::from_fn(|a| high[a] - low[a] + 1)) }
}

impl Deformed {
    /// Of a surface: vertex by vertex.
    fn of_surface(mesh: &TriangleMesh, shape: &DiscreteShape, prepared: Prepared) -> Result<Self, Error> {
        let (mut became, mut measures) = (vec![None; shape.len()], vec![0.0; shape.len()]);
        let copy = prepared.shape.element_of_vertex();
        for ((own, other), area) in shape.element_of_vertex().iter().zip(copy).zip(mesh.vertex_areas()) {
            if let Some(own) = own {
                became[*own as usize] = became[*own as usize].or(*other);
                measures[*own as usize] += area;
            }
        }
        Ok(Self { prepared, became, measures })
    }

    /// Of a solid: each voxel is moved to the nearest voxel of the copy.
    fn of_solid(
        shape: &DiscreteShape,
        moved: impl Fn(Vec3) -> Vec3 + Sync,
        prepared: Prepared,
    ) -> Result<Self, Error> {
        let became = match prepared.shape.grid() {
            None => vec![None; shape.len()],
            Some(grid) => {
                let nearest = grid.nearest();
                let reach = REACH * grid.frame().spacing().into_iter().fold(0.0, f64::max);
                let voxel =
                    |&place: &[f64; 3]| nearest.voxel_within(moved(place), reach).map(|found| found.0);
                shape.positions().par_iter().map(voxel).collect()
            }
        };
        Ok(Self { prepared, became, measures: vec![1.0; shape.len()] })
    }

    /// For each region of the original its best overlap with one of the copy, both seen on the original: the measure of
    /// what both have over that of what either has.
    pub fn best_overlaps(&self, original: &[&[u32]], copy: &[Vec<u32>]) -> Result<Vec<f64>, Error> {
        let (n, elements) = (self.became.len(), self.prepared.shape.len());
        let on_original = |region: &Vec<u32>| -> Result<IndexSet, Error> {
            let region = IndexSet::from_members(elements, region.iter().copied())?;
            Ok(IndexSet::from_fn(n, |e| self.became[e].is_some_and(|to| region.contains(to as usize))))
        };
        let copies = copy.iter().map(on_original).collect::<Result<Vec<_>, _>>()?;
        let best = |region: &&[u32]| {
            let region = IndexSet::from_members(n, region.iter().copied())?;
            let overlaps = copies.iter().map(|other| region.overlap(other, &self.measures));
            Ok(overlaps.fold(0.0, f64::max))
        };
        original.par_iter().map(best).collect()
    }
}
