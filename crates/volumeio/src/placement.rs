//! Where a volume lies, when the user knows better than the file.
use crate::error::Fault;
use crate::{LoadedVolume, VolumeIoError};
use mser3d_fileio::{NpyValues, ReadLimits, read_bytes_within, read_npy};
use mser3d_shape::{Affine, InvalidParameter, ShapeError};
use std::path::Path;

/// Parameters of [`LoadedVolume::placed`]: what stands in place of what the file says. Nothing of it is needed for a file that
/// says where its voxels lie.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PlacementParameters {
    /// Distance of neighbouring voxels along each axis of the array, in length. The directions stay.
    pub spacing: Option<[f64; 3]>,
    /// Centre of the first voxel, in length.
    pub origin: Option<[f64; 3]>,
    /// The whole map from voxels to the world, in place of both.
    pub affine: Option<Affine>,
}

impl PlacementParameters {
    /// Checks each value.
    ///
    /// # Errors
    /// [`InvalidParameter`], naming the parameter.
    pub fn validate(&self) -> Result<(), InvalidParameter> {
        if let Some(spacing) = self.spacing {
            let good = spacing.iter().all(|h| h.is_finite() && *h > 0.0);
            InvalidParameter::unless(good, "spacing", format!("{spacing:?}"), "three positive lengths")?;
        }
        if let Some(origin) = self.origin {
            let good = origin.iter().all(|x| x.is_finite());
            InvalidParameter::unless(good, "origin", format!("{origin:?}"), "three finite coordinates")?;
        }
        let both = self.affine.is_some() && (self.spacing.is_some() || self.origin.is_some());
        InvalidParameter::unless(!both, "affine", "given with spacing or origin", "given alone")
    }
}

impl LoadedVolume {
    /// The same volume, placed by the user. What the file said otherwise is noted.
    ///
    /// # Errors
    /// [`ShapeError::BadAffine`].
    pub fn placed(mut self, parameters: &PlacementParameters) -> Result<Self, ShapeError> {
        let before = *self.volume.affine();
        let after = match *parameters {
            PlacementParameters { affine: Some(affine), .. } => affine,
            PlacementParameters { spacing: None, origin: None, .. } => return Ok(self),
            PlacementParameters { spacing, origin, .. } => {
                let affine = spacing.map_or(Ok(before), |spacing| before.with_spacing(spacing))?;
                origin.map_or(affine, |origin| affine.with_origin(origin))
            }
        };
        if after != before && !self.says_nothing() {
            self.notes.push(format!("placed as asked, not as the file says ({})", self.placed_by));
        }
        self.volume = self.volume.with_affine(after);
        self.placed_by = "the user".to_owned();
        Ok(self)
    }

    /// Whether the file does not say where its voxels lie.
    fn says_nothing(&self) -> bool {
        *self.volume.affine() == Affine::default()
    }
}

/// Reads a map from voxels to the world: a text file with the 4 x 4 (or first 3 x 4) numbers row by row, separated by spaces,
/// commas or line ends, or a `.npy` array of them.
///
/// # Errors
/// [`VolumeIoError::File`], [`VolumeIoError::Invalid`].
pub fn read_affine(path: &Path, limits: &ReadLimits) -> Result<Affine, VolumeIoError> {
    let invalid = |reason: String| Fault::invalid(reason).in_file(path);
    let numbers: Vec<f64> = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
        let (array, first_axis_fastest) = read_npy(path, limits)?;
        if first_axis_fastest {
            return Err(invalid("an affine is an array in C order; save np.ascontiguousarray of it".into()));
        }
        match array.values() {
            NpyValues::F64(values) => values.to_vec(),
            NpyValues::F32(values) => values.iter().map(|&x| x.into()).collect(),
            _ => return Err(invalid("an affine is an array of floating-point numbers".into())),
        }
    } else {
        let bytes = read_bytes_within(path, limits, 2)?;
        let text = String::from_utf8_lossy(&bytes);
        let text = text.trim_start_matches('\u{feff}');
        let words = text
            .lines()
            .filter(|line| !line.trim_start().starts_with('#'))
            .flat_map(|line| line.split([' ', '\t', ',', ';', '[', ']', '\r']));
        let number = |word: &str| word.parse().map_err(|_| invalid(format!("{word:?} is not a number")));
        words.filter(|word| !word.is_empty()).map(number).collect::<Result<_, _>>()?
    };
    let rows: [[f64; 4]; 3] = match (numbers.len(), numbers.as_chunks::<4>().0) {
        (12, &[x, y, z]) | (16, &[x, y, z, [0.0, 0.0, 0.0, 1.0]]) => [x, y, z],
        (16, _) => return Err(invalid("the last row of a voxel-to-world affine is 0 0 0 1".into())),
        (n, _) => return Err(invalid(format!("{n} numbers; a voxel-to-world affine has 4 x 4"))),
    };
    Affine::new(rows).map_err(|e| invalid(e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn affines_are_read_from_text_and_arrays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        let expected = Affine::new([[-2., 0., 0., 90.], [0., 2., 0., -126.], [0., 0., 3., 1e-3]]).unwrap();
        for text in [
            "-2 0 0 90\n0 2 0 -126\n0 0 3 1e-3\n0 0 0 1\n",
            "# made by hand\n[[-2, 0, 0, 90],\r\n [0, 2, 0, -126],\r\n [0, 0, 3, .001]]",
        ] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(read_affine(&path, &ReadLimits::default()).unwrap(), expected);
        }
        for (text, says) in [
            ("1 0 0 0 0 1 0 0 0 0 1", "11 numbers"),
            ("1 0 0 0 0 1 0 0 0 0 1 x", "\"x\" is not a number"),
            ("1 0 0 0 0 1 0 0 0 0 1 0 0 0 1 1", "last row"),
            ("1 0 0 0 0 1 0 0 0 0 0 0", "no length"),
        ] {
            std::fs::write(&path, text).unwrap();
            let error = read_affine(&path, &ReadLimits::default()).unwrap_err().to_string();
            assert!(error.contains(says), "{error}");
        }
    }
}
