//! Shapes of several bodies: which of them are searched.

use mser3d_shape::{Components, Connectivity, Domain, VoxelGrid};

use crate::{DiscreteShape, Elements, Error, Warning};

mser3d_shape::choice! {
    /// What to do with a shape of several bodies, that is, of several connected components.
    ///
    /// A component counts as a body if it has at least [`MIN_BODY_ELEMENTS`] elements and a thousandth of the largest
    /// one's measure ([`MIN_BODY_FRACTION`]). What is smaller are specks, such as voxels at the tip of an ear. The
    /// largest component is a body at any size.
    pub enum Bodies("choice of bodies") {
        /// The largest body is searched, the others are left out
        #[default]
        Largest = "largest",
        /// Each body is searched on its own
        ///
        /// It has its own spectrum, its own times (relative to its own measure unless a reference is given) and its
        /// own component trees. Specks are left out.
        All = "all",
        /// All components are searched as one shape
        ///
        /// Specks too. Heat does not pass between components, so a small one is hot all over, and often a region
        /// as a whole.
        Join = "join",
    }
}

/// Fewest voxels, or vertices of a surface, that a body has.
pub const MIN_BODY_ELEMENTS: usize = 64;

/// The smallest measure of a body, over that of the largest.
pub const MIN_BODY_FRACTION: f64 = 1e-3;

/// The connected components of a shape, which of them are bodies, and which are searched.
pub(crate) struct Parts {
    pub components: Components,
    /// Volume or area of each.
    measures: Vec<f64>,
    /// Whether each is a body.
    is_body: Vec<bool>,
    /// Whether each is searched.
    kept: Vec<bool>,
}

impl Parts {
    /// The components of a shape, of which those with a measure can be searched.
    pub fn of(shape: &DiscreteShape, bodies: Bodies) -> Result<Self, Error> {
        Ok(match shape.elements() {
            Elements::Voxels { grid, connectivity } => Self::of_grid(grid, *connectivity, bodies)?,
            Elements::Vertices { mesh, edges } => {
                let components = edges.components();
                let mut measures = vec![0.0; components.len()];
                for (area, &label) in mesh.vertex_areas().iter().zip(&components.labels) {
                    measures[label as usize] += area;
                }
                Self::new(components, measures, bodies)
            }
        })
    }

    /// The components of a solid.
    pub fn of_grid(grid: &VoxelGrid, connectivity: Connectivity, bodies: Bodies) -> Result<Self, Error> {
        let components = match connectivity {
            Connectivity::Six => grid.components(),
            other => grid.graph(other)?.components(),
        };
        let measures = components.sizes.iter().map(|&n| n as f64 * grid.frame().voxel_volume()).collect();
        Ok(Self::new(components, measures, bodies))
    }

    fn new(components: Components, measures: Vec<f64>, bodies: Bodies) -> Self {
        let most = measures.iter().copied().fold(0.0, f64::max);
        let largest = measures.iter().position(|&m| m == most);
        let is_body: Vec<bool> = (0..measures.len())
            .map(|c| {
                let large =
                    components.sizes[c] >= MIN_BODY_ELEMENTS && measures[c] >= MIN_BODY_FRACTION * most;
                large || Some(c) == largest
            })
            .collect();
        let kept = match bodies {
            Bodies::Largest => (0..measures.len()).map(|c| Some(c) == largest).collect(),
            Bodies::All => is_body.clone(),
            Bodies::Join => vec![true; measures.len()],
        };
        let mut parts = Self { components, measures, is_body, kept };
        // What has no measure, such as vertices without triangles, changes nothing where there is but one body.
        if parts.measures.iter().filter(|&&m| m > 0.0).count() <= 1 {
            parts.kept.fill(true);
        }
        parts
    }

    /// Whether everything is searched.
    pub fn keeps_all(&self) -> bool {
        self.kept.iter().all(|kept| *kept)
    }

    /// Whether the component of an element is searched.
    pub fn keeps(&self, element: u32) -> bool {
        self.kept[self.components.labels[element as usize] as usize]
    }

    /// Whether the component of an element is a body.
    pub fn in_body(&self, element: u32) -> bool {
        self.is_body[self.components.labels[element as usize] as usize]
    }

    /// Components that are left out.
    pub fn dropped(&self) -> usize {
        self.kept.iter().filter(|kept| !**kept).count()
    }

    /// The elements of each body that is searched on its own, numbered among those that are searched, the largest body
    /// first. One of all elements where nothing parts them.
    pub fn searched(&self, bodies: Bodies) -> Vec<Vec<u32>> {
        let elements =
            (0u32..).zip(self.components.labels.iter().filter(|&&label| self.kept[label as usize]));
        let mut of_component = vec![Vec::new(); self.components.len()];
        match bodies {
            Bodies::All if !self.keeps_all() || self.is_body.iter().all(|body| *body) => {
                elements.for_each(|(element, &label)| of_component[label as usize].push(element));
            }
            _ => return vec![elements.map(|(element, _)| element).collect()],
        }
        let mut order: Vec<usize> = (0..self.kept.len()).filter(|&c| self.kept[c]).collect();
        order.sort_by(|&a, &b| self.measures[b].total_cmp(&self.measures[a]));
        order.into_iter().map(|c| std::mem::take(&mut of_component[c])).collect()
    }

    /// What is left out, if anything is that has a measure.
    pub fn warning(&self, domain: Domain) -> Option<Warning> {
        let dropped = || {
            (0..self.kept.len()).filter(|&component| !self.kept[component] && self.measures[component] > 0.0)
        };
        let total: f64 = self.measures.iter().sum();
        let measure: f64 = dropped().map(|c| self.measures[c]).sum();
        let mut bodies: Vec<usize> =
            dropped().filter(|&c| self.is_body[c]).map(|c| self.components.sizes[c]).collect();
        bodies.sort_unstable_by(|a, b| b.cmp(a));
        (dropped().next().is_some()).then(|| Warning::SmallerComponents {
            components: dropped().count(),
            elements: dropped().map(|c| self.components.sizes[c]).sum(),
            fraction: measure / total,
            bodies,
            domain,
        })
    }
}
