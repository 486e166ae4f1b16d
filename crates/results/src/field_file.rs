use std::path::{Path, PathBuf};

use mser3d::{DiscreteShape, Error, Field, LARGEST_WEIGHT};
use mser3d_fileio::{FileError, NpyArray, NpyValues, ReadLimits, read_npy};
use mser3d_shape::VoxelGrid;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::shape_file::hex;
use crate::{ResultsError, ShapeFile};

/// A weight from a NumPy file: a number or a vector for each vertex of a mesh, or each voxel of a volume.
///
/// ```no_run
/// use mser3d::{Detector, Domain, Parameters};
/// use mser3d_results::{FieldFile, Results, ShapeFile};
///
/// let file = ShapeFile::read("hand.off".as_ref(), &Default::default())?;
/// let field = FieldFile::read("thickness.npy".as_ref(), &Default::default())?;
/// let values = field.on(&file)?;
/// let detector = Detector::new(Parameters::default()).with_weight(&values);
/// let mut results = Results::of_file(&detector.detect(file.input(Domain::Volume)?)?, &file)?;
/// results.record.field = Some(field.record().clone());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FieldFile {
    path: PathBuf,
    record: FieldRecord,
    /// In C order.
    values: Vec<f64>,
}

/// What a record says of a weight that came from a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct FieldRecord {
    /// The file.
    pub path: String,
    /// Lengths of the array's axes.
    pub shape: Vec<usize>,
    /// SHA-256 of the values as numbers of 64 bits in C order, little-endian: what the array held, whatever its type.
    pub sha256: String,
}

impl FieldFile {
    /// Reads an array of numbers, as `numpy.save` writes them.
    ///
    /// # Errors
    /// [`ResultsError::File`] for files that are none, are damaged, hold no real numbers, or are over the limits.
    pub fn read(path: &Path, limits: &ReadLimits) -> Result<Self, ResultsError> {
        let (array, first_axis_fastest) = read_npy(path, limits)?;
        // As they are, as numbers of 64 bits, and in the other order.
        let needed = 24 * array.values().len() as u64;
        let what = || format!("it holds {} numbers", array.values().len());
        let over = |source| FileError::OverLimit { path: path.to_owned(), source };
        limits.check_memory(needed, what).map_err(over)?;
        Ok(Self::of_values(array.shape(), in_c_order(&array, first_axis_fastest), path))
    }

    /// An array that is in memory, with its values in C order; `name` tells people where it came from. Values that do not
    /// fit the shape are refused by [`FieldFile::on`].
    pub fn of_values(shape: &[usize], values: Vec<f64>, name: &Path) -> Self {
        let mut hash = Sha256::new();
        values.iter().for_each(|x| hash.update(x.to_le_bytes()));
        let path = name.display().to_string();
        let record = FieldRecord { path, shape: shape.to_vec(), sha256: hex(hash.finalize()) };
        Self { path: name.to_owned(), record, values }
    }

    /// What a record says of it.
    pub fn record(&self) -> &FieldRecord {
        &self.record
    }

    /// The weight of a file's shape, as [`Detector::with_weight`](mser3d::Detector::with_weight) takes it.
    ///
    /// A mesh of n vertices needs an array of the shape (n) or, for vectors of d numbers, (n, d), in the order of the file; of
    /// files that repeat vertices (STL, glTF), n may also be the number of the vertices in the file, of which those at one
    /// position give their mean. It is [carried](DiscreteShape::carry) to what is searched. A volume needs the volume's shape, (x, y, z) or
    /// (x, y, z, d); only voxels of the body have to have values.
    ///
    /// # Errors
    /// [`ResultsError::Field`] for an array of another shape, or with values that are no weights.
    pub fn on<'a>(
        &'a self,
        file: &'a ShapeFile,
    ) -> Result<impl Fn(&DiscreteShape) -> Result<Field, Error> + Sync + use<'a>, ResultsError> {
        let weld = file.loaded().and_then(|loaded| loaded.weld.as_deref());
        let of_mesh = file.mesh().map(|mesh| self.of_vertices(mesh.vertices().len(), weld));
        let of_mesh = of_mesh.transpose()?;
        if let Some(solid) = file.solid() {
            self.width_on_volume(solid.grid.frame().dims())?;
        }
        Ok(move |shape: &DiscreteShape| match (&of_mesh, shape.grid()) {
            (Some(field), _) => shape.carry(field),
            (None, Some(grid)) => self.of_voxels(grid),
            (None, None) => Err(Error::NoMesh),
        })
    }

    fn wrong(&self, reason: String) -> ResultsError {
        ResultsError::Field { path: self.path.clone(), reason }
    }

    /// How many numbers a vector has after axes of these lengths; none for numbers.
    fn width_after(&self, axes: &[usize]) -> Option<Option<usize>> {
        match self.record.shape.strip_prefix(axes)? {
            [] => Some(None),
            &[width] if width > 0 => Some(Some(width)),
            _ => None,
        }
    }

    fn of_vertices(&self, vertices: usize, weld: Option<&[u32]>) -> Result<Field, ResultsError> {
        let in_file = weld.map_or(vertices, <[u32]>::len);
        let found = [vertices, in_file].into_iter().find_map(|n| Some((n, self.width_after(&[n])?)));
        let Some((count, width)) = found else {
            let repeated = if in_file == vertices {
                String::new()
            } else {
                format!(" (or {in_file}, those of the file, in place of {vertices})")
            };
            return Err(self.wrong(format!(
                "an array of shape {} is no weight of this mesh; its vertices need ({vertices},), or ({vertices}, d) for \
                 vectors{repeated}",
                tuple(&self.record.shape)
            )));
        };
        let numbers = width.unwrap_or(1);
        let values = match weld {
            Some(weld) if count == in_file && in_file != vertices => {
                means(&self.values, numbers, vertices, weld)
            }
            _ => self.values.clone(),
        };
        let field = match width {
            None => Field::scalar(values),
            Some(width) => Field::vectors(width, values),
        };
        field.map_err(|error| self.wrong(error.to_string()))
    }

    fn width_on_volume(&self, dims: [usize; 3]) -> Result<Option<usize>, ResultsError> {
        let [nx, ny, nz] = dims;
        let flat = || if nz == 1 { self.width_after(&[nx, ny]) } else { None };
        self.width_after(&dims).or_else(flat).ok_or_else(|| {
            self.wrong(format!(
                "an array of shape {} is no weight of this volume; its voxels need ({nx}, {ny}, {nz}), or ({nx}, {ny}, {nz}, d) \
                 for vectors",
                tuple(&self.record.shape)
            ))
        })
    }

    fn of_voxels(&self, grid: &VoxelGrid) -> Result<Field, Error> {
        let [nx, ny, nz] = grid.frame().dims();
        let width = self.values.len() / (nx * ny * nz).max(1);
        let vectors = self.record.shape.len() > 3 || nz == 1 && self.record.shape == [nx, ny, width];
        let mut values = Vec::with_capacity(grid.len() * width);
        for [i, j, k] in grid.voxels() {
            let place = (i as usize * ny + j as usize) * nz + k as usize;
            let own = self.values.get(place * width..(place + 1) * width).unwrap_or_default();
            if let Some(&value) = own.iter().find(|x| x.is_nan() || x.abs() > LARGEST_WEIGHT) {
                let place = format!("voxel ({i}, {j}, {k}) of {}", self.path.display());
                return Err(Error::FieldValue { place, value });
            }
            values.extend_from_slice(own);
        }
        if vectors { Field::vectors(width, values) } else { Field::scalar(values) }
    }
}

/// A shape as Python writes it.
fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => format!("({})", shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

/// The mean over the file's vertices that are one of the mesh's.
fn means(values: &[f64], width: usize, vertices: usize, weld: &[u32]) -> Vec<f64> {
    let (mut sums, mut counts) = (vec![0.0; vertices * width], vec![0u32; vertices]);
    for (own, &vertex) in values.chunks_exact(width).zip(weld) {
        let vertex = vertex as usize;
        counts[vertex] += 1;
        sums[vertex * width..][..width].iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
    }
    let mean = |(i, sum): (usize, f64)| sum / f64::from(counts[i / width].max(1));
    sums.into_iter().enumerate().map(mean).collect()
}

fn in_c_order(array: &NpyArray, first_axis_fastest: bool) -> Vec<f64> {
    let values = numbers(array.values());
    if !first_axis_fastest {
        return values;
    }
    let shape = array.shape();
    let place = |mut number: usize| {
        // From the last axis, the fastest in C order, to the first, the fastest in the file.
        let (mut place, mut stride) = (0, values.len());
        for &n in shape.iter().rev() {
            stride /= n;
            place += number % n * stride;
            number /= n;
        }
        place
    };
    (0..values.len()).map(|number| values[place(number)]).collect()
}

fn numbers(values: &NpyValues) -> Vec<f64> {
    macro_rules! as_f64 {
        ($($variant:ident),*) => {
            match values {
                $(NpyValues::$variant(values) => values.iter().map(|&x| x as f64).collect(),)*
                // What the reader learns to read one day, this has to learn too.
                _ => vec![f64::NAN; values.len()],
            }
        };
    }
    as_f64!(U8, I8, U16, I16, I32, U32, I64, F32, F64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fortran_order_is_turned() {
        // [[0, 1, 2], [3, 4, 5]] as the file has it.
        let array = NpyArray::new(&[2, 3], vec![0i32, 3, 1, 4, 2, 5]).unwrap();
        assert_eq!(in_c_order(&array, true), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(in_c_order(&array, false)[1], 3.0);
    }

    #[test]
    fn vertices_at_one_position_give_their_mean() {
        assert_eq!(means(&[1.0, 10.0, 2.0, 20.0, 5.0, 30.0], 2, 2, &[0, 1, 0]), [3.0, 20.0, 2.0, 20.0]);
    }

    #[test]
    fn shapes_are_written_as_in_python() {
        assert_eq!([tuple(&[]), tuple(&[4]), tuple(&[4, 3])], ["()", "(4,)", "(4, 3)"]);
    }
}
