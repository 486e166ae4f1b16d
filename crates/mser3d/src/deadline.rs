use std::ops::ControlFlow;
use std::time::{Duration, Instant};

/// When work has to be done, from now on.
///
/// ```
/// use mser3d::Deadline;
/// use std::time::Duration;
///
/// assert!(!Deadline::new(None).has_passed());
/// let error = Deadline::new(Some(Duration::ZERO)).check().unwrap_err();
/// assert!(error.to_string().starts_with("not done within the time limit of 0 s"));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Deadline {
    end: Option<Instant>,
    limit: Duration,
}

/// Work was not done in time.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "not done within the time limit of {} s; use fewer voxels (--voxels) or eigenpairs (--eigenpairs), or raise --time-limit",
    limit.as_secs_f64()
)]
pub struct DeadlinePassed {
    limit: Duration,
}

impl Deadline {
    /// The deadline of work that begins now and may take so long; without a limit there is none.
    pub fn new(limit: Option<Duration>) -> Self {
        // One that no clock can show is none.
        let end = limit.and_then(|limit| Instant::now().checked_add(limit));
        Self { end, limit: limit.unwrap_or_default() }
    }

    /// The deadline when work goes on that waited since `left` was left.
    #[must_use]
    pub fn resumed(self, left: Option<Duration>) -> Self {
        Self { limit: self.limit, ..Self::new(left) }
    }

    /// What a progress function returns: to stop once it has passed.
    pub fn go_on(&self) -> ControlFlow<()> {
        if self.has_passed() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// How long there still is; `None` without a limit.
    pub fn left(&self) -> Option<Duration> {
        Some(self.end?.saturating_duration_since(Instant::now()))
    }

    /// Whether it has passed.
    pub fn has_passed(&self) -> bool {
        self.left() == Some(Duration::ZERO)
    }

    /// An error once it has passed.
    ///
    /// # Errors
    /// [`DeadlinePassed`].
    pub fn check(&self) -> Result<(), DeadlinePassed> {
        if self.has_passed() { Err(DeadlinePassed { limit: self.limit }) } else { Ok(()) }
    }
}
