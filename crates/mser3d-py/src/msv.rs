//! Maximally stable volumes of grey values.

use mser3d_cli::MsvArgs;
use mser3d_results::VolumeFile;
use mser3d_results::msv::MsvResults;
use numpy::{PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::{PyIndexError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{affine, flat, volume};
use crate::detect::ARRAY;
use crate::errors::{exception, usage};
use crate::options::parse;
use crate::run::{Call, run};

/// A volume that is an array: its lengths, its channels, its numbers x fastest; and a map to the world.
type Given<'py> = ([usize; 3], usize, Bound<'py, PyAny>, Option<PyReadonlyArray2<'py, f64>>);

/// What was found in a volume.
#[pyclass(frozen, module = "mser3d._native")]
pub struct Msv {
    found: MsvResults,
    notes: Vec<String>,
}

#[pymethods]
impl Msv {
    /// What reading the volume said.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// `msv.json` as text.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| serde_json::to_string(&self.found.record)).map_err(|e| exception(usage(e)))
    }

    /// The smallest region of each voxel, indexed [x, y, z]; -1 for none.
    fn labels<'py>(&self, py: Python<'py>, search: usize) -> PyResult<Bound<'py, PyAny>> {
        let found = self.found.labels.get(search);
        let found = found.ok_or_else(|| PyIndexError::new_err(format!("there is no search {search}")))?;
        let [nx, ny, nz] = self.found.record.dims;
        let mut labels = Vec::with_capacity(nx * ny * nz);
        for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (i, j))) {
            labels.extend((0..nz).map(|k| found[(k * ny + j) * nx + i].map_or(-1, |label| label as i32)));
        }
        let labels = flat(py, labels).reshape([nx, ny, nz]);
        Ok(labels.map_err(|e| PyValueError::new_err(e.to_string()))?.into_any())
    }
}

/// The regions of a volume from a file or an array. `save` is a folder to write.
#[pyfunction]
#[pyo3(signature = (path, given, keywords, save=None))]
pub fn msv(
    py: Python<'_>,
    path: Option<std::path::PathBuf>,
    given: Option<Given<'_>>,
    keywords: &Bound<'_, PyDict>,
    save: Option<std::path::PathBuf>,
) -> PyResult<Msv> {
    let path = path.unwrap_or_else(|| ARRAY.into());
    let args: MsvArgs = parse("msv", keywords, &[path.clone().into()])?;
    let mut options = args.shape_options().map_err(exception)?;
    let given = match given {
        None => None,
        Some((dims, channels, array, map)) => {
            if let Some(map) = map {
                options.placement.affine = Some(affine(&map)?);
            }
            Some(volume(dims, channels, &array)?)
        }
    };
    let colours = given.as_ref().is_some_and(|volume| volume.channels() > 1);
    run(py, &Call { progress: None, threads: None }, move |_| {
        let mut file = match given {
            Some(volume) => VolumeFile::of_volume(volume, ARRAY, &options)?,
            None => VolumeFile::read(&path, &options)?,
        };
        if colours && args.volume.is_none() {
            // The last axis of an array is what a voxel has, unless one of it is chosen.
            file.loaded.channels = mser3d_volumeio::ChannelKind::Colours;
        }
        let notes = file.loaded.notes.clone();
        let found = args.find(file)?;
        if let Some(folder) = save {
            found.write(&folder)?;
        }
        Ok(Msv { found, notes })
    })
}
