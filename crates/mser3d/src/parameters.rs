use mser3d_comptree::{Polarity, PoolParameters, StabilityParameters};
use mser3d_descriptors::{HksParameters, SiHksParameters, TimeScale};
use mser3d_spectral::SpectrumParameters;
use mser3d_voxelize::VoxelizeParameters;

use crate::Error;

/// What the component tree is built on, section 4.3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Weight {
    /// H_t(v,v) on voxels or vertices: high on protrusions, so its superlevel sets are searched.
    #[default]
    Heat,
    /// The commute-time weight (eq. 6) on voxels or vertices, without a time scale; superlevel sets.
    CommuteTime,
    /// 1/H_t(u,v) on links or edges: low where heat passes easily; sublevel sets.
    HeatEdge,
}

impl Weight {
    /// The polarity that finds protrusions and limbs.
    pub fn polarity(self) -> Polarity {
        match self {
            Self::Heat | Self::CommuteTime => Polarity::Superlevel,
            Self::HeatEdge => Polarity::Sublevel,
        }
    }

    /// Whether it depends on a time scale.
    pub fn has_time_scale(self) -> bool {
        self != Self::CommuteTime
    }
}

/// What describes a region, section 5.
#[derive(Clone, Debug, PartialEq)]
pub enum Descriptor {
    /// SI-vHKS in a volume, SI-HKS on a surface (eq. 9), and one number more for the region's size: see
    /// [`crate::describe`].
    SizedSiHks(SiHksParameters),
    /// SI-vHKS in a volume, SI-HKS on a surface (eq. 9), as published.
    SiHks(SiHksParameters),
    /// vHKS in a volume, HKS on a surface.
    Hks(HksParameters),
}

impl Default for Descriptor {
    fn default() -> Self {
        Self::SizedSiHks(SiHksParameters::default())
    }
}

/// Everything that [`crate::detect`] can be told; the defaults are the recommended settings.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameters {
    /// From the mesh to voxels (volumes only). Its connectivity is also the tree's.
    pub voxelize: VoxelizeParameters,
    /// The eigenpairs. Default: 100.
    pub spectrum: SpectrumParameters,
    /// What the tree is built on. Default: [`Weight::Heat`].
    pub weight: Weight,
    /// Which way the tree grows. Default: none, the weight's own [`Weight::polarity`].
    pub polarity: Option<Polarity>,
    /// One tree for each time scale. Default: 0.25 and 2, relative to the shape's size. They are far apart on
    /// purpose: a region changes gradually with time, so scales in between add near repetitions, and on
    /// each shape another one of them would be kept.
    pub time_scales: Vec<TimeScale>,
    /// The volume (or area) that relative time scales and descriptors refer to, in length^3 (or
    /// length^2). Give all poses of a body the measure of one of them. Default: none, each its own.
    pub reference_measure: Option<f64>,
    /// Which nodes of a tree are regions.
    pub stability: StabilityParameters,
    /// How the regions of several time scales become one set.
    pub pool: PoolParameters,
    /// What describes a region. Default: SI-vHKS and the region's size.
    pub descriptor: Descriptor,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            voxelize: VoxelizeParameters::default(),
            spectrum: SpectrumParameters::default(),
            weight: Weight::default(),
            polarity: None,
            time_scales: [0.25, 2.0].map(TimeScale::Relative).to_vec(),
            reference_measure: None,
            stability: StabilityParameters::default(),
            pool: PoolParameters::default(),
            descriptor: Descriptor::default(),
        }
    }
}

impl Parameters {
    /// Checks all parameters, those of the stages included.
    ///
    /// # Errors
    /// The first stage's error, or [`Error::BadParameter`].
    pub fn validate(&self) -> Result<(), Error> {
        self.voxelize.validate()?;
        self.spectrum.validate()?;
        self.stability.validate()?;
        self.pool.validate()?;
        match &self.descriptor {
            Descriptor::SizedSiHks(parameters) | Descriptor::SiHks(parameters) => parameters.validate()?,
            Descriptor::Hks(parameters) => parameters.validate()?,
        }
        let bad = |name, problem| Err(Error::BadParameter { name, problem });
        if self.weight.has_time_scale() && self.time_scales.is_empty() {
            return bad("time_scales", "is empty; give at least one time scale, such as 0.5");
        }
        if self.stability.min_volume_fraction > self.stability.max_volume_fraction {
            return bad(
                "min_volume_fraction",
                "must not be above max_volume_fraction: no region has such a size",
            );
        }
        for scale in &self.time_scales {
            scale.with_unit(1.0)?;
        }
        if self.reference_measure.is_some_and(|m| !(m.is_finite() && m > 0.0)) {
            return bad("reference_measure", "must be a positive volume or area");
        }
        Ok(())
    }
}
