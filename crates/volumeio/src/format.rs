use crate::error::Fault;
use crate::{LoadedVolume, VolumeIoError, nifti, npy, nrrd, tiff};
use std::fmt;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// A file format of volumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VolumeFormat {
    /// NumPy's `.npy`.
    Npy,
    /// NIfTI, `.nii` or `.nii.gz`.
    Nifti,
    /// NRRD with its data in the same file, `.nrrd`.
    Nrrd,
    /// TIFF with a page for each layer, `.tif` or `.tiff`.
    Tiff,
}

impl VolumeFormat {
    /// The known extensions.
    pub const LIST: &'static str = ".npy, .nii, .nii.gz, .nrrd, .tif and .tiff";

    /// The format that a file's name promises, if any.
    ///
    /// ```
    /// use mser3d_volumeio::VolumeFormat;
    /// assert_eq!(VolumeFormat::of("brain.nii.GZ".as_ref()), Some(VolumeFormat::Nifti));
    /// assert_eq!(VolumeFormat::of("mesh.obj".as_ref()), None);
    /// ```
    pub fn of(path: &Path) -> Option<Self> {
        let name = path.file_name()?.to_string_lossy().to_ascii_lowercase();
        let known = [
            (".npy", Self::Npy),
            (".nii", Self::Nifti),
            (".nii.gz", Self::Nifti),
            (".nrrd", Self::Nrrd),
            (".tif", Self::Tiff),
            (".tiff", Self::Tiff),
        ];
        known.into_iter().find(|(extension, _)| name.ends_with(extension)).map(|(_, format)| format)
    }
}

impl fmt::Display for VolumeFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Npy => "npy",
            Self::Nifti => "nifti",
            Self::Nrrd => "nrrd",
            Self::Tiff => "tiff",
        })
    }
}

/// Reads a volume from a file; its name says the format.
///
/// # Errors
/// [`VolumeIoError::File`], [`VolumeIoError::UnknownFormat`], [`VolumeIoError::Invalid`],
/// [`VolumeIoError::Unsupported`].
pub fn read_volume(path: &Path) -> Result<LoadedVolume, VolumeIoError> {
    let format =
        VolumeFormat::of(path).ok_or_else(|| VolumeIoError::UnknownFormat { path: path.to_path_buf() })?;
    let open = || Ok::<_, Fault>(BufReader::new(File::open(path).map_err(Fault::Io)?));
    let read = || match format {
        VolumeFormat::Nrrd => nrrd::read(open()?),
        VolumeFormat::Tiff => tiff::read(open()?),
        VolumeFormat::Npy => npy::read(open()?),
        VolumeFormat::Nifti => nifti::read(open()?),
    };
    read().map_err(|fault| fault.in_file(path))
}
