//! The shapes that are compared, and which parts of which are looked for on which.

use std::error::Error;

use mser3d::shape::TriangleMesh;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::shrec::{Class, transform};
use mser3d_evaluation::{Correspondence, EvaluationError, IndexSet, NullShape, Overlaps};
use rayon::prelude::*;

use crate::pose_sets::PoseSet;
use crate::solved::Solved;

/// Shapes of which each point is known on the null shape.
pub struct Case {
    pub name: String,
    null: NullShape,
    pub shapes: Vec<Shape>,
    /// The shape that is searched, and that whose parts are looked for.
    pairs: Vec<[usize; 2]>,
}

/// A shape with its spectrum.
pub struct Shape {
    pub name: String,
    pub mesh: TriangleMesh,
    pub solved: Solved,
    /// The volume that times refer to; none is the shape's own.
    pub reference: Option<f64>,
    correspondence: Correspondence,
}

/// Classes of the synthetic benchmark after which the whole body is still there.
const CLASSES: [Class; 10] = [
    Class::Affine,
    Class::Holes,
    Class::Localscale,
    Class::Microholes,
    Class::Noise,
    Class::Rasterize,
    Class::Sampling,
    Class::Scaling,
    Class::Shotnoise,
    Class::Topology,
];

/// The strength of each, and the seed.
const STRENGTH: u32 = 3;
const SEED: u64 = 1;

impl Case {
    /// All ordered pairs of a set.
    pub fn of_set(set: &PoseSet, voxels: usize) -> Result<Self, Box<dyn Error>> {
        let solved = set.solve(voxels, &VoxelizeParameters::default(), &SpectrumParameters::default())?;
        let reference = set.reference_measure(&solved);
        let same = Correspondence::identity(set.null.mesh().vertices().len());
        let shape = |((name, mesh), solved): (&(String, TriangleMesh), Solved)| Shape {
            name: name.clone(),
            mesh: mesh.clone(),
            solved,
            reference,
            correspondence: same.clone(),
        };
        let shapes: Vec<Shape> = set.poses.iter().zip(solved).map(shape).collect();
        let count = shapes.len();
        let pairs = (0..count).flat_map(|a| (0..count).map(move |b| [a, b])).filter(|[a, b]| a != b);
        Ok(Self { name: set.name.clone(), null: set.null.clone(), pairs: pairs.collect(), shapes })
    }

    /// The first pose of a set and transforms of it, each against the pose, both ways. All have the pose's voxel size
    /// and times, but for the scaled shape, which has its own.
    pub fn synthetic(set: &PoseSet, voxels: usize) -> Result<Self, Box<dyn Error>> {
        let null = set.null.clone();
        let solve = |mesh: &TriangleMesh, pitch| {
            let voxelize = VoxelizeParameters { pitch, ..Default::default() };
            Solved::volume(mesh, &voxelize, &SpectrumParameters::default())
        };
        let whole = Shape {
            name: "null".into(),
            mesh: null.mesh().clone(),
            solved: solve(null.mesh(), Pitch::Voxels(voxels))?,
            reference: None,
            correspondence: Correspondence::identity(null.mesh().vertices().len()),
        };
        let (measure, size) = (whole.solved.measure(), whole.solved.pitch().ok_or("a solid without voxels")?);
        let change = |&class: &Class| -> Result<Shape, Box<dyn Error>> {
            let transformed = transform(null.mesh(), class, STRENGTH, SEED)?;
            let scaled = class == Class::Scaling;
            let pitch = if scaled { Pitch::Voxels(voxels) } else { Pitch::Size(size) };
            Ok(Shape {
                name: class.to_string(),
                solved: solve(&transformed.mesh, pitch)?,
                reference: (!scaled).then_some(measure),
                correspondence: Correspondence::new(null.mesh(), &transformed.mesh, &transformed.points)?,
                mesh: transformed.mesh,
            })
        };
        let changed = CLASSES.par_iter().map(|class| change(class).map_err(|e| format!("{class}: {e}")));
        let changed = changed.collect::<Result<Vec<_>, String>>()?;
        let shapes: Vec<Shape> = std::iter::once(whole).chain(changed).collect();
        let pairs = (1..shapes.len()).flat_map(|i| [[0, i], [i, 0]]).collect();
        Ok(Self { name: format!("synthetic {}", set.name), null, shapes, pairs })
    }

    /// For each pair the best overlap of each part that is looked for, measured on the null shape. `parts` are those of
    /// each shape.
    pub fn best_overlaps(&self, parts: &[&[IndexSet]]) -> Result<Vec<Vec<f64>>, Box<dyn Error>> {
        let carry = |(shape, parts): (&Shape, &&[IndexSet])| -> Result<Vec<IndexSet>, EvaluationError> {
            parts.iter().map(|part| shape.correspondence.carry(part)).collect()
        };
        let on_null = self.shapes.iter().zip(parts).map(carry).collect::<Result<Vec<_>, _>>()?;
        let same = Correspondence::identity(self.null.mesh().vertices().len());
        let compare = |&[searched, sought]: &[usize; 2]| {
            Ok(Overlaps::new(&self.null, &on_null[searched], &on_null[sought], &same)?.best())
        };
        let best: Result<Vec<Vec<f64>>, EvaluationError> = self.pairs.par_iter().map(compare).collect();
        Ok(best?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_sets::SetArguments;

    fn quadruped() -> PoseSet {
        SetArguments { sets: vec!["quadruped".into()], voxels: 1000 }.read().unwrap().remove(0)
    }

    /// The part behind the middle of each shape's box, and all of it.
    fn halves(case: &Case) -> Vec<Vec<IndexSet>> {
        let halves = |shape: &Shape| {
            let vertices = shape.mesh.vertices();
            let bounds = shape.mesh.bounding_box().unwrap();
            let middle = 0.5 * (bounds.min[2] + bounds.max[2]);
            vec![
                IndexSet::from_fn(vertices.len(), |v| vertices[v][2] < middle),
                IndexSet::from_fn(vertices.len(), |_| true),
            ]
        };
        case.shapes.iter().map(halves).collect()
    }

    #[test]
    fn poses_share_vertices_size_and_times() {
        let case = Case::of_set(&quadruped(), 1000).unwrap();
        assert_eq!(case.pairs, [[0, 1], [0, 2], [1, 0], [1, 2], [2, 0], [2, 1]]);
        let first = &case.shapes[0].solved;
        for shape in &case.shapes {
            assert_eq!(shape.reference, Some(first.measure()));
            assert!((shape.solved.pitch().unwrap() / first.pitch().unwrap() - 1.0).abs() < 1e-12);
        }
        let halves = halves(&case);
        // The same vertices on all shapes, but none on the last: nothing is found there, and nothing is looked for.
        let parts = [&halves[0][..], &halves[0], &[]];
        let best = case.best_overlaps(&parts).unwrap();
        assert_eq!(best, [vec![1.0; 2], vec![], vec![1.0; 2], vec![], vec![0.0; 2], vec![0.0; 2]]);
    }

    #[test]
    fn transforms_are_carried_to_the_null_shape() {
        let case = Case::synthetic(&quadruped(), 1000).unwrap();
        assert_eq!((case.shapes.len(), case.pairs.len()), (11, 20));
        let scaled = case.shapes.iter().find(|shape| shape.name == "scaling").unwrap();
        assert_eq!(scaled.reference, None);
        let size = scaled.solved.pitch().unwrap() / case.shapes[0].solved.pitch().unwrap();
        assert!((size - 1.25).abs() < 0.03, "{size}");
        let halves = halves(&case);
        let parts: Vec<&[IndexSet]> = halves.iter().map(|parts| &parts[..]).collect();
        for (pair, best) in case.pairs.iter().zip(case.best_overlaps(&parts).unwrap()) {
            let name = &case.shapes[pair[0].max(pair[1])].name;
            assert!(best.iter().all(|overlap| *overlap > 0.8), "{name}: {best:?}");
        }
    }
}
