use serde::{Deserialize, Serialize};

use mser3d_volumeio::Label;

use crate::Job;

/// The name of the file in the folder of a shape.
pub(crate) const FAILURE: &str = "failure.json";

/// A shape that failed: what `failure.json` in its folder says, and `failures.json` of all.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Failure {
    /// Its name in the collection.
    pub name: String,
    /// The file.
    pub path: String,
    /// The glTF animation that poses it.
    pub animation: Option<String>,
    /// When in the animation, in seconds.
    pub time: f64,
    /// The label that was chosen, by number.
    pub label: Option<i64>,
    /// Why there is no result.
    pub error: String,
    /// Whether there is one of an earlier run, with other parameters or of another input, which was kept.
    #[serde(default)]
    pub kept: bool,
}

impl Failure {
    pub(crate) fn new(job: &Job, error: String, kept: bool) -> Self {
        Self {
            name: job.name.clone(),
            path: job.path.to_string_lossy().into_owned(),
            animation: job.options.pose.animation.clone(),
            time: job.options.pose.time,
            label: match job.options.body.label {
                Some(Label::Value(label)) => Some(label),
                _ => None,
            },
            error,
            kept,
        }
    }
}
