use std::path::PathBuf;
use std::sync::OnceLock;

use mser3d::SurfacePoints;
use mser3d_results::{Identity, Results};
use mser3d_shape::vector::{scale, sub};
use mser3d_shape::{BoundingBox, Domain, IndexSet};
use sha2::{Digest, Sha256};

use crate::{CollectionError, DescriptorSettings};

/// How far descriptors of regions that are alike may lie apart, in their own unit.
const DISTANCE: f64 = 8.0;

/// Cells along the diagonal of the first frame's body, in which places are compared.
const CELLS: f64 = 40.0;

/// What two regions have in common.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Likeness {
    /// From 0 to 1.
    pub value: f64,
    /// What was compared.
    pub identity: Identity,
}

/// The regions of a frame, as others are compared with them.
pub(super) struct Seen {
    name: PathBuf,
    /// Tells which triangles the frame has.
    triangles: Option<[u8; 32]>,
    /// The points of the surface that each region has.
    points: Vec<IndexSet>,
    regions: usize,
    /// Where the elements are, and which each region has.
    places: Vec<[f64; 3]>,
    members: Vec<Vec<u32>>,
    cell: f64,
    /// The cells that each region has, ascending; made when they are asked for.
    cells: OnceLock<Vec<Vec<[i32; 3]>>>,
    settings: DescriptorSettings,
    width: usize,
    descriptors: Vec<f64>,
}

/// The surfaces of a sequence: the places on them that frames are compared at.
pub(super) struct Surfaces {
    count: usize,
    /// Of the first frame with its triangles, by which they are known.
    points: Vec<([u8; 32], SurfacePoints)>,
    /// The length of a cell, that of the first frame.
    cell: Option<f64>,
    unseen: usize,
}

impl Surfaces {
    pub fn new(count: usize) -> Self {
        Self { count, points: Vec::new(), cell: None, unseen: 0 }
    }

    /// How many regions had no point of a surface.
    pub fn unseen(&self) -> usize {
        self.unseen
    }

    /// What is to be compared of a frame.
    pub fn see(&mut self, name: &str, results: &Results) -> Result<Seen, CollectionError> {
        let places = places(results);
        let cell = *self.cell.get_or_insert_with(|| {
            let bounds = BoundingBox::around(places.iter().copied());
            bounds.map_or(0.0, |bounds| bounds.diagonal()) / CELLS
        });
        let members = match results.domain() {
            Domain::Volume => results.region_voxels.clone(),
            Domain::Surface => results.region_vertices.clone(),
        };
        let triangles = (!results.mesh_of_voxels).then(|| digest(results));
        let points = match triangles {
            Some(triangles) => self.points_of_regions(triangles, results)?,
            None => Vec::new(),
        };
        self.unseen += points.iter().filter(|points| points.is_empty()).count();
        let settings = DescriptorSettings::of(&results.record);
        let (width, descriptors) = (results.descriptor_width, results.descriptors.clone());
        let regions = results.record.regions.len();
        let (name, cells) = (name.into(), OnceLock::new());
        Ok(Seen {
            name,
            triangles,
            points,
            regions,
            places,
            members,
            cell,
            cells,
            settings,
            width,
            descriptors,
        })
    }

    fn points_of_regions(
        &mut self,
        triangles: [u8; 32],
        results: &Results,
    ) -> Result<Vec<IndexSet>, CollectionError> {
        let at = match self.points.iter().position(|(known, _)| *known == triangles) {
            Some(at) => at,
            None => {
                self.points.push((triangles, SurfacePoints::spread(&results.mesh, self.count)));
                self.points.len() - 1
            }
        };
        let points = &self.points[at].1;
        let (elements, members, count) = match &results.grid {
            Some(grid) => (points.voxels(&results.mesh, grid)?, &results.region_voxels, grid.len()),
            None => {
                let vertices = points.vertices(&results.mesh).into_iter().map(Some).collect();
                (vertices, &results.region_vertices, results.mesh.vertices().len())
            }
        };
        let region = |members: &Vec<u32>| {
            let inside =
                IndexSet::from_members(count, members.iter().copied()).map_err(mser3d::Error::from)?;
            let has = |point: usize| elements[point].is_some_and(|element| inside.contains(element as usize));
            Ok(IndexSet::from_fn(elements.len(), has))
        };
        members.iter().map(region).collect()
    }
}

impl Seen {
    pub fn regions(&self) -> usize {
        self.regions
    }

    /// What the regions of two frames are compared by.
    pub fn identity(&self, other: &Self) -> Identity {
        let same = self.triangles.is_some() && self.triangles == other.triangles;
        if same { Identity::Vertices } else { Identity::Descriptors }
    }

    /// How much each region has in common with each of another frame.
    pub fn likeness(&self, other: &Self) -> Result<Vec<Vec<Likeness>>, CollectionError> {
        let identity = self.identity(other);
        let row = |region: usize| -> Vec<Likeness> {
            let value = |of: usize| match identity {
                Identity::Vertices => overlap(&self.points[region], &other.points[of]),
                Identity::Descriptors => self.alike(region, other, of),
            };
            (0..other.regions()).map(|of| Likeness { value: value(of), identity }).collect()
        };
        if identity == Identity::Descriptors
            && let Some(what) = self.settings.difference(&other.settings)
        {
            let (first, second) = (self.name.clone(), other.name.clone());
            return Err(CollectionError::DifferentDescriptors { first, second, what });
        }
        Ok((0..self.regions()).map(row).collect())
    }

    fn cells(&self) -> &[Vec<[i32; 3]>] {
        self.cells.get_or_init(|| cells(&self.places, &self.members, self.cell))
    }

    /// Half of the overlap in space, and half of how near the descriptors are.
    fn alike(&self, region: usize, other: &Self, of: usize) -> f64 {
        let row = |seen: &Self, region: usize| -> Vec<f64> {
            seen.descriptors[region * seen.width..(region + 1) * seen.width].to_vec()
        };
        let (a, b) = (row(self, region), row(other, of));
        let squares = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let (here, there) = (&self.cells()[region], &other.cells()[of]);
        let shared = common(here, there);
        let either = here.len() + there.len() - shared;
        0.5 * shared as f64 / either.max(1) as f64 + 0.5 * (-squares.sqrt() / DISTANCE).exp()
    }
}

/// The points in both regions over those in either.
fn overlap(a: &IndexSet, b: &IndexSet) -> f64 {
    let shared = a.intersection(b).len();
    shared as f64 / (a.len() + b.len() - shared).max(1) as f64
}

/// How many cells two ascending lists share.
fn common(a: &[[i32; 3]], b: &[[i32; 3]]) -> usize {
    a.iter().filter(|cell| b.binary_search(cell).is_ok()).count()
}

/// Where the elements of a result are.
fn places(results: &Results) -> Vec<[f64; 3]> {
    match &results.grid {
        Some(grid) => grid.voxels().map(|voxel| grid.frame().centre(voxel)).collect(),
        None => results.mesh.vertices().to_vec(),
    }
}

/// The cells of each region, seen from the mean of all places.
fn cells(places: &[[f64; 3]], members: &[Vec<u32>], cell: f64) -> Vec<Vec<[i32; 3]>> {
    let sum = places.iter().fold([0.0; 3], |sum: [f64; 3], p| std::array::from_fn(|a| sum[a] + p[a]));
    let middle = scale(sum, 1.0 / places.len().max(1) as f64);
    let of_place = |&element: &u32| {
        let from_middle = sub(places[element as usize], middle);
        from_middle.map(|x| if cell > 0.0 { (x / cell).floor() as i32 } else { 0 })
    };
    let region = |members: &Vec<u32>| {
        let mut cells: Vec<[i32; 3]> = members.iter().map(of_place).collect();
        cells.sort_unstable();
        cells.dedup();
        cells
    };
    members.iter().map(region).collect()
}

/// Tells lists of triangles apart.
fn digest(results: &Results) -> [u8; 32] {
    let mut hash = Sha256::new();
    hash.update((results.mesh.vertices().len() as u64).to_le_bytes());
    results.mesh.triangles().iter().flatten().for_each(|v| hash.update(v.to_le_bytes()));
    hash.finalize().into()
}
