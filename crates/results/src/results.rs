use mser3d::Features;
use mser3d::comptree::NodeLists;
use mser3d_shape::{Domain, IndexSet, TriangleMesh, VoxelGrid};
use mser3d_viewer::{RegionTraits, Rgb, region_colours, voxel_surface};

use crate::{Eigenfunctions, Extra, InputRecord, Record, RegionRecord, ResultsError, ShapeFile};

/// What was found on a shape, as it is written to a folder, drawn and compared.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Results {
    /// What `regions.json` says.
    pub record: Record,
    /// The surface: the input mesh, or the faces of a solid that was given as voxels.
    pub mesh: TriangleMesh,
    /// Whether the mesh was made of the voxels' faces.
    pub mesh_of_voxels: bool,
    /// The mesh's vertex of each vertex of a file that repeats them (STL, glTF).
    pub file_vertex: Option<Vec<u32>>,
    /// The voxels of a volume.
    pub grid: Option<VoxelGrid>,
    /// The vertices of each region, ascending.
    pub region_vertices: Vec<Vec<u32>>,
    /// The voxels of each region, ascending; of a surface, none.
    pub region_voxels: Vec<Vec<u32>>,
    /// The voxel that each vertex takes its regions from, -1 for vertices of bodies that were not searched; of a surface, none.
    pub vertex_voxel: Vec<i32>,
    /// The part of each vertex, -1 for those of bodies that were not searched; empty where no parts were asked for.
    pub vertex_part: Vec<i32>,
    /// The part of each voxel; of a surface, and where no parts were asked for, empty.
    pub voxel_part: Vec<i32>,
    /// Eigenvalues of the Laplacian in length^-2, of each body.
    pub eigenvalues: Vec<Vec<f64>>,
    /// Length of a descriptor.
    pub descriptor_width: usize,
    /// A descriptor per region, row by row.
    pub descriptors: Vec<f64>,
    /// How near each two regions are to each other, row by row: [`mser3d::Features::cosines`].
    pub cosines: Vec<f64>,
    /// The nodes of the trees. None of a large shape, whose trees are not kept ([`mser3d::Tree::tree`]): see
    /// [`with_trees`](Self::with_trees).
    pub trees: Vec<TreeArrays>,
    /// The eigenpairs of each body, where they were kept to be written ([`Extra::Eigenfunctions`](crate::Extra)). A result that is
    /// read has none: see [`Eigenfunctions::load`].
    pub eigenfunctions: Option<Vec<Eigenfunctions>>,
}

/// The nodes of a component tree, children before parents.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TreeArrays {
    /// Parent of each node; `u32::MAX` for a root.
    pub parents: Vec<u32>,
    /// Altitude of each node.
    pub altitudes: Vec<f64>,
    /// Volume of each node.
    pub volumes: Vec<f64>,
    /// The node in which each voxel (of a surface: each vertex) enters; `u32::MAX` for those that are not in its body.
    pub entry: Vec<u32>,
}

impl Results {
    /// What was found on a file.
    ///
    /// # Errors
    /// [`ResultsError::OtherMesh`] when the features are not that file's.
    pub fn of_file(features: &Features, file: &ShapeFile) -> Result<Self, ResultsError> {
        let record = Record::new(features, file.record(), file.notes());
        let file_vertex = file.loaded().and_then(|l| l.weld.clone());
        Ok(Self { file_vertex, ..Self::with_record(record, features, file.mesh())? })
    }

    /// What was found on a mesh, or (without one) on a solid given as voxels, whose outer faces then serve as its
    /// mesh. `name` tells people where it came from; see [`Results::of_file`] for files.
    ///
    /// # Errors
    /// [`ResultsError::OtherMesh`] when the features are not that mesh's.
    pub fn new(features: &Features, mesh: Option<&TriangleMesh>, name: &str) -> Result<Self, ResultsError> {
        Self::with_record(Record::new(features, InputRecord::named(name), &[]), features, mesh)
    }

    /// The same results with what some of the files that are written besides need.
    #[must_use]
    pub fn with_extras(self, features: &Features, extras: &[Extra]) -> Self {
        let kept =
            extras.iter().any(|extra| extra.needs_eigenfunctions()).then(|| Eigenfunctions::of(features));
        Self { eigenfunctions: kept, ..self }
    }

    /// The same results with the nodes of all trees, also where they have to be made anew.
    ///
    /// # Errors
    /// [`ResultsError::TreeOfFeatures`].
    pub fn with_trees(mut self, features: &Features) -> Result<Self, ResultsError> {
        if self.trees.len() < features.trees.len() {
            let all = 0..features.trees.len();
            self.trees = all.map(|tree| TreeArrays::of(features, tree)).collect::<Result<_, _>>()?;
        }
        Ok(self)
    }

    fn with_record(
        record: Record,
        features: &Features,
        mesh: Option<&TriangleMesh>,
    ) -> Result<Self, ResultsError> {
        let shape = &features.shape;
        let grid = shape.grid();
        let region_vertices = features.regions.iter().map(|r| r.vertices.clone()).collect();
        let elements = features.regions.iter().map(|r| r.elements.clone());
        let region_voxels = elements.map(|e| if grid.is_some() { e } else { Vec::new() }).collect();
        let voxel = |element: &Option<u32>| element.map_or(-1, |voxel| voxel as i32);
        let vertex_voxel = match grid {
            Some(_) => shape.element_of_vertex().iter().map(voxel).collect(),
            None => Vec::new(),
        };
        let parts = features.partition.as_ref();
        let vertex_part = parts.map_or_else(Vec::new, |found| {
            found.part_of_vertex.iter().map(|part| part.map_or(-1, |part| part as i32)).collect()
        });
        let voxel_part = parts
            .filter(|_| grid.is_some())
            .map_or_else(Vec::new, |found| found.part_of_element.iter().map(|&part| part as i32).collect());
        let expected = shape.element_of_vertex().len();
        let found = mesh.map_or(0, |m| m.vertices().len());
        if found != expected {
            return Err(ResultsError::OtherMesh { found, expected });
        }
        let results = Self {
            record,
            mesh: mesh.cloned().unwrap_or(TriangleMesh::new(Vec::new(), Vec::new())?),
            mesh_of_voxels: false,
            file_vertex: None,
            grid: grid.cloned(),
            region_vertices,
            region_voxels,
            vertex_voxel,
            vertex_part,
            voxel_part,
            eigenvalues: features.bodies.iter().map(|body| body.basis.eigenvalues().to_vec()).collect(),
            descriptor_width: features.descriptors.width(),
            descriptors: features.descriptors.values().to_vec(),
            cosines: features.cosines.values().to_vec(),
            trees: Vec::new(),
            eigenfunctions: None,
        };
        let kept = features.trees.iter().all(|tree| tree.tree.is_some());
        let results = if kept { results.with_trees(features)? } else { results };
        if mesh.is_some() { Ok(results) } else { results.with_voxel_surface() }
    }

    /// Takes the faces of the voxels as the mesh.
    pub(crate) fn with_voxel_surface(mut self) -> Result<Self, ResultsError> {
        let Some(grid) = &self.grid else { return Ok(self) };
        self.mesh = voxel_surface(grid)?;
        self.mesh_of_voxels = true;
        let nearest = grid.nearest_voxels(self.mesh.vertices());
        let vertices_of = |voxels: &Vec<u32>| {
            let inside = IndexSet::from_members(grid.len(), voxels.iter().copied())?;
            let vertices = (0u32..).zip(&nearest).filter(|&(_, &v)| inside.contains(v as usize));
            Ok(vertices.map(|(vertex, _)| vertex).collect())
        };
        let region_vertices: Result<_, ResultsError> = self.region_voxels.iter().map(vertices_of).collect();
        self.region_vertices = region_vertices?;
        self.vertex_voxel = nearest.iter().map(|&voxel| voxel as i32).collect();
        if self.record.parts.is_some() {
            self.vertex_part = nearest.iter().map(|&voxel| self.voxel_part[voxel as usize]).collect();
        }
        Ok(self)
    }

    /// The input's file name, without folder and ending.
    pub fn name(&self) -> String {
        self.record.name()
    }

    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        self.record.domain
    }

    /// The innermost region of each vertex; -1 for none.
    pub fn vertex_region(&self) -> Vec<i32> {
        labels(self.mesh.vertices().len(), &self.region_vertices)
    }

    /// The innermost region of each voxel; -1 for none.
    pub fn voxel_region(&self) -> Vec<i32> {
        labels(self.grid.as_ref().map_or(0, VoxelGrid::len), &self.region_voxels)
    }

    /// The descriptor of a region.
    pub fn descriptor(&self, region: usize) -> &[f64] {
        &self.descriptors[region * self.descriptor_width..][..self.descriptor_width]
    }

    /// The colour of each region, in all pictures of these results ([`region_colours`]): a hue for each region and its twin,
    /// a tone for each side. Where hues run out, small regions have the colour of those around them. The regions of a frame of a
    /// sequence have the colours of their tracks.
    pub fn colours(&self) -> Vec<Rgb> {
        let regions = &self.record.regions;
        let own: Option<Vec<Rgb>> = regions.iter().map(|region| region.colour.map(Rgb)).collect();
        if let (Some(own), false) = (own, regions.is_empty()) {
            return own;
        }
        region_colours(&self.traits(), &self.vertex_region(), &self.mesh.edge_graph())
    }

    /// What colours say of the regions.
    pub(crate) fn traits(&self) -> Vec<RegionTraits> {
        let mut traits = traits(&self.record.regions);
        traits.iter_mut().zip(self.around()).for_each(|(traits, around)| traits.parent = around);
        traits
    }

    /// The region in which each is seen to lie: [`around`].
    pub(crate) fn around(&self) -> Vec<Option<u32>> {
        around(if self.grid.is_some() { &self.region_voxels } else { &self.region_vertices })
    }

    /// The node of a region in its tree: on the way up from one of its elements, the one that comes
    /// into being at its altitude. `None` if the trees are not there.
    pub fn node(&self, region: usize) -> Option<u32> {
        let record = &self.record.regions[region];
        let tree = self.trees.get(record.tree as usize)?;
        let members = if self.grid.is_some() { &self.region_voxels } else { &self.region_vertices };
        let mut node = tree.entry[*members[region].first()? as usize];
        if node == u32::MAX {
            return None;
        }
        let gap = |n: u32| (tree.altitudes[n as usize] - record.altitude).abs();
        let mut best = node;
        while tree.parents[node as usize] != u32::MAX {
            node = tree.parents[node as usize];
            if gap(node) < gap(best) {
                best = node;
            }
        }
        Some(best)
    }
}

/// The share of a region that lies in another one, from which it is seen to lie in it.
const NEARLY_ALL: f64 = 0.9;

/// For each region the smallest larger one that holds nearly all of it: those of several trees need not nest to the last voxel. Regions come
/// by falling size.
fn around(regions: &[Vec<u32>]) -> Vec<Option<u32>> {
    let universe = regions.iter().flatten().max().map_or(0, |&member| member as usize + 1);
    let sets: Vec<IndexSet> =
        regions.iter().filter_map(|own| IndexSet::from_members(universe, own.iter().copied()).ok()).collect();
    let around = |(region, own): (usize, &IndexSet)| {
        let size = regions[region].len();
        let nearly = |larger: &IndexSet| {
            let shared = larger.common(own);
            shared > 0 && shared as f64 >= NEARLY_ALL * size as f64
        };
        sets[..region].iter().rposition(nearly).map(|larger| larger as u32)
    };
    sets.iter().enumerate().map(around).collect()
}

impl TreeArrays {
    /// The nodes of one of the trees.
    ///
    /// # Errors
    /// [`ResultsError::TreeOfFeatures`], where it has to be made anew.
    pub(crate) fn of(features: &Features, number: usize) -> Result<Self, ResultsError> {
        let tree = features.tree(number).map_err(|error| ResultsError::TreeOfFeatures(Box::new(error)))?;
        let NodeLists { parents, altitudes, volumes, node_of } = tree.into_owned().into_lists();
        let elements = &features.bodies[features.trees[number].body].elements;
        let of_element = if elements.len() == features.shape.len() {
            node_of
        } else {
            let mut of_element = vec![u32::MAX; features.shape.len()];
            elements.iter().zip(node_of).for_each(|(&element, node)| of_element[element as usize] = node);
            of_element
        };
        let of_vertex = |element: &Option<u32>| element.map_or(u32::MAX, |e| of_element[e as usize]);
        let entry = match features.shape.domain() {
            Domain::Volume => of_element,
            Domain::Surface => features.shape.element_of_vertex().iter().map(of_vertex).collect(),
        };
        Ok(Self { parents, altitudes, volumes, entry })
    }
}

/// What colours say of regions, or of parts as regions.
pub(crate) fn traits(regions: &[RegionRecord]) -> Vec<RegionTraits> {
    let family = |r: &RegionRecord| Some(r.twin.map_or(r.id, |twin| twin.min(r.id)));
    let traits = |r: &RegionRecord| RegionTraits { parent: r.parent, family: family(r), side: r.side };
    regions.iter().map(traits).collect()
}

/// Innermost regions as files have them: -1 for none. Regions come by falling size.
pub(crate) fn labels(count: usize, regions: &[Vec<u32>]) -> Vec<i32> {
    let mut labels = vec![-1; count];
    for (number, members) in (0..).zip(regions) {
        members.iter().for_each(|&member| labels[member as usize] = number);
    }
    labels
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_lies_in_the_smallest_that_holds_nearly_all_of_it() {
        let regions: Vec<Vec<u32>> =
            [0..100, 0..50, 31..51, 95..105, 20..30, 90..92].map(Iterator::collect).into();
        // The third sticks out of the second by a twentieth, the fourth out of the first by half.
        assert_eq!(around(&regions), [None, Some(0), Some(1), None, Some(1), Some(0)]);
    }
}
