//! Between NumPy's arrays and the libraries' types. The Python half has checked types and axes; what depends on values is
//! checked here.

use mser3d::shape::{Affine, Eigenbasis, FunctionsView, TriangleMesh};
use mser3d_volumeio::{Samples, Volume};
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// Wrong values of an argument.
pub fn wrong(argument: &str, reason: impl std::fmt::Display) -> PyErr {
    PyValueError::new_err(format!("{argument}: {reason}"))
}

/// Rows of three numbers.
pub fn triples(argument: &str, array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<[f64; 3]>> {
    let values = array.as_slice().map_err(|e| wrong(argument, e))?;
    let rows = values.as_chunks::<3>().0;
    if let Some(row) = rows.iter().position(|row| row.iter().any(|x| !x.is_finite())) {
        let values = rows[row];
        return Err(wrong(argument, format!("row {row} is {values:?}; coordinates must be finite")));
    }
    Ok(rows.to_vec())
}

/// Rows of numbers of vertices, of which there are `count`.
pub fn indices<const N: usize>(
    argument: &str,
    array: &PyReadonlyArray2<'_, i64>,
    count: usize,
) -> PyResult<Vec<[u32; N]>> {
    let values = array.as_slice().map_err(|e| wrong(argument, e))?;
    let mut rows = Vec::with_capacity(values.len() / N);
    for (number, row) in values.as_chunks::<N>().0.iter().enumerate() {
        let mut indices = [0; N];
        for (index, &value) in indices.iter_mut().zip(row) {
            let known = u32::try_from(value).ok().filter(|&v| (v as usize) < count);
            *index = known.ok_or_else(|| {
                wrong(
                    argument,
                    format!("row {number} names vertex {value}; there are {count}, numbered from 0"),
                )
            })?;
        }
        rows.push(indices);
    }
    Ok(rows)
}

/// A mesh from its arrays.
pub fn mesh(
    vertices: &PyReadonlyArray2<'_, f64>,
    faces: &PyReadonlyArray2<'_, i64>,
) -> PyResult<TriangleMesh> {
    let vertices = triples("vertices", vertices)?;
    let triangles = indices("faces", faces, vertices.len())?;
    TriangleMesh::new(vertices, triangles).map_err(|e| wrong("vertices", e))
}

/// A map from voxels to the world.
pub fn affine(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Affine> {
    let values = array.as_slice().map_err(|e| wrong("affine", e))?;
    let rows = values.as_chunks::<4>().0;
    if rows.len() != 4 || rows[3] != [0.0, 0.0, 0.0, 1.0] {
        return Err(wrong("affine", "must be 4 x 4 with the last row 0, 0, 0, 1"));
    }
    Affine::new([rows[0], rows[1], rows[2]]).map_err(|e| wrong("affine", e))
}

/// Does something with the numbers of an array of one axis, whatever their type.
#[macro_export]
macro_rules! with_numbers {
    ($array:expr, $values:ident => $action:expr, [$($type:ty),*]) => {{
        let array: &pyo3::Bound<'_, pyo3::PyAny> = $array;
        $(if let Ok($values) = array.extract::<numpy::PyReadonlyArray1<'_, $type>>() {
            $action
        } else)* {
            Err(pyo3::exceptions::PyTypeError::new_err(format!("numbers of type {} are not supported", array.getattr("dtype")?)))
        }
    }};
}

/// The numbers of an array of one axis.
pub fn samples(array: &Bound<'_, PyAny>) -> PyResult<Samples> {
    if let Ok(values) = array.extract::<PyReadonlyArray1<'_, bool>>() {
        return Ok(Samples::from(values.as_slice()?.iter().map(|&x| u8::from(x)).collect::<Vec<u8>>()));
    }
    with_numbers!(array, values => Ok(Samples::from(values.as_slice()?.to_vec())),
        [u8, i8, u16, i16, u32, i32, u64, i64, f32, f64])
}

/// A volume from its numbers, x fastest.
pub fn volume(dims: [usize; 3], channels: usize, array: &Bound<'_, PyAny>) -> PyResult<Volume> {
    Volume::new(dims, channels, Affine::default(), samples(array)?)
        .map_err(|e| PyValueError::new_err(e.to_string()))
}

/// A vector as an array, which owns it.
pub fn flat<T: Element>(py: Python<'_>, values: Vec<T>) -> Bound<'_, PyArray1<T>> {
    PyArray1::from_vec(py, values)
}

/// A vector as an array of rows, which owns it.
pub fn rows<T: Element>(py: Python<'_>, values: Vec<T>, width: usize) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = values.len().checked_div(width).unwrap_or(0);
    let array = PyArray1::from_vec(py, values).reshape([count, width]);
    array.map_err(|e| PyTypeError::new_err(e.to_string()))
}

/// The eigenfunctions of a basis in columns, in their own precision.
pub fn columns<'py>(py: Python<'py>, basis: &Eigenbasis) -> PyResult<Bound<'py, PyAny>> {
    let width = basis.eigenvalues().len();
    Ok(match basis.functions() {
        FunctionsView::Double(values) => rows(py, values.to_vec(), width)?.into_any(),
        FunctionsView::Single(values) => rows(py, values.to_vec(), width)?.into_any(),
    })
}

/// Eigenfunctions as a caller has them.
#[derive(FromPyObject)]
pub enum Columns<'py> {
    Double(PyReadonlyArray2<'py, f64>),
    Single(PyReadonlyArray2<'py, f32>),
}

impl Columns<'_> {
    /// Without a copy.
    pub fn view(&self) -> PyResult<FunctionsView<'_>> {
        Ok(match self {
            Self::Double(array) => array.as_slice()?.into(),
            Self::Single(array) => array.as_slice()?.into(),
        })
    }
}
