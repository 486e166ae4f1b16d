//! Pseudo-scalar fields: what tells left from right.

use std::ops::Range;

use mser3d_shape::vector::{cross, dot, norm};
use mser3d_shape::{Eigenbasis, Faces, TriangleMesh, VoxelGrid};
use pulp::Arch;
use rayon::prelude::*;

use crate::{DescriptorError, TimeScale, spectral_sums, vertex_subset::VertexSubset};

/// Elements that are summed one after the other. Sums of blocks are added in order, so that threads make no difference.
const BLOCK: usize = 1 << 12;

/// Voxels whose heat is known at a time, with that of those around them: blocks as a whole.
const GROUP: usize = BLOCK << 8;

/// Times that one pass over the eigenfunctions serves.
const MOST_TIMES: usize = 8;

/// Gradients that span less than this part of what orthogonal ones would are taken for coplanar: what is left is
/// rounding, and the eigensolver's tolerance.
const COPLANAR: f64 = 1e-6;

/// Parameters of [`chirality_of_solid`] and [`chirality_of_surface`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ChiralityParameters {
    /// The times of the heat kernels. Each three of them give a field in a volume, each two on a surface. Default: six
    /// octaves from 0.05 to 1.6 of the shape's unit of time, so 20 or 15 fields. One field alone vanishes on some
    /// shapes, and changes its sign in between; many seldom do at once.
    pub times: Vec<TimeScale>,
}

impl Default for ChiralityParameters {
    fn default() -> Self {
        Self { times: [0.05, 0.1, 0.2, 0.4, 0.8, 1.6].map(TimeScale::Relative).to_vec() }
    }
}

impl ChiralityParameters {
    /// Whether there are three to eight times, all of them positive.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        if !(3..=MOST_TIMES).contains(&self.times.len()) {
            let found = self.times.len();
            return Err(DescriptorError::parameter("the number of times of chirality", found, "3 to 8"));
        }
        self.times.iter().try_for_each(|t| t.with_unit(1.0).map(|_| ()))
    }

    /// How many fields a solid has: one for each three times.
    pub fn fields_of_solid(&self) -> usize {
        triples(self.times.len()).len()
    }

    /// How many fields a surface has: one for each two times.
    pub fn fields_of_surface(&self) -> usize {
        pairs(self.times.len()).len()
    }
}

/// Pseudo-scalar fields of a shape, by their coefficients in its eigenbasis: the mirror image of the shape has the same
/// ones with the other sign.
#[derive(Clone, Debug, PartialEq)]
pub struct Chirality {
    fields: usize,
    /// fields x k, each field divided by its norm.
    coefficients: Vec<f64>,
}

impl Chirality {
    /// Number of fields.
    pub fn fields(&self) -> usize {
        self.fields
    }

    /// The correlation of each field D with a function s: `<D, s> / (|D| |s|)`, in [-1, 1]; `function` holds the k
    /// coefficients of s in the eigenbasis. Of a function that a reflection of the shape turns into its negative, it says
    /// whether the positive side is left or right. 0 where the field or the function vanishes.
    pub fn correlations(&self, function: &[f64]) -> Vec<f64> {
        let length = function.iter().map(|c| c * c).sum::<f64>().sqrt();
        let modes = self.coefficients.len() / self.fields.max(1);
        let correlation = |field: usize| {
            let row = &self.coefficients[field * modes..][..modes];
            let sum: f64 = row.iter().zip(function).map(|(a, b)| a * b).sum();
            if length > 0.0 { sum / length } else { 0.0 }
        };
        (0..self.fields).map(correlation).collect()
    }
}

/// The pseudo-scalar fields of a solid: for each three times a < b < c the signed cube root of
///
/// `D = V det(grad log H_a, grad log H_b, grad log H_c)`,
///
/// where H_t is the heat kernel's diagonal and V the volume. A reflection of the shape leaves H as it is and changes the
/// sign of the determinant; a rotation changes neither. So D has opposite values on both sides of a body with a plane of
/// symmetry, and vanishes in the mean over a part that has such a plane of its own. It has no unit and is the same on a
/// scaled copy. The root keeps the few places where all gradients are large from outweighing all others.
///
/// Gradients are central differences along the links. Where a neighbour is missing or not linked the voxel itself takes
/// its place: no heat flows there, so H has no slope through that face. Axes are those of the grid; where they are of the
/// left hand the sign is changed, so that it is that of the world.
///
/// Times refer to `unit_time`, as in [`TimeScale::with_unit`]; fields go by a, then b, then c. Cost: n k (times + fields).
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], [`DescriptorError::EmptyBasis`], [`DescriptorError::SizeMismatch`] for an
/// eigenbasis of another grid.
pub fn chirality_of_solid(
    basis: &Eigenbasis,
    grid: &VoxelGrid,
    unit_time: f64,
    params: &ChiralityParameters,
) -> Result<Chirality, DescriptorError> {
    check_size(basis, grid.len())?;
    let heat = LogHeat::new(basis, unit_time, params)?;
    let triples = triples(heat.times());
    let hand = if grid.frame().is_left_handed() { -1.0 } else { 1.0 };
    let steps = grid.frame().spacing().map(|h| 0.5 * unit_time.sqrt() / h);
    let fields = |v: usize, faces: Faces, logs: &Logs, values: &mut [f64]| {
        let mut gradients = [[0.0; 3]; MOST_TIMES];
        for axis in 0..3 {
            let [before, after] = faces.0[axis].map(|u| logs.at(u.map_or(v, |u| u as usize)));
            for (gradient, (low, high)) in gradients.iter_mut().zip(before.iter().zip(after)) {
                gradient[axis] = steps[axis] * (high - low);
            }
        }
        let lengths = gradients.map(norm);
        for (value, &[a, b, c]) in values.iter_mut().zip(&triples) {
            let det = dot(gradients[a], cross(gradients[b], gradients[c]));
            let coplanar = det.abs() <= COPLANAR * lengths[a] * lengths[b] * lengths[c];
            *value = if coplanar { 0.0 } else { hand * det.cbrt() };
        }
    };
    let faces = |voxels: &Range<usize>| grid.faces(voxels.start as u32..voxels.end as u32);
    let logs = |voxels: Range<usize>| {
        heat.of(if voxels.len() == grid.len() {
            voxels
        } else {
            let reached = || faces(&voxels).flat_map(Faces::ascending).map(|(v, _)| v as usize);
            let (low, high) =
                reached().fold((voxels.start, voxels.end), |(low, high), v| (low.min(v), high.max(v + 1)));
            low..high
        })
    };
    let at = |voxels: Range<usize>, logs: &Logs, add: &mut dyn FnMut(&[f64], usize, f64)| {
        let mut values = vec![0.0; triples.len()];
        for (v, faces) in voxels.clone().zip(faces(&voxels)) {
            fields(v, faces, logs, &mut values);
            add(&values, v, basis.mass()[v]);
        }
    };
    Ok(project(basis, triples.len(), [grid.len(), GROUP], logs, at))
}

/// The pseudo-scalar fields of a surface: for each two times a < b the signed square root of
///
/// `D = A n . (grad log H_a x grad log H_b)`
///
/// on each triangle, where n is its normal and A the area of the surface. What holds in a volume
/// ([`chirality_of_solid`]) holds here: the normal takes the place of the third gradient.
///
/// Normals should point outward. Of a mesh that encloses a negative volume all are turned, so an inside-out mesh gives
/// the same. An open mesh is taken as its triangles are oriented.
///
/// # Errors
/// As for [`chirality_of_solid`].
pub fn chirality_of_surface(
    basis: &Eigenbasis,
    mesh: &TriangleMesh,
    unit_time: f64,
    params: &ChiralityParameters,
) -> Result<Chirality, DescriptorError> {
    check_size(basis, mesh.vertices().len())?;
    let heat = LogHeat::new(basis, unit_time, params)?;
    let pairs = pairs(heat.times());
    let outward = if mesh.signed_volume() < 0.0 { -1.0 } else { 1.0 };
    let triangles = mesh.triangles().len();
    let logs = |_| heat.of(0..basis.len());
    let at = |places: Range<usize>, logs: &Logs, add: &mut dyn FnMut(&[f64], usize, f64)| {
        let mut values = vec![0.0; pairs.len()];
        for triangle in places {
            let corners = mesh.triangles()[triangle].map(|v| v as usize);
            let area = mesh.triangle_area(triangle);
            let [here, first, second] = corners.map(|v| logs.at(v));
            let mut rises = [[0.0; 2]; MOST_TIMES];
            for (t, rise) in rises.iter_mut().enumerate().take(logs.times) {
                *rise = [first[t] - here[t], second[t] - here[t]];
            }
            for (value, &[a, b]) in values.iter_mut().zip(&pairs) {
                let ([a1, a2], [b1, b2]) = (rises[a], rises[b]);
                let wedge = a1 * b2 - a2 * b1;
                let coplanar = wedge.abs() <= COPLANAR * (a1.hypot(a2) * b1.hypot(b2)) || area <= 0.0;
                let density = if coplanar { 0.0 } else { outward * wedge * unit_time / (2.0 * area) };
                *value = density.signum() * density.abs().sqrt();
            }
            corners.iter().for_each(|&v| add(&values, v, area / 3.0));
        }
    };
    Ok(project(basis, pairs.len(), [triangles; 2], logs, at))
}

/// Each three of so many times, ascending.
fn triples(times: usize) -> Vec<[usize; 3]> {
    let after = |a: usize| a + 1..times;
    (0..times).flat_map(|a| after(a).flat_map(move |b| after(b).map(move |c| [a, b, c]))).collect()
}

/// Each two of so many times, ascending.
fn pairs(times: usize) -> Vec<[usize; 2]> {
    (0..times).flat_map(|a| (a + 1..times).map(move |b| [a, b])).collect()
}

fn check_size(basis: &Eigenbasis, expected: usize) -> Result<(), DescriptorError> {
    spectral_sums::check(basis.view())?;
    let found = basis.len();
    if found == expected {
        return Ok(());
    }
    Err(DescriptorError::SizeMismatch { what: "elements of the eigenbasis", found, expected })
}

/// The projection of fields on the eigenfunctions, each divided by its norm. Places come in groups of at most so many, for which
/// `logs` are made. `at` adds the values of all fields at each of a range of places to the elements that the place stands for, with
/// how much of their measure.
fn project(
    basis: &Eigenbasis,
    fields: usize,
    [places, group]: [usize; 2],
    logs: impl Fn(Range<usize>) -> Logs,
    at: impl Fn(Range<usize>, &Logs, &mut dyn FnMut(&[f64], usize, f64)) + Sync,
) -> Chirality {
    let (modes, arch) = (basis.eigenvalues().len(), Arch::new());
    let of_block = |places: Range<usize>, logs: &Logs| {
        let (mut squares, mut sums) = (vec![0.0; fields], vec![0.0; fields * modes]);
        let mut scratch = Vec::new();
        at(places, logs, &mut |values, element, measure| {
            let rows = sums.chunks_exact_mut(modes);
            let phi = basis.row(element, 0..modes, &mut scratch);
            arch.dispatch(
                #[inline(always)]
                || project_one(values, measure, phi, &mut squares, rows),
            );
        });
        (squares, sums)
    };
    let (mut squares, mut coefficients) = (vec![0.0; fields], vec![0.0; fields * modes]);
    for group in pieces(0..places, group) {
        let logs = logs(group.clone());
        let blocks: Vec<(Vec<f64>, Vec<f64>)> = pieces(group, BLOCK)
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|places| of_block(places, &logs))
            .collect();
        for (more_squares, more) in &blocks {
            squares.iter_mut().zip(more_squares).for_each(|(sum, x)| *sum += x);
            coefficients.iter_mut().zip(more).for_each(|(sum, x)| *sum += x);
        }
    }
    for (row, square) in coefficients.chunks_exact_mut(modes).zip(&squares) {
        let length = square.sqrt();
        row.iter_mut().for_each(|c| *c = if length > 0.0 { *c / length } else { 0.0 });
    }
    Chirality { fields, coefficients }
}

/// A range in pieces of a length.
fn pieces(whole: Range<usize>, length: usize) -> impl Iterator<Item = Range<usize>> {
    let end = whole.end;
    whole.step_by(length.max(1)).map(move |start| start..end.min(start + length))
}

/// Adds what an element contributes to the squared norm and the coefficients of each field.
#[inline(always)]
fn project_one<'a>(
    values: &[f64],
    measure: f64,
    phi: &[f64],
    squares: &mut [f64],
    coefficients: impl Iterator<Item = &'a mut [f64]>,
) {
    for ((&value, square), sums) in values.iter().zip(squares).zip(coefficients) {
        let weighed = measure * value;
        *square += weighed * value;
        spectral_sums::add_multiple(sums, weighed, phi);
    }
}

/// log H_t(v,v) at all times.
struct LogHeat<'a> {
    basis: &'a Eigenbasis,
    /// How much of each eigenfunction is left at each time. The last lanes may be idle.
    decays: Vec<[f64; MOST_TIMES]>,
    times: usize,
}

/// That of some elements.
struct Logs {
    first: usize,
    times: usize,
    values: Vec<f64>,
}

impl<'a> LogHeat<'a> {
    fn new(
        basis: &'a Eigenbasis,
        unit_time: f64,
        params: &ChiralityParameters,
    ) -> Result<Self, DescriptorError> {
        params.validate()?;
        let times: Vec<f64> =
            params.times.iter().map(|t| t.with_unit(unit_time)).collect::<Result<_, _>>()?;
        let decay = |lambda: &f64| -> [f64; MOST_TIMES] {
            std::array::from_fn(|t| times.get(t).map_or(0.0, |time| (-lambda * time).exp()))
        };
        let decays = basis.eigenvalues().iter().map(decay).collect();
        Ok(Self { basis, decays, times: times.len() })
    }

    fn times(&self) -> usize {
        self.times
    }

    /// That of some elements. One pass over the eigenfunctions serves all times.
    fn of(&self, elements: Range<usize>) -> Logs {
        let Self { basis, decays, times } = self;
        let values = spectral_sums::for_each_row(
            basis.view(),
            VertexSubset::range(elements.clone()),
            0..decays.len(),
            *times,
            #[inline(always)]
            |phi, logs| {
                let mut sums = [0.0; MOST_TIMES];
                for (decay, phi) in decays.iter().zip(phi) {
                    let square = phi * phi;
                    sums.iter_mut().zip(decay).for_each(|(sum, d)| *sum += d * square);
                }
                // No heat at all is where no eigenfunction lives, on a whole component: its logarithm is as level.
                logs.iter_mut().zip(sums).for_each(|(log, sum)| *log = sum.max(f64::MIN_POSITIVE).ln());
            },
        );
        Logs { first: elements.start, times: *times, values }
    }
}

impl Logs {
    /// Those of an element, one for each time.
    #[inline]
    fn at(&self, element: usize) -> &[f64] {
        &self.values[(element - self.first) * self.times..][..self.times]
    }
}
