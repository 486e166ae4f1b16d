//! Ctrl-C: the work stops at the next step, or else within a second, and takes away what it made; pressed again, it stops at
//! once.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use mser3d_fileio::is_writing;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
/// Folders that were made for results, innermost first.
static MADE: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// How long a stage may take to its next step before the program ends without it.
pub const PATIENCE: Duration = Duration::from_millis(600);
/// How long files that are being written may take.
const LAST_WRITES: Duration = Duration::from_secs(10);

/// From now on a signal to stop is noted, and ends the program soon.
pub fn listen() {
    let requested = REQUESTED.get_or_init(Arc::default);
    for signal in [SIGINT, SIGTERM] {
        // Should the system refuse, it goes on ending the program as ever.
        let _ = flag::register_conditional_default(signal, Arc::clone(requested));
        let _ = flag::register(signal, Arc::clone(requested));
    }
    std::thread::spawn(watch);
}

pub fn is_requested() -> bool {
    REQUESTED.get().is_some_and(|requested| requested.load(Ordering::Relaxed))
}

/// Folders to be taken away when the program is stopped, as far as they are empty.
pub fn take_away(made: &[PathBuf]) {
    MADE.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(made);
}

/// Waits for a signal. Stages that ask [`is_requested`] end by themselves; for others this ends the program.
fn watch() {
    while !is_requested() {
        std::thread::sleep(Duration::from_millis(50));
    }
    std::thread::sleep(PATIENCE);
    // As shells report a program that ended by SIGINT.
    leave("interrupted", 130);
}

/// Ends the program, once no file is being written: with a message, and without the folders that it made, as far as they are
/// empty.
pub fn leave(what: &str, code: i32) -> ! {
    let start = Instant::now();
    while is_writing() && start.elapsed() < LAST_WRITES {
        std::thread::sleep(Duration::from_millis(5));
    }
    let made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    made.iter().take_while(|path| std::fs::remove_dir(path).is_ok()).for_each(drop);
    eprintln!("mser3d: {what}");
    std::process::exit(code);
}
