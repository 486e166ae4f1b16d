use mser3d_comptree::{Polarity, PoolParameters, StabilityParameters};
use mser3d_descriptors::{HksParameters, SiHksParameters, TimeScale};
use mser3d_shape::InvalidParameter;
use mser3d_spectral::SpectrumParameters;
use mser3d_voxelize::VoxelizeParameters;

use crate::{Bodies, Error, Field, PartParameters, ReliabilityParameters, Weight};

mser3d_shape::choice! {
    /// The kinds of [`Descriptor`].
    pub enum DescriptorKind("descriptor") {
        /// SI-vHKS, the region's share of the volume, and on which side of the body it is
        #[default]
        SidedSiHks = "sided-si-hks",
        /// The same without the side: the same for left and right
        SizedSiHks = "sized-si-hks",
        /// SI-vHKS alone, as in the paper
        SiHks = "si-hks",
        /// vHKS
        Hks = "hks",
    }
}

/// What describes a region, section 5.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Descriptor {
    /// SI-vHKS in a volume, SI-HKS on a surface (eq. 9), a number more for the region's size, and what tells left from right:
    /// see [`crate::describe`].
    SidedSiHks(SiHksParameters),
    /// SI-vHKS in a volume, SI-HKS on a surface (eq. 9), and one number more for the region's size: see
    /// [`crate::describe`].
    SizedSiHks(SiHksParameters),
    /// SI-vHKS in a volume, SI-HKS on a surface (eq. 9), as published.
    SiHks(SiHksParameters),
    /// vHKS in a volume, HKS on a surface.
    Hks(HksParameters),
}

impl Descriptor {
    /// Which kind it is, without its parameters.
    pub fn kind(&self) -> DescriptorKind {
        match self {
            Self::SidedSiHks(_) => DescriptorKind::SidedSiHks,
            Self::SizedSiHks(_) => DescriptorKind::SizedSiHks,
            Self::SiHks(_) => DescriptorKind::SiHks,
            Self::Hks(_) => DescriptorKind::Hks,
        }
    }

    /// The first of the numbers that change their sign in a mirror image; all after it do. None where none does.
    pub fn first_mirrored(&self) -> Option<usize> {
        match self {
            Self::SidedSiHks(own) => Some(own.frequencies + 2),
            Self::SizedSiHks(_) | Self::SiHks(_) | Self::Hks(_) => None,
        }
    }
}

impl From<DescriptorKind> for Descriptor {
    /// The descriptor with its default parameters.
    fn from(kind: DescriptorKind) -> Self {
        match kind {
            DescriptorKind::SidedSiHks => Self::SidedSiHks(SiHksParameters::default()),
            DescriptorKind::SizedSiHks => Self::SizedSiHks(SiHksParameters::default()),
            DescriptorKind::SiHks => Self::SiHks(SiHksParameters::default()),
            DescriptorKind::Hks => Self::Hks(HksParameters::default()),
        }
    }
}

impl Default for Descriptor {
    fn default() -> Self {
        DescriptorKind::default().into()
    }
}

/// The parameters of all stages of [`Detector::detect`](crate::Detector::detect); the defaults are the recommended
/// settings.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Parameters {
    /// What to do with a shape of several bodies. Default: the largest is searched.
    pub bodies: Bodies,
    /// From the mesh to voxels (volumes only). Its connectivity is also the tree's.
    pub voxelize: VoxelizeParameters,
    /// The eigenpairs. Default: 100, or as many as a small shape has, with a tolerance of 1e-4. More exact ones, as are the
    /// default of [`SpectrumParameters`], give the same regions: `cargo xtask tolerance`.
    pub spectrum: SpectrumParameters,
    /// What the tree is built on. Default: [`Weight::Heat`].
    pub weight: Weight,
    /// How long heat smooths the weight before the tree is built; only weights of elements, not those of links (edge, diffusion).
    /// Vectors are smoothed number by number. See [`mser3d_laplace::Operator::heat_flow`] for how exact it is; a
    /// time of T blurs over a length of about 2 sqrt(T). Default: none.
    pub smooth_weight: Option<TimeScale>,
    /// Which way the tree grows. Default: none, the weight's own [`Weight::polarity`]; of a field of vectors sublevel.
    pub polarity: Option<Polarity>,
    /// One tree for each time scale. Default: 0.25, 0.5, 1 and 2, relative to the shape's size. A part that one of them
    /// misses in some pose is mostly there in the next, and what several of them have is pooled. More scales, or scales
    /// farther apart, find no more that repeats: `cargo xtask selection`.
    pub time_scales: Vec<TimeScale>,
    /// The volume (or area) that relative time scales and descriptors refer to, in length^3 (or
    /// length^2). Give all poses of a body the measure of one of them. Default: none, each its own.
    pub reference_measure: Option<f64>,
    /// Which nodes of a tree are regions. Its scale of altitudes has to suit the weight: [`Parameters::of_weight`]. Where it is
    /// linear, all altitudes of stability (the window, the least stability, lifetimes) are in units of the weight's spread
    /// over the body, so that they don't depend on the unit of the weight: its root mean square, or of a field of values,
    /// whose zero says nothing, its standard deviation. So what is nearly the same everywhere, as the curvature of a ball, has no
    /// altitudes to speak of.
    pub stability: StabilityParameters,
    /// How the regions of several time scales become one set.
    pub pool: PoolParameters,
    /// How surely regions are found again.
    pub reliability: ReliabilityParameters,
    /// What describes a region. Default: SI-vHKS, the region's size and its side.
    pub descriptor: Descriptor,
    /// How bodies are divided into parts ([`partition`](crate::partition())). Default: into limbs and trunk; none: not at all.
    pub parts: Option<PartParameters>,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            bodies: Bodies::default(),
            voxelize: VoxelizeParameters::default(),
            spectrum: SpectrumParameters { tolerance: 1e-4, ..SpectrumParameters::default() },
            weight: Weight::default(),
            smooth_weight: None,
            polarity: None,
            time_scales: [0.25, 0.5, 1.0, 2.0].map(TimeScale::Relative).to_vec(),
            reference_measure: None,
            stability: StabilityParameters::default(),
            pool: PoolParameters::default(),
            reliability: ReliabilityParameters::default(),
            descriptor: Descriptor::default(),
            parts: Some(PartParameters::default()),
        }
    }
}

impl Parameters {
    /// The defaults for a weight, with [the scale of altitudes](Weight::altitude) that suits it.
    pub fn of_weight(weight: Weight) -> Self {
        let mut parameters = Self { weight, ..Self::default() };
        parameters.stability.altitude = weight.altitude();
        parameters
    }

    /// Checks all parameters, those of the stages included.
    ///
    /// # Errors
    /// The first stage's error, or [`Error::InvalidParameter`].
    pub fn validate(&self) -> Result<(), Error> {
        self.voxelize.validate()?;
        InvalidParameter::unless(
            self.voxelize.largest_only,
            "voxelize.largest_only",
            false,
            "true here; to search other components too, choose bodies: all or join",
        )?;
        self.spectrum.validate()?;
        self.stability.validate()?;
        self.pool.validate()?;
        self.reliability.validate()?;
        match &self.descriptor {
            Descriptor::SidedSiHks(parameters)
            | Descriptor::SizedSiHks(parameters)
            | Descriptor::SiHks(parameters) => parameters.validate()?,
            Descriptor::Hks(parameters) => parameters.validate()?,
        }
        if let Some(parts) = &self.parts {
            parts.validate()?;
        }
        for scale in &self.time_scales {
            scale.with_unit(1.0)?;
        }
        InvalidParameter::unless(
            !self.weight.has_time_scale() || !self.time_scales.is_empty(),
            "time_scales",
            "empty",
            "one time scale at least, such as 0.5",
        )?;
        if let Some(scale) = self.smooth_weight {
            scale.with_unit(1.0)?;
            InvalidParameter::unless(
                self.weight.is_of_elements(),
                "smooth_weight",
                scale,
                format!(
                    "none with the weight {}, which is one of links; a longer time scale smooths it",
                    self.weight
                ),
            )?;
        }
        let least = self.reliability.min_reliability;
        InvalidParameter::unless(
            self.weight != Weight::Field || least.is_none(),
            "min_reliability",
            least.unwrap_or_default(),
            "none with a field of values as the weight, of which no deformed copy is known",
        )?;
        let measure = self.reference_measure.unwrap_or(1.0);
        let good = measure.is_finite() && measure > 0.0;
        InvalidParameter::unless(good, "reference_measure", measure, "a positive volume or area")?;
        Ok(())
    }

    /// The same without limits that only refuse work: all that a result depends on.
    pub fn without_limits(&self) -> Self {
        let mut parameters = self.clone();
        parameters.spectrum.memory_limit = None;
        parameters.voxelize.max_box_voxels = VoxelizeParameters::default().max_box_voxels;
        parameters
    }

    /// Which way the tree grows: as given, or as the weight asks.
    pub fn polarity(&self) -> Polarity {
        self.polarity.unwrap_or(self.weight.polarity())
    }

    /// The same, where the weight may be a field.
    pub(crate) fn polarity_with(&self, field: Option<&Field>) -> Polarity {
        match (self.polarity, field) {
            (None, Some(field)) if field.has_vectors() => Polarity::Sublevel,
            _ => self.polarity(),
        }
    }
}
