//! Heat kernels and heat kernel signatures of eigenpairs.

use mser3d::descriptors::{self, SiHksParameters};
use mser3d::shape::{Domain, Eigenbasis};
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::{flat, indices, rows, wrong};
use crate::errors::of_library;
use crate::run::{Call, run};

fn basis(
    domain: Domain,
    mass: Option<&PyReadonlyArray1<'_, f64>>,
    evals: &PyReadonlyArray1<'_, f64>,
    evecs: &PyReadonlyArray2<'_, f64>,
) -> PyResult<Eigenbasis> {
    let functions = evecs.as_slice()?.to_vec();
    // Whether, and then where: the first is fast.
    let bad = functions.iter().fold(false, |bad, x| bad | !x.is_finite());
    if bad {
        let place = functions.iter().position(|x| !x.is_finite()).unwrap_or(0);
        let row = place / evecs.shape()[1].max(1);
        return Err(wrong("evecs", format!("row {row} holds a value that is not finite")));
    }
    let mass = match mass {
        Some(mass) => mass.as_slice()?.to_vec(),
        None => vec![1.0; evecs.shape()[0]],
    };
    Eigenbasis::new(domain, mass, evals.as_slice()?.to_vec(), functions)
        .map_err(|e| wrong("evals, evecs, mass", e))
}

/// The heat kernel at each time, one after the other: of each row with itself, or of pairs of rows.
#[pyfunction]
#[pyo3(signature = (evals, evecs, times, pairs=None))]
pub fn heat_kernel<'py>(
    py: Python<'py>,
    evals: PyReadonlyArray1<'py, f64>,
    evecs: PyReadonlyArray2<'py, f64>,
    times: Vec<f64>,
    pairs: Option<PyReadonlyArray2<'py, i64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let basis = basis(Domain::Volume, None, &evals, &evecs)?;
    let pairs = pairs.map(|pairs| indices::<2>("pairs", &pairs, basis.len())).transpose()?;
    let values = run(py, &Call { progress: None, threads: None }, move |_| {
        let at = |&t: &f64| match &pairs {
            None => descriptors::auto_diffusivity(&basis, t),
            Some(pairs) => descriptors::heat_kernel(&basis, t, pairs),
        };
        let values: Result<Vec<Vec<f64>>, _> = times.iter().map(at).collect();
        Ok(values.map_err(of_library)?.concat())
    })?;
    Ok(flat(py, values).into_any())
}

/// Scale-invariant heat kernel signatures, a row for each row of the eigenfunctions, or for those that are named.
#[pyfunction]
#[pyo3(signature = (domain, mass, evals, evecs, settings, of=None))]
pub fn si_hks<'py>(
    py: Python<'py>,
    domain: &str,
    mass: PyReadonlyArray1<'py, f64>,
    evals: PyReadonlyArray1<'py, f64>,
    evecs: PyReadonlyArray2<'py, f64>,
    settings: &str,
    of: Option<PyReadonlyArray2<'py, i64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let domain: Domain = domain.parse().map_err(|e| wrong("domain", e))?;
    let basis = basis(domain, Some(&mass), &evals, &evecs)?;
    // Fields that are not given are the defaults'.
    let mut parameters =
        serde_json::to_value(SiHksParameters::default()).map_err(|e| wrong("parameters", e))?;
    let given: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(settings).map_err(|e| wrong("parameters", e))?;
    for (name, value) in given {
        parameters[&name] = value;
    }
    let parameters: SiHksParameters =
        serde_json::from_value(parameters).map_err(|e| wrong("parameters", e))?;
    let of = of.map(|of| indices::<1>("rows", &of, basis.len())).transpose()?;
    let found = run(py, &Call { progress: None, threads: None }, move |_| {
        let of: Option<Vec<u32>> = of.map(|of| of.concat());
        descriptors::si_hks(&basis, &parameters, of.as_deref()).map_err(of_library)
    })?;
    let width = found.width();
    let values = found.values().to_vec();
    Ok(rows(py, values, width)?.into_any())
}
