//! Grey-value volumes, label maps and masks from files and back: NumPy, NIfTI, NRRD, MetaImage, FreeSurfer, TIFF.
//!
//! A [`Volume`] is a box of voxels, x fastest, each with one value or with several channels, and an
//! [`Affine`] that says where it lies. [`read_volume`] takes the format from the file's name, and tells what
//! the file says of it in a [`LoadedVolume`]: what its channels are, what the axes of its world are, which statement
//! placed it, what its labels are called, and what was guessed or left out. [`LoadedVolume::body`] says which voxels are the
//! body, by one rule for all formats.
//!
//! | format | read | written |
//! |---|---|---|
//! | NumPy `.npy` | `array[x, y]`, `[x, y, z]` or `[x, y, z, channel]`, all numbers, both orders | the same |
//! | NIfTI `.nii`, `.nii.gz` | versions 1 and 2, both byte orders, scaled values | the same |
//! | `.hdr` with `.img` | NIfTI pairs and Analyze 7.5 | no |
//! | NRRD `.nrrd`, `.nhdr` | every encoding, data in the file, beside it or in many | no |
//! | MetaImage `.mha`, `.mhd` | the same | no |
//! | FreeSurfer `.mgh`, `.mgz` | all types, frames | no |
//! | TIFF `.tif`, `.tiff` | a page for each z; uncompressed, LZW, Deflate, PackBits, fax | no |
//!
//! ```
//! use mser3d_volumeio::{Affine, Samples, Volume, read_volume, write_nifti};
//!
//! let affine = Affine::along_axes([10.0, 0.0, -5.0], [0.5, 0.5, 2.0])?;
//! let volume = Volume::new([2, 2, 1], 1, affine, Samples::U8(vec![0, 7, 0, 255]))?;
//! # let folder = std::env::temp_dir().join(format!("mser3d-volumeio-{}", std::process::id()));
//! # std::fs::create_dir_all(&folder)?;
//! let path = folder.join("small.nii.gz");
//! write_nifti(&path, &volume)?;
//! assert_eq!(read_volume(&path, &Default::default())?.volume, volume);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![warn(missing_docs)]

mod body;
mod bytes;
mod error;
mod format;
mod half;
mod label_names;
mod loaded;
mod metaimage;
mod mgh;
mod nifti;
mod npy;
mod nrrd;
mod placement;
mod sample_type;
mod samples;
mod text_values;
mod tiff;
mod values;
mod volume;

pub use body::{Body, BodyError, BodyParameters, Label, LabelCount};
pub use error::VolumeIoError;
pub use format::{VolumeFormat, read_volume, read_volume_as};
pub use label_names::{LabelName, read_label_names};
pub use loaded::{ChannelKind, LoadedVolume, Segment, World, WorldAxes};
pub use mser3d_shape::Affine;
pub use nifti::{write_nifti, write_nifti_in};
pub use npy::write_npy;
pub use placement::{PlacementParameters, read_affine};
pub use samples::Samples;
pub use values::{ValueCounts, ValueKind};
pub use volume::Volume;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
