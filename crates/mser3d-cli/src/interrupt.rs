//! Ctrl-C and its like: the work stops at the next step, or else within a second, and takes away what it made; pressed again, it
//! stops at once.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use mser3d_fileio::abandon;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::message::tell;

/// Signals that ask to stop.
#[cfg(unix)]
const SIGNALS: [i32; 3] = [SIGINT, SIGTERM, signal_hook::consts::SIGHUP];
#[cfg(not(unix))]
const SIGNALS: [i32; 2] = [SIGINT, SIGTERM];

/// How long a stage may take to its next step before the program ends without it.
pub const PATIENCE: Duration = Duration::from_millis(500);
/// How long steps that should not be cut in two may take.
const LAST_STEPS: Duration = Duration::from_secs(10);
/// How often signals are looked for.
const LOOK: Duration = Duration::from_millis(20);

/// The signal that asked to stop; 0 for none.
static REQUESTED: AtomicUsize = AtomicUsize::new(0);
/// Whether the same command goes on where this one was stopped.
static RESUMABLE: AtomicBool = AtomicBool::new(false);
/// Folders that were made for results, innermost first.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// What signals set.
#[derive(Default)]
struct Flags {
    /// The last signal that nobody has looked at; 0 for none.
    came: Arc<AtomicUsize>,
    /// The next one has the effect that it has on any program.
    last: Arc<AtomicBool>,
}

/// From now on a signal to stop is noted, and ends the program soon. One that is ignored, as under `nohup`, still is.
pub fn listen() {
    static FLAGS: OnceLock<Flags> = OnceLock::new();
    let mut first = false;
    let flags = FLAGS.get_or_init(|| {
        first = true;
        Flags::default()
    });
    if !first {
        return;
    }
    for signal in SIGNALS.into_iter().filter(|signal| !is_ignored(*signal)) {
        // Should the system refuse, it goes on ending the program as ever.
        let _ = flag::register_conditional_default(signal, Arc::clone(&flags.last));
        let _ = flag::register_usize(signal, Arc::clone(&flags.came), signal.unsigned_abs() as usize);
    }
    std::thread::spawn(|| watch(flags));
}

/// Whether who started the program wants it to ignore a signal.
fn is_ignored(signal: i32) -> bool {
    // Only Linux says so in a file.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0);
    mask >> (signal - 1) & 1 == 1
}

/// The exit code after a signal to stop, as shells report it; none if there was none.
pub fn exit_code() -> Option<u8> {
    match REQUESTED.load(Ordering::SeqCst) {
        0 => None,
        signal => Some(128 + signal as u8),
    }
}

/// What a function says that hears of progress: whether the work is to go on.
pub fn go_on() -> ControlFlow<()> {
    if exit_code().is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// From now on what is done is kept when the program is stopped, and the same command goes on from there.
pub fn keeps_what_is_done() {
    RESUMABLE.store(true, Ordering::SeqCst);
}

/// Folders to be taken away when the program is stopped, as far as they are empty.
pub fn take_away(made: &[PathBuf]) {
    MADE.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(made);
}

/// Tells the user, once, that the program was stopped and how to go on.
pub fn say() {
    static SAID: AtomicBool = AtomicBool::new(false);
    let what = match RESUMABLE.load(Ordering::SeqCst) {
        true => "interrupted; what is done is kept: run the same command again to go on",
        false => "interrupted; nothing is left half written: run the same command again to start anew",
    };
    if !SAID.swap(true, Ordering::SeqCst) {
        tell(what);
    }
}

/// Waits for a signal. Stages that ask [`go_on`] end by themselves; for others this ends the program.
fn watch(flags: &Flags) {
    let signal = loop {
        match flags.came.swap(0, Ordering::SeqCst) {
            0 => std::thread::sleep(LOOK),
            signal => break signal,
        }
    };
    REQUESTED.store(signal, Ordering::SeqCst);
    let start = Instant::now();
    // Another one is impatient.
    while start.elapsed() < PATIENCE && flags.came.load(Ordering::SeqCst) == 0 {
        std::thread::sleep(LOOK);
    }
    flags.last.store(true, Ordering::SeqCst);
    clear();
    say();
    std::process::exit(exit_code().unwrap_or(1).into());
}

/// Ends the program for another reason, as a signal does.
pub fn leave(why: &str, code: i32) -> ! {
    clear();
    tell(why);
    std::process::exit(code);
}

/// Takes away what is unfinished, and the folders that were made, as far as they are empty.
fn clear() {
    abandon(LAST_STEPS);
    let made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    made.iter().take_while(|path| std::fs::remove_dir(path).is_ok()).for_each(drop);
}
