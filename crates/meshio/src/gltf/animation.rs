//! Keyframe animations, evaluated at a time.

use super::accessor::{Asset, Rows, get};
use super::pose::Pose;
use super::transform::{slerp, unit};
use crate::MeshIoError;
use crate::error::Fault;
use gltf::json;
use json::accessor::Type;
use json::animation::{Interpolation, Property};
use json::validation::Checked;
use mser3d_shape::InvalidParameter;
use std::fmt;

/// An animation that a glTF file offers.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct AnimationInfo {
    /// Its number in the file, from 0.
    pub index: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Time of the first key, in seconds.
    pub start: f64,
    /// Time of the last key, in seconds.
    pub end: f64,
}

/// More frames than any sensible batch has.
const MAX_FRAMES: f64 = 1e6;

impl AnimationInfo {
    /// Times from start to end, both included, at most `1 / frames_per_second` seconds apart. A
    /// file read at each of them gives all frames.
    ///
    /// # Errors
    /// [`MeshIoError::InvalidParameter`] for a rate that is not positive or makes over a million frames.
    pub fn frame_times(&self, frames_per_second: f64) -> Result<Vec<f64>, MeshIoError> {
        let duration = self.end - self.start;
        // A whole number of frames may come out a rounding error too long.
        let steps = (duration * frames_per_second - 1e-6).ceil().max(0.0);
        if !(frames_per_second > 0.0 && steps <= MAX_FRAMES) {
            let expected = format!("positive and make at most {MAX_FRAMES} frames");
            return Err(InvalidParameter::new("frames per second", frames_per_second, expected).into());
        }
        let time = |i: u64| if i == 0 { self.start } else { self.start + duration * (i as f64 / steps) };
        Ok((0..=steps as u64).map(time).collect())
    }
}

impl fmt::Display for AnimationInfo {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", self.index)?;
        if let Some(name) = &self.name {
            write!(f, " {name:?}")?;
        }
        write!(f, " ({:.2} s)", self.end)
    }
}

/// All animations of a file.
pub(super) fn list(asset: &Asset) -> Result<Vec<AnimationInfo>, Fault> {
    let describe = |(index, animation): (usize, &json::Animation)| {
        let (mut start, mut end) = (f64::INFINITY, f64::NEG_INFINITY);
        for sampler in &animation.samplers {
            let times = key_times(asset, sampler)?;
            start = start.min(times[0]);
            end = end.max(times[times.len() - 1]);
        }
        let (start, end) = if start <= end { (start, end) } else { (0.0, 0.0) };
        Ok(AnimationInfo { index, name: animation.name.clone(), start, end })
    };
    asset.root.animations.iter().enumerate().map(describe).collect()
}

/// Poses a figure by an animation at a time.
pub(super) fn apply(asset: &Asset, animation: usize, time: f64, pose: &mut Pose) -> Result<(), Fault> {
    let animation = get(&asset.root.animations, animation, "animation")?;
    for channel in &animation.channels {
        let sampler = get(&animation.samplers, channel.sampler.value(), "animation sampler")?;
        let node = channel.target.node.value();
        get(&asset.root.nodes, node, "node")?;
        let Checked::Valid(property) = channel.target.path else { continue };
        let (kind, width) = match property {
            Property::Translation | Property::Scale => (Type::Vec3, Some(3)),
            Property::Rotation => (Type::Vec4, Some(4)),
            Property::MorphTargetWeights => (Type::Scalar, None),
        };
        let curve = Curve::new(asset, sampler, kind, width)?;
        let value = curve.at(time, property == Property::Rotation);
        let local = &mut pose.locals[node];
        match property {
            Property::Translation => local.translation = [value[0], value[1], value[2]],
            Property::Scale => local.scale = [value[0], value[1], value[2]],
            Property::Rotation => local.rotation = [value[0], value[1], value[2], value[3]],
            Property::MorphTargetWeights => local.morph_weights = Some(value),
        }
        if property != Property::MorphTargetWeights {
            local.matrix = None;
        }
    }
    Ok(())
}

fn key_times(asset: &Asset, sampler: &json::animation::Sampler) -> Result<Vec<f64>, Fault> {
    let times = asset.rows(sampler.input, Type::Scalar)?.values;
    if times.is_empty() || !times.is_sorted() {
        let accessor = sampler.input.value();
        return Err(Fault::new(format!("accessor {accessor}: the times of an animation's keys must ascend")));
    }
    Ok(times)
}

/// A value that changes with time.
struct Curve {
    times: Vec<f64>,
    keys: Rows,
    width: usize,
    interpolation: Interpolation,
}

impl Curve {
    fn new(
        asset: &Asset,
        sampler: &json::animation::Sampler,
        kind: Type,
        width: Option<usize>,
    ) -> Result<Self, Fault> {
        let times = key_times(asset, sampler)?;
        let keys = asset.rows(sampler.output, kind)?;
        let Checked::Valid(interpolation) = sampler.interpolation else {
            return Err(Fault::new("an animation's interpolation is none of LINEAR, STEP and CUBICSPLINE"));
        };
        let rows_per_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let width = width.unwrap_or(keys.len() / (times.len() * rows_per_key));
        if keys.values.len() != times.len() * rows_per_key * width {
            return Err(Fault::new(format!(
                "accessor {}: {} values for {} keys of an animation",
                sampler.output.value(),
                keys.values.len(),
                times.len()
            )));
        }
        Ok(Self { times, keys, width, interpolation })
    }

    /// Row `part` of a key: a spline's keys are in-tangent, value, out-tangent.
    fn row(&self, key: usize, part: usize) -> &[f64] {
        let parts = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        &self.keys.values[(key * parts + part) * self.width..][..self.width]
    }

    fn at(&self, time: f64, rotation: bool) -> Vec<f64> {
        let value = usize::from(self.interpolation == Interpolation::CubicSpline);
        let after = self.times.partition_point(|&t| t <= time);
        if after == 0 || after == self.times.len() {
            return self.row(after.saturating_sub(1), value).to_vec();
        }
        let (before, span) = (after - 1, self.times[after] - self.times[after - 1]);
        let u = (time - self.times[before]) / span;
        let (a, b) = (self.row(before, value), self.row(after, value));
        match self.interpolation {
            Interpolation::Step => a.to_vec(),
            Interpolation::Linear if rotation => {
                slerp([a[0], a[1], a[2], a[3]], [b[0], b[1], b[2], b[3]], u).to_vec()
            }
            Interpolation::Linear => a.iter().zip(b).map(|(a, b)| a + u * (b - a)).collect(),
            Interpolation::CubicSpline => {
                let (leave, arrive) = (self.row(before, 2), self.row(after, 0));
                let (u2, u3) = (u * u, u * u * u);
                let hermite = |i: usize| {
                    (2. * u3 - 3. * u2 + 1.) * a[i]
                        + span * (u3 - 2. * u2 + u) * leave[i]
                        + (3. * u2 - 2. * u3) * b[i]
                        + span * (u3 - u2) * arrive[i]
                };
                let value: Vec<f64> = (0..self.width).map(hermite).collect();
                if rotation { unit([value[0], value[1], value[2], value[3]]).to_vec() } else { value }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(interpolation: Interpolation, keys: Vec<f64>) -> Curve {
        Curve { times: vec![1.0, 3.0], keys: Rows { values: keys, width: 1 }, width: 1, interpolation }
    }

    #[test]
    fn curves_hold_at_their_ends_and_pass_through_their_keys() {
        for curve in [
            curve(Interpolation::Linear, vec![5., 9.]),
            curve(Interpolation::Step, vec![5., 9.]),
            curve(Interpolation::CubicSpline, vec![7., 5., 1., -3., 9., 2.]),
        ] {
            let at: Vec<f64> = [0., 1., 3., 4.].map(|t| curve.at(t, false)[0]).into();
            assert_eq!(at, [5., 5., 9., 9.]);
        }
        assert_eq!(curve(Interpolation::Step, vec![5., 9.]).at(2.999, false), [5.]);
        assert_eq!(curve(Interpolation::Linear, vec![5., 9.]).at(1.5, false), [6.]);
    }

    #[test]
    fn a_spline_reproduces_a_cubic() {
        // x(t) = t^3 - 2 t with its derivative as tangents.
        let (x, d) = (|t: f64| t.powi(3) - 2. * t, |t: f64| 3. * t * t - 2.);
        let spline = curve(Interpolation::CubicSpline, vec![0., x(1.), d(1.), d(3.), x(3.), 0.]);
        for t in [1.25, 2.0, 2.9] {
            assert!((spline.at(t, false)[0] - x(t)).abs() < 1e-12);
        }
    }

    #[test]
    fn frames_cover_the_animation_evenly() {
        let info = AnimationInfo { index: 0, name: None, start: 0.5, end: 1.5 };
        assert_eq!(info.frame_times(4.0).unwrap(), [0.5, 0.75, 1.0, 1.25, 1.5]);
        assert_eq!(info.frame_times(1.5).unwrap().len(), 3);
        assert!(info.frame_times(0.0).is_err() && info.frame_times(f64::NAN).is_err());
        assert!(info.frame_times(1e9).is_err());
        let still = AnimationInfo { end: 0.5, ..info };
        assert_eq!(still.frame_times(30.0).unwrap(), [0.5]);
    }
}
