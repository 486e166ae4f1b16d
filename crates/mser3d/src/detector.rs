use std::time::Instant;

use mser3d_descriptors::Descriptors;
use mser3d_shape::{Eigenbasis, innermost_regions};
use mser3d_spectral::{EigenpairRange, Spectrum, SpectrumParameters, SpectrumReport};
use mser3d_voxelize::Voxelization;

use crate::input::Prepared;
use crate::memory::peak_memory;
use crate::progress::{NO_PROGRESS, ProgressFn, Stage, report};
use crate::{
    DiscreteShape, Error, Input, Parameters, Region, RegionSet, Tree, Warning, describe, find_regions,
};

/// Where the eigenpairs of a shape come from: [`DiscreteShape::spectrum`], or a cache before it.
pub type SpectrumSource<'a> =
    &'a (dyn Fn(&DiscreteShape, &SpectrumParameters, ProgressFn) -> Result<Spectrum, Error> + Sync);

/// Finds and describes the stable regions of shapes: the whole pipeline, and all that it can be told.
///
/// ```
/// # fn run(mesh: &mser3d::shape::TriangleMesh) -> Result<(), mser3d::Error> {
/// use mser3d::{Detector, Input, Parameters};
///
/// let features = Detector::new(Parameters::default()).detect(Input::Volume(mesh))?;
/// for region in &features.regions {
///     println!("{:.1} % of the volume around {:?}", 100.0 * region.volume_fraction, region.centroid);
/// }
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Detector<'a> {
    /// The parameters of all stages.
    pub parameters: Parameters,
    /// Hears how far the work is, and can cancel it. Default: [`NO_PROGRESS`].
    pub progress: ProgressFn<'a>,
    /// Where eigenpairs come from. Default: [`DiscreteShape::spectrum`].
    pub spectra: SpectrumSource<'a>,
}

impl Default for Detector<'_> {
    fn default() -> Self {
        Self::new(Parameters::default())
    }
}

impl<'a> Detector<'a> {
    /// A detector with these parameters that computes its own spectra and tells nobody how far it is.
    pub fn new(parameters: Parameters) -> Self {
        Self { parameters, progress: NO_PROGRESS, spectra: &DiscreteShape::spectrum }
    }

    /// The same detector, which tells this function how far it is.
    pub fn with_progress(self, progress: ProgressFn<'a>) -> Self {
        Self { progress, ..self }
    }

    /// The same detector, with eigenpairs from elsewhere.
    pub fn with_spectra(self, spectra: SpectrumSource<'a>) -> Self {
        Self { spectra, ..self }
    }

    /// Finds and describes the stable regions of a shape.
    ///
    /// # Errors
    /// [`Error`]: that of the stage that failed, or [`Error::Cancelled`].
    pub fn detect(&self, input: Input) -> Result<Features, Error> {
        let Self { parameters, progress, spectra } = self;
        parameters.validate()?;
        let mut clock = Clock::start();
        if let Input::Volume(_) = input {
            report(*progress, Stage::Voxelize, 0, 1)?;
        }
        let Prepared { shape, voxelization, mut warnings } = input.prepare(parameters)?;
        if let Some(voxelization) = &voxelization {
            report(*progress, Stage::Voxelize, 1, 1)?;
            let seconds = clock.lap(Stage::Voxelize);
            tracing::info!(
                voxels = shape.len(),
                pitch = voxelization.grid.frame().spacing()[0],
                inside = %voxelization.inside,
                cut_links = voxelization.cut_links,
                seconds,
                "voxelized"
            );
        } else {
            clock.restart();
        }
        let Spectrum { basis, report: spectrum, .. } = spectra(&shape, &parameters.spectrum, *progress)?;
        let (seconds, available) = (clock.lap(Stage::Spectrum), basis.eigenvalues().len());
        tracing::info!(
            eigenpairs = available,
            solver = %spectrum.solver,
            residual = spectrum.residual,
            seconds,
            "solved"
        );
        match parameters.spectrum.eigenpairs {
            EigenpairRange::AtMost(wanted) if available < wanted => {
                // Before what the voxelizer says, which is long.
                warnings.insert(0, Warning::FewEigenpairs { wanted, available });
            }
            _ => {}
        }
        let RegionSet { regions, trees, duplicates } = find_regions(&shape, &basis, parameters, *progress)?;
        let seconds = clock.lap(Stage::Regions);
        tracing::info!(regions = regions.len(), trees = trees.len(), duplicates, seconds, "found regions");
        report(*progress, Stage::Descriptors, 0, regions.len())?;
        let descriptors = describe(&basis, &regions, parameters)?;
        report(*progress, Stage::Descriptors, regions.len(), regions.len())?;
        let seconds = clock.lap(Stage::Descriptors);
        tracing::info!(regions = regions.len(), seconds, "described regions");
        Ok(Features {
            parameters: Parameters { polarity: Some(parameters.polarity()), ..parameters.clone() },
            shape,
            voxelization,
            basis,
            spectrum,
            regions,
            descriptors,
            trees,
            duplicates,
            warnings,
            run: clock.stop(),
        })
    }
}

/// The stable regions of a shape, their descriptors, and how they were found.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Features {
    /// The parameters they were found with; the polarity is set.
    pub parameters: Parameters,
    /// What heat flowed on.
    pub shape: DiscreteShape,
    /// How the mesh was voxelized; none for surfaces and for solids given as voxels.
    pub voxelization: Option<Voxelization>,
    /// The eigenpairs.
    pub basis: Eigenbasis,
    /// Their measured quality.
    pub spectrum: SpectrumReport,
    /// The regions, by descending volume.
    pub regions: Vec<Region>,
    /// A descriptor for each region, in the same order.
    pub descriptors: Descriptors,
    /// One component tree for each time scale, and what each filter cut.
    pub trees: Vec<Tree>,
    /// Regions dropped because another time scale had them too.
    pub duplicates: usize,
    /// What the user should know.
    pub warnings: Vec<Warning>,
    /// What the run took.
    pub run: RunReport,
}

impl Features {
    /// The innermost region of each vertex of the mesh, in file order: the smallest that has it.
    pub fn region_of_vertex(&self) -> Vec<Option<u32>> {
        innermost_regions(self.shape.element_of_vertex().len(), self.regions.iter().map(|r| &r.vertices))
    }

    /// The innermost region of each voxel or surface vertex.
    pub fn region_of_element(&self) -> Vec<Option<u32>> {
        innermost_regions(self.shape.len(), self.regions.iter().map(|r| &r.elements))
    }
}

/// What a run took: what differs from run to run.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RunReport {
    /// Threads that it could use.
    pub threads: usize,
    /// Wall time of all stages, in seconds.
    pub seconds: f64,
    /// The most memory that the process held up to the end, in bytes; none where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// What each stage took.
    pub stages: Vec<StageReport>,
}

/// What a stage took.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct StageReport {
    /// The stage.
    pub stage: Stage,
    /// Its wall time in seconds.
    pub seconds: f64,
    /// The most memory that the process held up to its end, in bytes; none where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

/// Measures one stage after another.
struct Clock {
    start: Instant,
    stages: Vec<StageReport>,
}

impl Clock {
    fn start() -> Self {
        Self { start: Instant::now(), stages: Vec::new() }
    }

    fn restart(&mut self) {
        self.start = Instant::now();
    }

    /// Ends a stage; returns its seconds.
    fn lap(&mut self, stage: Stage) -> f64 {
        let seconds = self.start.elapsed().as_secs_f64();
        self.stages.push(StageReport { stage, seconds, peak_memory_bytes: peak_memory() });
        self.restart();
        seconds
    }

    fn stop(self) -> RunReport {
        RunReport {
            threads: rayon::current_num_threads(),
            seconds: self.stages.iter().map(|s| s.seconds).sum(),
            peak_memory_bytes: peak_memory(),
            stages: self.stages,
        }
    }
}
