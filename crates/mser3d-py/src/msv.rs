//! Maximally stable volumes of grey values.

use mser3d_cli::MsvArgs;
use mser3d_results::VolumeFile;
use numpy::{PyArrayMethods, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{affine, flat, volume};
use crate::detect::ARRAY;
use crate::errors::{exception, usage};
use crate::options::parse;
use crate::run::{Call, run};

/// A volume that is an array: its lengths, its channels, its numbers x fastest; and a map to the world.
type Given<'py> = ([usize; 3], usize, Bound<'py, PyAny>, Option<PyReadonlyArray2<'py, f64>>);

/// The regions of a volume from a file or an array: `msv.json` as text, for each search the smallest region of each voxel
/// (indexed [search, x, y, z]; -1 for none), and what reading it said. `save` is a folder to write.
#[pyfunction]
#[pyo3(signature = (path, given, keywords, save=None))]
pub fn msv<'py>(
    py: Python<'py>,
    path: Option<std::path::PathBuf>,
    given: Option<Given<'py>>,
    keywords: &Bound<'_, PyDict>,
    save: Option<std::path::PathBuf>,
) -> PyResult<(String, Bound<'py, PyAny>, Vec<String>)> {
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
    let (found, notes) = run(py, &Call { progress: None, threads: None }, move |_| {
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
        Ok((found, notes))
    })?;
    let json = serde_json::to_string(&found.record).map_err(|e| exception(usage(e)))?;
    let [nx, ny, nz] = found.record.dims;
    let mut labels = Vec::with_capacity(found.labels.len() * nx * ny * nz);
    for search in &found.labels {
        for place in 0..nx * ny * nz {
            let [i, j, k] = [place / (ny * nz), place / nz % ny, place % nz];
            labels.push(search[(k * ny + j) * nx + i].map_or(-1, |label| label as i32));
        }
    }
    let labels = flat(py, labels).reshape([found.labels.len(), nx, ny, nz]);
    let labels = labels.map_err(|e| PyValueError::new_err(e.to_string()))?.into_any();
    Ok((json, labels, notes))
}
