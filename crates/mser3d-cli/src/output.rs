//! Names of what is written: a name must promise what the file will be. Checked before anything is read.

use std::path::{Path, PathBuf};

use clap::builder::{PathBufValueParser, TypedValueParser};

/// Pictures.
pub const PICTURE: Kind = Kind { what: "pictures are written as PNG", endings: &[".png"] };
/// Pages for the browser.
pub const PAGE: Kind = Kind { what: "pages are written as HTML", endings: &[".html", ".htm"] };
/// Masks of voxels.
pub const MASK: Kind =
    Kind { what: "masks are written as NIfTI or NumPy", endings: &[".nii.gz", ".nii", ".npy"] };
/// Results for other programs.
pub const EXPORT: Kind = Kind { what: "no such format", endings: &mser3d_results::EXPORT_ENDINGS };

/// Endings of files that people know; a folder of such a name is most likely meant to be one.
const FILES: [&str; 28] = [
    ".png", ".jpg", ".jpeg", ".svg", ".pdf", ".gif", ".webp", ".bmp", ".tif", ".tiff", ".html", ".htm",
    ".json", ".csv", ".tsv", ".txt", ".parquet", ".npy", ".npz", ".nii", ".gz", ".glb", ".ply", ".vtp",
    ".vti", ".obj", ".off", ".stl",
];

/// A kind of file, and how its name may end.
#[derive(Clone, Copy)]
pub struct Kind {
    what: &'static str,
    endings: &'static [&'static str],
}

/// Whether a name ends so, in capitals or not, and is more than its ending.
fn ends_in(path: &Path, endings: &[&str]) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    endings.iter().any(|ending| name.ends_with(ending) && name.len() > ending.len())
}

/// A file of this kind to write.
pub fn file(kind: Kind) -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(move |path| {
        if ends_in(&path, kind.endings) {
            return Ok(path);
        }
        let choices = match kind.endings {
            [one] => (*one).to_owned(),
            [first @ .., last] => format!("{} or {last}", first.join(", ")),
            [] => String::new(),
        };
        Err(format!("{}; end the name in {choices}", kind.what))
    })
}

/// A folder to write into. One that isn't there yet may not be named like a file.
pub fn folder() -> impl TypedValueParser<Value = PathBuf> {
    PathBufValueParser::new().try_map(|path| {
        if ends_in(&path, &FILES) && !path.is_dir() {
            return Err("this is to be a folder, and the name is that of a file; name a folder");
        }
        Ok(path)
    })
}
