use std::cell::Cell;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d_fileio::Writing;

use crate::{Extra, Results, ResultsError};

/// A folder that will hold a whole result or none.
///
/// It is made before the work, so that a folder that cannot be written to is found out early. If nothing gets written,
/// what was made is taken away again.
pub struct ResultsFolder {
    path: PathBuf,
    /// The folders we made, innermost first.
    made: Vec<PathBuf>,
    done: Cell<bool>,
}

impl ResultsFolder {
    /// Makes the folder if it is not there, and finds out whether it can be written to.
    ///
    /// # Errors
    /// [`ResultsError::OutputFolder`].
    pub fn create(path: &Path) -> Result<Self, ResultsError> {
        let fail = |error| ResultsError::OutputFolder { path: path.to_owned(), error };
        let missing = path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
        let made = missing.map(Path::to_path_buf).collect();
        fs::create_dir_all(path).map_err(fail)?;
        let folder = Self { path: path.to_owned(), made, done: false.into() };
        tempfile::tempfile_in(path).map_err(fail)?;
        Ok(folder)
    }

    /// The folders that were made, innermost first.
    pub fn made(&self) -> &[PathBuf] {
        &self.made
    }

    /// Writes a result, in place of an older one, and with it what is asked for besides. `regions.json` is the first file
    /// to go and the last to appear: while it is there, the others belong to it.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::File`] or [`ResultsError::Mesh`], naming the file.
    pub fn write(&self, results: &Results, extras: &[Extra]) -> Result<(), ResultsError> {
        let _whole = Writing::begin();
        results.write_files(&self.path, extras)?;
        self.done.set(true);
        Ok(())
    }
}

impl Drop for ResultsFolder {
    fn drop(&mut self) {
        if !self.done.get() {
            // Only what is still empty goes.
            self.made.iter().take_while(|path| fs::remove_dir(path).is_ok()).for_each(drop);
        }
    }
}
