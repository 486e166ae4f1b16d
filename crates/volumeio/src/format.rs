use crate::error::Fault;
use crate::{LoadedVolume, VolumeIoError, bytes, metaimage, mgh, nifti, npy, nrrd, tiff};
use mser3d_fileio::ReadLimits;
use std::fmt;
use std::path::Path;

/// A file format of volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// NumPy's `.npy`.
    Npy,
    /// NIfTI, `.nii` or `.nii.gz`, or as a pair of `.hdr` and `.img`, which may also be of Analyze 7.5.
    Nifti,
    /// NRRD, `.nrrd`, or `.nhdr` with the data beside it.
    Nrrd,
    /// MetaImage, `.mha`, or `.mhd` with the data beside it.
    MetaImage,
    /// FreeSurfer's `.mgz` and `.mgh`.
    Mgh,
    /// TIFF with a page for each layer, `.tif` or `.tiff`.
    Tiff,
}

/// Endings of names, in lower case.
const ENDINGS: [(&str, VolumeFormat); 17] = [
    (".npy", VolumeFormat::Npy),
    (".nii", VolumeFormat::Nifti),
    (".nii.gz", VolumeFormat::Nifti),
    (".hdr", VolumeFormat::Nifti),
    (".hdr.gz", VolumeFormat::Nifti),
    (".img", VolumeFormat::Nifti),
    (".img.gz", VolumeFormat::Nifti),
    (".nrrd", VolumeFormat::Nrrd),
    (".nhdr", VolumeFormat::Nrrd),
    (".mha", VolumeFormat::MetaImage),
    (".mhd", VolumeFormat::MetaImage),
    (".mgz", VolumeFormat::Mgh),
    (".mgh", VolumeFormat::Mgh),
    (".mgh.gz", VolumeFormat::Mgh),
    (".tif", VolumeFormat::Tiff),
    (".tiff", VolumeFormat::Tiff),
    (".btf", VolumeFormat::Tiff),
];

impl VolumeFormat {
    /// All formats.
    pub const ALL: [Self; 6] = [Self::Npy, Self::Nifti, Self::Nrrd, Self::MetaImage, Self::Mgh, Self::Tiff];

    /// The known extensions.
    pub const LIST: &'static str =
        ".npy, .nii, .nii.gz, .hdr with .img, .nrrd, .nhdr, .mha, .mhd, .mgz, .mgh, .tif and .tiff";

    /// Its name, in lower case.
    pub fn name(self) -> &'static str {
        match self {
            Self::Npy => "npy",
            Self::Nifti => "nifti",
            Self::Nrrd => "nrrd",
            Self::MetaImage => "metaimage",
            Self::Mgh => "mgh",
            Self::Tiff => "tiff",
        }
    }

    /// The format that a file's name promises, if any.
    ///
    /// ```
    /// use mser3d_volumeio::VolumeFormat;
    /// assert_eq!(VolumeFormat::of("brain.nii.GZ".as_ref()), Some(VolumeFormat::Nifti));
    /// assert_eq!(VolumeFormat::of("mesh.obj".as_ref()), None);
    /// ```
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        ENDINGS.into_iter().find(|(ending, _)| name.ends_with(ending)).map(|(_, format)| format)
    }
}

impl fmt::Display for VolumeFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Reads a volume from a file; its name says the format.
///
/// What the file declares is compared with the limits before memory is taken for it. While it is read it takes no more
/// than twice the bytes of its values, as they are kept: NIfTI's scaled values have 8 bytes, half numbers 4.
///
/// # Errors
/// [`VolumeIoError::File`], also for a file over the limits, [`VolumeIoError::UnknownFormat`], [`VolumeIoError::Invalid`],
/// [`VolumeIoError::Unsupported`].
pub fn read_volume(path: &Path, limits: &ReadLimits) -> Result<LoadedVolume, VolumeIoError> {
    let format =
        VolumeFormat::of(path).ok_or_else(|| VolumeIoError::UnknownFormat { path: path.to_path_buf() })?;
    read_volume_as(format, path, limits)
}

/// Reads a volume from a file of this format, whatever its name.
///
/// # Errors
/// As [`read_volume`], but for the format.
pub fn read_volume_as(
    format: VolumeFormat,
    path: &Path,
    limits: &ReadLimits,
) -> Result<LoadedVolume, VolumeIoError> {
    let read = || -> Result<LoadedVolume, Fault> {
        match format {
            VolumeFormat::Npy => npy::read(bytes::open_raw(path)?, limits),
            VolumeFormat::Nifti => nifti::read(path, limits),
            VolumeFormat::Nrrd => nrrd::read(path, limits),
            VolumeFormat::MetaImage => metaimage::read(path, limits),
            VolumeFormat::Mgh => mgh::read(path, limits),
            VolumeFormat::Tiff => tiff::read(bytes::open_raw(path)?, limits),
        }
    };
    read().map_err(|fault| fault.in_file(path))
}
