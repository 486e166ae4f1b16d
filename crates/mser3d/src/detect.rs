use std::time::Instant;

use mser3d_descriptors::{Descriptors, hks, region_descriptors, si_hks};
use mser3d_shape::{Domain, Eigenbasis, TriangleMesh};
use mser3d_spectral::{Spectrum, SpectrumParameters, SpectrumReport};
use mser3d_voxelize::Voxelization;

use crate::progress::{ProgressFn, Stage, report};
use crate::{Body, Descriptor, Error, Found, Parameters, Region, Tree, find_regions};

/// The stable regions of a shape, their descriptors, and how they were found.
#[derive(Clone, Debug)]
pub struct Features {
    /// What heat flowed on.
    pub body: Body,
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
    /// The time each stage took.
    pub times: Vec<StageTime>,
}

/// The wall time of a stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageTime {
    /// The stage.
    pub stage: Stage,
    /// Its duration in seconds.
    pub seconds: f64,
}

impl Features {
    /// The innermost region of each vertex of the mesh, in file order: the smallest that has it.
    pub fn region_of_vertex(&self) -> Vec<Option<u32>> {
        innermost(self.body.element_of_vertex().len(), self.regions.iter().map(|r| &r.vertices[..]))
    }

    /// The innermost region of each voxel or surface vertex.
    pub fn region_of_element(&self) -> Vec<Option<u32>> {
        innermost(self.body.len(), self.regions.iter().map(|r| &r.elements[..]))
    }
}

/// Regions come by descending volume, so the last that has an element is the smallest.
fn innermost<'a>(n: usize, regions: impl Iterator<Item = &'a [u32]>) -> Vec<Option<u32>> {
    let mut labels = vec![None; n];
    for (number, members) in regions.enumerate() {
        members.iter().for_each(|&m| labels[m as usize] = Some(number as u32));
    }
    labels
}

/// Finds and describes the stable regions of a mesh: of the solid inside it, or of its surface.
///
/// ```
/// # fn run(mesh: &mser3d::shape::TriangleMesh) -> Result<(), mser3d::Error> {
/// let features =
///     mser3d::detect(mesh, mser3d::Domain::Volume, &Default::default(), &mser3d::no_progress)?;
/// for region in &features.regions {
///     println!("{:.1} % of the volume around {:?}", 100.0 * region.volume_fraction, region.centroid);
/// }
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error`]: that of the stage that failed, or [`Error::Cancelled`].
pub fn detect(
    mesh: &TriangleMesh,
    domain: Domain,
    parameters: &Parameters,
    progress: ProgressFn,
) -> Result<Features, Error> {
    detect_using(mesh, domain, parameters, &Body::spectrum, progress)
}

/// Where the eigenpairs of a body come from: [`Body::spectrum`], or a cache before it.
pub type SpectrumFn<'a> = &'a dyn Fn(&Body, &SpectrumParameters, ProgressFn) -> Result<Spectrum, Error>;

/// As [`detect`], with eigenpairs from elsewhere.
///
/// # Errors
/// As [`detect`].
pub fn detect_using(
    mesh: &TriangleMesh,
    domain: Domain,
    parameters: &Parameters,
    spectrum: SpectrumFn,
    progress: ProgressFn,
) -> Result<Features, Error> {
    parameters.validate()?;
    match domain {
        Domain::Surface => detect_on_using(Body::surface(mesh), parameters, spectrum, progress),
        Domain::Volume => {
            report(progress, Stage::Voxelize, 0, 1)?;
            let start = Instant::now();
            let (body, voxelization) = Body::volume(mesh, &parameters.voxelize)?;
            let seconds = start.elapsed().as_secs_f64();
            report(progress, Stage::Voxelize, 1, 1)?;
            tracing::info!(
                voxels = body.len(),
                pitch = voxelization.grid.frame().spacing()[0],
                method = ?voxelization.method,
                cut_links = voxelization.cut_links,
                seconds,
                "voxelized"
            );
            let mut features = detect_on_using(body, parameters, spectrum, progress)?;
            features.voxelization = Some(voxelization);
            features.times.insert(0, StageTime { stage: Stage::Voxelize, seconds });
            Ok(features)
        }
    }
}

/// As [`detect`], on a body that is there already: a voxel mask, or one that serves several weights.
///
/// # Errors
/// As [`detect`].
pub fn detect_on(body: Body, parameters: &Parameters, progress: ProgressFn) -> Result<Features, Error> {
    detect_on_using(body, parameters, &Body::spectrum, progress)
}

/// As [`detect_on`], with eigenpairs from elsewhere.
///
/// # Errors
/// As [`detect`].
pub fn detect_on_using(
    body: Body,
    parameters: &Parameters,
    spectrum: SpectrumFn,
    progress: ProgressFn,
) -> Result<Features, Error> {
    parameters.validate()?;
    let mut times = Vec::new();
    let mut start = Instant::now();
    let mut lap = |stage| {
        let seconds = start.elapsed().as_secs_f64();
        times.push(StageTime { stage, seconds });
        start = Instant::now();
        seconds
    };
    let Spectrum { basis, report: spectrum } = spectrum(&body, &parameters.spectrum, progress)?;
    let seconds = lap(Stage::Spectrum);
    tracing::info!(
        eigenpairs = basis.eigenvalues().len(),
        solver = spectrum.solver,
        residual = spectrum.residual,
        seconds,
        "solved"
    );
    let Found { regions, trees, duplicates } = find_regions(&body, &basis, parameters, progress)?;
    let seconds = lap(Stage::Regions);
    tracing::info!(regions = regions.len(), trees = trees.len(), duplicates, seconds, "found regions");
    report(progress, Stage::Descriptors, 0, regions.len())?;
    let descriptors = describe(&basis, &regions, parameters)?;
    report(progress, Stage::Descriptors, regions.len(), regions.len())?;
    let seconds = lap(Stage::Descriptors);
    tracing::info!(regions = regions.len(), seconds, "described regions");
    let voxelization = None;
    Ok(Features { body, voxelization, basis, spectrum, regions, descriptors, trees, duplicates, times })
}

/// The descriptors of regions: means over their elements (eq. 11).
///
/// SI-vHKS is the modulus of a Fourier transform over log time. That makes it the same at any scale, but
/// it also loses where on the time axis a signature lies, which tells a part from the larger part
/// around it. [`Descriptor::SizedSiHks`] gives the place back as one number more, in samples of the time
/// axis: `samples_per_octave * 2/d * log2(V_region / V_body)`, with d = 3 in a volume, 2 on a surface (heat
/// takes a time of `V^(2/d)` to cross a body of measure V). It depends on neither pose nor scale.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn describe(
    basis: &Eigenbasis,
    regions: &[Region],
    parameters: &Parameters,
) -> Result<Descriptors, Error> {
    let members: Vec<&[u32]> = regions.iter().map(|r| &r.elements[..]).collect();
    let rows = region_descriptors(&members, basis.mass(), |elements| match &parameters.descriptor {
        Descriptor::SizedSiHks(own) | Descriptor::SiHks(own) => {
            let mut own = own.clone();
            if let (None, Some(measure)) = (own.unit, parameters.reference_measure) {
                own.unit = Some(match basis.domain() {
                    Domain::Volume => (measure / own.reference_volume).powf(2.0 / 3.0),
                    Domain::Surface => measure / own.reference_area,
                });
            }
            si_hks(basis, &own, Some(elements))
        }
        Descriptor::Hks(own) => hks(basis, own, Some(elements)),
    })?;
    let Descriptor::SizedSiHks(own) = &parameters.descriptor else { return Ok(rows) };
    let unit = own.samples_per_octave as f64 * 2.0 / f64::from(basis.domain().dimension());
    let sizes = regions.iter().map(|region| unit * region.volume_fraction.log2());
    let values = rows.rows().zip(sizes).flat_map(|(row, size)| row.iter().copied().chain([size])).collect();
    Ok(Descriptors::new(rows.width() + 1, values)?)
}
