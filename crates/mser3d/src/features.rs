use std::borrow::Cow;

use mser3d_comptree::ComponentTree;
use mser3d_descriptors::{Descriptors, RegionCosines};
use mser3d_shape::{Eigenbasis, innermost_regions};
use mser3d_spectral::SpectrumReport;
use mser3d_voxelize::Voxelization;

use crate::regions::{tree_at, vertices_in};
use crate::{
    DiscreteShape, Error, Parameters, Partition, Region, RegionSet, RunReport, Sidedness, Tree, Warning,
};

/// The stable regions of a shape, their descriptors, and how they were found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Features {
    /// The parameters they were found with; the polarity is set.
    pub parameters: Parameters,
    /// What heat flowed on: all bodies that were searched.
    pub shape: DiscreteShape,
    /// How the mesh was voxelized; none for surfaces and for solids given as voxels.
    pub voxelization: Option<Voxelization>,
    /// The bodies that were searched each on its own, by descending measure. Mostly one: the whole shape.
    pub bodies: Vec<Body>,
    /// The regions of all bodies, by descending volume. Elements are numbered as in the shape.
    pub regions: Vec<Region>,
    /// A descriptor for each region, in the same order.
    pub descriptors: Descriptors,
    /// How near the regions are to each other ([`Sides::cosines`](crate::Sides::cosines)), in the same order; 0 for those of
    /// different bodies.
    pub cosines: RegionCosines,
    /// One component tree for each time scale of each body, body by body, and what each filter cut.
    pub trees: Vec<Tree>,
    /// Regions dropped because another time scale had them too.
    pub duplicates: usize,
    /// The parts of all bodies, if [`Parameters::parts`] asks for them.
    pub partition: Option<Partition>,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// What the run took.
    pub run: RunReport,
    /// Each body as a shape of its own, if there are several.
    pub(crate) parts: Vec<DiscreteShape>,
}

/// A body that was searched on its own.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Body {
    /// Its elements, ascending. Its eigenbasis and trees number them by their place here.
    pub elements: Vec<u32>,
    /// Its eigenpairs.
    pub basis: Eigenbasis,
    /// Their measured quality.
    pub spectrum: SpectrumReport,
    /// Whether it has a left and a right.
    pub sidedness: Sidedness,
}

impl Body {
    /// Its volume in length^3, or area in length^2.
    pub fn measure(&self) -> f64 {
        self.basis.measure()
    }

    /// The place of an element of the shape among the body's; none for those of other bodies.
    pub fn number_of(&self, element: u32) -> Option<u32> {
        // Mostly a body is all there is.
        let itself = self.elements.get(element as usize) == Some(&element);
        if itself {
            Some(element)
        } else {
            self.elements.binary_search(&element).ok().map(|place| place as u32)
        }
    }
}

impl Features {
    /// The innermost region of each vertex of the mesh, in file order: the smallest that has it.
    pub fn region_of_vertex(&self) -> Vec<Option<u32>> {
        innermost_regions(self.shape.element_of_vertex().len(), self.regions.iter().map(|r| &r.vertices))
    }

    /// The volume or area of each element of the shape; 0 of those that are in no body.
    pub fn measures(&self) -> Cow<'_, [f64]> {
        match &self.bodies[..] {
            [all] if all.elements.len() == self.shape.len() => Cow::Borrowed(all.basis.mass()),
            bodies => {
                let mut measures = vec![0.0; self.shape.len()];
                for body in bodies {
                    body.elements.iter().zip(body.basis.mass()).for_each(|(&e, &m)| measures[e as usize] = m);
                }
                Cow::Owned(measures)
            }
        }
    }

    /// One of the component trees, by its place in [`trees`](Self::trees). Those of a large shape are not kept, and made anew by this.
    ///
    /// # Errors
    /// As for [`find_regions`](crate::find_regions), which made the same tree before.
    pub fn tree(&self, number: usize) -> Result<Cow<'_, ComponentTree>, Error> {
        let tree = &self.trees[number];
        match &tree.tree {
            Some(kept) => Ok(Cow::Borrowed(kept)),
            None => {
                let shape = self.parts.get(tree.body).unwrap_or(&self.shape);
                let basis = &self.bodies[tree.body].basis;
                Ok(Cow::Owned(tree_at(shape, basis, &self.parameters, tree.time)?))
            }
        }
    }

    /// The places of the regions in [`regions`](Self::regions), the most reliable first. Where reliability was not
    /// measured, those that a real merge ends come first, then the others, each the largest first.
    pub fn ranked(&self) -> Vec<usize> {
        let rank = |&place: &usize| {
            let region = &self.regions[place];
            region.reliability.unwrap_or(f64::from(region.merge.is_some()))
        };
        let mut order: Vec<usize> = (0..self.regions.len()).collect();
        // The sort keeps the order of equal ones, which is that of volumes.
        order.sort_by(|a, b| rank(b).total_cmp(&rank(a)));
        order
    }

    /// The innermost region of each voxel or surface vertex.
    pub fn region_of_element(&self) -> Vec<Option<u32>> {
        innermost_regions(self.shape.len(), self.regions.iter().map(|r| &r.elements))
    }
}

/// What was found on one body, its elements numbered by their place in the body.
pub(crate) struct FoundOnBody {
    pub set: RegionSet,
    pub descriptors: Descriptors,
    pub cosines: RegionCosines,
}

/// The regions of a shape of one body or of several, with what belongs to them.
pub(crate) struct Found {
    pub regions: Vec<Region>,
    pub descriptors: Descriptors,
    pub cosines: RegionCosines,
    pub trees: Vec<Tree>,
    pub duplicates: usize,
}

impl Found {
    /// What was found on all bodies; elements are numbered as in the shape, regions go by descending volume.
    pub fn on_all(shape: &DiscreteShape, bodies: &[Body], found: Vec<FoundOnBody>) -> Result<Self, Error> {
        let width = found.first().map_or(1, |first| first.descriptors.width());
        let (mut trees, mut duplicates) = (Vec::new(), 0);
        let mut rows: Vec<(Region, Vec<f64>)> = Vec::new();
        let (mut first_regions, mut of_bodies) = (Vec::new(), Vec::new());
        for (body, (Body { elements, .. }, FoundOnBody { set, descriptors, cosines })) in
            bodies.iter().zip(found).enumerate()
        {
            let (first_tree, first_region) = (trees.len(), rows.len());
            for (mut region, row) in set.regions.into_iter().zip(descriptors.rows()) {
                region.body = body;
                region.tree += first_tree;
                region.parent = region.parent.map(|parent| parent + first_region);
                region.twin = region.twin.map(|twin| twin + first_region);
                if bodies.len() > 1 {
                    region.elements.iter_mut().for_each(|e| *e = elements[*e as usize]);
                    region.tip = elements[region.tip as usize];
                    region.vertices = vertices_in(shape, &region.elements)?;
                }
                rows.push((region, row.to_vec()));
            }
            trees.extend(set.trees.into_iter().map(|tree| Tree { body, ..tree }));
            duplicates += set.duplicates;
            first_regions.push(first_region);
            of_bodies.push(cosines);
        }
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by(|&a, &b| rows[b].0.volume.total_cmp(&rows[a].0.volume));
        let mut place = vec![0; rows.len()];
        order.iter().enumerate().for_each(|(to, &from)| place[from] = to);
        let values = order.iter().flat_map(|&from| rows[from].1.iter().copied()).collect();
        let descriptors = Descriptors::new(width, values)?;
        let cosine = |&[a, b]: &[usize; 2]| {
            let (body, other) = (rows[a].0.body, rows[b].0.body);
            let number = |region: usize| region - first_regions[body];
            if body == other { of_bodies[body].row(number(a))[number(b)] } else { 0.0 }
        };
        let pairs = order.iter().flat_map(|&a| order.iter().map(move |&b| [a, b]));
        let cosines = RegionCosines::new(order.len(), pairs.map(|pair| cosine(&pair)).collect())?;
        let mut regions: Vec<(usize, Region)> = rows
            .into_iter()
            .zip(&place)
            .map(|((region, _), &to)| {
                let [parent, twin] = [region.parent, region.twin].map(|other| other.map(|r| place[r]));
                (to, Region { parent, twin, ..region })
            })
            .collect();
        regions.sort_by_key(|&(to, _)| to);
        let regions = regions.into_iter().map(|(_, region)| region).collect();
        Ok(Self { regions, descriptors, cosines, trees, duplicates })
    }
}
