use mser3d_shape::vector::Vec3;
use mser3d_shape::{BitGrid, BoundingBox, Frame, IndexSet, ShapeError, TriangleMesh, VoxelGrid};
use mser3d_voxelize::Pitch;
use rayon::prelude::*;

use super::warp::Warp;
use crate::input::Prepared;
use crate::progress::ProgressFn;
use crate::solid::SolidOfMesh;
use crate::{DiscreteShape, Error, Input, Parameters};

/// What is deformed: the mesh or the mask that a shape was made of.
#[derive(Clone, Copy)]
pub(crate) enum Original<'a> {
    Volume(&'a TriangleMesh),
    Surface(&'a TriangleMesh),
    Solid(&'a VoxelGrid),
}

/// A deformed copy of a shape, and what overlaps with its regions are measured on.
pub(super) struct Deformed {
    pub prepared: Prepared,
    /// The area at each vertex of the mesh, which both have. None of a mask.
    areas: Option<Vec<f64>>,
    /// The voxel of the copy that each voxel of the original became, as far as there is one: for a mask, and for regions
    /// with few vertices.
    became: Option<Vec<Option<u32>>>,
}

/// Where a region is: its elements, and the vertices of the mesh.
pub(super) struct Place {
    pub elements: Vec<u32>,
    pub vertices: Vec<u32>,
}

/// Voxels of a copy, where its shape has more; of large shapes an eighth. Reliability orders regions as well as on copies
/// with all voxels (areas of .63 and .60, `cargo xtask reliability`), in a fifth of the time. With half as many voxels it
/// does not on thin limbs.
const COPY_VOXELS: f64 = 8_000.0;
const COARSEST: f64 = 2.0;

/// How far, in voxels, an element may be from the voxel that it became.
const REACH: f64 = 2.0;

/// How much sums of the same numbers in another order may differ, relatively.
const ROUNDING: f64 = 1e-9;

/// Fewest vertices on which an overlap is measured: it is then known to a tenth.
const FEWEST_VERTICES: usize = 10;

/// How many times longer the voxels of a solid's copy are.
pub(crate) fn coarser(voxels: usize) -> f64 {
    (voxels as f64 / COPY_VOXELS).cbrt().clamp(1.0, COARSEST)
}

impl Place {
    /// Whether overlaps with it can be measured on the mesh's vertices.
    fn is_on_vertices(&self) -> bool {
        self.vertices.len() >= FEWEST_VERTICES
    }
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

    /// The same as an input.
    pub fn input(self) -> Input<'a> {
        match self {
            Self::Volume(mesh) => Input::Volume(mesh),
            Self::Surface(mesh) => Input::Surface(mesh),
            Self::Solid(grid) => Input::Solid(grid),
        }
    }

    /// The copy that a deformation makes, to be searched for these regions of the original, in [`coarser`] voxels. A mesh is
    /// moved. A mask is sampled anew on a wider grid: a voxel is in the copy if its centre is moved into the original. So a
    /// mask is deformed by the inverse, which is as random.
    pub(super) fn deform(
        self,
        shape: &DiscreteShape,
        regions: &[Place],
        parameters: &Parameters,
        amplitude: f64,
        number: u64,
        progress: ProgressFn,
    ) -> Result<Deformed, Error> {
        let bounds = BoundingBox::around(shape.positions().iter())
            .unwrap_or(BoundingBox { min: [0.0; 3], max: [0.0; 3] });
        let warp = Warp::new(&bounds, amplitude, number);
        match self {
            Self::Volume(mesh) => {
                let mut parameters = parameters.clone();
                if let Some(grid) = shape.grid() {
                    let coarser = coarser(grid.len());
                    parameters.voxelize.pitch = Pitch::Spacing(grid.frame().spacing().map(|h| coarser * h));
                }
                parameters.voxelize.frame = None;
                let moved = moved(mesh, &warp)?;
                let elements = |_: &_, _: &_, grid: &_| Ok(voxels_of_vertices(shape, &warp, grid));
                let (voxelize, bodies) = (&parameters.voxelize, Some(parameters.bodies));
                let prepared: Prepared =
                    SolidOfMesh::with_elements(&moved, voxelize, bodies, progress, elements)?.into();
                let coarse = !regions.iter().all(Place::is_on_vertices);
                let became = coarse.then(|| voxels_of(shape, |place| warp.apply(place), &prepared.shape));
                Ok(Deformed { prepared, areas: Some(mesh.vertex_areas()), became })
            }
            Self::Surface(mesh) => {
                let moved = moved(mesh, &warp)?;
                let prepared = Input::Surface(&moved).prepare(parameters, progress)?;
                Ok(Deformed { prepared, areas: Some(mesh.vertex_areas()), became: None })
            }
            Self::Solid(grid) => {
                let solid = sampled(grid, &warp)?;
                let prepared = Input::Solid(&solid).prepare(parameters, progress)?;
                let became = voxels_of(shape, |place| warp.origin_of(place), &prepared.shape);
                Ok(Deformed { prepared, areas: None, became: Some(became) })
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
    let coarser = coarser(grid.len());
    let margin = frame.spacing().map(|h| (warp.reach() / (coarser * h)).ceil() + 1.0);
    // Of a label map only the box around the label.
    let (low, extent) = occupied(grid);
    let affine = frame.affine();
    let first = std::array::from_fn(|a| f64::from(low[a]) - 0.5 + coarser * (0.5 - margin[a]));
    let affine =
        affine.with_origin(affine.position(first)).with_spacing(affine.spacing().map(|h| coarser * h))?;
    let dims = std::array::from_fn(|a| ((f64::from(extent[a]) / coarser).ceil() + 2.0 * margin[a]) as usize);
    let wider = Frame::placed(dims, &affine)?;
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

/// The voxel of a copy that each voxel of the original became: the nearest one to where it is moved.
fn voxels_of(
    original: &DiscreteShape,
    moved: impl Fn(Vec3) -> Vec3 + Sync,
    copy: &DiscreteShape,
) -> Vec<Option<u32>> {
    let Some(grid) = copy.grid() else { return vec![None; original.len()] };
    let nearest = grid.nearest();
    let reach = REACH * grid.frame().spacing().into_iter().fold(0.0, f64::max);
    let voxel = |place: [f64; 3]| nearest.voxel_within(moved(place), reach).map(|found| found.0);
    let places: Vec<[f64; 3]> = original.positions().iter().collect();
    places.into_par_iter().map(voxel).collect()
}

/// The voxel of each vertex of a copy: what the vertex's voxel on the original became. None is far from it.
fn voxels_of_vertices(original: &DiscreteShape, warp: &Warp, grid: &VoxelGrid) -> Vec<Option<u32>> {
    let nearest = grid.nearest();
    let reach = REACH * grid.frame().spacing().into_iter().fold(0.0, f64::max);
    let voxel = |&element: &Option<u32>| {
        let place = warp.apply(original.positions().at(element?));
        nearest.voxel_within(place, reach).map(|found| found.0)
    };
    original.element_of_vertex().par_iter().map(voxel).collect()
}

impl Deformed {
    /// For each region of the original its best overlap with one of the copy, both seen on the original: the measure of
    /// what both have over that of what either has. Of a mesh it is by the area at its vertices, as in section 6; of a mask,
    /// and of regions with few vertices, by voxels.
    pub fn best_overlaps(&self, original: &[Place], copy: &[Place]) -> Result<Vec<f64>, Error> {
        let by_vertices = self.areas.as_ref().map(|areas| on_vertices(areas, original, copy)).transpose()?;
        let by_voxels =
            self.became.as_ref().map(|became| self.on_voxels(became, original, copy)).transpose()?;
        Ok(match (by_vertices, by_voxels) {
            (Some(by_vertices), Some(by_voxels)) => original
                .iter()
                .zip(by_vertices.into_iter().zip(by_voxels))
                .map(|(place, (vertices, voxels))| if place.is_on_vertices() { vertices } else { voxels })
                .collect(),
            (Some(best), None) | (None, Some(best)) => best,
            (None, None) => vec![0.0; original.len()],
        })
    }

    fn on_voxels(
        &self,
        became: &[Option<u32>],
        original: &[Place],
        copy: &[Place],
    ) -> Result<Vec<f64>, Error> {
        let (voxels, of_copy) = (became.len(), self.prepared.shape.len());
        let here = |place: &Place| IndexSet::from_members(voxels, place.elements.iter().copied());
        let there = |place: &Place| {
            let there = IndexSet::from_members(of_copy, place.elements.iter().copied())?;
            Ok(IndexSet::from_fn(voxels, |v| became[v].is_some_and(|to| there.contains(to as usize))))
        };
        Ok(best(sets(original, here)?, &sets(copy, there)?, &vec![1.0; voxels]))
    }
}

fn on_vertices(areas: &[f64], original: &[Place], copy: &[Place]) -> Result<Vec<f64>, Error> {
    let vertices = |place: &Place| IndexSet::from_members(areas.len(), place.vertices.iter().copied());
    Ok(best(sets(original, vertices)?, &sets(copy, vertices)?, areas))
}

fn sets(
    places: &[Place],
    set: impl Fn(&Place) -> Result<IndexSet, ShapeError>,
) -> Result<Vec<IndexSet>, Error> {
    Ok(places.iter().map(set).collect::<Result<_, _>>()?)
}

/// The best overlap of each of the first sets with one of the others.
fn best(sets: Vec<IndexSet>, others: &[IndexSet], measures: &[f64]) -> Vec<f64> {
    let measure = |set: &IndexSet| set.members().map(|member| measures[member]).sum::<f64>();
    let others: Vec<(&IndexSet, f64)> = others.iter().map(|other| (other, measure(other))).collect();
    let best = |set: IndexSet| {
        let own = measure(&set);
        others.iter().fold(0.0, |best: f64, &(other, measure)| {
            // An overlap is at most the ratio of the measures, but for rounding.
            if (1.0 + ROUNDING) * own.min(measure) < best * own.max(measure) {
                return best;
            }
            best.max(set.overlap(other, measures))
        })
    };
    sets.into_par_iter().map(best).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::NO_PROGRESS;

    fn place(elements: std::ops::Range<u32>, vertices: std::ops::Range<u32>) -> Place {
        Place { elements: elements.collect(), vertices: vertices.collect() }
    }

    #[test]
    fn a_masks_copy_has_as_much_volume_in_coarser_voxels() {
        for (voxels, expected) in [(1_000, 1.0), (27_000, 1.5), (64_000, 2.0), (10_000_000, 2.0)] {
            assert!((coarser(voxels) - expected).abs() < 1e-12, "{voxels}");
        }
        // A box that is not at the corner of its grid, nor as long along all axes, of voxels that are no cubes.
        let (dims, inside) = ([60, 50, 40], [(5, 50), (8, 40), (2, 38)]);
        let frame = Frame::new(dims, [1.0, -2.0, 3.0], [0.5, 1.0, 0.8]).unwrap();
        let mut bits = BitGrid::empty(dims).unwrap();
        for v in BitGrid::full(dims).unwrap().ones() {
            bits.set(v, (0..3).all(|a| (inside[a].0..inside[a].1).contains(&v[a])));
        }
        let solid = VoxelGrid::solid(frame, bits).unwrap();
        let bounds =
            BoundingBox { min: frame.position([5.0, 8.0, 2.0]), max: frame.position([50.0, 40.0, 38.0]) };
        let copy = sampled(&solid, &Warp::new(&bounds, 1e-9, 3)).unwrap();
        let coarser = coarser(solid.len());
        for (own, of_copy) in frame.spacing().iter().zip(copy.frame().spacing()) {
            assert!((of_copy - coarser * own).abs() < 1e-12);
        }
        assert!((copy.volume() / solid.volume() - 1.0).abs() < 0.1, "{} {}", copy.volume(), solid.volume());
        let centres: Vec<_> = copy.voxels().map(|v| copy.frame().centre(v)).collect();
        let of_copy = BoundingBox::around(centres).unwrap();
        for a in 0..3 {
            let edge = copy.frame().spacing()[a] / 2.0;
            assert!((of_copy.min[a] - edge - bounds.min[a]).abs() <= edge, "axis {a}");
            assert!((of_copy.max[a] + edge - bounds.max[a]).abs() <= edge, "axis {a}");
        }
    }

    #[test]
    fn overlaps_are_by_area_at_vertices_or_by_voxels_where_these_are_few() {
        let dims = [10, 1, 1];
        let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
        let bar = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
        let prepared = Input::Solid(&bar).prepare(&Parameters::default(), NO_PROGRESS).unwrap();
        // Voxel i of the original became voxel i - 1 of the copy; the first is gone.
        let became = (0..10u32).map(|v| v.checked_sub(1)).collect();
        let areas = (0..20).map(f64::from).collect();
        let copy = Deformed { prepared, areas: Some(areas), became: Some(became) };
        let original = [place(0..4, 0..10), place(0..4, 0..9)];
        let found = [place(1..4, 5..15), place(9..10, 19..20)];
        // Vertices 5 to 9 of 0 to 14; voxels 2 and 3 of 0 to 4.
        assert_eq!(copy.best_overlaps(&original, &found).unwrap(), [35.0 / 105.0, 2.0 / 5.0]);
        let of_mask = Deformed { areas: None, ..copy };
        assert_eq!(of_mask.best_overlaps(&original, &found).unwrap(), [2.0 / 5.0; 2]);
    }
}
