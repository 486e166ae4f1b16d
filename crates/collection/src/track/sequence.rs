use std::cmp::Ordering;
use std::path::PathBuf;

use mser3d::spectral::EigenpairRange;
use mser3d::{Domain, Parameters};
use mser3d_meshio::MeshFormat;
use mser3d_results::ShapeOptions;
use mser3d_shape::InvalidParameter;

use crate::job::{expand, find_animation, jobs_at, names};
use crate::{CollectionError, Job, Plan};

/// Which moments of an animation become frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sampling {
    /// So many, from its start to its end, both included; at least 2.
    Count(usize),
    /// One every so many seconds or somewhat less, so that they are even, from its start to its end, both included.
    Every(f64),
}

impl Default for Sampling {
    /// 24 a second.
    fn default() -> Self {
        Self::Every(1.0 / 24.0)
    }
}

/// The frames of a sequence, in their order, as the plan of a batch.
///
/// Of one input that is an animated glTF file, they are moments of an animation, by name or number, or of its only one. Otherwise
/// each file is a frame: in the order in which they are given, and those of a folder, a pattern or a list in the order of their
/// names, with numbers in them by value: `pose_2` comes before `pose_10`.
///
/// # Errors
/// [`CollectionError::Input`] where there are fewer than two frames, or no such animation; [`CollectionError::Mesh`] for an
/// animation that cannot be read; [`CollectionError::InvalidParameter`] for a sampling out of range.
pub fn plan_sequence(
    inputs: &[PathBuf],
    animation: Option<&str>,
    sampling: Sampling,
    volumes: &ShapeOptions,
) -> Result<Plan, CollectionError> {
    let mut paths = Vec::new();
    for input in inputs {
        let mut found = expand(input, false, volumes.limits())?;
        if input.extension().is_none_or(|ending| ending != "txt") {
            found.sort_by(|a, b| by_numbers(&a.to_string_lossy(), &b.to_string_lossy()));
        }
        paths.extend(found);
    }
    let mut plan = Plan::default();
    for (path, name) in paths.iter().zip(names(&paths)) {
        let is_mesh = MeshFormat::from_extension(path).is_some();
        let options = if is_mesh { volumes.limits_alone() } else { volumes.clone() };
        plan.jobs.push(Job { name, path: path.clone(), options, parameters: None });
    }
    if let (Some(only), 1) = (plan.jobs.first().cloned(), plan.jobs.len()) {
        let animation_info = find_animation(&only.path, animation, volumes.limits())?;
        let times = match sampling {
            Sampling::Every(seconds) => {
                InvalidParameter::unless(seconds > 0.0, "every", seconds, "a number of seconds above 0")?;
                animation_info.frame_times(1.0 / seconds)?
            }
            Sampling::Count(count) => {
                let most = 1_000_000;
                InvalidParameter::unless((2..=most).contains(&count), "frames", count, "from 2 to 1000000")?;
                let (start, end) = (animation_info.start, animation_info.end);
                let time = |i: usize| start + (end - start) * (i as f64 / (count - 1) as f64);
                (0..count).map(time).collect()
            }
        };
        let named = animation.map_or(animation_info.index.to_string(), str::to_owned);
        let named = animation_info.name.clone().unwrap_or(named);
        plan.jobs = jobs_at(&only, &named, animation_info.index, times);
    } else if let Some(animation) = animation {
        let problem = format!("animation {animation:?} is of one file, and here are {}", plan.jobs.len());
        return Err(CollectionError::Input { input: paths[0].display().to_string(), problem });
    }
    if plan.jobs.len() < 2 {
        let problem = "one frame is no sequence; give at least two, or an animation that lasts".to_owned();
        return Err(CollectionError::Input { input: inputs[0].display().to_string(), problem });
    }
    Ok(plan)
}

/// How much heat a spectrum leaves out at the shortest time: exp(-LEFT_OUT). Then regions are the same, to the voxel or nearly so, as
/// with more eigenpairs.
const LEFT_OUT: f64 = 12.0;

/// Prepares the frames of a plan for being tracked: all have the voxel size and the reference measure of the first, and what
/// each of them need not do for itself is shared.
///
/// * With `few_eigenpairs`, only the eigenpairs that the weight's shortest time needs are computed: those with
///   `lambda t < 12`. A weight without times needs all.
/// * If the parameters don't say how many deformed copies of a frame are searched, it is one. Each frame has another
///   one, and reliability is that of the copies of a frame and its neighbours together.
///
/// # Errors
/// Those of reading the first frame, and of [`Parameters::with_scale_of`].
pub fn share_parameters(
    plan: &mut Plan,
    domain: Domain,
    parameters: &Parameters,
    few_eigenpairs: bool,
) -> Result<Parameters, CollectionError> {
    let mut shared = parameters.clone();
    if let Some(first) = plan.jobs.first() {
        let file = first.read()?;
        let fail = |error: mser3d::Error| CollectionError::Input {
            input: first.path.display().to_string(),
            problem: format!("the first frame gives all frames their scale: {error}"),
        };
        shared = parameters.with_scale_of(file.input(domain)?).map_err(fail)?;
        if let Some(measure) = parameters.reference_measure {
            shared.reference_measure = Some(measure);
        }
    }
    if let (true, Some(measure)) =
        (few_eigenpairs && shared.weight.has_time_scale(), shared.reference_measure)
    {
        let unit = measure.powf(if domain == Domain::Volume { 2.0 / 3.0 } else { 1.0 });
        let times = shared.time_scales.iter().filter_map(|scale| scale.with_unit(unit).ok());
        let shortest = times.fold(f64::INFINITY, f64::min);
        let bound = LEFT_OUT * unit / shortest;
        if bound > 0.0 && bound.is_finite() {
            shared.spectrum.eigenpairs = EigenpairRange::LambdaMax(bound);
        }
    }
    let reliability = &mut shared.reliability;
    if reliability.deformations.is_none() && reliability.min_reliability.is_none() {
        reliability.deformations = Some(1);
    }
    for (frame, job) in (0u64..).zip(&mut plan.jobs) {
        let mut own = shared.clone();
        own.reliability.seed = own.reliability.seed.wrapping_add(frame);
        job.parameters = Some(Box::new(own));
    }
    Ok(shared)
}

/// Orders texts with numbers in them by the values of these.
fn by_numbers(a: &str, b: &str) -> Ordering {
    let (mut a_rest, mut b_rest) = (a, b);
    loop {
        let (Some(x), Some(y)) = (a_rest.chars().next(), b_rest.chars().next()) else {
            return a_rest.len().cmp(&b_rest.len()).then_with(|| a.cmp(b));
        };
        if x.is_ascii_digit() && y.is_ascii_digit() {
            let [(p, after_p), (q, after_q)] = [a_rest, b_rest].map(|rest| {
                let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
                (rest[..end].trim_start_matches('0'), &rest[end..])
            });
            let order = p.len().cmp(&q.len()).then_with(|| p.cmp(q));
            if order != Ordering::Equal {
                return order;
            }
            (a_rest, b_rest) = (after_p, after_q);
        } else {
            if x != y {
                return x.cmp(&y);
            }
            (a_rest, b_rest) = (&a_rest[x.len_utf8()..], &b_rest[y.len_utf8()..]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_count_by_value() {
        let mut names = ["pose_10", "pose_2", "pose_02b", "a1", "pose_100", "pose_", "pose_2b"];
        names.sort_by(|a, b| by_numbers(a, b));
        assert_eq!(names, ["a1", "pose_", "pose_2", "pose_02b", "pose_2b", "pose_10", "pose_100"]);
    }

    #[test]
    fn files_are_frames_in_the_order_given_and_one_is_no_sequence() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["p10.off", "p9.off", "z.off"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let file = |name: &str| folder.path().join(name);
        let plan = |inputs: &[PathBuf]| {
            let plan = plan_sequence(inputs, None, Sampling::default(), &ShapeOptions::default());
            plan.map(|plan| plan.jobs.into_iter().map(|job| job.name).collect::<Vec<_>>())
        };
        assert_eq!(plan(&[file("z.off"), file("p*.off")]).unwrap(), ["z", "p9", "p10"]);
        assert_eq!(plan(&[folder.path().to_owned()]).unwrap(), ["p9", "p10", "z"]);
        let error = plan(&[file("p9.off")]).unwrap_err().to_string();
        assert!(error.contains("no animation") && error.contains("several files"), "{error}");
    }
}
