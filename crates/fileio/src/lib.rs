//! Files written whole or not at all, and NumPy's arrays.
//!
//! * [`write_atomically`] and [`write_text`] write to the side and rename: nobody ever sees half of a file.
//! * [`Unfinished`] is a file or a folder that is being made; a program that is told to stop takes all of them away by
//!   [`abandon`].
//! * [`read_npy`] and [`write_npy`] read and write one array, [`read_npz`] and [`write_npz`] several with
//!   names; [`NpzReader`] and [`write_npz_by`] hold only one of them at a time. The same arrays make the same bytes.
//! * [`ReadLimits`] bounds what every reader of ours may take, and says which files a file may name.
//! * [`FolderLock`] keeps other processes out of a folder, and [`sync_folder`] waits until one is on the disk.
//!
//! A damaged file ends in a [`FileError`] that names the file, never in a panic. Memory is bounded by the
//! size of the file, not by what its header promises.
//!
//! # Limits
//! Arrays are integers of up to 32 bits, `int64`, `float32`, `float64` or `bool`, little-endian. `.npz`
//! archives are not compressed. Records, strings and objects are refused.
//!
//! # Example
//! ```
//! use mser3d_fileio::{NpyArray, NpyValues, read_npz, write_npz};
//!
//! # let folder = std::env::temp_dir().join(format!("mser3d-fileio-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! let path = folder.join("features.npz");
//! let voxels = NpyArray::new(&[2, 3], vec![0u32, 0, 0, 1, 0, 0])?;
//! write_npz(&path, &[("voxels", voxels), ("eigenvalues", NpyArray::flat(vec![0.0, 0.25]))])?;
//!
//! let arrays = read_npz(&path)?;
//! assert_eq!(arrays["voxels"].shape(), [2, 3]);
//! assert_eq!(*arrays["eigenvalues"].values(), NpyValues::from(vec![0.0, 0.25]));
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod error;
mod file;
mod folder;
mod input;
mod limits;
mod npy;
mod npz;
mod unfinished;

pub use error::{FileError, abridged};
pub use file::{file_stem, read_bytes, read_bytes_within, write_atomically, write_text};
pub use folder::{FolderLock, sync_folder, sync_names};
pub use input::{InputFile, STDIN, take_stdin};
pub use limits::{OverLimit, ReadLimits};
pub use npy::{NpyArray, NpyValues, read_npy, write_npy};
pub use npz::{NpzReader, NpzWriter, read_npz, write_npz, write_npz_by};
pub use unfinished::{Unfinished, Writing, abandon};

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
