//! Work on files beside each other.

use std::thread::Builder;

/// What a function makes of each item, each on a thread of its own: there are few, and they wait for the disk.
pub(crate) fn beside<I: Sync, T: Send>(items: &[I], of: impl Fn(&I) -> T + Sync) -> Vec<T> {
    std::thread::scope(|scope| {
        let of = &of;
        let begin = |item| (item, Builder::new().spawn_scoped(scope, move || of(item)).ok());
        let threads: Vec<_> = items.iter().map(begin).collect();
        // A thread that there was not, or that died, is no reason to do less.
        let ended = threads.into_iter().map(|(item, thread)| {
            let made = thread.and_then(|thread| thread.join().ok());
            made.unwrap_or_else(|| of(item))
        });
        ended.collect()
    })
}
