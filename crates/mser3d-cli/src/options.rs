//! Command-line options that become [`Parameters`]. Defaults and the names of choices are the library's.

use std::path::PathBuf;
use std::str::FromStr;

use mser3d::comptree::{AltitudeScale, Polarity, PoolParameters, StabilityParameters, StabilityRule};
use mser3d::descriptors::TimeScale;
use mser3d::shape::{Domain, InvalidParameter};
use mser3d::spectral::{EigenpairRange, Eigensolver, SpectrumParameters};
use mser3d::{Bodies, DescriptorKind, Parameters, PartCount, PartParameters, ReliabilityParameters};
use mser3d_collection::SpectrumCache;
use mser3d_meshio::ReadOptions;
use mser3d_results::{Extra, FieldFile, ShapeFile, ShapeOptions};

use crate::choice::choice;
use crate::error::CliError;
use crate::limit_options::LimitOptions;
use crate::numbers::{count, fraction, positive, zero_or_more};
use crate::volume_options::VolumeOptions;
use crate::voxel_options::VoxelOptions;
use crate::weight_option::{WeightOption, WeightParser};

/// Options of everything that computes regions.
#[derive(clap::Args, Clone, Debug)]
pub struct RegionOptions {
    /// Search the surface instead of the volume inside
    #[arg(long, help_heading = "Method",
          conflicts_with_all = ["size", "origin", "connectivity", "inside", "overlap", "no_cut_links",
                                "morphology"])]
    pub surface: bool,
    /// What the component tree is built on; FIELD.npy: values or vectors of its own for each vertex or voxel
    #[arg(long, value_name = "WEIGHT|FIELD.npy", value_parser = WeightParser, default_value_t = WeightOption::default(),
          help_heading = "Method")]
    pub weight: WeightOption,
    /// How long heat smooths the weight first, in units of volume^(2/3) (surface: area); not edge and diffusion
    /// [default: none]
    #[arg(long, value_name = "T_REL", value_parser = positive, help_heading = "Method")]
    pub smooth_weight: Option<f64>,
    /// Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    #[arg(long, value_name = "T_REL,...", value_delimiter = ',', default_values_t = relative_times(),
          value_parser = positive, help_heading = "Method")]
    pub time_scale: Vec<f64>,
    /// Time scales in squared units of the input's coordinates, instead of --time-scale
    #[arg(
        long,
        value_name = "T,...",
        value_delimiter = ',',
        conflicts_with = "time_scale",
        value_parser = positive,
        help_heading = "Method"
    )]
    pub absolute_time: Vec<f64>,
    /// Volume (surface: area) that time scales and descriptors refer to, in the input's units; give all
    /// poses of a body that of one [default: the shape's own]
    #[arg(long, value_name = "MEASURE", value_parser = positive, help_heading = "Method")]
    pub reference_measure: Option<f64>,
    /// What to do with a shape of several bodies
    #[arg(long, value_parser = choice::<Bodies>(), default_value_t = Bodies::default(), help_heading = "Method")]
    pub bodies: Bodies,
    /// Which way the tree grows [default: the one that finds limbs; of a field where its values are high, of
    /// vectors where they differ little]
    #[arg(long, value_parser = choice::<Polarity>(), help_heading = "Method")]
    pub polarity: Option<Polarity>,

    #[command(flatten)]
    pub voxels: VoxelOptions,
    #[command(flatten)]
    pub limits: LimitOptions,

    /// Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    #[arg(long, value_name = "K", value_parser = count, help_heading = "Spectrum")]
    pub eigenpairs: Option<usize>,
    /// All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    #[arg(long, value_name = "X", conflicts_with = "eigenpairs", help_heading = "Spectrum")]
    pub lambda_max: Option<f64>,
    /// Largest relative residual of an eigenpair; below 1e-4 regions stay the same
    /// [default: 1e-4; 1e-9 where --write asks for eigenfunctions, signatures or fields]
    #[arg(long, value_name = "R", help_heading = "Spectrum")]
    pub tolerance: Option<f64>,
    /// How eigenpairs are found
    #[arg(long, value_parser = choice::<Eigensolver>(), default_value_t = Eigensolver::default(),
          help_heading = "Spectrum")]
    pub solver: Eigensolver,
    /// Keep spectra in this folder and take them from there; results are the same with and without
    #[arg(long, value_name = "DIR", help_heading = "Spectrum")]
    pub cache: Option<PathBuf>,

    /// How stable regions are chosen
    #[arg(long, alias = "mode", value_parser = choice::<StabilityRule>(),
          default_value_t = StabilityParameters::default().rule, help_heading = "Regions")]
    pub stability_rule: StabilityRule,
    /// Half width of the stability window, in units of log altitude; linear: of the weight's spread
    #[arg(long, value_name = "D", value_parser = positive, default_value_t = StabilityParameters::default().window,
          help_heading = "Regions")]
    pub window: f64,
    /// Least lifetime of a part, in units of (log) altitude [default: 0.1; with linear altitude 0]
    #[arg(long, value_name = "D", value_parser = zero_or_more, help_heading = "Regions")]
    pub min_lifetime: Option<f64>,
    /// Scale on which altitude, and so stability, is measured [default: log; linear for curvature and fields]
    #[arg(long, value_parser = choice::<AltitudeScale>(), help_heading = "Regions")]
    pub altitude: Option<AltitudeScale>,
    /// Smallest region, as a fraction of the whole
    #[arg(long, value_name = "F", value_parser = fraction,
          default_value_t = StabilityParameters::default().min_volume_fraction, help_heading = "Regions")]
    pub min_volume: f64,
    /// Largest region, as a fraction of the whole
    #[arg(long, value_name = "F", value_parser = fraction,
          default_value_t = StabilityParameters::default().max_volume_fraction, help_heading = "Regions")]
    pub max_volume: f64,
    /// How much smaller than the next larger region a nested one must be, as a fraction
    #[arg(long, value_name = "F", value_parser = fraction,
          default_value_t = StabilityParameters::default().min_diversity, help_heading = "Regions")]
    pub min_diversity: f64,
    /// Drop regions that are less stable [default: none]
    #[arg(long, value_name = "S", help_heading = "Regions")]
    pub min_stability: Option<f64>,
    /// Overlap from which regions of two time scales are one
    #[arg(long, value_name = "F", value_parser = fraction,
          default_value_t = PoolParameters::default().duplicate_overlap, help_heading = "Regions")]
    pub duplicate_overlap: f64,
    /// Deformed copies of the shape that are searched, to measure how surely each region is found again; 0 for none
    /// [default: 6, fewer where they take over 10 s]
    #[arg(long, value_name = "N", help_heading = "Regions")]
    pub reliability: Option<usize>,
    /// Drop regions that are found again less surely, 0 to 1
    #[arg(long, value_name = "P", value_parser = fraction, help_heading = "Regions")]
    pub min_reliability: Option<f64>,
    /// Heat kernel signature that describes a region
    #[arg(long, value_parser = choice::<DescriptorKind>(), default_value_t = DescriptorKind::default(),
          help_heading = "Regions")]
    pub descriptor: DescriptorKind,
    /// Divide each body into parts too, every voxel and vertex in exactly one: limbs and trunk (auto), this many, or none
    #[arg(long, value_name = "auto|N|none", default_value = "auto", help_heading = "Regions")]
    pub parts: WantedParts,
}

/// How many parts, if any.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WantedParts(pub Option<PartCount>);

impl FromStr for WantedParts {
    type Err = InvalidParameter;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.parse() {
            _ if text == "none" => Ok(Self(None)),
            Ok(count) => Ok(Self(Some(count))),
            Err(_) => {
                Err(InvalidParameter::new("parts", text, "auto, none, or a whole number of at least 1"))
            }
        }
    }
}

impl RegionOptions {
    pub fn domain(&self) -> Domain {
        if self.surface { Domain::Surface } else { Domain::Volume }
    }

    /// The library's parameters, where so much is written besides; values out of range are wrong use.
    pub fn parameters(&self, extras: &[Extra]) -> Result<Parameters, CliError> {
        // Regions need less than those who ask for eigenpairs.
        let defaults = match extras.iter().any(|extra| extra.needs_eigenfunctions()) {
            true => SpectrumParameters::default(),
            false => Parameters::default().spectrum,
        };
        let parameters = Parameters {
            bodies: self.bodies,
            voxelize: self.voxels.parameters(&self.limits)?,
            spectrum: SpectrumParameters {
                eigenpairs: match (self.eigenpairs, self.lambda_max) {
                    (Some(count), _) => EigenpairRange::Count(count),
                    (None, Some(bound)) => EigenpairRange::LambdaMax(bound),
                    (None, None) => defaults.eigenpairs,
                },
                tolerance: self.tolerance.unwrap_or(defaults.tolerance),
                solver: self.solver,
                memory_limit: self.limits.memory(),
                ..defaults
            },
            weight: self.weight.weight(),
            smooth_weight: self.smooth_weight.map(TimeScale::Relative),
            polarity: self.polarity,
            time_scales: if self.absolute_time.is_empty() {
                self.time_scale.iter().copied().map(TimeScale::Relative).collect()
            } else {
                self.absolute_time.iter().copied().map(TimeScale::Absolute).collect()
            },
            reference_measure: self.reference_measure,
            stability: StabilityParameters {
                rule: self.stability_rule,
                window: self.window,
                min_lifetime: self.min_lifetime,
                altitude: self.altitude.unwrap_or(self.weight.weight().altitude()),
                min_volume_fraction: self.min_volume,
                max_volume_fraction: self.max_volume,
                min_diversity: self.min_diversity,
                min_stability: self.min_stability,
                ..StabilityParameters::default()
            },
            pool: PoolParameters { duplicate_overlap: self.duplicate_overlap },
            reliability: ReliabilityParameters {
                deformations: self.reliability,
                min_reliability: self.min_reliability,
                ..ReliabilityParameters::default()
            },
            descriptor: self.descriptor.into(),
            parts: self.parts.0.map(|count| PartParameters {
                count,
                min_volume_fraction: self.min_volume,
                ..PartParameters::default()
            }),
        };
        parameters.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(parameters)
    }

    /// How a shape is read.
    pub fn shape(&self, volume: &VolumeOptions, pose: ReadOptions) -> Result<ShapeOptions, CliError> {
        let pose = ReadOptions { limits: self.limits.reading(), ..pose };
        volume.shape(pose, self.voxels.volume_spacing()?, self.voxels.volume_origin()?)
    }

    /// Refuses options that the file has no use for.
    pub fn check(&self, file: &ShapeFile) -> Result<(), CliError> {
        if file.mesh().is_some() {
            return Ok(());
        }
        file.input(self.domain())?;
        match self.voxels.first_given() {
            Some(option) => {
                Err(CliError::Usage(format!("{option} needs a mesh; a volume is voxels already")))
            }
            None => Ok(()),
        }
    }

    /// The file of the weight, if it has one.
    pub fn field(&self) -> Result<Option<FieldFile>, CliError> {
        let limits = self.limits.reading();
        Ok(self.weight.file().map(|file| FieldFile::read(file, &limits)).transpose()?)
    }

    /// Refuses a weight that belongs to one shape.
    pub fn refuse_field(&self) -> Result<(), CliError> {
        match self.weight.file() {
            None => Ok(()),
            Some(path) => Err(CliError::Usage(format!(
                "--weight {}: a field belongs to one shape, and here are many; run mser3d detect for each",
                path.display()
            ))),
        }
    }

    pub fn cache(&self) -> Result<Option<SpectrumCache>, CliError> {
        Ok(self.cache.as_deref().map(SpectrumCache::open).transpose()?)
    }
}

/// The default time scales, which are relative.
fn relative_times() -> Vec<f64> {
    let relative = |scale| match scale {
        TimeScale::Relative(t) => Some(t),
        TimeScale::Absolute(_) => None,
    };
    Parameters::default().time_scales.into_iter().filter_map(relative).collect()
}
