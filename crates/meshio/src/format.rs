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
    /// VTK's unstructured grid in XML: cells of solids or polygons.
    Vtu,
    /// VTK's polygons in XML.
    Vtp,
    /// VTK's older files, with an unstructured grid or polygons.
    Vtk,
    /// Gmsh's mesh, versions 2 and 4: cells of solids or polygons.
    Msh,
    /// Medit's mesh, ASCII: cells of solids or polygons.
    Medit,
}

impl MeshFormat {
    /// Every format.
    pub const ALL: [Self; 11] = [
        Self::Obj,
        Self::Gltf,
        Self::Glb,
        Self::Off,
        Self::Ply,
        Self::Stl,
        Self::Vtu,
        Self::Vtp,
        Self::Vtk,
        Self::Msh,
        Self::Medit,
    ];

    /// The extensions of all formats, for messages. Each may be followed by `.gz`.
    pub const LIST: &str = ".obj, .gltf, .glb, .off, .ply, .stl, .vtu, .vtp, .vtk, .msh and .mesh";

    /// The extension of its files, lower case, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
            Self::Off => "off",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Vtu => "vtu",
            Self::Vtp => "vtp",
            Self::Vtk => "vtk",
            Self::Msh => "msh",
            Self::Medit => "mesh",
        }
    }

    /// Bytes of memory that reading takes for each byte of a file, at most: the file itself, and what is made of it. Measured
    /// on large files whose numbers have a digit each, which are the worst.
    pub(crate) fn memory_per_byte(self) -> u64 {
        match self {
            // Their arrays are counted one by one.
            Self::Gltf | Self::Glb => 1,
            Self::Obj => 15,
            Self::Ply => 12,
            Self::Stl | Self::Vtk => 10,
            Self::Off | Self::Vtu | Self::Vtp | Self::Msh | Self::Medit => 8,
        }
    }

    /// The format that a file's extension names, upper or lower case; of `.off.gz` and the like, the inner one.
    pub fn from_extension(path: &Path) -> Option<Self> {
        let inner = path.file_stem().map(Path::new).filter(|_| Self::is_named_packed(path));
        let extension = inner.unwrap_or(path).extension()?.to_str()?;
        Self::ALL.into_iter().find(|f| f.extension().eq_ignore_ascii_case(extension))
    }

    /// Whether a file's name ends in `.gz`.
    pub(crate) fn is_named_packed(path: &Path) -> bool {
        path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"))
    }

    /// The format that the contents show beyond doubt, if any: most begin with a word of their own. Contents
    /// packed by gzip are looked into.
    pub fn from_contents(bytes: &[u8]) -> Option<Self> {
        let (bytes, length) = crate::gzip::peek(bytes);
        if bytes.starts_with(b"glTF") {
            return Some(Self::Glb);
        }
        // A binary STL may begin with anything, even with another format's word; its size tells.
        if crate::stl::is_binary(&bytes, length) {
            return Some(Self::Stl);
        }
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&bytes).trim_ascii_start();
        let word = text.split(|b| b.is_ascii_whitespace()).next().unwrap_or_default();
        match word {
            b"ply" => Some(Self::Ply),
            _ if word.eq_ignore_ascii_case(b"solid") => Some(Self::Stl),
            _ if word.starts_with(b"{") => Some(Self::Gltf),
            _ if crate::off::is_header(word) => Some(Self::Off),
            b"v" | b"vn" | b"vt" | b"mtllib" | b"usemtl" | b"o" | b"g" | b"f" => Some(Self::Obj),
            b"$MeshFormat" | b"$NOD" | b"$Comments" => Some(Self::Msh),
            crate::medit::HEADER => Some(Self::Medit),
            _ if text.starts_with(crate::vtk::legacy::HEADER) => Some(Self::Vtk),
            _ if text.starts_with(b"<") => match crate::vtk::xml::data_set(text)? {
                "UnstructuredGrid" => Some(Self::Vtu),
                "PolyData" => Some(Self::Vtp),
                _ => None,
            },
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
            Self::Vtu => "VTU",
            Self::Vtp => "VTP",
            Self::Vtk => "VTK",
            Self::Msh => "Gmsh",
            Self::Medit => "Medit",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_are_told_apart() {
        let cases: [(&[u8], Option<MeshFormat>); 14] = [
            (b"# comment\nv 0 0 0\n", None),
            (b"v 0 0 0\n", Some(MeshFormat::Obj)),
            (b"\n {\"asset\":{}}", Some(MeshFormat::Gltf)),
            (b"glTF\x02\0\0\0", Some(MeshFormat::Glb)),
            (b"COFF\n1 2 3", Some(MeshFormat::Off)),
            (b"ply\r\nformat", Some(MeshFormat::Ply)),
            (b"solid x", Some(MeshFormat::Stl)),
            (b"# vtk DataFile Version 3.0\n", Some(MeshFormat::Vtk)),
            (b"<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">", Some(MeshFormat::Vtu)),
            (b"<VTKFile type='PolyData'>", Some(MeshFormat::Vtp)),
            (b"<VTKFile type='ImageData'>", None),
            (b"$MeshFormat\n2.2 0 8", Some(MeshFormat::Msh)),
            (b"MeshVersionFormatted 1", Some(MeshFormat::Medit)),
            (b"", None),
        ];
        for (bytes, expected) in cases {
            assert_eq!(MeshFormat::from_contents(bytes), expected);
        }
    }

    #[test]
    fn the_extension_must_agree_with_the_contents() {
        assert_eq!(MeshFormat::of(Path::new("a.OBJ"), b"v 0 0 0").unwrap(), MeshFormat::Obj);
        assert_eq!(MeshFormat::of(Path::new("a.b.Off.GZ"), b"OFF").unwrap(), MeshFormat::Off);
        assert_eq!(MeshFormat::from_extension(Path::new("a.nii.gz")), None);
        assert_eq!(MeshFormat::from_extension(Path::new("off.gz")), None);
        let wrong = MeshFormat::of(Path::new("a.obj.gz"), b"ply\n").unwrap_err().to_string();
        assert_eq!(wrong, "a.obj.gz: named as OBJ, but its contents are PLY; rename it to .ply.gz");
        let wrong = MeshFormat::of(Path::new("a.obj"), b"ply\n").unwrap_err().to_string();
        assert_eq!(wrong, "a.obj: named as OBJ, but its contents are PLY; rename it to .ply");
        let unknown = MeshFormat::of(Path::new("a.fbx"), b"Kaydara").unwrap_err().to_string();
        assert!(unknown.contains(MeshFormat::LIST), "{unknown}");
    }
}
