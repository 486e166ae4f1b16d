//! What a page shows, as its caller gives it, and whether its parts fit each other.

use mser3d_shape::{InvalidParameter, TriangleMesh, VoxelGrid};

use crate::model::fits;
use crate::{Rgb, Up, ViewerError};

/// Everything a page shows: one shape, or two beside each other.
#[derive(Clone, Debug)]
pub struct PageData<'a> {
    /// Heading of the page.
    pub title: String,
    /// One shape or two.
    pub shapes: Vec<PageShape<'a>>,
    /// Regions of the first shape and what they are matched with in the second. Give matched regions
    /// equal colours ([`linked_colours`](crate::linked_colours)).
    pub matches: Vec<RegionPair>,
    /// The same for the parts of both shapes, where they have parts.
    pub part_matches: Vec<RegionPair>,
    /// The axis that points up.
    pub up: Up,
}

/// A shape on a page.
#[derive(Clone, Debug)]
pub struct PageShape<'a> {
    /// Its name, such as its file's.
    pub name: String,
    /// The azimuth of its front, in degrees ([`View::azimuth`](crate::View::azimuth)), from which the page counts its own; none where
    /// that is not known, and then the file's axes rule.
    pub front: Option<f64>,
    /// Its surface.
    pub mesh: &'a TriangleMesh,
    /// Its inside, if it was detected in: shown where a plane cuts the shape.
    pub grid: Option<&'a VoxelGrid>,
    /// The voxel of each vertex of the surface, which enters a tree with it; -1 for none, which never enters. Empty without a grid.
    pub vertex_voxel: &'a [i32],
    /// Its regions, in the order of their ids.
    pub regions: Vec<PageRegion<'a>>,
    /// Its parts, which a page shows first; none where there are none.
    pub parts: Option<PageParts<'a>>,
    /// The grey values it was found in, shown in slices beside it; none where there are none.
    pub grey: Option<PageGrey>,
    /// The trees the regions come from, one per time scale; may be empty.
    pub trees: Vec<PageTree<'a>>,
    /// Facts listed below the regions: what they are called and what they are.
    pub facts: Vec<[String; 2]>,
}

/// A region and its numbers.
#[derive(Clone, Debug)]
pub struct PageRegion<'a> {
    /// Its colour on the page.
    pub colour: Rgb,
    /// The smallest region that contains it.
    pub parent: Option<u32>,
    /// Weight at which its component comes into being.
    pub altitude: f64,
    /// Stability (eq. 5); infinite where nothing changes.
    pub stability: f64,
    /// How surely it is found again, 0 to 1; none where that was not measured.
    pub reliability: Option<f64>,
    /// How long it lasts before the real merge that ends it, in altitude; none where no merge does.
    pub lifetime: Option<f64>,
    /// Its mirror image, another region of the shape.
    pub twin: Option<u32>,
    /// On which side of its body it is, from -1 to 1; none where the body has no sides.
    pub side: Option<f64>,
    /// Volume in length^3 (of a surface: area in length^2).
    pub volume: f64,
    /// Share of the whole volume or area.
    pub volume_fraction: f64,
    /// Vertices of the mesh in it.
    pub vertices: &'a [u32],
    /// Voxels of the grid in it; empty without a grid.
    pub voxels: &'a [u32],
    /// The tree it comes from, by its place in [`PageShape::trees`], and its node there.
    pub node: Option<[u32; 2]>,
}

/// The grey values of a volume, on the grid of the shape or on every so many of its voxels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageGrey {
    /// How many values there are along the axes of the grid.
    pub dims: [usize; 3],
    /// One for every so many voxels along each axis.
    pub step: usize,
    /// From 0, dark, to 255, bright, x fastest.
    pub values: Vec<u8>,
}

/// The parts of a shape: each vertex and each voxel is in one at most.
#[derive(Clone, Debug)]
pub struct PageParts<'a> {
    /// The parts, in the order of their ids.
    pub list: Vec<PagePart>,
    /// The part of each vertex; -1 for none.
    pub vertices: &'a [i32],
    /// The part of each voxel; -1 for none. Empty without a grid.
    pub voxels: &'a [i32],
}

/// A part and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct PagePart {
    /// Its colour on the page.
    pub colour: Rgb,
    /// Whether it is what the other parts leave.
    pub trunk: bool,
    /// The region that it grew from, by its place in [`PageShape::regions`].
    pub region: Option<u32>,
    /// The parts that are its mirror images, or equal to it.
    pub twins: Vec<u32>,
    /// On which side of its body it is, from -1 to 1; none where the body has no sides.
    pub side: Option<f64>,
    /// Volume in length^3 (of a surface: area in length^2).
    pub volume: f64,
    /// Share of the whole volume or area.
    pub volume_fraction: f64,
}

/// A component tree as plain arrays. Nodes are numbered children first, as `ComponentTree` does.
#[derive(Clone, Debug)]
pub struct PageTree<'a> {
    /// Its name, such as its time scale.
    pub name: String,
    /// Whether the level falls (superlevel sets): the highest altitudes come first.
    pub superlevel: bool,
    /// Parent of each node; `u32::MAX` for a root.
    pub parents: &'a [u32],
    /// Altitude of each node.
    pub altitudes: &'a [f64],
    /// Volume of each node.
    pub volumes: &'a [f64],
    /// For each voxel (without a grid: each vertex), the node in which it enters.
    pub entry: &'a [u32],
}

/// A region or part of the first shape of a page, and that of the second that it is matched with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RegionPair {
    /// Id in the first shape.
    pub first: u32,
    /// Id in the second shape.
    pub second: u32,
    /// Distance of their descriptors.
    pub distance: f64,
    /// Whether a ground truth says that they are not the same: a mistake.
    pub mistake: bool,
}

impl PageData<'_> {
    /// Checks that all numbers fit the shapes they refer to.
    pub(crate) fn check(&self) -> Result<(), ViewerError> {
        if !(1..=2).contains(&self.shapes.len()) {
            let name = "number of shapes on a page";
            return Err(InvalidParameter::new(name, self.shapes.len(), "1 or 2").into());
        }
        self.shapes.iter().try_for_each(PageShape::check)?;
        let regions = |shape: &PageShape<'_>| shape.regions.len();
        let parts = |shape: &PageShape<'_>| shape.parts.as_ref().map_or(0, |parts| parts.list.len());
        self.check_pairs("region", &self.matches, regions)?;
        self.check_pairs("part", &self.part_matches, parts)
    }

    fn check_pairs(
        &self,
        what: &'static str,
        pairs: &[RegionPair],
        count: impl Fn(&PageShape<'_>) -> usize,
    ) -> Result<(), ViewerError> {
        let count = |shape: usize| self.shapes.get(shape).map_or(0, &count);
        for (number, pair) in pairs.iter().enumerate() {
            in_range("match", number, what, pair.first, count(0))?;
            in_range("match", number, what, pair.second, count(1))?;
        }
        Ok(())
    }
}

impl PageShape<'_> {
    fn check(&self) -> Result<(), ViewerError> {
        if self.mesh.triangles().is_empty() {
            return Err(ViewerError::Empty { reason: "the mesh has no triangles" });
        }
        if let Some(front) = self.front {
            InvalidParameter::unless(
                front.is_finite(),
                "azimuth of a front",
                front,
                "a finite number of degrees",
            )?;
        }
        let vertices = self.mesh.vertices().len();
        let voxels = self.grid.map_or(0, VoxelGrid::len);
        for (number, region) in self.regions.iter().enumerate() {
            for &v in region.vertices {
                in_range("region", number, "vertex", v, vertices)?;
            }
            for &v in region.voxels {
                in_range("region", number, "voxel", v, voxels)?;
            }
            for other in region.parent.into_iter().chain(region.twin) {
                in_range("region", number, "region", other, self.regions.len())?;
            }
            if let Some([tree, node]) = region.node {
                in_range("region", number, "tree", tree, self.trees.len())?;
                in_range("region", number, "node", node, self.trees[tree as usize].parents.len())?;
            }
        }
        fits("voxels of vertices", self.vertex_voxel.len(), if self.grid.is_some() { vertices } else { 0 })?;
        for (number, &voxel) in self.vertex_voxel.iter().enumerate() {
            if let Ok(voxel) = u32::try_from(voxel) {
                in_range("vertex", number, "voxel", voxel, voxels)?;
            }
        }
        if let Some(grey) = &self.grey {
            let step = grey.step.max(1);
            let dims = self.grid.map_or([0; 3], |grid| grid.frame().dims().map(|n| n.div_ceil(step)));
            for (found, expected) in grey.dims.into_iter().zip(dims) {
                fits("grey values along an axis", found, expected)?;
            }
            fits("grey values", grey.values.len(), dims.iter().product())?;
        }
        if let Some(parts) = &self.parts {
            parts.check(self.regions.len(), vertices, voxels)?;
        }
        let elements = if self.grid.is_some() { voxels } else { vertices };
        self.trees.iter().try_for_each(|tree| tree.check(elements))
    }
}

impl PageParts<'_> {
    fn check(&self, regions: usize, vertices: usize, voxels: usize) -> Result<(), ViewerError> {
        for (number, part) in self.list.iter().enumerate() {
            if let Some(region) = part.region {
                in_range("part", number, "region", region, regions)?;
            }
            for &twin in &part.twins {
                in_range("part", number, "part", twin, self.list.len())?;
            }
        }
        fits("parts of vertices", self.vertices.len(), vertices)?;
        fits("parts of voxels", self.voxels.len(), voxels)?;
        for (what, labels) in [("vertex", self.vertices), ("voxel", self.voxels)] {
            for (number, &label) in labels.iter().enumerate() {
                if let Ok(part) = u32::try_from(label) {
                    in_range(what, number, "part", part, self.list.len())?;
                }
            }
        }
        Ok(())
    }
}

impl PageTree<'_> {
    fn check(&self, elements: usize) -> Result<(), ViewerError> {
        let nodes = self.parents.len();
        fits("altitudes of a tree's nodes", self.altitudes.len(), nodes)?;
        fits("volumes of a tree's nodes", self.volumes.len(), nodes)?;
        fits("entry nodes of a tree", self.entry.len(), elements)?;
        for (number, &parent) in self.parents.iter().enumerate() {
            if parent != u32::MAX && (parent as usize <= number || parent as usize >= nodes) {
                let (name, value) = ("parent of a tree's node", format!("{parent} for node {number}"));
                let expected = "a greater number of a node, or u32::MAX for a root";
                return Err(InvalidParameter::new(name, value, expected).into());
            }
        }
        if let Some(number) = self.altitudes.iter().position(|a| a.is_nan()) {
            return Err(ViewerError::NotFinite { what: "the altitude of node", number });
        }
        self.entry.iter().enumerate().try_for_each(|(e, &n)| in_range("element", e, "node", n, nodes))
    }
}

fn in_range(
    what: &'static str,
    number: usize,
    target: &'static str,
    index: u32,
    count: usize,
) -> Result<(), ViewerError> {
    if (index as usize) < count {
        return Ok(());
    }
    Err(ViewerError::OutOfRange { what, number, target, index: index.into(), count })
}
