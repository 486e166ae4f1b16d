use std::ops::ControlFlow;

use mser3d_descriptors::TimeScale;
use mser3d_shape::Domain;
use mser3d_spectral::{Eigensolver, SINGLE_PRECISION, SpectrumParameters, uses_multigrid};

use crate::reliability::{Original, coarser, occupied};
use crate::weighing::{KEPT_ELEMENTS, in_pairs};
use crate::{Descriptor, Input, Parameters, Weight};

/// What a run will take, roughly.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Estimate {
    /// Voxels or vertices.
    pub elements: usize,
    /// Eigenpairs.
    pub eigenpairs: usize,
    /// Peak memory in bytes.
    pub memory_bytes: u64,
    /// Seconds of work on one core: the sum of those of the stages, and what it takes to begin.
    pub seconds: f64,
    /// Seconds of work of each stage.
    pub stages: StageSeconds,
}

/// Seconds of work on one core, by stage.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct StageSeconds {
    /// From the mesh to voxels, and back to its vertices.
    pub voxelize: f64,
    /// The eigenpairs.
    pub spectrum: f64,
    /// Weights and component trees, for all time scales.
    pub regions: f64,
    /// Deformed copies, searched for the same regions.
    pub reliability: f64,
    /// The descriptors.
    pub descriptors: f64,
    /// The bodies' parts, if they are asked for.
    pub parts: f64,
}

impl StageSeconds {
    pub(crate) fn sum(&self) -> f64 {
        self.voxelize + self.spectrum + self.regions + self.reliability + self.descriptors + self.parts
    }
}

/// Seconds that any run takes before and after its work.
const BEGIN: f64 = 0.01;

/// Bytes that any run takes.
const MEMORY: f64 = 1.6e7;

/// Bytes that an element takes beside the numbers of the spectrum and the weight; and one of a large shape, of which less is kept: while
/// its spectrum is computed, and beside its eigenfunctions, while two trees are made and one.
const BESIDE: f64 = 200.0;
const BESIDE_SOLVER: f64 = 20.0;
const BESIDE_TWO_TREES: f64 = 170.0;
const BESIDE_LARGE: f64 = 100.0;

/// Bytes that a triangle takes while it is voxelized and its vertices look for their voxels, the mesh and its file included.
const TRIANGLE: f64 = 360.0;

/// Seconds to find the nearest voxel of a point.
const NEAREST: f64 = 0.4e-6;

/// Seconds to find the nearest voxel that a vertex sees, with what tells where the surface is.
const NEAREST_SEEN: f64 = 3.5e-6;

/// Seconds to divide an element's body into parts, for each element.
const PARTS: f64 = 1.1e-6;

impl Parameters {
    /// What a run with these parameters will take on an input, from its size alone: a pass over the mesh.
    ///
    /// The formulas were fitted to the CPU time of a single thread, on a processor of 2025 with two cores and
    /// AVX-512, the machine not idle: human bodies, a cow, a fish, plates and boxes of 200 to 400,000 voxels, and
    /// surfaces of 600 to 214,000 vertices, with 10 to 300 eigenpairs. They are within a factor of 2 there, 3 on the
    /// worst, where the solver does not have to begin again (on a small solid with more than 200 eigenpairs it may).
    pub fn estimate(&self, input: &Input) -> Estimate {
        let n = input.expected_elements(self);
        let eigenpairs = self.spectrum.eigenpairs.about(input.domain()).min(n.max(1));
        let links = if self.weight.is_of_elements() { 1.0 } else { 2.0 };
        let trees = if self.weight.has_time_scale() { self.time_scales.len() } else { 1 };
        let samples = match &self.descriptor {
            Descriptor::SidedSiHks(own) | Descriptor::SizedSiHks(own) | Descriptor::SiHks(own) => {
                own.samples()
            }
            Descriptor::Hks(own) => own.times.len(),
        };
        let (elements, k) = (n as f64, eigenpairs as f64);
        let solid = Solid::of(input, self, elements);
        let in_box = solid.in_box;
        let spectrum = match input.domain() {
            Domain::Volume => volume_spectrum(elements, k, &self.spectrum),
            Domain::Surface => surface_spectrum(elements, k),
        };
        let weight = weight_work(self, input, elements);
        let stages = StageSeconds {
            voxelize: solid.seconds + NEAREST_SEEN * solid.vertices,
            spectrum: spectrum.seconds,
            regions: links * trees as f64 * elements * (95e-9 + 0.23e-9 * k) + weight.seconds,
            reliability: match Original::of(input).map(|original| self.copies_of(original, n)) {
                None | Some(0) => 0.0,
                Some(copies) => copies as f64 * self.seconds_of_copy(input, n),
            },
            // A third of it tells left from right.
            descriptors: 1.5 * elements * samples as f64 * (1.8e-9 + 0.035e-9 * k),
            parts: if self.parts.is_some() { PARTS * elements } else { 0.0 },
        };
        let search = if n > KEPT_ELEMENTS {
            // Nothing of the solver is left when regions are searched for.
            let solving = 8.0 * spectrum.numbers + BESIDE_SOLVER * elements;
            let basis = if spectrum.single { 4.0 } else { 8.0 } * elements * k;
            let beside = if in_pairs(n, self.weight) { BESIDE_TWO_TREES } else { BESIDE_LARGE };
            solving.max(basis + beside * elements)
        } else {
            8.0 * spectrum.numbers + BESIDE * elements
        };
        let search = search + 8.0 * weight.numbers + 2.0 * in_box;
        let memory = MEMORY + search.max(TRIANGLE * solid.triangles);
        Estimate {
            elements: n,
            eigenpairs,
            memory_bytes: memory as u64,
            seconds: BEGIN + stages.sum(),
            stages,
        }
    }

    /// Seconds of work on one core that a deformed copy takes: [`ReliabilityParameters`](crate::ReliabilityParameters).
    pub(crate) fn seconds_of_copy(&self, input: &Input, elements: usize) -> f64 {
        self.stages_of_copy(input, elements).sum()
    }

    /// The same for the stages of its search.
    pub(crate) fn stages_of_copy(&self, input: &Input, elements: usize) -> StageSeconds {
        let (coarser, elements) = (coarser(elements), elements as f64);
        let all = self.spectrum.eigenpairs.about(input.domain()) as f64;
        let k = if self.weight.has_time_scale() { all.min(COPY_EIGENPAIRS) } else { all };
        let trees = if self.weight.has_time_scale() { self.time_scales.len() } else { 1 } as f64;
        let (n, spectrum) = match input.domain() {
            Domain::Volume => {
                let n = elements / coarser.powi(3);
                (n, volume_spectrum(n, k, &self.spectrum).seconds)
            }
            Domain::Surface => (elements, surface_spectrum(elements, k).seconds),
        };
        let solid = Solid::of(input, self, elements);
        let voxels = match input {
            // The box around what is moved, which is wider; and the components in it.
            Input::Solid(grid) => {
                0.4e-6 * occupied(grid).1.iter().map(|&n| f64::from(n) / coarser).product::<f64>()
            }
            _ => solid.seconds,
        };
        // Where each voxel and each vertex is on the copy.
        let places = 1e-6 * elements + NEAREST * solid.vertices;
        StageSeconds {
            voxelize: voxels + places,
            spectrum: 0.6 * spectrum,
            regions: trees * n * 170e-9 + weight_work(self, input, n).seconds,
            ..StageSeconds::default()
        }
    }
}

/// Eigenpairs that matter at the default times.
const COPY_EIGENPAIRS: f64 = 25.0;

/// What a part of the work takes.
struct Work {
    seconds: f64,
    /// Numbers in memory at its peak, in double precision.
    numbers: f64,
    /// Whether eigenfunctions are in single precision.
    single: bool,
}

/// Orthogonalization of Krylov bases, which are larger than the wanted eigenpairs by a few blocks.
fn orthogonalization(n: f64, k: f64) -> f64 {
    2.4e-9 * n * k.powf(1.7)
}

/// All eigenpairs by a dense solver, small ones in the cache, where an iteration's basis would be as large: up to 400 rows, or 2.5 k + 80.
fn dense(n: f64, k: f64) -> Option<Work> {
    (n <= 400.0 || n < 2.5 * k + 80.0).then(|| Work {
        seconds: 1.5e-9 * n.powi(3) * (n / 800.0).min(1.0),
        numbers: 3.0 * n * n,
        single: false,
    })
}

/// Shift-invert on small grids, the polynomial filter on those with 96 times more voxels than eigenpairs, multigrid on the largest.
fn volume_spectrum(n: f64, k: f64, parameters: &SpectrumParameters) -> Work {
    if let Some(work) = dense(n, k) {
        return work;
    }
    let (solver, digits) = (parameters.solver, parameters.tolerance.ln().abs());
    if uses_multigrid(n as usize, k as usize, parameters) {
        // Corrections, and for every three all are made orthogonal.
        let (columns, corrections) = (1.1 * k + 8.0, 0.45 * digits);
        let seconds = n * columns * corrections * (17e-9 + 0.04e-9 * columns);
        let single = parameters.tolerance >= SINGLE_PRECISION;
        // Vectors come in blocks of eight.
        let columns = if single { (1.1 * (k - 1.0) / 8.0).ceil() * 4.0 + 9.0 } else { columns + 24.0 };
        return Work { seconds, numbers: n * columns, single };
    }
    let filter = match solver {
        Eigensolver::Auto => n >= 96.0 * k.max(16.0),
        Eigensolver::ShiftInvert => false,
        _ => true,
    };
    if !filter {
        // The factor and solves with it; the projected matrices.
        let factor = 0.3e-9 * n * n + 13e-9 * n.powf(4.0 / 3.0) * k;
        let seconds = factor + orthogonalization(n, k) + 6.5e-9 * k.powi(3);
        return Work { seconds, numbers: n * (2.6 * k + 60.0) + 8.0 * n.powf(4.0 / 3.0), single: false };
    }
    let block = k + 30.0;
    let updates = 9.5 * n.powf(4.0 / 3.0) * block.powf(2.0 / 3.0);
    Work {
        seconds: 0.5e-9 * updates + orthogonalization(n, block),
        numbers: n * (1.7 * k + 90.0),
        single: false,
    }
}

/// Shift-invert with the sparser factors of surfaces.
fn surface_spectrum(n: f64, k: f64) -> Work {
    dense(n, k).unwrap_or_else(|| Work {
        seconds: 5e-6 * n + 7.4e-9 * n * n.log2() * k + orthogonalization(n, k) + 6.5e-9 * k.powi(3),
        numbers: n * (2.6 * k + 60.0) + 6.0 * n * n.log2(),
        single: false,
    })
}

/// Harmonic functions, where the weight lies on the surface of a solid, and heat that smooths; both on sparse matrices.
fn weight_work(parameters: &Parameters, input: &Input, n: f64) -> Work {
    let weight = parameters.weight;
    let carried = matches!(weight, Weight::Curvature | Weight::Field) && matches!(input, Input::Volume(_));
    let carry = if carried { 33e-9 * n.powf(4.0 / 3.0) } else { 0.0 };
    let dimension = f64::from(input.domain().dimension());
    let smooth = match parameters.smooth_weight {
        // Products with the matrix, and what one takes.
        Some(TimeScale::Relative(t)) => (8.0 + 15.0 * t.sqrt() * n.powf(1.0 / dimension)) * 9e-9 * n,
        Some(TimeScale::Absolute(_)) | None => 0.0,
    };
    let times = if weight.has_time_scale() { parameters.time_scales.len() } else { 1 };
    let matrix = if carried || parameters.smooth_weight.is_some() { 30.0 * n } else { 0.0 };
    Work { seconds: carry + times as f64 * smooth, numbers: matrix, single: false }
}

/// What it takes to get the voxels of a solid.
struct Solid {
    seconds: f64,
    /// Voxels of the box around it; none for a surface.
    in_box: f64,
    /// Of the mesh that it is the inside of.
    vertices: f64,
    triangles: f64,
}

impl Solid {
    fn of(input: &Input, parameters: &Parameters, voxels: f64) -> Self {
        let product = |dims: [usize; 3]| dims.iter().map(|&d| d as f64).product();
        let nothing = Self { seconds: 0.0, in_box: 0.0, vertices: 0.0, triangles: 0.0 };
        match input {
            Input::Solid(grid) => Self { in_box: product(grid.frame().dims()), ..nothing },
            Input::Surface(_) | Input::Shape(_) => nothing,
            Input::Volume(mesh) => {
                let goes_on = || ControlFlow::Continue(());
                match mser3d_voxelize::estimate(mesh, &parameters.voxelize, &goes_on) {
                    // Topology and components of the solid beside the voxelizer's own work.
                    Ok(cost) => Self {
                        seconds: cost.seconds + 0.1e-6 * voxels,
                        in_box: product(cost.dims),
                        vertices: mesh.vertices().len() as f64,
                        triangles: mesh.triangles().len() as f64,
                    },
                    // It will be refused, after a look at each triangle.
                    Err(_) => Self { seconds: 0.3e-6 * mesh.triangles().len() as f64, ..nothing },
                }
            }
        }
    }
}
