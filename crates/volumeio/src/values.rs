//! Which values a volume holds, and what that makes of it.
use crate::Volume;
use std::collections::HashMap;
use std::fmt;

/// The values of one channel of a volume, with counts.
///
/// ```
/// use mser3d_volumeio::{Affine, ValueCounts, ValueKind, Volume};
/// let volume = Volume::new([5, 1, 1], 1, Affine::default(), vec![0u8, 2, 2, 7, 0])?;
/// let counts = ValueCounts::of(&volume, 0);
/// assert_eq!(counts.values, [(0.0, 2), (2.0, 2), (7.0, 1)]);
/// assert_eq!(counts.to_string(), "0 (2 voxels), 2 (2 voxels), 7 (1 voxels)");
/// assert_eq!(counts.kind, ValueKind::Labels);
/// # Ok::<(), mser3d_volumeio::VolumeIoError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct ValueCounts {
    /// Each value and its voxels, ascending; of more than [`ValueCounts::LIMIT`] values, the ones that came first.
    pub values: Vec<(f64, u64)>,
    /// Whether there are more values than are listed.
    pub more: bool,
    /// Voxels that are NaN.
    pub nan: u64,
    /// The smallest and the largest value; none where all are NaN.
    pub range: Option<[f64; 2]>,
    /// What that makes of the volume.
    pub kind: ValueKind,
}

mser3d_shape::choice! {
    /// What the values of a volume are, as far as they tell.
    pub enum ValueKind("kind of values") {
        /// Nothing but zeros and NaN: there is no body
        #[default]
        Empty = "empty",
        /// Zero and one other value, or one value alone
        Mask = "mask",
        /// Whole numbers that fill parts: a label map
        Labels = "labels",
        /// Anything else: grey values
        Grey = "grey",
    }
}

impl ValueCounts {
    /// More different values than this are not counted one by one.
    pub const LIMIT: usize = 1 << 16;

    /// Of whole numbers other than the commonest, this part has a neighbour along x of its own value in a label map. In
    /// grey values, which are noisy, few have.
    const ALIKE: f64 = 0.8;

    /// So few whole numbers are labels, however they lie.
    const FEW: usize = 4;

    /// Counts the values of a channel. Time: one pass, O(1) for each run of equal values.
    pub fn of(volume: &Volume, channel: usize) -> Self {
        let (samples, channels, width) = (volume.samples(), volume.channels(), volume.dims()[0]);
        let mut counts: HashMap<u64, Tally> = HashMap::new();
        let (mut nan, mut more, mut whole) = (0, false, true);
        let mut range: Option<[f64; 2]> = None;
        let voxels: usize = volume.dims().iter().product();
        let mut add = |value: f64, run: u64| {
            if value.is_nan() {
                nan += run;
                return;
            }
            whole &= value.fract() == 0.0 && value.abs() <= 2f64.powi(53);
            range = Some(range.map_or([value; 2], |[low, high]| [low.min(value), high.max(value)]));
            // -0 is 0.
            let key = (value + 0.0).to_bits();
            if counts.len() >= Self::LIMIT && !counts.contains_key(&key) {
                more = true;
                return;
            }
            let tally = counts.entry(key).or_default();
            tally.voxels += run;
            tally.alike += if run > 1 { run } else { 0 };
        };
        for row in 0..voxels / width.max(1) {
            let (mut last, mut run) = (f64::NAN, 0);
            for i in 0..width {
                let value = samples.value((row * width + i) * channels + channel);
                if run > 0 && value == last {
                    run += 1;
                    continue;
                }
                if run > 0 {
                    add(last, run);
                }
                (last, run) = (value, 1);
            }
            add(last, run);
        }
        let commonest = counts.values().map(|t| t.voxels).max().unwrap_or(0);
        let others = counts.values().filter(|t| t.voxels < commonest);
        let (voxels, alike) = others.fold((0, 0), |(v, a), t| (v + t.voxels, a + t.alike));
        let filled = voxels == 0 || alike as f64 >= Self::ALIKE * voxels as f64;
        let mut values: Vec<(f64, u64)> =
            counts.into_iter().map(|(bits, t)| (f64::from_bits(bits), t.voxels)).collect();
        values.sort_by(|a, b| a.0.total_cmp(&b.0));
        let kind = match (values.iter().filter(|v| v.0 != 0.0).count(), values.len()) {
            (0, _) => ValueKind::Empty,
            (1, _) => ValueKind::Mask,
            // Labels are counted from 0; a CT begins at -1024.
            _ if whole && !more && values[0].0 >= 0.0 && (filled || values.len() <= Self::FEW) => {
                ValueKind::Labels
            }
            _ => ValueKind::Grey,
        };
        Self { values, more, nan, range, kind }
    }

    /// The voxels of a value.
    pub fn voxels_of(&self, value: f64) -> u64 {
        self.values.iter().find(|v| v.0 == value).map_or(0, |v| v.1)
    }
}

/// How often a value comes.
#[derive(Default)]
struct Tally {
    voxels: u64,
    /// Those with a neighbour along x of the same value.
    alike: u64,
}

impl fmt::Display for ValueCounts {
    /// `0 (2392 voxels), 1 (5 voxels)`, or the range of many values.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 8;
        let several = self.more || self.values.len() > SHOWN;
        if let (ValueKind::Grey, true, Some([low, high])) = (self.kind, several, self.range) {
            let more = if self.more { "more than " } else { "" };
            write!(f, "{more}{} different values from {low} to {high}", self.values.len())?;
        } else {
            for (number, (value, voxels)) in self.values.iter().take(SHOWN).enumerate() {
                write!(f, "{}{value} ({voxels} voxels)", if number > 0 { ", " } else { "" })?;
            }
            if self.values.len() > SHOWN {
                write!(f, " and {} more", self.values.len() - SHOWN)?;
            }
        }
        if self.nan > 0 {
            write!(f, "{}NaN ({} voxels)", if self.values.is_empty() { "" } else { ", " }, self.nan)?;
        }
        Ok(())
    }
}
