//! Work on a thread of its own, so that Python is free meanwhile, Ctrl-C ends it within a second, and progress is told by
//! the thread that called.

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use mser3d::Progress;
use mser3d::shape::Choice;
use mser3d_cli::CliError;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::exception;

/// How often signals are looked for and progress is told.
const STEP: Duration = Duration::from_millis(50);
/// How long a stage may take to its next step after Ctrl-C, before it is left to itself.
const PATIENCE: Duration = Duration::from_millis(700);

/// Nanoseconds that the libraries took in the last call.
static LAST: AtomicU64 = AtomicU64::new(0);

/// Seconds that the libraries took in the last call that had them work: what the time of the call is compared with.
#[pyfunction]
pub fn last_seconds() -> f64 {
    LAST.load(Ordering::Relaxed) as f64 * 1e-9
}

/// How a call runs.
pub struct Call {
    /// Hears (stage, share of the stage, share of all).
    pub progress: Option<Py<PyAny>>,
    pub threads: Option<usize>,
}

/// What the work tells those who wait for it.
#[derive(Default)]
pub struct Told {
    cancelled: AtomicBool,
    /// The stages since it was last taken, in order: of each the latest share that is done, and that of all.
    progress: Mutex<Vec<(&'static str, f64, f64)>>,
    warnings: Mutex<Vec<String>>,
}

impl Told {
    /// For a detector: remembers how far it is, and cancels it once that is asked for.
    pub fn report(&self, progress: Progress) -> ControlFlow<()> {
        self.set(progress.stage.name(), progress.done, progress.overall)
    }

    /// For work of one stage.
    pub fn report_share(&self, stage: &'static str, done: f64) -> ControlFlow<()> {
        self.set(stage, done, done)
    }

    fn set(&self, stage: &'static str, done: f64, overall: f64) -> ControlFlow<()> {
        let mut told = self.progress.lock().unwrap_or_else(PoisonError::into_inner);
        match told.last_mut() {
            Some(last) if last.0 == stage => *last = (stage, done, overall),
            _ => told.push((stage, done, overall)),
        }
        self.go_on()
    }

    pub fn go_on(&self) -> ControlFlow<()> {
        if self.cancelled.load(Ordering::Relaxed) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    }

    pub fn warn(&self, what: &str) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(what.to_owned());
    }

    pub fn warnings(&self) -> Vec<String> {
        std::mem::take(&mut self.warnings.lock().unwrap_or_else(PoisonError::into_inner))
    }

    fn latest(&self) -> Vec<(&'static str, f64, f64)> {
        std::mem::take(&mut self.progress.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The threads that work is spread over: made at first use, and anew in a process that was forked.
fn pool(threads: Option<usize>) -> Result<Arc<ThreadPool>, CliError> {
    static POOLS: Mutex<Option<(u32, HashMap<usize, Arc<ThreadPool>>)>> = Mutex::new(None);
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if pools.as_ref().is_some_and(|(of, _)| *of != process) {
        // Their threads are not in this process, so nothing can be told to end.
        std::mem::forget(pools.take());
    }
    let (_, pools) = pools.get_or_insert_with(|| (process, HashMap::new()));
    let threads = threads.unwrap_or(0);
    if let Some(pool) = pools.get(&threads) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(pool.map_err(|e| CliError::Usage(format!("threads={threads}: {e}")))?);
    pools.insert(threads, Arc::clone(&pool));
    Ok(pool)
}

/// Runs work and waits for it. After Ctrl-C, work that does not end soon is left to itself.
///
/// # Errors
/// The work's own as exceptions, what a signal handler or the progress function raised, and a `RuntimeError` where the
/// work panicked.
pub fn run<T: Send + 'static>(
    py: Python<'_>,
    call: &Call,
    work: impl FnOnce(&Told) -> Result<T, CliError> + Send + 'static,
) -> PyResult<T> {
    let pool = pool(call.threads).map_err(exception)?;
    let told = Arc::new(Told::default());
    let (done, waiting) = mpsc::channel();
    let heard = Arc::clone(&told);
    let worker = thread().spawn(move || timed(&pool, &heard, work, done)).map_err(no_thread)?;
    match wait(py, call, &told, waiting) {
        Waited::Over(outcome) => outcome.map_err(exception),
        Waited::Panicked => Err(fault(py.detach(|| worker.join().err()))),
        Waited::Stopped(error) => {
            py.detach(move || {
                let start = Instant::now();
                while !worker.is_finished() && start.elapsed() < PATIENCE {
                    std::thread::sleep(Duration::from_millis(5));
                }
            });
            Err(error)
        }
    }
}

/// As [`run`], for work on arrays of the caller's, which are not copied: it always waits for the end, so the work looks every
/// now and then whether it should go on.
pub fn run_borrowing<T: Send>(
    py: Python<'_>,
    call: &Call,
    work: impl FnOnce(&Told) -> Result<T, CliError> + Send,
) -> PyResult<T> {
    let pool = pool(call.threads).map_err(exception)?;
    let told = Told::default();
    let (done, waiting) = mpsc::channel();
    std::thread::scope(|scope| {
        let worker = thread().spawn_scoped(scope, || timed(&pool, &told, work, done)).map_err(no_thread)?;
        let waited = wait(py, call, &told, waiting);
        let panicked = py.detach(|| worker.join().err());
        match waited {
            Waited::Over(outcome) => outcome.map_err(exception),
            Waited::Panicked => Err(fault(panicked)),
            Waited::Stopped(error) => Err(error),
        }
    })
}

fn thread() -> std::thread::Builder {
    std::thread::Builder::new().name("mser3d".into())
}

fn no_thread(error: std::io::Error) -> PyErr {
    PyRuntimeError::new_err(format!("no thread can be started: {error}"))
}

/// Does the work on the threads of a pool, and hands over what came of it.
fn timed<T: Send>(
    pool: &ThreadPool,
    told: &Told,
    work: impl FnOnce(&Told) -> Result<T, CliError> + Send,
    done: mpsc::Sender<Result<T, CliError>>,
) {
    let start = Instant::now();
    let outcome = pool.install(|| work(told));
    LAST.store(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    // Nobody waits any more after Ctrl-C.
    let _ = done.send(outcome);
}

enum Waited<T> {
    Over(Result<T, CliError>),
    Panicked,
    /// The work was told to end: why.
    Stopped(PyErr),
}

fn wait<T: Send>(
    py: Python<'_>,
    call: &Call,
    told: &Told,
    mut waiting: mpsc::Receiver<Result<T, CliError>>,
) -> Waited<T> {
    loop {
        let outcome;
        (waiting, outcome) = py.detach(move || {
            let outcome = waiting.recv_timeout(STEP);
            (waiting, outcome)
        });
        let stop = match outcome {
            Ok(outcome) => match tell(py, call, told) {
                Ok(()) => return Waited::Over(outcome),
                Err(error) => Err(error),
            },
            Err(RecvTimeoutError::Disconnected) => return Waited::Panicked,
            Err(RecvTimeoutError::Timeout) => py.check_signals().and_then(|()| tell(py, call, told)),
        };
        if let Err(error) = stop {
            told.cancelled.store(true, Ordering::Relaxed);
            return Waited::Stopped(error);
        }
    }
}

/// Tells the caller's function how far the work is, if it has gone on; a stage shorter than [`STEP`] once, too.
fn tell(py: Python<'_>, call: &Call, told: &Told) -> PyResult<()> {
    let latest = told.latest();
    if let Some(function) = &call.progress {
        for progress in latest {
            function.call1(py, progress)?;
        }
    }
    Ok(())
}

/// What a panic of the work becomes: an error like others, never the end of the interpreter.
fn fault(payload: Option<Box<dyn std::any::Any + Send>>) -> PyErr {
    let text = payload.as_ref().and_then(|payload| {
        let text = payload.downcast_ref::<&str>().copied();
        text.or_else(|| payload.downcast_ref::<String>().map(String::as_str))
    });
    let text = text.unwrap_or("it gave no reason");
    PyRuntimeError::new_err(format!("mser3d failed by a fault of its own, please report it: {text}"))
}
