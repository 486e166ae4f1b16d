use mser3d_spectral::{EigenpairRange, Spectrum, SpectrumParameters};

use crate::course::Course;
use crate::describe::{Described, describe_with};
use crate::features::{Found, FoundOnBody};
use crate::input::Prepared;
use crate::progress::{NO_PROGRESS, Progress, ProgressFn, Stage, report};
use crate::regions::find_regions_with;
use crate::reliability::{self, Original};
use crate::run_report::Clock;
use crate::{
    Body, DiscreteShape, Error, Features, Field, Input, Parameters, RegionSet, Sidedness, Warning, Weight,
    partition,
};

/// Where the eigenpairs of a shape come from: [`DiscreteShape::spectrum`], or a cache before it.
pub type SpectrumSource<'a> =
    &'a (dyn Fn(&DiscreteShape, &SpectrumParameters, ProgressFn) -> Result<Spectrum, Error> + Sync);

/// Where the values of [`Weight::Field`] come from: a field on all elements of the shape that is searched.
pub type FieldSource<'a> = &'a (dyn Fn(&DiscreteShape) -> Result<Field, Error> + Sync);

/// Finds and describes the stable regions of shapes: the whole pipeline, and all that it can be told.
///
/// Of a shape of several bodies the largest is searched, unless [`Parameters::bodies`] says otherwise.
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
    /// The values of [`Weight::Field`]. Default: none.
    pub field: Option<FieldSource<'a>>,
}

impl Default for Detector<'_> {
    fn default() -> Self {
        Self::new(Parameters::default())
    }
}

impl<'a> Detector<'a> {
    /// A detector with these parameters that computes its own spectra and tells nobody how far it is.
    pub fn new(parameters: Parameters) -> Self {
        Self { parameters, progress: NO_PROGRESS, spectra: &DiscreteShape::spectrum, field: None }
    }

    /// The same detector, which tells this function how far it is.
    pub fn with_progress(self, progress: ProgressFn<'a>) -> Self {
        Self { progress, ..self }
    }

    /// The same detector, with eigenpairs from elsewhere.
    pub fn with_spectra(self, spectra: SpectrumSource<'a>) -> Self {
        Self { spectra, ..self }
    }

    /// The same detector, with another weight: any function of the shape's elements, with values or vectors. Altitudes
    /// become linear, since it may be negative; of one that is positive set them back, if its ratios matter.
    ///
    /// What is known at the vertices of a mesh is brought to the elements by [`DiscreteShape::carry`].
    ///
    /// ```
    /// # fn run(mesh: &mser3d::shape::TriangleMesh) -> Result<(), mser3d::Error> {
    /// use mser3d::{Detector, DiscreteShape, Field, Input, Parameters};
    ///
    /// // Parts that stand up: superlevel sets of the height.
    /// let height = |shape: &DiscreteShape| Field::scalar(shape.positions().iter().map(|p| p[2]).collect());
    /// let features = Detector::new(Parameters::default()).with_weight(&height).detect(Input::Volume(mesh))?;
    /// # Ok(())
    /// # }
    /// ```
    pub fn with_weight(mut self, field: FieldSource<'a>) -> Self {
        self.parameters.weight = Weight::Field;
        self.parameters.stability.altitude = Weight::Field.altitude();
        Self { field: Some(field), ..self }
    }

    /// Finds and describes the stable regions of a shape.
    ///
    /// # Errors
    /// [`Error`]: that of the stage that failed, or [`Error::Cancelled`]. [`Error::TooMuchMemory`] where the
    /// [estimate](Parameters::estimate) of the run is above the spectrum's `memory_limit`: before any work.
    pub fn detect(&self, input: Input) -> Result<Features, Error> {
        let Self { parameters, progress, spectra, field } = self;
        parameters.validate()?;
        if parameters.weight == Weight::Field && field.is_none() {
            return Err(Error::NoField);
        }
        let mut clock = Clock::start();
        let estimate = parameters.estimate(&input);
        // More eigenpairs than there can be are refused as such, and so are grids of too many voxels.
        let possible = estimate.elements as u64 <= parameters.voxelize.max_box_voxels
            && match parameters.spectrum.eigenpairs {
                EigenpairRange::Count(count) => count <= estimate.elements,
                _ => true,
            };
        let limit =
            parameters.spectrum.memory_limit.filter(|&limit| possible && estimate.memory_bytes > limit);
        if let Some(limit) = limit {
            return Err(Error::TooMuchMemory {
                elements: estimate.elements,
                eigenpairs: estimate.eigenpairs,
                needed_mb: estimate.memory_bytes.div_ceil(1_000_000),
                limit_mb: limit / 1_000_000,
            });
        }
        let course = Course::new(*progress, estimate.stages);
        let progress = |told: Progress| course.hear(told);
        if let Input::Volume(_) = input {
            report(&progress, Stage::Voxelize, 0.0)?;
        }
        let original = Original::of(&input);
        let mesh = match input {
            Input::Volume(mesh) => Some(mesh),
            _ => None,
        };
        let Prepared { shape, bodies, voxelization, mut warnings } = input.prepare(parameters, &progress)?;
        if parameters.weight == Weight::Curvature && shape.mesh().is_none() {
            return Err(Error::NoMesh);
        }
        if let Some(voxelization) = &voxelization {
            course.end(Stage::Voxelize)?;
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
        let parts = if bodies.len() > 1 { shape.split(&bodies)? } else { Vec::new() };
        let part = |body: usize| parts.get(body).unwrap_or(&shape);
        let copies = original.map_or(0, |original| parameters.copies_of(original, shape.len()));
        let of_copies = |of: Original| copies as f64 * parameters.seconds_of_copy(&of.input(), shape.len());
        course.expect(Stage::Reliability, original.map_or(0.0, of_copies));
        // A larger body takes longer.
        let sizes: Vec<usize> = bodies.iter().map(Vec::len).collect();
        let of_bodies = |told: Progress, body: usize| {
            let elements = |bodies: &[usize]| bodies.iter().sum::<usize>() as f64;
            let done = elements(&sizes[..body]) + told.done * elements(&sizes[body..=body]);
            progress(Progress { done: done / elements(&sizes), ..told })
        };

        let mut searched = Vec::with_capacity(sizes.len());
        for (body, elements) in bodies.into_iter().enumerate() {
            let progress = |told| of_bodies(told, body);
            let wanted = spectrum_of_body(&parameters.spectrum, body);
            let Spectrum { basis, report, .. } = spectra(part(body), &wanted, &progress)?;
            let (available, residual) = (basis.eigenvalues().len(), report.residual);
            tracing::info!(body, eigenpairs = available, solver = %report.solver, residual, "solved");
            let sidedness = Sidedness::default();
            searched.push(Body { elements, basis, spectrum: report, sidedness });
        }
        course.end(Stage::Spectrum)?;
        let seconds = clock.lap(Stage::Spectrum);
        tracing::info!(bodies = searched.len(), seconds, "solved all");
        self.warn_of_spectra(&searched, &mut warnings);

        let field = match (parameters.weight, field) {
            (Weight::Field, Some(field)) => Some(field(&shape)?),
            (Weight::Curvature, _) => Some(shape.mean_curvature()?),
            _ => None,
        };
        if let Some(field) = &field {
            field.expect("voxels or vertices in the shape", shape.len())?;
        }
        let mut sets = Vec::with_capacity(searched.len());
        for (number, body) in searched.iter().enumerate() {
            let progress = |told| of_bodies(told, number);
            let own = field.as_ref().map(|field| field.of(&body.elements));
            sets.push(find_regions_with(part(number), &body.basis, own.as_ref(), parameters, &progress)?);
        }
        let seconds = clock.lap(Stage::Regions);
        let count = |sets: &[RegionSet]| sets.iter().map(|set| set.regions.len()).sum::<usize>();
        let trees: usize = sets.iter().map(|set| set.trees.len()).sum();
        let duplicates: usize = sets.iter().map(|set| set.duplicates).sum();
        tracing::info!(regions = count(&sets), trees, duplicates, seconds, "found regions");

        if let (Some(original), 1..) = (original, copies) {
            reliability::measure(original, &shape, &searched, &mut sets, parameters, copies, &progress)?;
            let seconds = clock.lap(Stage::Reliability);
            tracing::info!(copies, regions = count(&sets), seconds, "measured reliability");
        } else if original.is_some() && parameters.reliability.deformations != Some(0) {
            warnings.push(Warning::Unmeasured { of_field: parameters.weight == Weight::Field });
        }

        let mut found = Vec::with_capacity(searched.len());
        for (number, (mut set, body)) in sets.into_iter().zip(&mut searched).enumerate() {
            let progress = |told| of_bodies(told, number);
            let Described { descriptors, sides } =
                describe_with(part(number), &body.basis, &set.regions, parameters, &progress)?;
            for ((region, twin), side) in set.regions.iter_mut().zip(&sides.twins).zip(&sides.sides) {
                (region.twin, region.side) = (*twin, *side);
            }
            body.sidedness = sides.sidedness;
            found.push(FoundOnBody { set, descriptors, cosines: sides.cosines });
        }
        let Found { regions, descriptors, cosines, trees, duplicates } =
            Found::on_all(&shape, &searched, found)?;
        course.end(Stage::Descriptors)?;
        let seconds = clock.lap(Stage::Descriptors);
        tracing::info!(regions = regions.len(), seconds, "described regions");
        if voxelization.is_some() {
            let regions = regions.iter().filter(|region| region.vertices.is_empty()).count();
            if regions > 0 {
                warnings.push(Warning::BetweenVertices { regions });
            }
        }
        let mut features = Features {
            parameters: Parameters {
                polarity: Some(parameters.polarity_with(field.as_ref())),
                ..parameters.clone()
            },
            shape,
            voxelization,
            bodies: searched,
            regions,
            descriptors,
            cosines,
            trees,
            duplicates,
            partition: None,
            warnings,
            run: clock.report(),
            parts,
        };
        if let Some(wanted) = &parameters.parts {
            report(&progress, Stage::Parts, 0.0)?;
            let partition = partition(&features, mesh, wanted)?;
            course.end(Stage::Parts)?;
            let seconds = clock.lap(Stage::Parts);
            tracing::info!(parts = partition.parts.len(), seconds, "divided into parts");
            features.partition = Some(partition);
            features.run = clock.report();
        }
        Ok(features)
    }

    /// Adds what the spectra tell of the shape.
    fn warn_of_spectra(&self, bodies: &[Body], warnings: &mut Vec<Warning>) {
        let most = bodies.iter().map(|body| body.spectrum.zero_modes).max().unwrap_or(0);
        if most > 1 {
            warnings.push(Warning::Apart { parts: most });
        }
        let available = bodies.iter().map(|body| body.basis.eigenvalues().len()).min().unwrap_or(0);
        match self.parameters.spectrum.eigenpairs {
            EigenpairRange::AtMost(wanted) | EigenpairRange::Count(wanted) if available < wanted => {
                // Before what the voxelizer says, which is long.
                warnings.insert(0, Warning::FewEigenpairs { wanted, available });
            }
            _ => {}
        }
    }
}

/// What to compute of a body. A number of eigenpairs that is asked for the largest must have; a smaller body has as many as
/// it can.
fn spectrum_of_body(parameters: &SpectrumParameters, body: usize) -> SpectrumParameters {
    let eigenpairs = match parameters.eigenpairs {
        EigenpairRange::Count(count) if body > 0 => EigenpairRange::AtMost(count),
        range => range,
    };
    SpectrumParameters { eigenpairs, ..parameters.clone() }
}
