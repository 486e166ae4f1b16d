use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// What a file name says of a shape: `0001.noise.3` is null shape 1 under noise of strength 3.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ShapeName {
    /// Number of the null shape.
    pub null: u32,
    /// Class of the transform; `"null"` for the null shape itself.
    pub class: String,
    /// Strength, 1 to 5; 0 for the null shape.
    pub strength: u32,
}

impl ShapeName {
    /// The name of a null shape.
    pub fn null(number: u32) -> Self {
        Self { null: number, class: "null".into(), strength: 0 }
    }

    /// Whether this is a null shape.
    pub fn is_null(&self) -> bool {
        self.class == "null"
    }

    /// The file of the mesh.
    pub fn mesh_path(&self, folder: &Path) -> PathBuf {
        folder.join(format!("{self}.off"))
    }

    /// The file of the ground truth.
    pub fn corr_path(&self, folder: &Path) -> PathBuf {
        folder.join("corr").join(format!("{self}.corr"))
    }
}

impl fmt::Display for ShapeName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}.{}.{}", self.null, self.class, self.strength)
    }
}

/// The text is not `NNNN.<class>.<strength>`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("not a shape's name, NNNN.<class>.<strength>")]
pub struct NotAShapeName;

impl FromStr for ShapeName {
    type Err = NotAShapeName;

    fn from_str(text: &str) -> Result<Self, NotAShapeName> {
        let [null, class, strength] = text.split('.').collect::<Vec<_>>()[..] else {
            return Err(NotAShapeName);
        };
        let number = |digits: &str| digits.parse().map_err(|_| NotAShapeName);
        if class.is_empty() {
            return Err(NotAShapeName);
        }
        Ok(Self { null: number(null)?, class: class.into(), strength: number(strength)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_what_the_benchmark_uses() {
        let name: ShapeName = "0001.microholes.5".parse().unwrap();
        assert_eq!(name, ShapeName { null: 1, class: "microholes".into(), strength: 5 });
        assert_eq!(name.corr_path(Path::new("d")), Path::new("d/corr/0001.microholes.5.corr"));
        assert_eq!(ShapeName::null(3).to_string(), "0003.null.0");
        for bad in ["README", "0001.noise", "0001.noise.x", "a.noise.1", "0001..1", "0001.null.0.sym"] {
            assert_eq!(bad.parse::<ShapeName>(), Err(NotAShapeName));
        }
    }
}
