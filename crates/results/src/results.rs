use mser3d::Features;
use mser3d_shape::{Domain, TriangleMesh, VoxelGrid};
use mser3d_viewer::{Rgb, region_colours, voxel_surface};

use crate::{Record, ResultsError};

/// What was found on a shape, as it is written to a folder, drawn and compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Results {
    /// What `regions.json` says.
    pub record: Record,
    /// The surface: the input mesh, or the faces of a solid that was given as voxels.
    pub mesh: TriangleMesh,
    /// Whether the mesh was made of the voxels' faces.
    pub mesh_of_voxels: bool,
    /// The voxels of a volume.
    pub grid: Option<VoxelGrid>,
    /// The vertices of each region, ascending.
    pub region_vertices: Vec<Vec<u32>>,
    /// The voxels of each region, ascending; of a surface, none.
    pub region_voxels: Vec<Vec<u32>>,
    /// Eigenvalues of the Laplacian in length^-2.
    pub eigenvalues: Vec<f64>,
    /// Length of a descriptor.
    pub descriptor_width: usize,
    /// A descriptor per region, row by row.
    pub descriptors: Vec<f64>,
    /// The nodes of the trees.
    pub trees: Vec<TreeArrays>,
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
    /// The node in which each voxel (of a surface: each vertex) enters.
    pub entry: Vec<u32>,
}

impl Results {
    /// The results of [`mser3d::detect`] on a mesh, or (without one) on a solid given as voxels, whose
    /// outer faces then serve as its mesh. `path` names the input.
    ///
    /// # Errors
    /// [`ResultsError::OtherMesh`] when the features are not that mesh's.
    pub fn new(features: &Features, mesh: Option<&TriangleMesh>, path: &str) -> Result<Self, ResultsError> {
        let body = &features.body;
        let grid = body.grid();
        let record = Record::new(features, path);
        let region_vertices = features.regions.iter().map(|r| r.vertices.clone()).collect();
        let elements = features.regions.iter().map(|r| r.elements.clone());
        let region_voxels = elements.map(|e| if grid.is_some() { e } else { Vec::new() }).collect();
        let trees = features.trees.iter().map(|t| TreeArrays {
            parents: (0..t.tree.len() as u32).map(|n| t.tree.parent(n).unwrap_or(u32::MAX)).collect(),
            altitudes: t.tree.altitudes().to_vec(),
            volumes: (0..t.tree.len() as u32).map(|n| t.tree.volume(n)).collect(),
            entry: t.tree.nodes_of_vertices().to_vec(),
        });
        let expected = body.element_of_vertex().len();
        let found = mesh.map_or(0, |m| m.vertices().len());
        if found != expected {
            return Err(ResultsError::OtherMesh { found, expected });
        }
        let results = Self {
            record,
            mesh: mesh.cloned().unwrap_or(TriangleMesh::new(Vec::new(), Vec::new())?),
            mesh_of_voxels: false,
            grid: grid.cloned(),
            region_vertices,
            region_voxels,
            eigenvalues: features.basis.eigenvalues().to_vec(),
            descriptor_width: features.descriptors.width(),
            descriptors: features.descriptors.values().to_vec(),
            trees: trees.collect(),
        };
        if mesh.is_some() { Ok(results) } else { results.with_voxel_surface() }
    }

    /// Takes the faces of the voxels as the mesh.
    pub(crate) fn with_voxel_surface(mut self) -> Result<Self, ResultsError> {
        let Some(grid) = &self.grid else { return Ok(self) };
        self.mesh = voxel_surface(grid)?;
        self.mesh_of_voxels = true;
        let nearest = grid.nearest_voxels(self.mesh.vertices());
        let vertices_of = |voxels: &Vec<u32>| {
            let mut inside = vec![false; grid.len()];
            voxels.iter().for_each(|&v| inside[v as usize] = true);
            let vertices = (0u32..).zip(&nearest).filter(|&(_, &v)| inside[v as usize]);
            vertices.map(|(vertex, _)| vertex).collect()
        };
        self.region_vertices = self.region_voxels.iter().map(vertices_of).collect();
        Ok(self)
    }

    /// Volume or surface.
    pub fn domain(&self) -> Domain {
        self.record.domain
    }

    /// The innermost region of each vertex; -1 for none.
    pub fn vertex_region(&self) -> Vec<i32> {
        innermost(self.mesh.vertices().len(), &self.region_vertices)
    }

    /// The innermost region of each voxel; -1 for none.
    pub fn voxel_region(&self) -> Vec<i32> {
        innermost(self.grid.as_ref().map_or(0, VoxelGrid::len), &self.region_voxels)
    }

    /// The descriptor of a region.
    pub fn descriptor(&self, region: usize) -> &[f64] {
        &self.descriptors[region * self.descriptor_width..][..self.descriptor_width]
    }

    /// The colour of each region, in all pictures of these results: neighbours on the surface differ,
    /// and regions differ from those that contain them.
    pub fn colours(&self) -> Vec<Rgb> {
        let regions = &self.record.regions;
        let nested: Vec<[u32; 2]> =
            regions.iter().filter_map(|r| r.parent.map(|parent| [parent, r.id])).collect();
        region_colours(regions.len(), &self.vertex_region(), &self.mesh.edge_graph(), &nested)
    }

    /// The node of a region in its tree: on the way up from one of its elements, the one that comes
    /// into being at its altitude. `None` if the trees are not there.
    pub fn node(&self, region: usize) -> Option<u32> {
        let record = &self.record.regions[region];
        let tree = self.trees.get(record.tree as usize)?;
        let members = if self.grid.is_some() { &self.region_voxels } else { &self.region_vertices };
        let mut node = tree.entry[*members[region].first()? as usize];
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

/// Regions come by descending volume, so the last that has a member is the smallest.
fn innermost(count: usize, regions: &[Vec<u32>]) -> Vec<i32> {
    let mut labels = vec![-1; count];
    for (id, members) in regions.iter().enumerate() {
        members.iter().for_each(|&m| labels[m as usize] = id as i32);
    }
    labels
}
