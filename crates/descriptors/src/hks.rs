//! The heat kernel signature (section 5; Sun et al. 2009, Raviv et al. 2010).
use crate::heat::at_times;
use crate::{DescriptorError, Descriptors, TimeScale, spectral_sums, vertex_subset::VertexSubset};
use mser3d_shape::EigenbasisView;

/// Parameters of [`hks`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HksParameters {
    /// The time samples, one a column. Default: six from 0.25 to 1 of the shape's unit of time, evenly
    /// spaced in log t. (The paper's 1024 to 4096 are 0.23 to 0.92 on its own shapes.)
    pub times: Vec<TimeScale>,
}

impl Default for HksParameters {
    fn default() -> Self {
        Self { times: (0..6).map(|i| TimeScale::Relative(0.25 * 4f64.powf(f64::from(i) / 5.0))).collect() }
    }
}

impl HksParameters {
    /// Whether there is a time sample and all of them are positive.
    ///
    /// # Errors
    /// [`DescriptorError::InvalidParameter`].
    pub fn validate(&self) -> Result<(), DescriptorError> {
        if self.times.is_empty() {
            return Err(DescriptorError::parameter("the number of time samples", 0, "at least 1"));
        }
        self.times.iter().try_for_each(|t| t.with_unit(1.0).map(|_| ()))
    }
}

/// The (volumetric) heat kernel signature: H_t(v,v) at q times t, a row for each vertex
/// (Sun et al. 2009 on surfaces, Raviv et al. 2010 in volumes).
///
/// `vertices` lists the vertices to compute, one a row; `None` means all. Values in length^-3 in a volume,
/// length^-2 on a surface: unlike those of [`si_hks`](crate::si_hks) they depend on the shape's scale.
///
/// # Errors
/// [`DescriptorError::InvalidParameter`], [`DescriptorError::EmptyBasis`], [`DescriptorError::IndexOutOfRange`].
pub fn hks<'a>(
    basis: impl Into<EigenbasisView<'a>>,
    params: &HksParameters,
    vertices: Option<&[u32]>,
) -> Result<Descriptors, DescriptorError> {
    let basis = basis.into();
    params.validate()?;
    spectral_sums::check(basis)?;
    let subset = VertexSubset::new(basis.len(), vertices)?;
    let times: Vec<f64> = params.times.iter().map(|t| t.on(basis)).collect::<Result<_, _>>()?;
    Descriptors::new(times.len(), at_times(basis, &times, subset)?)
}
