use mser3d_shape::{BitGrid, BoundingBox, Frame, IndexSet, TriangleMesh, VoxelGrid};
use mser3d_voxelize::Pitch;
use rayon::prelude::*;

use super::warp::Warp;
use crate::input::Prepared;
use crate::progress::NO_PROGRESS;
use crate::{DiscreteShape, Elements, Error, Input, Parameters};

/// What is deformed: the mesh or the mask that a shape was made of.
#[derive(Clone, Copy)]
pub(super) enum Original<'a> {
    Volume(&'a TriangleMesh),
    Surface(&'a TriangleMesh),
    Solid(&'a VoxelGrid),
}

/// A deformed copy of a shape, and places that both have.
pub(super) struct Deformed {
    pub prepared: Prepared,
    /// The element of the original and of the copy at each place, as far as there is one.
    places: Vec<[Option<u32>; 2]>,
    /// The area that a place stands for, or the voxel.
    weights: Vec<f64>,
}

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

    /// The copy that a deformation makes. A mesh is moved, and its solid divided into voxels of the same size. A mask is
    /// sampled anew on a grid of the same voxels: each is in the copy if the voxel that it came from is in the original.
    pub fn deform(
        self,
        shape: &DiscreteShape,
        parameters: &Parameters,
        amplitude: f64,
        number: u64,
    ) -> Result<Deformed, Error> {
        match self {
            Self::Volume(mesh) => {
                let mut parameters = parameters.clone();
                if let Some(grid) = shape.grid() {
                    parameters.voxelize.pitch = Pitch::Spacing(grid.frame().spacing());
                }
                parameters.voxelize.frame = None;
                let moved = moved(mesh, amplitude, number)?;
                Deformed::of_mesh(mesh, shape, Input::Volume(&moved).prepare(&parameters, NO_PROGRESS)?)
            }
            Self::Surface(mesh) => {
                let moved = moved(mesh, amplitude, number)?;
                Deformed::of_mesh(mesh, shape, Input::Surface(&moved).prepare(parameters, NO_PROGRESS)?)
            }
            Self::Solid(grid) => Deformed::of_solid(grid, shape, parameters, amplitude, number),
        }
    }
}

fn moved(mesh: &TriangleMesh, amplitude: f64, number: u64) -> Result<TriangleMesh, Error> {
    let Some(bounds) = mesh.bounding_box() else { return Ok(mesh.clone()) };
    let warp = Warp::new(&bounds, amplitude, number);
    let vertices = mesh.vertices().iter().map(|&p| warp.apply(p)).collect();
    Ok(TriangleMesh::new(vertices, mesh.triangles().to_vec())?)
}

impl Deformed {
    fn of_mesh(mesh: &TriangleMesh, shape: &DiscreteShape, prepared: Prepared) -> Result<Self, Error> {
        let copy = prepared.shape.element_of_vertex();
        let places = shape.element_of_vertex().iter().zip(copy).map(|(&a, &b)| [a, b]).collect();
        Ok(Self { places, weights: mesh.vertex_areas(), prepared })
    }

    fn of_solid(
        grid: &VoxelGrid,
        shape: &DiscreteShape,
        parameters: &Parameters,
        amplitude: f64,
        number: u64,
    ) -> Result<Self, Error> {
        let frame = grid.frame();
        let bounds = BoundingBox::around(shape.positions().iter().copied())
            .unwrap_or(BoundingBox { min: [0.0; 3], max: [0.0; 3] });
        let warp = Warp::new(&bounds, amplitude, number);
        let low = frame.spacing().map(|h| (warp.reach() / h).ceil() as u32 + 1);
        let dims = std::array::from_fn(|a| frame.dims()[a] + 2 * low[a] as usize);
        let affine = frame.affine();
        let wider = Frame::placed(dims, &affine.with_origin(affine.position(low.map(|n| -f64::from(n)))))?;
        let source = |voxel: [u32; 3]| -> Option<[u32; 3]> {
            let place = frame.locate(warp.apply(wider.centre(voxel)));
            let inside = (0..3).all(|a| place[a] >= 0.0 && place[a] < frame.dims()[a] as f64);
            inside.then(|| place.map(|x| x as u32))
        };
        let mut occupancy = BitGrid::empty(dims)?;
        let layers: Vec<Vec<[u32; 3]>> = (0..dims[2] as u32)
            .into_par_iter()
            .map(|k| {
                let row = |j| (0..dims[0] as u32).map(move |i| [i, j, k]);
                let layer = (0..dims[1] as u32).flat_map(row);
                layer.filter(|&voxel| source(voxel).is_some_and(|v| grid.occupancy().get(v))).collect()
            })
            .collect();
        layers.into_iter().flatten().for_each(|voxel| occupancy.set(voxel, true));
        let solid = VoxelGrid::solid(wider, occupancy)?;
        let prepared = Input::Solid(&solid).prepare(parameters, NO_PROGRESS)?;
        let original = |voxel| {
            let voxel = source(voxel)?;
            shape.grid()?.index(voxel)
        };
        let places: Vec<[Option<u32>; 2]> = match prepared.shape.elements() {
            Elements::Voxels { grid, .. } => {
                (0u32..).zip(grid.voxels()).map(|(number, voxel)| [original(voxel), Some(number)]).collect()
            }
            Elements::Vertices { .. } => Vec::new(),
        };
        Ok(Self { weights: vec![1.0; places.len()], places, prepared })
    }

    /// For each region of the original its best overlap with one of the copy: the weight of the places that both have,
    /// over that of the places that either has.
    pub fn best_overlaps(&self, original: &[&[u32]], copy: &[Vec<u32>]) -> Result<Vec<f64>, Error> {
        let copies = copy.iter().map(|members| self.places_of(1, members)).collect::<Result<Vec<_>, _>>()?;
        let best = |members: &&[u32]| {
            let own = self.places_of(0, members)?;
            let overlaps = copies.iter().map(|other| own.overlap(other, &self.weights));
            Ok(overlaps.fold(0.0, f64::max))
        };
        original.par_iter().map(best).collect()
    }

    /// The places of a region of the original (side 0) or of the copy (side 1).
    fn places_of(&self, side: usize, members: &[u32]) -> Result<IndexSet, Error> {
        let elements = 1 + members.iter().copied().max().map_or(0, |last| last as usize);
        let region = IndexSet::from_members(elements, members.iter().copied())?;
        let element = |place: usize| self.places[place][side].map(|element| element as usize);
        let is_in = |place| element(place).is_some_and(|e| e < elements && region.contains(e));
        Ok(IndexSet::from_fn(self.places.len(), is_in))
    }
}
