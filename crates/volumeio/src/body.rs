//! Which voxels of a volume are the body: one rule for all formats.
use crate::{ChannelKind, LoadedVolume, ValueCounts, ValueKind, Volume};
use mser3d_shape::{BitGrid, ShapeError};
use std::convert::Infallible;
use std::fmt;
use std::str::FromStr;

/// Parameters of [`LoadedVolume::body`]: which voxels are the body. Nothing of it is needed for a mask.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BodyParameters {
    /// Which volume of a file that holds several (points in time, components, channels, layers), from 0.
    pub volume: Option<usize>,
    /// The voxels of this label; 0 is the background.
    pub label: Option<Label>,
    /// The voxels whose value is at least this.
    pub threshold: Option<f64>,
}

/// A label of a label map.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum Label {
    /// Its number.
    Value(i64),
    /// Its name, which the file or a table gives it.
    Name(String),
}

impl FromStr for Label {
    type Err = Infallible;

    /// A whole number is a value, anything else a name.
    fn from_str(text: &str) -> Result<Self, Infallible> {
        Ok(text.parse().map_or_else(|_| Self::Name(text.to_owned()), Self::Value))
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Value(value) => value.fmt(f),
            Self::Name(name) => name.fmt(f),
        }
    }
}

/// The body in a volume.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Body {
    /// Its voxels.
    pub mask: BitGrid,
    /// The channel of the volume that it was taken from.
    pub volume: usize,
    /// Its label, if it was chosen by one.
    pub label: Option<i64>,
    /// The label's name, if it has one.
    pub name: Option<String>,
    /// What the user should know.
    pub notes: Vec<String>,
}

impl BodyParameters {
    /// The voxels of a label.
    pub fn of_label(value: i64) -> Self {
        Self { label: Some(Label::Value(value)), ..Self::default() }
    }
}

/// A label, with its size.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct LabelCount {
    /// The label's number.
    pub value: i64,
    /// Its name, if the file or a table gives it one.
    pub name: Option<String>,
    /// The channel that holds it.
    pub volume: usize,
    /// Its voxels.
    pub voxels: u64,
}

/// Why a volume does not say what its body is, and what to do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyError {
    /// The file holds several volumes.
    #[error("the file holds {count} {what}; choose one with --volume N, from 0 to {}", count - 1)]
    SeveralVolumes {
        /// How many.
        count: usize,
        /// What they are.
        what: &'static str,
    },
    /// The file holds a segmentation of several layers.
    #[error(
        "a segmentation of {count} layers with {names}; choose a segment with --label NAME, all with --label all, or a layer \
         with --volume N, from 0 to {}",
        count - 1
    )]
    SeveralSegments {
        /// How many layers.
        count: usize,
        /// The names of the segments.
        names: String,
    },
    /// There is no volume of this number.
    #[error("there is no volume {volume}: the file holds {count}, from 0 on")]
    NoVolume {
        /// The number asked for.
        volume: usize,
        /// How many there are.
        count: usize,
    },
    /// The volume holds several labels.
    #[error("several labels: {counts}; choose one with --label N, or all with --label all")]
    SeveralLabels {
        /// What was found.
        counts: String,
    },
    /// There is no such label.
    #[error("there is no label {label}; there are {counts}")]
    NoLabel {
        /// The label asked for.
        label: Label,
        /// What was found.
        counts: String,
    },
    /// Several layers have a label of this number.
    #[error("label {label} is in several layers; choose one with --volume N, or by its name")]
    SeveralLayers {
        /// The label asked for.
        label: Label,
    },
    /// The volume holds grey values.
    #[error(
        "grey values: {counts}; say from which value on the body begins with --threshold T, or \
             choose one value with --label N"
    )]
    Grey {
        /// What was found.
        counts: String,
    },
    /// There are no labels in grey values.
    #[error("grey values and no labels: {counts}; --label needs whole numbers that fill parts")]
    NotLabels {
        /// What was found.
        counts: String,
    },
    /// No voxel is inside.
    #[error("{reason}: there is no solid")]
    Empty {
        /// Why not.
        reason: String,
    },
    /// Two ways to choose at once.
    #[error("--label and --threshold are two ways to choose the body; give one")]
    TwoChoices,
    /// The mask cannot be made.
    #[error(transparent)]
    Shape(#[from] ShapeError),
}

/// From this part of the box's outer voxels on, an inside that reaches there is suspect.
const MOST_OF_BORDER: f64 = 0.5;

impl LoadedVolume {
    /// The body: the voxels of a mask that are not 0, of a label, or from a threshold on. NaN is outside.
    ///
    /// A volume of 0 and one other value is a mask. Nothing else is guessed: several labels, grey values and several
    /// volumes are errors that say what there is to choose from.
    ///
    /// # Errors
    /// [`BodyError`].
    pub fn body(&self, parameters: &BodyParameters) -> Result<Body, BodyError> {
        if parameters.label.is_some() && parameters.threshold.is_some() {
            return Err(BodyError::TwoChoices);
        }
        let mut notes = Vec::new();
        let labelled = match &parameters.label {
            Some(label) => Some(self.find_label(label, parameters.volume)?),
            None => None,
        };
        let volume = match &labelled {
            Some(found) => found.volume,
            None => self.chosen_volume(parameters.volume, &mut notes)?,
        };
        let counts = || ValueCounts::of(&self.volume, volume);
        let mask = match (&labelled, parameters.threshold) {
            (Some(LabelCount { value, .. }), _) => {
                let value = *value as f64;
                self.voxels_where(volume, |x| x == value)?
            }
            (None, Some(threshold)) => {
                let mask = self.voxels_where(volume, |x| x >= threshold)?;
                if mask.count_ones() == 0 {
                    let reason = format!("no value is {threshold} or more ({})", counts());
                    return Err(BodyError::Empty { reason });
                }
                mask
            }
            (None, None) => {
                let counts = counts();
                match counts.kind {
                    ValueKind::Empty if counts.nan > 0 => {
                        let reason = "the volume is zero or NaN everywhere".to_owned();
                        return Err(BodyError::Empty { reason });
                    }
                    ValueKind::Empty => {
                        let reason = "the mask is zero everywhere".to_owned();
                        return Err(BodyError::Empty { reason });
                    }
                    ValueKind::Labels => {
                        return Err(BodyError::SeveralLabels { counts: self.named(volume, &counts) });
                    }
                    ValueKind::Grey => return Err(BodyError::Grey { counts: counts.to_string() }),
                    ValueKind::Mask => {}
                }
                if counts.nan > 0 {
                    notes.push(format!("{} voxels are NaN and were read as outside", counts.nan));
                }
                self.voxels_where(volume, |x| x != 0.0 && !x.is_nan())?
            }
        };
        let border = border_share(&mask);
        if border > MOST_OF_BORDER {
            notes.push(format!(
                "{:.0} % of the volume's border is inside, so the background may be taken for the body (an inverted \
                 look-up table); --label 0 takes the other voxels",
                100.0 * border
            ));
        }
        let (label, name) = labelled.map(|l| (l.value, l.name)).unzip();
        Ok(Body { mask, volume, label, name: name.flatten(), notes })
    }

    /// The grey values or colours: one of several volumes, if there are several.
    ///
    /// # Errors
    /// [`BodyError::SeveralVolumes`], [`BodyError::NoVolume`].
    pub fn grey(self, volume: Option<usize>) -> Result<Volume, BodyError> {
        if volume.is_none() && self.channels == ChannelKind::Colours {
            return Ok(self.volume);
        }
        let chosen = self.chosen_volume(volume, &mut Vec::new())?;
        Ok(self.volume.channel(chosen))
    }

    /// All labels but 0, by volume and number.
    ///
    /// # Errors
    /// [`BodyError::NotLabels`] for grey values, [`BodyError::SeveralVolumes`], [`BodyError::NoVolume`].
    pub fn labels(&self, volume: Option<usize>) -> Result<Vec<LabelCount>, BodyError> {
        let mut labels = Vec::new();
        for channel in self.label_volumes(volume)? {
            let counts = ValueCounts::of(&self.volume, channel);
            if counts.kind == ValueKind::Grey {
                return Err(BodyError::NotLabels { counts: counts.to_string() });
            }
            labels.extend(counts.values.iter().filter(|v| v.0 != 0.0).map(|&(value, voxels)| LabelCount {
                value: value as i64,
                name: self.name_of(value as i64, channel).map(str::to_owned),
                volume: channel,
                voxels,
            }));
        }
        Ok(labels)
    }

    /// The name that the file gives a label.
    pub fn name_of(&self, value: i64, volume: usize) -> Option<&str> {
        let segment = self.segments.iter().find(|s| s.value == value && s.layer == volume);
        segment.map(|s| s.name.as_str())
    }

    /// The channels in which labels are looked for: the one chosen, or all layers of a segmentation.
    fn label_volumes(&self, volume: Option<usize>) -> Result<std::ops::Range<usize>, BodyError> {
        if volume.is_none() && self.channels == ChannelKind::Layers {
            return Ok(0..self.volume.channels());
        }
        let chosen = self.chosen_volume(volume, &mut Vec::new())?;
        Ok(chosen..chosen + 1)
    }

    fn find_label(&self, label: &Label, volume: Option<usize>) -> Result<LabelCount, BodyError> {
        let volumes = self.label_volumes(volume)?;
        let count = |value: i64, channel: usize, voxels: u64| LabelCount {
            value,
            name: self.name_of(value, channel).map(str::to_owned),
            volume: channel,
            voxels,
        };
        let mut found = Vec::new();
        let mut there = Vec::new();
        for channel in volumes {
            let counts = ValueCounts::of(&self.volume, channel);
            for &(value, voxels) in &counts.values {
                let here = count(value as i64, channel, voxels);
                let is_it = match label {
                    Label::Value(wanted) => value == *wanted as f64,
                    Label::Name(wanted) => here.name.as_ref() == Some(wanted),
                };
                if is_it {
                    found.push(here);
                }
            }
            there.push(self.named(channel, &counts));
        }
        match (found.pop(), found.is_empty()) {
            (Some(found), true) => Ok(found),
            (Some(_), false) => Err(BodyError::SeveralLayers { label: label.clone() }),
            (None, _) => Err(BodyError::NoLabel { label: label.clone(), counts: there.join("; ") }),
        }
    }

    /// The channel that is meant.
    fn chosen_volume(&self, volume: Option<usize>, notes: &mut Vec<String>) -> Result<usize, BodyError> {
        let count = self.volume.channels();
        match volume {
            Some(volume) if volume < count => return Ok(volume),
            Some(volume) => return Err(BodyError::NoVolume { volume, count }),
            None if count == 1 => return Ok(0),
            None => {}
        }
        if self.channels == ChannelKind::Colours && self.are_channels_alike() {
            notes.push(format!("all {count} colours are the same grey and were read as one"));
            return Ok(0);
        }
        if self.channels == ChannelKind::Layers {
            let names: Vec<&str> = self.segments.iter().map(|segment| segment.name.as_str()).collect();
            let names = if names.is_empty() { "unnamed segments".to_owned() } else { names.join(", ") };
            return Err(BodyError::SeveralSegments { count, names });
        }
        let what = if self.channels == ChannelKind::Colours { "colours a voxel" } else { "volumes" };
        Err(BodyError::SeveralVolumes { count, what })
    }

    fn are_channels_alike(&self) -> bool {
        let (samples, channels) = (self.volume.samples(), self.volume.channels());
        (0..samples.len()).all(|i| samples.value(i) == samples.value(i - i % channels))
    }

    fn voxels_where(&self, channel: usize, inside: impl Fn(f64) -> bool) -> Result<BitGrid, ShapeError> {
        let (dims, channels) = (self.volume.dims(), self.volume.channels());
        let mut mask = BitGrid::empty(dims)?;
        let samples = self.volume.samples();
        let mut at = channel;
        for k in 0..dims[2] as u32 {
            for j in 0..dims[1] as u32 {
                for i in 0..dims[0] as u32 {
                    if inside(samples.value(at)) {
                        mask.set([i, j, k], true);
                    }
                    at += channels;
                }
            }
        }
        Ok(mask)
    }

    /// The values with counts, and with names where there are any.
    fn named(&self, volume: usize, counts: &ValueCounts) -> String {
        let text = counts.to_string();
        let named: Vec<String> = counts
            .values
            .iter()
            .filter_map(|v| Some(format!("{} is {}", v.0, self.name_of(v.0 as i64, volume)?)))
            .collect();
        if named.is_empty() { text } else { format!("{text} ({})", named.join(", ")) }
    }
}

/// The part of the outer voxels of the box that are inside; 0 for an image, which is all border, and without a background.
fn border_share(mask: &BitGrid) -> f64 {
    let dims = mask.dims();
    // A volume that is all body has no background.
    if dims.iter().any(|&d| d < 3) || mask.count_ones() == dims.iter().product::<usize>() {
        return 0.0;
    }
    let outer = |v: &[u32; 3]| (0..3).any(|a| v[a] == 0 || v[a] as usize + 1 == dims[a]);
    let inner: usize = dims.iter().map(|d| d - 2).product();
    mask.ones().filter(outer).count() as f64 / (dims.iter().product::<usize>() - inner) as f64
}

#[cfg(test)]
mod tests;
