//! Command-line options that become [`Parameters`].

use std::path::PathBuf;

use clap::ValueEnum;
use mser3d::comptree::{AltitudeScale, Mode, Polarity};
use mser3d::descriptors::{HksParameters, SiHksParameters, TimeScale};
use mser3d::shape::Domain;
use mser3d::spectral::{Eigensolver, Extent};
use mser3d::{Descriptor, Parameters, Weight};

use crate::error::CliError;
use crate::machine::available_memory;
use crate::voxel_options::VoxelOptions;

/// Options of everything that computes regions.
#[derive(clap::Args, Clone, Debug)]
pub struct RegionOptions {
    /// Search the surface instead of the volume inside
    #[arg(long, help_heading = "Method",
          conflicts_with_all = ["size", "origin", "connectivity", "inside", "overlap", "no_cut_links", "open",
                                "close"])]
    pub surface: bool,
    /// What the component tree is built on
    #[arg(long, value_enum, default_value_t = WeightArg::Heat, help_heading = "Method")]
    pub weight: WeightArg,
    /// Time scales, in units of volume^(2/3) (surface: area); one tree each, regions pooled
    #[arg(long, value_name = "T_REL,...", value_delimiter = ',', default_values_t = [0.25, 2.0],
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
    /// Which way the tree grows [default: the one that finds limbs]
    #[arg(long, value_enum, help_heading = "Method")]
    pub polarity: Option<PolarityArg>,

    #[command(flatten)]
    pub voxels: VoxelOptions,

    /// Smallest eigenpairs of the Laplacian [default: 100, or as many as a small shape has]
    #[arg(long, value_name = "K", value_parser = count, help_heading = "Spectrum")]
    pub eigenpairs: Option<usize>,
    /// All eigenpairs with lambda V^(2/3) below this (lambda A with --surface): the same scales on any shape
    #[arg(long, value_name = "X", conflicts_with = "eigenpairs", help_heading = "Spectrum")]
    pub lambda_max: Option<f64>,
    /// Largest relative residual of an eigenpair
    #[arg(long, value_name = "R", default_value = "1e-9", help_heading = "Spectrum")]
    pub tolerance: f64,
    /// How eigenpairs are found
    #[arg(long, value_enum, default_value_t = SolverArg::Auto, help_heading = "Spectrum")]
    pub solver: SolverArg,
    /// Refuse to start when the spectrum needs more memory, in MB [default: 80 % of what is free]
    #[arg(long, value_name = "MB", help_heading = "Spectrum")]
    pub memory_limit: Option<u64>,
    /// Keep spectra in this folder and take them from there; results are the same with and without
    #[arg(long, value_name = "DIR", help_heading = "Spectrum")]
    pub cache: Option<PathBuf>,

    /// How stable regions are chosen
    #[arg(long, value_enum, default_value_t = ModeArg::Windowed, help_heading = "Regions")]
    pub mode: ModeArg,
    /// Half width of the stability window, in units of (log) altitude
    #[arg(long, value_name = "D", value_parser = positive, default_value_t = 0.2, help_heading = "Regions")]
    pub window: f64,
    /// Scale on which altitude, and so stability, is measured
    #[arg(long, value_enum, default_value_t = AltitudeArg::Log, help_heading = "Regions")]
    pub altitude: AltitudeArg,
    /// Smallest region, as a fraction of the whole
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = 0.01, help_heading = "Regions")]
    pub min_volume: f64,
    /// Largest region, as a fraction of the whole
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = 0.75, help_heading = "Regions")]
    pub max_volume: f64,
    /// How much smaller than the next larger region a nested one must be, as a fraction
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = 0.2, help_heading = "Regions")]
    pub min_diversity: f64,
    /// Drop regions that are less stable [default: none]
    #[arg(long, value_name = "S", help_heading = "Regions")]
    pub min_stability: Option<f64>,
    /// Overlap from which regions of two time scales are one
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = 0.8, help_heading = "Regions")]
    pub duplicate_overlap: f64,
    /// Heat kernel signature that describes a region
    #[arg(long, value_enum, default_value_t = DescriptorArg::SizedSiHks, help_heading = "Regions")]
    pub descriptor: DescriptorArg,
}

macro_rules! choices {
    ($name:ident { $($(#[$doc:meta])* $variant:ident),* $(,)? }) => {
        #[derive(Clone, Copy, Debug, ValueEnum, PartialEq, Eq)]
        pub enum $name { $($(#[$doc])* $variant),* }
    };
}

choices!(WeightArg {
    /// The heat kernel H_t(v,v): heat that stays
    Heat,
    /// The commute time, which has no time scale
    Commute,
    /// 1/H_t(u,v) of neighbours: where heat passes badly
    Edge,
});
choices!(PolarityArg {
    /// Regions where the weight is low
    Sublevel,
    /// Regions where the weight is high
    Superlevel,
});
choices!(ConnectivityArg {
    /// Across faces
    #[value(name = "6")]
    Six,
    /// Across faces, edges and corners
    #[value(name = "26")]
    TwentySix,
});
choices!(MethodArg {
    /// What the mesh needs, as `mser3d inspect` says
    Auto,
    /// Crossings of rays along x, counted modulo 2: closed meshes only
    Parity,
    /// The same along x, y and z, and the majority
    Vote,
    /// The winding number: for open and overlapping meshes too
    Winding,
});
choices!(OverlapArg {
    /// A surface that overlaps itself is parted, different bodies are joined
    Auto,
    /// Voxels that are covered twice are left out
    Part,
    /// Voxels that are covered twice belong to the solid
    Join,
});
choices!(SolverArg {
    /// The faster one for the shape
    Auto,
    /// Block Lanczos on the inverse, by sparse factorization
    ShiftInvert,
    /// Block Lanczos on a polynomial, without a matrix: voxels only
    Filter,
});
choices!(ModeArg {
    /// Change over a window of altitude, on branches that end at real merges
    Windowed,
    /// As published: differences of neighbouring nodes
    Paper,
    /// Every node that is well larger than the last: what stability has to beat
    Baseline,
});
choices!(AltitudeArg {
    /// Logarithm of the weight: regions don't depend on the shape's size
    Log,
    /// The weight itself
    Linear,
});
choices!(DescriptorArg {
    /// SI-vHKS, and the region's share of the volume: neither changes with the shape's size
    SizedSiHks,
    /// SI-vHKS alone, as in the paper
    SiHks,
    /// vHKS
    Hks,
});

impl RegionOptions {
    pub fn domain(&self) -> Domain {
        if self.surface { Domain::Surface } else { Domain::Volume }
    }

    /// The library's parameters; values out of range are wrong use.
    pub fn parameters(&self) -> Result<Parameters, CliError> {
        let mut p = Parameters { voxelize: self.voxels.parameters()?, ..Parameters::default() };
        p.spectrum.eigenpairs = match (self.eigenpairs, self.lambda_max) {
            (Some(count), _) => Extent::Count(count),
            (None, Some(bound)) => Extent::Below(bound),
            (None, None) => p.spectrum.eigenpairs,
        };
        p.spectrum.tolerance = self.tolerance;
        p.spectrum.solver = match self.solver {
            SolverArg::Auto => Eigensolver::Auto,
            SolverArg::ShiftInvert => Eigensolver::ShiftInvert,
            SolverArg::Filter => Eigensolver::Filter,
        };
        p.spectrum.memory_limit = self
            .memory_limit
            .map(|mb| mb.saturating_mul(1_000_000))
            .or_else(|| available_memory().map(|m| m / 5 * 4));
        p.weight = match self.weight {
            WeightArg::Heat => Weight::Heat,
            WeightArg::Commute => Weight::CommuteTime,
            WeightArg::Edge => Weight::HeatEdge,
        };
        p.polarity = self.polarity.map(|polarity| match polarity {
            PolarityArg::Sublevel => Polarity::Sublevel,
            PolarityArg::Superlevel => Polarity::Superlevel,
        });
        p.time_scales = if self.absolute_time.is_empty() {
            self.time_scale.iter().copied().map(TimeScale::Relative).collect()
        } else {
            self.absolute_time.iter().copied().map(TimeScale::Absolute).collect()
        };
        p.reference_measure = self.reference_measure;
        p.stability.mode = match self.mode {
            ModeArg::Windowed => Mode::Windowed { window: self.window },
            ModeArg::Paper => Mode::Paper,
            ModeArg::Baseline => Mode::Baseline,
        };
        p.stability.scale = match self.altitude {
            AltitudeArg::Log => AltitudeScale::Log,
            AltitudeArg::Linear => AltitudeScale::Linear,
        };
        p.stability.min_volume_fraction = self.min_volume;
        p.stability.max_volume_fraction = self.max_volume;
        p.stability.min_diversity = self.min_diversity;
        p.stability.min_stability = self.min_stability;
        p.pool.duplicate_overlap = self.duplicate_overlap;
        p.descriptor = match self.descriptor {
            DescriptorArg::SizedSiHks => Descriptor::SizedSiHks(SiHksParameters::default()),
            DescriptorArg::SiHks => Descriptor::SiHks(SiHksParameters::default()),
            DescriptorArg::Hks => Descriptor::Hks(HksParameters::default()),
        };
        p.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(p)
    }
}

/// A whole number that is at least one.
pub fn count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) => Err("must be at least 1".into()),
        Ok(n) => Ok(n),
        Err(_) => Err("not a whole number of at least 1".into()),
    }
}

/// A number greater than zero.
pub fn positive(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number")?;
    (value.is_finite() && value > 0.0).then_some(value).ok_or("must be positive and finite".into())
}

fn fraction(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "not a number")?;
    (0.0..=1.0).contains(&value).then_some(value).ok_or("must be between 0 and 1".into())
}
