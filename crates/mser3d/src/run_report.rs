use std::time::Instant;

use crate::Stage;
use crate::memory::peak_memory;

/// What a run took: what differs from run to run.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct RunReport {
    /// Threads that it could use.
    pub threads: usize,
    /// Wall time of all stages, in seconds.
    pub seconds: f64,
    /// The most memory that the process held up to the end, in bytes; none where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// What each stage took.
    pub stages: Vec<StageReport>,
}

/// What a stage took.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct StageReport {
    /// The stage.
    pub stage: Stage,
    /// Its wall time in seconds.
    pub seconds: f64,
    /// The most memory that the process held up to its end, in bytes; none where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

/// Measures one stage after another.
pub(crate) struct Clock {
    start: Instant,
    stages: Vec<StageReport>,
}

impl Clock {
    pub fn start() -> Self {
        Self { start: Instant::now(), stages: Vec::new() }
    }

    pub fn restart(&mut self) {
        self.start = Instant::now();
    }

    /// Ends a stage; returns its seconds.
    pub fn lap(&mut self, stage: Stage) -> f64 {
        let seconds = self.start.elapsed().as_secs_f64();
        self.stages.push(StageReport { stage, seconds, peak_memory_bytes: peak_memory() });
        self.restart();
        seconds
    }

    /// What the run took up to the end of the last stage.
    pub fn report(&self) -> RunReport {
        RunReport {
            threads: rayon::current_num_threads(),
            seconds: self.stages.iter().map(|s| s.seconds).sum(),
            peak_memory_bytes: peak_memory(),
            stages: self.stages.clone(),
        }
    }
}
