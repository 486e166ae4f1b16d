//! The weights of a shape at each time scale, and the trees over them.

use std::borrow::Cow;

use mser3d_comptree::{
    AltitudeScale, ComponentTree, Polarity, Selection, StabilityParameters, join_levels, stable_regions,
};
use mser3d_descriptors::{
    auto_diffusivities, auto_diffusivity, commute_time, diffusion_distance, inverse_heat_kernel,
};
use mser3d_laplace::Operator;
use mser3d_shape::vector::{norm, sub};
use mser3d_shape::{Connectivity, Eigenbasis, Graph};

use crate::{DiscreteShape, Elements, Error, Field, Parameters, Weight};

/// Weights that differ by less, relatively, are one level. Eigenfunctions of a symmetric solid are symmetric to 1e-13,
/// and its voxels' weights lie 1e-4 apart.
const ROUNDING: f64 = 1e-9;

/// The most elements of a shape of which what can be made anew is kept: its links, the weights at all times, its trees. Of a larger
/// one they would take more memory than all else.
pub(crate) const KEPT_ELEMENTS: usize = 1 << 20;

/// The most elements of a shape of which two trees are made beside each other: of more they would take more memory than all else.
const PAIRED_ELEMENTS: usize = 1 << 25;

/// Whether two trees of a shape too large to keep them are made beside each other. Those over links take too much memory.
pub(crate) fn in_pairs(elements: usize, weight: Weight) -> bool {
    elements <= PAIRED_ELEMENTS && !weight.may_be_of_links()
}

/// How many of the trees of a shape are made one after the other; `kept` are those that are there, or will be.
pub(crate) fn in_turn(elements: usize, weight: Weight, trees: usize, kept: bool) -> usize {
    match (kept, in_pairs(elements, weight)) {
        (true, _) => 1,
        (false, true) => trees.div_ceil(2),
        (false, false) => trees,
    }
}

/// How a shape, or a body of it, is weighed.
pub(crate) struct Weighing<'a> {
    shape: &'a DiscreteShape,
    basis: &'a Eigenbasis,
    parameters: &'a Parameters,
    /// The weight, or what it is made of, where that is no matter of heat; smoothed.
    field: Option<Cow<'a, Field>>,
    polarity: Polarity,
    /// What smooths weights, and for how long, in length^2.
    smoothing: Option<(Operator, f64)>,
    /// The links between voxels, where several trees are built along them.
    links: Option<Graph>,
}

/// The values of a weight: what a component tree is built over.
pub(crate) struct Weights {
    values: Values,
    /// The unit of altitudes on a linear scale.
    unit: Option<f64>,
}

enum Values {
    Elements(Vec<f64>),
    Edges(Vec<[u32; 2]>, Vec<f64>),
}

impl<'a> Weighing<'a> {
    /// `unit_time` is the time that relative times are multiples of, in length^2.
    pub fn new(
        shape: &'a DiscreteShape,
        basis: &'a Eigenbasis,
        field: Option<&'a Field>,
        parameters: &'a Parameters,
        unit_time: f64,
    ) -> Result<Self, Error> {
        let field = match (parameters.weight, field) {
            (Weight::Field, None) => return Err(Error::NoField),
            (Weight::Field | Weight::Curvature, Some(field)) => {
                field.expect("voxels or vertices", shape.len())?;
                Some(Cow::Borrowed(field))
            }
            (Weight::Curvature, None) => Some(Cow::Owned(shape.mean_curvature()?)),
            _ => None,
        };
        let polarity = parameters.polarity_with(field.as_deref());
        let smoothing = match parameters.smooth_weight {
            Some(scale) => Some((shape.operator()?, scale.with_unit(unit_time)?)),
            None => None,
        };
        // Of 26 neighbours they would take more memory than all else.
        let links = match shape.elements() {
            Elements::Voxels { grid, connectivity: Connectivity::Six }
                if parameters.weight == Weight::Heat
                    && parameters.time_scales.len() > 1
                    && shape.len() <= KEPT_ELEMENTS =>
            {
                Some(grid.graph(Connectivity::Six)?)
            }
            _ => None,
        };
        let mut weighing = Self { shape, basis, parameters, field: None, polarity, smoothing, links };
        weighing.field = match field {
            Some(field) if weighing.smoothing.is_some() => {
                Some(Cow::Owned(field.with_components(|c| weighing.smoothed(field.component(c)))?))
            }
            field => field,
        };
        Ok(weighing)
    }

    /// Whether what is made of the weights at each time is kept: where it is not, one time comes after the other. What is made of
    /// other things than the eigenpairs cannot be made anew.
    pub fn keeps(&self) -> bool {
        self.shape.len() <= KEPT_ELEMENTS || !self.parameters.weight.has_time_scale()
    }

    /// A function of the elements after heat has smoothed it, if it is to.
    fn smoothed(&self, values: Vec<f64>) -> Result<Vec<f64>, Error> {
        match &self.smoothing {
            Some((operator, t)) => Ok(operator.heat_flow(&values, *t)?),
            None => Ok(values),
        }
    }

    /// What the weights at each of some times can be made of with one look at the eigenfunctions; nothing for most weights.
    pub fn prepared(&self, times: &[f64]) -> Result<Vec<Option<Vec<f64>>>, Error> {
        Ok(match self.parameters.weight {
            Weight::Heat if self.keeps() => {
                auto_diffusivities(self.basis, times)?.into_iter().map(Some).collect()
            }
            _ => vec![None; times.len()],
        })
    }

    /// The weights at time `t` (length^2, where the weight has one), of what was [prepared](Self::prepared) for it.
    pub fn at(&self, t: f64, prepared: Option<Vec<f64>>) -> Result<Weights, Error> {
        let mut values = match prepared {
            Some(values) => Values::Elements(self.smoothed(values)?),
            None => self.values(t)?,
        };
        match self.parameters.stability.altitude {
            AltitudeScale::Log => {
                let lowest = values.lowest();
                // Of weights that are a matter of heat, 0 is rounded.
                if self.field.is_some() && lowest <= 0.0 {
                    return Err(Error::NoLogarithm { value: lowest });
                }
                join_levels(values.numbers_mut(), ROUNDING);
                Ok(Weights { values, unit: None })
            }
            AltitudeScale::Linear => {
                // Where zero is says nothing: rounding errors are relative to what differs.
                let of_values =
                    self.parameters.weight == Weight::Field && matches!(values, Values::Elements(_));
                let (unit, lowest) = (values.spread(self.basis.mass(), of_values), values.lowest());
                let above = |w: f64| if w - lowest <= ROUNDING * unit { 0.0 } else { w - lowest };
                values.numbers_mut().iter_mut().for_each(|w| *w = above(*w));
                join_levels(values.numbers_mut(), ROUNDING);
                values.numbers_mut().iter_mut().for_each(|w| *w += lowest);
                Ok(Weights { values, unit: Some(unit) })
            }
        }
    }

    fn values(&self, t: f64) -> Result<Values, Error> {
        let elements = |values: Vec<f64>| Ok(Values::Elements(self.smoothed(values)?));
        match (self.parameters.weight, &self.field) {
            (Weight::Heat, _) => elements(auto_diffusivity(self.basis, t)?),
            (Weight::Commute, _) => elements(commute_time(self.basis)?),
            (Weight::Edge, _) => {
                let edges = self.edges()?;
                let weights = inverse_heat_kernel(self.basis, t, &edges)?;
                Ok(Values::Edges(edges, weights))
            }
            (Weight::Diffusion, _) => {
                let edges = self.edges()?;
                let mut weights = diffusion_distance(self.basis, t, &edges)?;
                let positions: Vec<[f64; 3]> = self.shape.positions().iter().collect();
                for (weight, [u, v]) in weights.iter_mut().zip(&edges) {
                    let length = norm(sub(positions[*u as usize], positions[*v as usize]));
                    *weight = if length > 0.0 { *weight / length } else { 0.0 };
                }
                Ok(Values::Edges(edges, weights))
            }
            (Weight::Curvature | Weight::Field, None) => Err(Error::NoField),
            (Weight::Curvature | Weight::Field, Some(field)) if field.has_vectors() => {
                let edges = self.edges()?;
                let weights = edges.iter().map(|&[u, v]| field.distance(u, v)).collect();
                Ok(Values::Edges(edges, weights))
            }
            (Weight::Curvature | Weight::Field, Some(field)) => Ok(Values::Elements(field.values().to_vec())),
        }
    }

    /// The neighbours that the tree links.
    fn edges(&self) -> Result<Vec<[u32; 2]>, Error> {
        Ok(match self.shape.elements() {
            Elements::Voxels { grid, connectivity } => grid.graph(*connectivity)?.edges().collect(),
            Elements::Vertices { edges, .. } => edges.edges().collect(),
        })
    }
}

impl Values {
    fn numbers_mut(&mut self) -> &mut Vec<f64> {
        match self {
            Self::Elements(weights) | Self::Edges(_, weights) => weights,
        }
    }

    /// The lowest weight; 0 without any.
    fn lowest(&self) -> f64 {
        let (Self::Elements(weights) | Self::Edges(_, weights)) = self;
        let lowest = weights.iter().copied().fold(f64::INFINITY, f64::min);
        if lowest.is_finite() { lowest } else { 0.0 }
    }

    /// The spread of the finite weights: of elements by their volume, of links each alike; about their mean, or about zero. 1 where
    /// there is none.
    fn spread(&self, volumes: &[f64], about_mean: bool) -> f64 {
        let (Self::Elements(weights) | Self::Edges(_, weights)) = self;
        let shares = matches!(self, Self::Elements(_)).then_some(volumes);
        let share = |i: usize| shares.map_or(1.0, |shares| shares[i]);
        let finite = || (0..weights.len()).filter(|&i| weights[i].is_finite());
        let total: f64 = finite().map(share).sum();
        let mean: f64 = finite().map(|i| share(i) / total * weights[i]).sum();
        let centre = if about_mean { mean } else { 0.0 };
        let square: f64 = finite().map(|i| share(i) / total * (weights[i] - centre).powi(2)).sum();
        let spread = square.sqrt();
        // Rounding errors of equal weights are no spread.
        if spread > 1e-12 * mean.abs() && spread > 1e-300 { spread } else { 1.0 }
    }
}

impl Weights {
    /// The component tree over them, and the unit of its altitudes on a linear scale.
    pub fn into_tree(self, of: &Weighing) -> Result<(ComponentTree, Option<f64>), Error> {
        let (volumes, polarity) = (of.basis.mass(), of.polarity);
        let tree = match (&self.values, of.shape.elements()) {
            (Values::Edges(edges, weights), _) => {
                ComponentTree::from_edge_weights(of.shape.len(), edges, weights, volumes, polarity)?
            }
            (Values::Elements(values), Elements::Voxels { grid, connectivity }) => match &of.links {
                Some(links) => ComponentTree::from_graph(links, values, volumes, polarity)?,
                None => ComponentTree::from_voxel_grid(grid, *connectivity, values, volumes, polarity)?,
            },
            (Values::Elements(values), Elements::Vertices { edges, .. }) => {
                ComponentTree::from_graph(edges, values, volumes, polarity)?
            }
        };
        Ok((tree, self.unit))
    }
}

/// The stable regions of a tree, with altitudes in this unit where the scale is linear.
pub(crate) fn stable_regions_in(
    tree: &ComponentTree,
    unit: Option<f64>,
    parameters: &StabilityParameters,
) -> Result<Selection, Error> {
    let Some(unit) = unit else { return Ok(stable_regions(tree, parameters)?) };
    let mut selection = stable_regions(&tree.scaled(1.0 / unit), parameters)?;
    selection.regions.iter_mut().for_each(|region| region.altitude = tree.altitude(region.node));
    Ok(selection)
}
