//! What is drawn: triangles with normals, colours and light, perhaps cut open.

use std::collections::BTreeMap;

use mser3d_shape::vector::{Vec3, scale, sub, unit};
use mser3d_shape::{BoundingBox, Graph, Subdivision, TriangleMesh, VoxelGrid};

use crate::borders::{self, Shares};
use crate::cut::Cut;
use crate::occlusion::openness;
use crate::section::{Filling, is_closed};
use crate::{NO_REGION, Rgb, ViewerError, normals, section};

/// How a surface is coloured.
#[derive(Clone, Copy, Debug)]
pub enum Colours<'a> {
    /// One colour.
    Uniform(Rgb),
    /// One colour per vertex, blended over the triangles: scalar fields.
    Vertices(&'a [Rgb]),
    /// One colour per triangle.
    Triangles(&'a [Rgb]),
    /// The region of each vertex (negative: none) and the colour of each region, with crisp borders
    /// between them.
    Regions {
        /// One region number per vertex.
        labels: &'a [i32],
        /// One colour per region.
        colours: &'a [Rgb],
    },
}

/// Something to draw: triangles with normals, colours and the light that reaches them.
#[derive(Clone, Debug)]
pub struct Model {
    pub(crate) points: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Normals at the corners of each triangle.
    pub(crate) normals: Vec<[[f32; 3]; 3]>,
    /// The share of the sky each vertex sees, 0 to 1.
    pub(crate) openness: Vec<f32>,
    /// Index of each vertex into `colours`.
    pub(crate) paint: Vec<u32>,
    /// Where borders are smooth, how much of each vertex belongs to which of `colours`; else empty.
    pub(crate) shares: Vec<Shares>,
    pub(crate) colours: Vec<[f32; 3]>,
    /// Whether colours are mixed between vertices; otherwise each place takes the prevailing one.
    pub(crate) blend: bool,
    pub(crate) section: Option<Section>,
    /// What is written on each region; empty for nothing.
    pub(crate) labels: Vec<String>,
}

/// How a model is cut open.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub cut: Cut,
    /// Triangles before this one are clipped by the plane.
    pub clipped: usize,
    /// What fills the cut of a closed surface; an open one is filled by polygons instead.
    pub filling: Option<Filling>,
}

impl Model {
    /// A surface. Its normals are smooth but for creases of more than 50 degrees; a closed mesh that
    /// is inside out is drawn as if it were not.
    ///
    /// Cost: dominated by ambient occlusion, some 100 ms CPU for 10^4 vertices.
    ///
    /// # Errors
    /// [`ViewerError::Empty`] without triangles; [`ViewerError::SizeMismatch`] when colours and mesh
    /// differ; [`ViewerError::OutOfRange`] for a label without a colour.
    pub fn from_mesh(mesh: &TriangleMesh, colours: Colours<'_>) -> Result<Self, ViewerError> {
        if mesh.triangles().is_empty() {
            return Err(ViewerError::Empty { reason: "the mesh has no triangles" });
        }
        let mut points = mesh.vertices().to_vec();
        let mut triangles = mesh.triangles().to_vec();
        let normals::Normals { corners, mut vertices } = normals::smooth(mesh);
        let n = points.len();
        let (paint, palette, blend) = match colours {
            Colours::Uniform(colour) => (vec![0; n], vec![colour], false),
            Colours::Vertices(c) => {
                fits("colours per vertex", c.len(), n)?;
                ((0..n as u32).collect(), c.to_vec(), true)
            }
            Colours::Triangles(c) => {
                fits("colours per triangle", c.len(), triangles.len())?;
                // Each triangle gets corners of its own, which all carry its colour.
                points = triangles.iter().flatten().map(|&v| points[v as usize]).collect();
                vertices = triangles.iter().flatten().map(|&v| vertices[v as usize]).collect();
                let t = triangles.len() as u32;
                triangles = (0..t).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
                ((0..3 * t).map(|i| i / 3).collect(), c.to_vec(), false)
            }
            Colours::Regions { labels, colours } => {
                fits("labels per vertex", labels.len(), n)?;
                let palette = [NO_REGION].iter().chain(colours).copied().collect();
                (region_paint(labels, colours.len())?, palette, false)
            }
        };
        let openness = openness(&points, &triangles, &vertices);
        let mut model = Self {
            points,
            triangles,
            normals: corners,
            openness,
            paint: Vec::new(),
            shares: Vec::new(),
            colours: Vec::new(),
            blend,
            section: None,
            labels: Vec::new(),
        };
        match colours {
            // Regions of one colour stay apart: a line is drawn between them.
            Colours::Regions { .. } => {
                (model.paint, model.colours) = (paint, palette.into_iter().map(Rgb::linear).collect());
            }
            _ => model.paint = model.intern(&palette, &paint),
        }
        Ok(model)
    }

    /// The same surface with regions coloured anew; what light reaches it is not computed again.
    ///
    /// # Errors
    /// [`ViewerError::SizeMismatch`] unless there is one label per vertex, and the model was made of a mesh
    /// with colours by vertex or by region; [`ViewerError::OutOfRange`] for a label without a colour.
    pub fn with_regions(&self, labels: &[i32], colours: &[Rgb]) -> Result<Self, ViewerError> {
        fits("labels per vertex", labels.len(), self.points.len())?;
        let paint = region_paint(labels, colours.len())?;
        let colours = [NO_REGION].iter().chain(colours).map(|colour| colour.linear()).collect();
        let (shares, labels) = (Vec::new(), Vec::new());
        Ok(Self { colours, paint, shares, blend: false, section: None, labels, ..self.clone() })
    }

    /// The same surface in smaller triangles, for regions whose borders run through the triangles. It looks the same: normals and light are those of the
    /// surface before. Of one colour until [`Model::with_regions`] gives it regions.
    ///
    /// # Errors
    /// [`ViewerError::SizeMismatch`] unless this is the whole surface of the mesh that was divided.
    pub fn divided(&self, divided: &Subdivision) -> Result<Self, ViewerError> {
        let own = divided.mesh().vertices().iter().zip(&self.points).take_while(|(a, b)| a == b).count();
        fits("vertices of the mesh that was divided", own, self.points.len())?;
        let own = divided.pieces().last().map_or(0, |(triangle, _)| *triangle as usize + 1);
        fits("triangles of the mesh that was divided", own, self.triangles.len())?;
        let corners = |triangle: u32| self.triangles[triangle as usize].map(|v| self.openness[v as usize]);
        let light = |(triangle, weights): &(u32, [f64; 3])| {
            corners(*triangle).iter().zip(weights).map(|(light, w)| light * *w as f32).sum()
        };
        let normal = |(triangle, corners): &(u32, [[f64; 3]; 3])| {
            let whole = &self.normals[*triangle as usize];
            let at =
                |axis: usize, w: &[f64; 3]| (0..3).map(|i| w[i] * f64::from(whole[i][axis])).sum::<f64>();
            corners.map(|weights| unit(std::array::from_fn(|axis| at(axis, &weights))).map(|x| x as f32))
        };
        let mesh = divided.mesh();
        Ok(Self {
            points: mesh.vertices().to_vec(),
            triangles: mesh.triangles().to_vec(),
            normals: divided.pieces().iter().map(normal).collect(),
            openness: divided.places().iter().map(light).collect(),
            paint: vec![0; mesh.vertices().len()],
            colours: vec![NO_REGION.linear()],
            ..Self::empty()
        })
    }

    /// The same with borders between regions that run smoothly: labels are averaged over a length along the surface, in the unit of its coordinates
    /// (a standard deviation), and each place takes the one that has most there.
    #[must_use]
    pub fn with_smooth_borders(self, length: f64) -> Self {
        if self.blend {
            return self;
        }
        let sides = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
        let edges: Vec<[u32; 2]> = self.triangles.iter().flat_map(sides).collect();
        // Triangles were checked when the model was made.
        let Ok(edges) = Graph::from_edges(self.points.len(), &edges) else { return self };
        let shares = borders::smoothed(&self.points, &edges, &self.paint, length);
        Self { shares, ..self }
    }

    /// The same with a text on each region, such as its number; empty for none. Regions with one text count as one. It is written
    /// where there is most room, and left out where there is too little.
    #[must_use]
    pub fn with_labels(self, labels: Vec<String>) -> Self {
        Self { labels, ..self }
    }

    /// The exposed faces of a voxel grid, one colour per voxel; with a cut, of the voxels whose centre
    /// is kept.
    ///
    /// # Errors
    /// [`ViewerError::SizeMismatch`] when colours and grid differ; [`ViewerError::Empty`] when no voxel
    /// is left; [`ViewerError::InvalidParameter`] for a cut that is no plane.
    pub fn from_voxels(grid: &VoxelGrid, colours: &[Rgb], cut: Option<&Cut>) -> Result<Self, ViewerError> {
        fits("colours per voxel", colours.len(), grid.len())?;
        cut.map_or(Ok(()), Cut::check)?;
        let faces = section::exposed_faces(grid, cut);
        if faces.is_empty() {
            return Err(ViewerError::Empty { reason: "no voxel is left" });
        }
        let mut model = Self::empty();
        model.add_polygons(&faces, colours);
        let normals: Vec<Vec3> = faces.iter().flat_map(|f| [f.normal; 4]).collect();
        model.openness = openness(&model.points, &model.triangles, &normals);
        Ok(model)
    }

    /// A surface cut open by a plane; the cut shows the voxels inside in their colours. Of a closed
    /// surface the cut is filled up to the surface, with straight borders between colours; of an open
    /// one the cut voxels are drawn.
    ///
    /// # Errors
    /// As [`Model::from_mesh`] and [`Model::from_voxels`].
    pub fn from_section(
        mesh: &TriangleMesh,
        colours: Colours<'_>,
        grid: &VoxelGrid,
        voxel_colours: &[Rgb],
        cut: &Cut,
    ) -> Result<Self, ViewerError> {
        Self::from_mesh(mesh, colours)?.cut_open(grid, voxel_colours, cut)
    }

    /// A surface that is there already, cut open as by [`Model::from_section`].
    ///
    /// # Errors
    /// As [`Model::from_voxels`].
    pub fn cut_open(
        mut self,
        grid: &VoxelGrid,
        voxel_colours: &[Rgb],
        cut: &Cut,
    ) -> Result<Self, ViewerError> {
        fits("colours per voxel", voxel_colours.len(), grid.len())?;
        cut.check()?;
        let clipped = self.triangles.len();
        let filling = if is_closed(&self.triangles) && !grid.is_empty() {
            let voxels: Vec<u32> = (0..grid.len() as u32).collect();
            let paint = self.intern(voxel_colours, &voxels);
            Some(Filling { grid: grid.clone(), paint })
        } else {
            self.add_polygons(&section::cut_face(grid, cut), voxel_colours);
            None
        };
        self.section = Some(Section { cut: *cut, clipped, filling });
        Ok(self)
    }

    fn empty() -> Self {
        Self {
            points: Vec::new(),
            triangles: Vec::new(),
            normals: Vec::new(),
            openness: Vec::new(),
            paint: Vec::new(),
            shares: Vec::new(),
            colours: Vec::new(),
            blend: false,
            section: None,
            labels: Vec::new(),
        }
    }

    /// Adds a palette and gives the place of each of its entries `used` among all colours. Unless
    /// colours are blended, equal ones share a place: no line is drawn between them.
    fn intern(&mut self, palette: &[Rgb], used: &[u32]) -> Vec<u32> {
        let mut places = BTreeMap::new();
        for (i, &colour) in self.colours.iter().enumerate() {
            places.insert(colour.map(f32::to_bits), i as u32);
        }
        let place = |colour: &Rgb| {
            let linear = colour.linear();
            let next = self.colours.len() as u32;
            let at = *places.entry(linear.map(f32::to_bits)).or_insert(next);
            if at == next {
                self.colours.push(linear);
            }
            at
        };
        let place: Vec<u32> = palette.iter().map(place).collect();
        used.iter().map(|&i| place[i as usize]).collect()
    }

    /// Adds flat convex polygons in the open, each with the colour of its voxel.
    fn add_polygons<C: AsRef<[Vec3]>>(&mut self, polygons: &[section::Face<C>], colours: &[Rgb]) {
        let voxels: Vec<u32> = polygons.iter().map(|f| f.voxel).collect();
        for (face, paint) in polygons.iter().zip(self.intern(colours, &voxels)) {
            let corners = face.corners.as_ref();
            let first = self.points.len() as u32;
            self.points.extend(corners);
            self.paint.extend(std::iter::repeat_n(paint, corners.len()));
            if !self.shares.is_empty() {
                self.shares.extend(std::iter::repeat_n(borders::whole(paint), corners.len()));
            }
            self.openness.extend(std::iter::repeat_n(1.0, corners.len()));
            for i in 2..corners.len() as u32 {
                self.triangles.push([first, first + i - 1, first + i]);
                self.normals.push([face.normal.map(|x| x as f32); 3]);
            }
        }
    }

    /// Centre of the box around all triangles.
    pub(crate) fn centre(&self) -> Vec3 {
        let used = self.triangles.iter().flatten().map(|&v| self.points[v as usize]);
        BoundingBox::around(used).map_or([0.0; 3], |b| scale(sub(b.max, scale(b.min, -1.0)), 0.5))
    }
}

pub(crate) fn fits(what: &'static str, found: usize, expected: usize) -> Result<(), ViewerError> {
    if found == expected { Ok(()) } else { Err(ViewerError::SizeMismatch { what, found, expected }) }
}

/// For each vertex, the index into a palette whose first colour stands for no region.
fn region_paint(labels: &[i32], regions: usize) -> Result<Vec<u32>, ViewerError> {
    let paint = labels.iter().enumerate().map(|(vertex, &label)| match usize::try_from(label) {
        Err(_) => Ok(0),
        Ok(r) if r < regions => Ok(r as u32 + 1),
        Ok(_) => Err(ViewerError::OutOfRange {
            what: "vertex",
            number: vertex,
            target: "region",
            index: label.into(),
            count: regions,
        }),
    });
    paint.collect()
}
