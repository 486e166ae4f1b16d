//! Work on files beside each other.

/// What a function makes of each item, each on a thread of its own: there are few, and they wait for the disk.
pub(crate) fn beside<I: Sync, T: Send>(items: &[I], of: impl Fn(&I) -> T + Sync) -> Vec<T> {
    std::thread::scope(|scope| {
        let of = &of;
        let threads: Vec<_> = items.iter().map(|item| (item, scope.spawn(move || of(item)))).collect();
        // A thread that died is no reason to do less.
        threads.into_iter().map(|(item, thread)| thread.join().unwrap_or_else(|_| of(item))).collect()
    })
}
