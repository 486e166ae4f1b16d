//! `mser3d detect`: from a file to its regions.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use mser3d::shape::{Frame, TriangleMesh, VoxelGrid};
use mser3d::spectral::{Extent, SpectrumParameters};
use mser3d::{Body, Domain, Features, Parameters, ProgressFn, SpectrumFn, detect_on_using, detect_using};
use mser3d_collection::{CacheUse, SpectrumCache};

use crate::error::CliError;
use crate::input::{Contents, Input, InputArgs};
use crate::interrupt;
use crate::options::RegionOptions;
use crate::output::{OutputFolder, Report};
use crate::progress::Meter;
use crate::render::UpAxis;
use crate::run_options::RunOptions;
use crate::table;
use crate::view::write_page;

#[derive(clap::Args)]
pub struct DetectArgs {
    #[command(flatten)]
    pub input: InputArgs,
    /// Folder for the results; made if it isn't there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Write a page for the browser too, view.html in the folder
    #[arg(long)]
    pub html: bool,
    /// Print the regions as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub run: RunOptions,
    #[command(flatten)]
    pub options: RegionOptions,
}

pub fn run(args: &DetectArgs) -> Result<(), CliError> {
    args.run.use_threads()?;
    interrupt::listen();
    let parameters = args.options.parameters()?;
    let input = Input::read(&args.input)?;
    let meter = Meter::new(args.run.quiet);
    let (features, report) =
        detect_into(&args.output, &input, &args.input, &args.options, &parameters, &meter)?;
    if !args.run.quiet {
        report.warnings().iter().for_each(|w| eprintln!("mser3d: warning: {}: {w}", input.path.display()));
    }
    if args.html {
        write_page(&args.output, &args.output.join("view.html"), UpAxis::Y)?;
    }
    if args.json {
        report.print()
    } else if !args.run.quiet {
        table::print(&features, &args.output)
    } else {
        Ok(())
    }
}

/// Finds the regions of an input and writes them to a folder.
pub fn detect_into(
    path: &Path,
    input: &Input,
    args: &InputArgs,
    options: &RegionOptions,
    parameters: &Parameters,
    meter: &Meter,
) -> Result<(Features, Report), CliError> {
    let subject = Subject::of(input, options)?;
    let cache = options.cache.as_deref().map(SpectrumCache::open).transpose()?;
    let folder = OutputFolder::create(path)?;
    let notes = RefCell::new(Vec::from_iter(subject.warning()));
    let spectrum = |body: &Body, parameters: &SpectrumParameters, progress: ProgressFn| {
        let parameters = match (options.eigenpairs, parameters.eigenpairs) {
            (None, Extent::Count(count)) if count > body.len() => {
                notes.borrow_mut().push(format!(
                    "there are only {0} eigenpairs in so small a shape, not {1}; its descriptors compare only \
                     with those of shapes with --eigenpairs {0}",
                    body.len(),
                    count
                ));
                SpectrumParameters { eigenpairs: body.len().into(), ..parameters.clone() }
            }
            _ => parameters.clone(),
        };
        let Some(cache) = &cache else { return body.spectrum(&parameters, progress) };
        let (spectrum, used) = cache.spectrum(body, &parameters, progress)?;
        tracing::info!(?used, "asked the cache of spectra");
        if let CacheUse::Trouble(what) = used {
            meter.warn(&what);
        }
        Ok(spectrum)
    };
    let result = subject.features(options.domain(), parameters, &spectrum, meter);
    meter.finish();
    let features = result.map_err(|source| match source {
        mser3d::Error::Cancelled => CliError::Interrupted,
        source => CliError::Shape { path: input.path.clone(), source },
    })?;
    let report = Report::new(input, args, parameters, &features, notes.into_inner(), meter);
    folder.write(input, &features, &report)?;
    tracing::info!(folder = %path.display(), "wrote");
    Ok((features, report))
}

/// What regions are searched in.
enum Subject<'a> {
    Mesh(&'a TriangleMesh),
    /// The largest part of a voxel mask, and what was left out.
    Solid(Box<VoxelGrid>, Option<String>),
}

impl<'a> Subject<'a> {
    fn of(input: &'a Input, options: &RegionOptions) -> Result<Self, CliError> {
        let (mask, frame) = match &input.contents {
            Contents::Mesh(loaded) => return Ok(Self::Mesh(&loaded.mesh)),
            Contents::Mask(mask, frame) => (mask, frame),
        };
        if options.domain() == Domain::Surface {
            return Err(CliError::Usage("--surface needs a mesh; a voxel mask has no surface mesh".into()));
        }
        if let Some(option) = options.voxels.first_given() {
            return Err(CliError::Usage(format!("{option} needs a mesh; a voxel mask is voxels already")));
        }
        let failed = |e| CliError::Shape { path: input.path.clone(), source: mser3d::Error::from(e) };
        let frame = match options.voxels.pitch() {
            Some(pitch) => Frame::new(mask.dims(), [0.0; 3], [pitch; 3]).map_err(failed)?,
            None => *frame,
        };
        let whole = VoxelGrid::solid(frame, mask.clone()).map_err(failed)?;
        let voxels = whole.len();
        let (grid, components, dropped) = whole.largest_component();
        let warning = (dropped > 0).then(|| {
            let share = 100.0 * dropped as f64 / voxels as f64;
            format!("{components} smaller components with {dropped} voxels ({share:.2} %) were dropped")
        });
        Ok(Self::Solid(Box::new(grid), warning))
    }

    fn features(
        &self,
        domain: Domain,
        parameters: &Parameters,
        spectrum: SpectrumFn,
        meter: &Meter,
    ) -> Result<Features, mser3d::Error> {
        let progress = |p| meter.report(p);
        match self {
            Self::Mesh(mesh) => detect_using(mesh, domain, parameters, spectrum, &progress),
            Self::Solid(grid, _) => {
                let body = Body::solid(VoxelGrid::clone(grid), parameters.voxelize.connectivity);
                detect_on_using(body, parameters, spectrum, &progress)
            }
        }
    }

    fn warning(&self) -> Option<String> {
        match self {
            Self::Mesh(_) => None,
            Self::Solid(_, warning) => warning.clone(),
        }
    }
}
