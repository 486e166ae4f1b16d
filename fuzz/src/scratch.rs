//! A folder of this process for files that are read by their names, in memory where the system has such a place.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// The folder. It is swept by who started the process, `cargo xtask fuzz`: a crash leaves no time for it.
pub fn folder() -> &'static Path {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    FOLDER.get_or_init(|| {
        let parent = std::env::var_os("MSER3D_FUZZ_SCRATCH").map_or_else(std::env::temp_dir, PathBuf::from);
        let path = parent.join(format!("mser3d-fuzz-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        path
    })
}

/// A file of this name with these bytes.
pub fn file(name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder().join(name);
    std::fs::write(&path, bytes).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    path
}

/// An error is one message that names what it is about.
pub fn check_message(text: &str, about: &str) {
    assert!(text.contains(about), "an error that does not name {about:?}: {text:?}");
    assert!(text.len() < 4000, "an error of {} bytes", text.len());
}
