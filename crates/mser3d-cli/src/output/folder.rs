use std::fs;
use std::path::{Path, PathBuf};

use mser3d::Features;
use mser3d_meshio::{NpyArray, write_atomically};
use mser3d_results::Results;

use super::report::Report;
use crate::error::CliError;
use crate::input::Input;

/// A folder that either holds a whole result or none.
///
/// `regions.json` is the last file to appear and the first to go: while it is there, the others
/// belong to it.
pub struct OutputFolder {
    path: PathBuf,
    /// The folders we made, innermost first, and take away again if nothing gets written.
    made: Vec<PathBuf>,
    done: std::cell::Cell<bool>,
}

impl OutputFolder {
    /// Makes the folder, and finds out early whether it can be written to.
    pub fn create(path: &Path) -> Result<Self, CliError> {
        let fail = |source| CliError::OutputFolder { path: path.to_path_buf(), source };
        let missing = path.ancestors().take_while(|p| !p.as_os_str().is_empty() && !p.exists());
        let made = missing.map(Path::to_path_buf).collect();
        fs::create_dir_all(path).map_err(fail)?;
        let folder = Self { path: path.to_path_buf(), made, done: false.into() };
        tempfile::tempfile_in(path).map_err(fail)?;
        Ok(folder)
    }

    pub fn write(&self, input: &Input, features: &Features, report: &Report) -> Result<(), CliError> {
        let results = Results::new(features, input.mesh(), &input.path.to_string_lossy())?;
        // Leads from the vertices of a file that repeats them to those of the mesh.
        let weld = input.loaded().and_then(|loaded| loaded.weld.as_deref());
        let more = weld.map(|weld| ("file_vertex", NpyArray::flat(weld)));
        results.write_files(&self.path, more.into_iter().collect())?;
        let json = report.to_json();
        write_atomically(&self.path.join("regions.json"), |out| {
            use std::io::Write;
            out.write_all(json.as_bytes())
        })?;
        self.done.set(true);
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if !self.done.get() {
            // Only what is still empty goes.
            self.made.iter().take_while(|path| fs::remove_dir(path).is_ok()).for_each(drop);
        }
    }
}
