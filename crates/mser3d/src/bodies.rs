//! Shapes of several bodies: which of them are searched.

use mser3d_shape::{Components, Connectivity, Domain, VoxelGrid};

use crate::{DiscreteShape, Elements, Error, Warning};

mser3d_shape::choice! {
    /// What to do with a shape of several bodies, that is, of several connected components.
    ///
    /// A component counts as a body if it has at least [`MIN_BODY_ELEMENTS`] elements and a thousandth of the largest
    /// one's measure, or a tenth of that at any number ([`MIN_BODY_FRACTIONS`]). What is smaller are specks, such as
    /// voxels at the tip of an ear. They are always left out.
    pub enum Bodies("choice of bodies") {
        /// The largest body is searched, the others are left out
        #[default]
        Largest = "largest",
        /// Each body is searched on its own
        ///
        /// It has its own spectrum, its own times (relative to its own measure unless a reference is given) and its
        /// own component trees.
        All = "all",
        /// All bodies are searched together, as one shape
        ///
        /// Heat does not pass between them, so a small one is hot all over, and often a region as a whole.
        Join = "join",
    }
}

/// Fewest voxels, or vertices of a surface, of a body that is small beside the largest.
pub const MIN_BODY_ELEMENTS: usize = 64;

/// The smallest measure of a body over that of the largest: of one with [`MIN_BODY_ELEMENTS`], and of any.
pub const MIN_BODY_FRACTIONS: [f64; 2] = [1e-3, 0.1];

/// The connected components of a shape, which of them are bodies, and which are searched.
pub(crate) struct Parts {
    pub components: Components,
    /// Volume or area of each.
    measures: Vec<f64>,
    /// Whether each is a body.
    is_body: Vec<bool>,
    /// Whether each is searched.
    kept: Vec<bool>,
    /// Whether each is searched on its own.
    apart: bool,
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
                let [small, large] = MIN_BODY_FRACTIONS.map(|fraction| measures[c] >= fraction * most);
                large && most > 0.0 || small && components.sizes[c] >= MIN_BODY_ELEMENTS || Some(c) == largest
            })
            .collect();
        let kept = match bodies {
            Bodies::Largest => (0..measures.len()).map(|c| Some(c) == largest).collect(),
            Bodies::All | Bodies::Join => is_body.clone(),
        };
        let mut parts = Self { components, measures, is_body, kept, apart: bodies == Bodies::All };
        // What has no measure, such as vertices without triangles, changes nothing where there is but one body.
        if parts.measures.iter().filter(|&&m| m > 0.0).count() <= 1 {
            parts.kept.fill(true);
        }
        parts
    }

    /// The same, but everything is searched as one.
    pub fn with_all(mut self) -> Self {
        self.kept.fill(true);
        Self { apart: false, ..self }
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
    pub fn searched(&self) -> Vec<Vec<u32>> {
        // Where all is kept although not all are bodies, only one has a measure.
        if !self.apart || self.keeps_all() && self.is_body.iter().any(|body| !*body) {
            let elements: usize = self.of_kept().map(|component| self.components.sizes[component]).sum();
            return vec![(0..elements as u32).collect()];
        }
        let mut of_component = vec![Vec::new(); self.components.len()];
        for component in self.of_kept() {
            of_component[component].reserve_exact(self.components.sizes[component]);
        }
        let labels = self.components.labels.iter().filter(|&&label| self.kept[label as usize]);
        (0u32..).zip(labels).for_each(|(element, &label)| of_component[label as usize].push(element));
        let mut order: Vec<usize> = self.of_kept().collect();
        order.sort_by(|&a, &b| self.measures[b].total_cmp(&self.measures[a]));
        order.into_iter().map(|c| std::mem::take(&mut of_component[c])).collect()
    }

    /// The components that are searched.
    fn of_kept(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.kept.len()).filter(|&component| self.kept[component])
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
