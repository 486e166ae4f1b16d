//! Ctrl-C: the work stops at the next step and takes away what it made; pressed again, it stops at once.

use std::sync::Arc;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

static REQUESTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();

/// From now on a signal to stop is noted instead of obeyed. For commands that ask [`is_requested`].
pub fn listen() {
    let requested = REQUESTED.get_or_init(Arc::default);
    for signal in [SIGINT, SIGTERM] {
        // Should the system refuse, it goes on ending the program as ever.
        let _ = flag::register_conditional_default(signal, Arc::clone(requested));
        let _ = flag::register(signal, Arc::clone(requested));
    }
}

pub fn is_requested() -> bool {
    REQUESTED.get().is_some_and(|requested| requested.load(Ordering::Relaxed))
}
