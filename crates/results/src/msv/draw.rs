use std::path::Path;

use mser3d_shape::{BitGrid, TriangleMesh, VoxelGrid};
use mser3d_viewer::{
    Image, Model, PageData, PageRegion, PageShape, Panel, RegionTraits, RenderOptions, Rgb, Up, page,
    region_colours, render, voxel_surface,
};
use mser3d_volumeio::Volume;

use super::grey::page_grey;
use super::{MsvRegion, MsvResults};
use crate::ResultsError;

/// The regions of all searches as voxels, in one list.
struct Drawn<'a> {
    regions: Vec<&'a MsvRegion>,
    /// The smallest region that contains each, in the list.
    parents: Vec<Option<u32>>,
    /// The voxels that are in any region.
    grid: VoxelGrid,
    /// The smallest region of each of these voxels, in the list.
    innermost: Vec<u32>,
    /// The faces of the voxels.
    mesh: TriangleMesh,
    /// The voxel of each of its vertices.
    vertex_voxel: Vec<i32>,
    /// Vertices and voxels of each region, ascending.
    members: Vec<[Vec<u32>; 2]>,
    colours: Vec<Rgb>,
}

impl MsvResults {
    /// One sheet: the voxels of the regions, in their colours, from four sides.
    ///
    /// # Errors
    /// [`ResultsError::NoRegions`], [`ResultsError::Viewer`].
    pub fn sheet(&self, options: &RenderOptions) -> Result<Image, ResultsError> {
        let drawn = self.drawn()?;
        let colours: Vec<Rgb> = drawn.innermost.iter().map(|&r| drawn.colours[r as usize]).collect();
        let model = Model::from_voxels(&drawn.grid, &colours, None)?;
        Ok(render(&Panel::around(&model), options)?)
    }

    /// A page that shows the regions in a browser: their voxels, the numbers of each, and beside them slices of the volume that
    /// they were found in, if it is given. Its values are not kept in the folder; read them from
    /// [`MsvRecord::volume`](super::MsvRecord::volume).
    ///
    /// # Errors
    /// [`ResultsError::NoRegions`], [`ResultsError::Viewer`], also for a volume of another size.
    pub fn page(&self, title: &str, up: Up, volume: Option<&Volume>) -> Result<String, ResultsError> {
        let drawn = self.drawn()?;
        let voxels: f64 = self.record.dims.iter().product::<usize>() as f64;
        let numbered = drawn.regions.iter().enumerate();
        let regions = numbered.map(|(id, region)| PageRegion {
            colour: drawn.colours[id],
            parent: drawn.parents[id],
            altitude: region.grey,
            stability: 1.0 / region.variation,
            reliability: None,
            lifetime: None,
            twin: None,
            side: None,
            volume: region.volume,
            volume_fraction: region.voxels as f64 / voxels,
            vertices: &drawn.members[id][0],
            voxels: &drawn.members[id][1],
            node: None,
        });
        let [x, y, z] = self.record.dims;
        let fact = |name: &str, value: String| [name.to_owned(), value];
        let mut facts = vec![
            fact("volume", self.record.volume.clone()),
            fact("voxels", format!("{x} x {y} x {z}")),
            fact("mser3d", self.record.mser3d.clone()),
        ];
        if volume.is_none() {
            facts.push(fact("grey values", "not shown: the volume was not at hand".to_owned()));
        }
        facts.extend(
            self.record.searches.iter().map(|search| {
                fact(&format!("{} regions", search.contrast), search.regions.len().to_string())
            }),
        );
        let shape = PageShape {
            name: self.name(),
            front: None,
            mesh: &drawn.mesh,
            grid: Some(&drawn.grid),
            vertex_voxel: &drawn.vertex_voxel,
            regions: regions.collect(),
            parts: None,
            grey: volume.map(page_grey),
            trees: Vec::new(),
            facts,
        };
        let (title, matches, part_matches) = (title.to_owned(), Vec::new(), Vec::new());
        Ok(page(&PageData { title, shapes: vec![shape], matches, part_matches, up })?)
    }

    /// The volume's file name, without folder and endings.
    pub fn name(&self) -> String {
        let name = Path::new(&self.record.volume).file_name().unwrap_or_default().to_string_lossy();
        name.split('.').find(|part| !part.is_empty()).unwrap_or("volume").to_owned()
    }

    fn drawn(&self) -> Result<Drawn<'_>, ResultsError> {
        if self.record.searches.iter().all(|search| search.regions.is_empty()) {
            return Err(ResultsError::NoRegions { volume: self.record.volume.clone() });
        }
        let [nx, ny, _] = self.record.dims;
        let mut regions = Vec::new();
        let mut parents = Vec::new();
        let mut smallest: Vec<Option<u32>> = vec![None; self.record.dims.iter().product()];
        for (search, labels) in self.record.searches.iter().zip(&self.labels) {
            let first = regions.len() as u32;
            regions.extend(&search.regions);
            parents.extend(search.regions.iter().map(|r| r.parent.map(|p| first + p)));
            for (best, label) in smallest.iter_mut().zip(labels) {
                let Some(label) = label.map(|l| first + l) else { continue };
                let size = |region: u32| regions[region as usize].voxels;
                if best.is_none_or(|best| size(label) < size(best)) {
                    *best = Some(label);
                }
            }
        }
        let mut inside = BitGrid::empty(self.record.dims)?;
        let place = |v: usize| [v % nx, v / nx % ny, v / (nx * ny)].map(|i| i as u32);
        (0..smallest.len()).filter(|&v| smallest[v].is_some()).for_each(|v| inside.set(place(v), true));
        let grid = VoxelGrid::solid(self.frame()?, inside)?;
        let innermost: Vec<u32> = smallest.into_iter().flatten().collect();
        let mesh = voxel_surface(&grid)?;
        let nearest = grid.nearest_voxels(mesh.vertices());
        // A voxel belongs to its smallest region and to all around that.
        let mut members = vec![[Vec::new(), Vec::new()]; regions.len()];
        let mut add = |which: usize, member: u32, innermost: u32| {
            let mut region = Some(innermost);
            while let Some(r) = region {
                members[r as usize][which].push(member);
                region = parents[r as usize];
            }
        };
        (0..).zip(&nearest).for_each(|(vertex, &voxel)| add(0, vertex, innermost[voxel as usize]));
        (0..).zip(&innermost).for_each(|(voxel, &region)| add(1, voxel, region));
        let labels: Vec<i32> = nearest.iter().map(|&v| innermost[v as usize] as i32).collect();
        let traits =
            |(id, &parent): (u32, &Option<u32>)| RegionTraits { parent, family: Some(id), side: None };
        let traits: Vec<RegionTraits> = (0..).zip(&parents).map(traits).collect();
        let colours = region_colours(&traits, &labels, &mesh.edge_graph());
        let vertex_voxel = nearest.into_iter().map(|voxel| voxel as i32).collect();
        Ok(Drawn { regions, parents, grid, innermost, mesh, vertex_voxel, members, colours })
    }
}
