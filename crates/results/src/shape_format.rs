use std::fmt;
use std::str::FromStr;

use mser3d_meshio::MeshFormat;
use mser3d_shape::InvalidParameter;
use mser3d_volumeio::VolumeFormat;

/// A file format of shapes.
///
/// ```
/// use mser3d_results::ShapeFormat;
/// use mser3d_volumeio::VolumeFormat;
/// assert_eq!("nifti".parse(), Ok(ShapeFormat::Volume(VolumeFormat::Nifti)));
/// assert_eq!("ply".parse::<ShapeFormat>().unwrap().to_string(), "ply");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeFormat {
    /// Of meshes.
    Mesh(MeshFormat),
    /// Of volumes.
    Volume(VolumeFormat),
}

impl ShapeFormat {
    /// All formats.
    pub fn all() -> impl Iterator<Item = Self> {
        let meshes = MeshFormat::ALL.into_iter().map(Self::Mesh);
        meshes.chain(VolumeFormat::ALL.into_iter().map(Self::Volume))
    }

    /// Its name: of a mesh the ending of its files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Mesh(format) => format.extension(),
            Self::Volume(format) => format.name(),
        }
    }

    /// Their names, for messages.
    pub(crate) fn names() -> String {
        Self::all().map(Self::name).collect::<Vec<_>>().join(", ")
    }
}

impl fmt::Display for ShapeFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for ShapeFormat {
    type Err = InvalidParameter;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let found = Self::all().find(|format| format.name() == text);
        found.ok_or_else(|| InvalidParameter::new("format", text, Self::names()))
    }
}
