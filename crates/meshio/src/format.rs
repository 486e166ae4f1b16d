use crate::MeshIoError;
use std::fmt;
use std::path::Path;

/// The mesh file formats that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// glTF 2.0 as JSON, with buffers beside or inside it.
    Gltf,
    /// glTF 2.0 in one binary file.
    Glb,
    /// Geomview's Object File Format, ASCII, with or without normals and colours.
    Off,
    /// Stanford's polygon file format, ASCII or binary of either byte order.
    Ply,
    /// Stereolithography triangles, ASCII or binary.
    Stl,
}

impl MeshFormat {
    /// Every format.
    pub const ALL: [Self; 6] = [Self::Obj, Self::Gltf, Self::Glb, Self::Off, Self::Ply, Self::Stl];

    pub(crate) const LIST: &str = ".obj, .gltf, .glb, .off, .ply and .stl";

    /// The extension of its files, lower case, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Off => "off",
            Self::Ply => "ply",
            Self::Stl => "stl",
        }
    }

    /// The format that a file's extension names, upper or lower case.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?;
        Self::ALL.into_iter().find(|f| f.extension().eq_ignore_ascii_case(extension))
    }

    /// The format that the contents show beyond doubt, if any: most begin with a word of their own.
    pub fn from_contents(bytes: &[u8]) -> Option<Self> {
        if bytes.starts_with(b"glTF") {
            return Some(Self::Glb);
        }
        // A binary STL may begin with anything, even with another format's word; its size tells.
        if crate::stl::is_binary(bytes) {
            return Some(Self::Stl);
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
        let word = text.split(|b| b.is_ascii_whitespace()).next().unwrap_or_default();
        match word {
            b"ply" => Some(Self::Ply),
            _ if word.eq_ignore_ascii_case(b"solid") => Some(Self::Stl),
            _ if word.starts_with(b"{") => Some(Self::Gltf),
            _ if crate::off::is_header(word) => Some(Self::Off),
            b"v" | b"vn" | b"vt" | b"mtllib" | b"usemtl" | b"o" | b"g" | b"f" => Some(Self::Obj),
            _ => None,
        }
    }

    /// The format of a file by its extension, checked against its contents.
    ///
    /// # Errors
    /// [`MeshIoError::UnknownFormat`] or [`MeshIoError::WrongExtension`].
    pub fn of(path: &Path, bytes: &[u8]) -> Result<Self, MeshIoError> {
        let contents = Self::from_contents(bytes);
        let Some(extension) = Self::from_extension(path) else {
            return Err(MeshIoError::UnknownFormat { path: path.to_path_buf(), contents });
        };
        match contents {
            Some(contents) if contents != extension => {
                Err(MeshIoError::WrongExtension { path: path.to_path_buf(), extension, contents })
            }
            _ => Ok(extension),
        }
    }
}

impl fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Gltf => "glTF",
            Self::Glb => "GLB",
            Self::Off => "OFF",
            Self::Ply => "PLY",
            Self::Stl => "STL",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_told_apart() {
        let cases: [(&[u8], Option<MeshFormat>); 8] = [
            (b"# comment\nv 0 0 0\n", None),
            (b"v 0 0 0\n", Some(MeshFormat::Obj)),
            (b"\n {\"asset\":{}}", Some(MeshFormat::Gltf)),
            (b"glTF\x02\0\0\0", Some(MeshFormat::Glb)),
            (b"COFF\n1 2 3", Some(MeshFormat::Off)),
            (b"ply\r\nformat", Some(MeshFormat::Ply)),
            (b"solid x", Some(MeshFormat::Stl)),
            (b"", None),
        ];
        for (bytes, expected) in cases {
            assert_eq!(MeshFormat::from_contents(bytes), expected);
        }
    }

    #[test]
    fn the_extension_must_agree_with_the_contents() {
        assert_eq!(MeshFormat::of(Path::new("a.OBJ"), b"v 0 0 0").unwrap(), MeshFormat::Obj);
        let wrong = MeshFormat::of(Path::new("a.obj"), b"ply\n").unwrap_err().to_string();
        assert_eq!(wrong, "a.obj: named as OBJ, but its contents are PLY; rename it to .ply");
        let unknown = MeshFormat::of(Path::new("a.fbx"), b"Kaydara").unwrap_err().to_string();
        assert!(unknown.contains(MeshFormat::LIST), "{unknown}");
    }
}
