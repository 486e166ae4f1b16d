//! The surface of a result as it is drawn: in triangles of about a voxel, with smooth borders.

use mser3d_viewer::{Colours, Cut, Model, NO_REGION, Rgb, label_colour};

use crate::fine_surface::FineSurface;
use crate::{Results, ResultsError};

/// Triangles with longer edges, in voxels, are divided: borders run through them.
const LONGEST_EDGE: f64 = 2.0;
/// Borders are smoothed over so many voxels; of a surface, over so many edges.
const SMOOTH: f64 = 1.5;

/// What pictures of a result have in common: the surface and the light on it. Regions are drawn as the voxels below the surface have them, so that
/// triangles larger than a voxel show them too.
pub struct Drawing<'a> {
    results: &'a Results,
    /// The surface in one colour.
    plain: Model,
    fine: Option<FineSurface>,
    /// The length over which borders are smoothed.
    smooth: f64,
}

impl<'a> Drawing<'a> {
    /// The surface of a result.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`] where there is nothing to see.
    pub fn new(results: &'a Results) -> Result<Self, ResultsError> {
        let mesh = &results.mesh;
        let plain = Model::from_mesh(mesh, Colours::Uniform(NO_REGION))?;
        let fine = match &results.grid {
            Some(grid) if !results.mesh_of_voxels => Some(results.divided(grid, LONGEST_EDGE)?),
            _ => None,
        };
        let plain = match &fine {
            Some(fine) => plain.divided(&fine.divided)?,
            None => plain,
        };
        let edge = match &results.grid {
            Some(grid) => grid.frame().spacing().into_iter().fold(0.0, f64::max),
            // Of an equilateral triangle of the mean area.
            None => {
                let count = mesh.triangles().len();
                let area: f64 = (0..count).map(|t| mesh.triangle_area(t)).sum();
                (area / count as f64 * 4.0 / 3.0_f64.sqrt()).sqrt()
            }
        };
        Ok(Self { results, plain, fine, smooth: SMOOTH * edge })
    }

    /// The surface with each place in the colour of the innermost region, one colour per region.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`] when there is not one colour per region.
    pub fn regions(&self, colours: &[Rgb]) -> Result<Model, ResultsError> {
        self.labelled(&self.results.vertex_region(), &self.results.voxel_region(), colours)
    }

    /// The same with the number of each region that has a colour of its own written on it.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`] when there is not one colour per region.
    pub fn numbered(&self, colours: &[Rgb]) -> Result<Model, ResultsError> {
        let around = self.results.around();
        let number = |mut region: u32| {
            // What has the colour of the region around it has its number too.
            for _ in 0..colours.len() {
                let same = |p: &u32| colours.get(*p as usize) == colours.get(region as usize);
                let Some(parent) = around[region as usize].filter(same) else { break };
                region = parent;
            }
            let seen = colours.get(region as usize).is_some_and(|colour| *colour != NO_REGION);
            if seen { region.to_string() } else { String::new() }
        };
        Ok(self.regions(colours)?.with_labels((0..around.len() as u32).map(number).collect()))
    }

    /// The surface with one region in a colour.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`]: in theory.
    pub fn one(&self, region: u32, colour: Rgb) -> Result<Model, ResultsError> {
        let only = |members: &[Vec<u32>], count: usize| {
            let mut labels = vec![-1; count];
            let own = members.get(region as usize).into_iter().flatten();
            own.for_each(|&member| labels[member as usize] = 0);
            labels
        };
        let results = self.results;
        let vertices = only(&results.region_vertices, results.mesh.vertices().len());
        let voxels = only(&results.region_voxels, results.grid.as_ref().map_or(0, |grid| grid.len()));
        self.labelled(&vertices, &voxels, &[colour])
    }

    /// The surface cut open, and the regions inside. Of a surface without voxels, only coloured.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn section(&self, colours: &[Rgb], cut: &Cut) -> Result<Model, ResultsError> {
        let model = self.regions(colours)?;
        let Some(grid) = &self.results.grid else { return Ok(model) };
        let voxels: Vec<Rgb> =
            self.results.voxel_region().iter().map(|&label| label_colour(colours, label)).collect();
        Ok(model.cut_open(grid, &voxels, cut)?)
    }

    fn labelled(&self, vertices: &[i32], voxels: &[i32], colours: &[Rgb]) -> Result<Model, ResultsError> {
        let model = match &self.fine {
            Some(fine) => self.plain.with_regions(&fine.labels(vertices, voxels), colours)?,
            None => self.plain.with_regions(vertices, colours)?,
        };
        Ok(model.with_smooth_borders(self.smooth))
    }
}
