//! What is being made, and must not stay behind half done when the program is stopped.

use std::cell::Cell;
use std::fs;
use std::io;
use std::marker::PhantomData;
use std::path::{Path, PathBuf};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// All that is under way in this process.
#[derive(Default)]
struct UnderWay {
    /// Files and folders that have not got their names yet.
    unfinished: Vec<PathBuf>,
    /// Steps that should not be cut in two.
    steps: usize,
    /// The program is being stopped: no step begins any more.
    ended: bool,
}

static UNDER_WAY: Mutex<UnderWay> = Mutex::new(UnderWay { unfinished: Vec::new(), steps: 0, ended: false });
static STEP_DONE: Condvar = Condvar::new();

thread_local! {
    /// Steps that this thread is in, one in the other.
    static DEPTH: Cell<usize> = const { Cell::new(0) };
}

fn under_way() -> MutexGuard<'static, UnderWay> {
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file or a folder that is being made under another name. Unless it is [finished](Self::finish), it is taken away: when
/// this is dropped, or by [`abandon`].
///
/// ```
/// use mser3d_fileio::Unfinished;
/// # let root = std::env::temp_dir().join(format!("mser3d-unfinished-{}", std::process::id()));
/// # std::fs::create_dir_all(&root)?;
/// let (folder, hidden) = (root.join("result"), root.join(".result.partial"));
/// let (unfinished, ()) = Unfinished::make(|| Ok((hidden.clone(), std::fs::create_dir(&hidden)?)))?;
/// std::fs::write(unfinished.path().join("a.txt"), "a")?;
/// unfinished.finish(|hidden| std::fs::rename(hidden, &folder))?;
/// assert!(folder.join("a.txt").exists() && !hidden.exists());
/// # std::fs::remove_dir_all(&root)?;
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug)]
pub struct Unfinished {
    path: PathBuf,
    finished: bool,
}

impl Unfinished {
    /// Makes it by a function that says where it is.
    ///
    /// # Errors
    /// Those of the function.
    pub fn make<T>(make: impl FnOnce() -> io::Result<(PathBuf, T)>) -> io::Result<(Self, T)> {
        let _step = Writing::begin();
        let (path, made) = make()?;
        under_way().unfinished.push(path.clone());
        Ok((Self { path, finished: false }, made))
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name by a function that takes where it is. After an error it is taken away.
    ///
    /// # Errors
    /// Those of the function.
    pub fn finish<T>(mut self, rename: impl FnOnce(&Path) -> io::Result<T>) -> io::Result<T> {
        let _step = Writing::begin();
        let renamed = rename(&self.path)?;
        self.finished = true;
        Ok(renamed)
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if !self.finished {
            take_away(&self.path);
        }
        under_way().unfinished.retain(|path| *path != self.path);
    }
}

/// While it is there, something is being done that should not be cut in two: short steps, such as files that get their
/// names. It stays on its thread.
#[derive(Debug)]
pub struct Writing(PhantomData<*const ()>);

impl Writing {
    /// From now on [`abandon`] waits. Where that has begun to wait, this never returns: the program is about to end. (Within
    /// a step of the same thread it does, so that the step comes to its end.)
    pub fn begin() -> Self {
        let mut all = under_way();
        let inside = DEPTH.get() > 0;
        while all.ended && !inside {
            all = STEP_DONE.wait(all).unwrap_or_else(PoisonError::into_inner);
        }
        all.steps += 1;
        DEPTH.set(DEPTH.get() + 1);
        Self(PhantomData)
    }
}

impl Drop for Writing {
    fn drop(&mut self) {
        DEPTH.set(DEPTH.get() - 1);
        under_way().steps -= 1;
        STEP_DONE.notify_all();
    }
}

/// For a program that ends without its other threads: takes away all that is [`Unfinished`]. From now on no file of this
/// process gets its name. Steps under way that should not be cut in two ([`Writing`]) have so long to come to their end.
///
/// Other threads wait for ever at their next step, so the program has to end after this.
pub fn abandon(patience: Duration) {
    let end = Instant::now() + patience;
    let mut all = under_way();
    all.ended = true;
    while all.steps > 0 {
        let left = end.saturating_duration_since(Instant::now());
        if left.is_zero() {
            break;
        }
        all = STEP_DONE.wait_timeout(all, left).unwrap_or_else(PoisonError::into_inner).0;
    }
    let unfinished = std::mem::take(&mut all.unfinished);
    drop(all);
    unfinished.iter().for_each(|path| take_away(path));
}

/// Removes a file or a folder, if it is there. What cannot be removed is left.
fn take_away(path: &Path) {
    let _ = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
}
