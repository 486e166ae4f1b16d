//! `detect` and `detect_volume`: a shape from a file or from arrays, its regions as a [`Found`].

use std::path::{Path, PathBuf};

use mser3d_cli::{CliError, DetectArgs};
use mser3d_results::{Extra, FieldFile, ShapeFile, ShapeOptions, VolumeFile};
use mser3d_volumeio::{LabelName, Volume};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{affine, mesh, volume};
use crate::errors::exception;
use crate::options::parse;
use crate::result::Found;
use crate::run::{Call, Told, run};

/// How a shape that was given as arrays is called.
pub const ARRAY: &str = "array";

/// A mesh or a path.
#[derive(FromPyObject)]
pub enum Source<'py> {
    Mesh(PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, i64>),
    Path(PathBuf),
}

/// A weight from an array: its shape, and its values in C order.
type Weight<'py> = Option<(Vec<usize>, PyReadonlyArray1<'py, f64>)>;

fn field(weight: &Weight<'_>, args: &DetectArgs) -> PyResult<Option<FieldFile>> {
    match weight {
        None => args.field().map_err(exception),
        Some((shape, values)) => {
            let values = values.as_slice()?.to_vec();
            Ok(Some(FieldFile::of_values(shape, values, Path::new(ARRAY))))
        }
    }
}

/// What is known of a volume beside its options.
fn placed(
    args: &DetectArgs,
    map: Option<PyReadonlyArray2<'_, f64>>,
    names: Vec<(i64, String)>,
) -> PyResult<ShapeOptions> {
    let mut options = args.shape_options().map_err(exception)?;
    if let Some(map) = map {
        options.placement.affine = Some(affine(&map)?);
        let placement = options.placement.validate();
        placement.map_err(|e| exception(CliError::Usage(format!("wrong parameter: {e}"))))?;
    }
    if !names.is_empty() {
        options.label_names = names.into_iter().map(|(value, name)| LabelName { value, name }).collect();
    }
    Ok(options)
}

fn find(
    args: &DetectArgs,
    file: &ShapeFile,
    field: Option<&FieldFile>,
    told: &Told,
) -> Result<Found, CliError> {
    args.check(file)?;
    let (features, results) =
        args.find(file, field, &[Extra::Eigenfunctions], &|p| told.report(p), &|what| told.warn(what))?;
    Ok(Found::new(results.with_trees(&features)?, told.warnings()))
}

fn refuse_all_labels(args: &DetectArgs) -> PyResult<()> {
    if !args.all_labels() {
        return Ok(());
    }
    let why = "label='all' makes many shapes; call detect for each label, or run `mser3d detect --label all`";
    Err(exception(CliError::Usage(why.into())))
}

/// The regions of a mesh, or of a file.
#[pyfunction]
#[pyo3(signature = (source, keywords, weight=None, affine=None, names=Vec::new(), progress=None))]
pub fn detect(
    py: Python<'_>,
    source: Source<'_>,
    keywords: &Bound<'_, PyDict>,
    weight: Weight<'_>,
    affine: Option<PyReadonlyArray2<'_, f64>>,
    names: Vec<(i64, String)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let path = match &source {
        Source::Path(path) => path.clone(),
        Source::Mesh(..) => ARRAY.into(),
    };
    let args: DetectArgs = parse("detect", keywords, &[path.clone().into()])?;
    refuse_all_labels(&args)?;
    let field = field(&weight, &args)?;
    let options = placed(&args, affine, names)?;
    let call = Call { progress, threads: args.threads().map_err(exception)? };
    let given = match source {
        Source::Path(_) => None,
        Source::Mesh(vertices, faces) => Some(mesh(&vertices, &faces)?),
    };
    run(py, &call, move |told| {
        let file = match given {
            Some(mesh) => ShapeFile::of_mesh(mesh, ARRAY, &options)?,
            None => ShapeFile::read(&path, &options)?,
        };
        find(&args, &file, field.as_ref(), told)
    })
}

/// The regions of the body in a volume that is an array, x fastest.
#[pyfunction]
#[pyo3(signature = (dims, channels, array, keywords, weight=None, affine=None, names=Vec::new(), progress=None))]
#[allow(clippy::too_many_arguments)]
pub fn detect_volume(
    py: Python<'_>,
    dims: [usize; 3],
    channels: usize,
    array: &Bound<'_, PyAny>,
    keywords: &Bound<'_, PyDict>,
    weight: Weight<'_>,
    affine: Option<PyReadonlyArray2<'_, f64>>,
    names: Vec<(i64, String)>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Found> {
    let args: DetectArgs = parse("detect", keywords, &[ARRAY.into()])?;
    refuse_all_labels(&args)?;
    let field = field(&weight, &args)?;
    let options = placed(&args, affine, names)?;
    let volume: Volume = volume(dims, channels, array)?;
    let call = Call { progress, threads: args.threads().map_err(exception)? };
    run(py, &call, move |told| {
        let file = VolumeFile::of_volume(volume, ARRAY, &options)?.shape(&options.body)?;
        find(&args, &file, field.as_ref(), told)
    })
}
