//! Heat kernels and heat kernel signatures of eigenpairs.

use std::ops::Range;

use mser3d::descriptors::{self, SiHksParameters};
use mser3d::shape::{Domain, EigenbasisView, FunctionsView};
use mser3d_cli::CliError;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Columns, flat, indices, rows, wrong};
use crate::errors::{of_library, usage};
use crate::run::{Call, Told, run_borrowing};

/// Rows that are dealt with at a time: they stay in the processor's cache from the check to the sums, and Ctrl-C comes between.
const ROWS: usize = 4096;

/// Eigenpairs as NumPy holds them, which are large and not copied.
#[derive(Clone, Copy)]
struct Eigenpairs<'a> {
    domain: Domain,
    mass: &'a [f64],
    evals: &'a [f64],
    evecs: FunctionsView<'a>,
}

impl<'a> Eigenpairs<'a> {
    fn view(self, rows: Range<usize>) -> Result<EigenbasisView<'a>, CliError> {
        EigenbasisView::new(self.domain, &self.mass[rows.clone()], self.evals, self.functions(rows))
            .map_err(|e| usage(format!("evals, evecs, mass: {e}")))
    }

    fn functions(self, rows: Range<usize>) -> FunctionsView<'a> {
        let k = self.evals.len();
        self.evecs.slice(rows.start * k..rows.end * k)
    }

    fn whole(self) -> Result<EigenbasisView<'a>, CliError> {
        self.view(0..self.mass.len())
    }

    /// The rows in blocks, each checked before it is used.
    fn blocks(
        self,
        told: &Told,
        mut each: impl FnMut(Range<usize>) -> Result<(), CliError>,
    ) -> Result<(), CliError> {
        for start in (0..self.mass.len()).step_by(ROWS) {
            if told.go_on().is_break() {
                return Err(CliError::Interrupted);
            }
            let rows = start..(start + ROWS).min(self.mass.len());
            self.check(rows.clone())?;
            each(rows)?;
        }
        Ok(())
    }

    fn check(self, rows: Range<usize>) -> Result<(), CliError> {
        let values = self.functions(rows.clone());
        // Whether, and then where: the first is fast.
        let sound = match values {
            FunctionsView::Double(values) => are_finite(values),
            FunctionsView::Single(values) => are_finite(values),
        };
        if sound {
            return Ok(());
        }
        let place = values.values().position(|x| !x.is_finite()).unwrap_or(0);
        let row = rows.start + place / self.evals.len().max(1);
        Err(usage(format!("evecs: row {row} holds a value that is not finite")))
    }
}

fn are_finite<T: Copy + Into<f64> + Sync>(values: &[T]) -> bool {
    let part = |part: &[T]| part.iter().fold(true, |good, &x| good & x.into().is_finite());
    values.par_chunks(1 << 15).all(part)
}

/// The heat kernel at each time, one after the other: of each row with itself, or of pairs of rows.
#[pyfunction]
#[pyo3(signature = (evals, evecs, times, pairs=None))]
pub fn heat_kernel<'py>(
    py: Python<'py>,
    evals: PyReadonlyArray1<'py, f64>,
    evecs: Columns<'py>,
    times: Vec<f64>,
    pairs: Option<PyReadonlyArray2<'py, i64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (evals, evecs) = (evals.as_slice()?, evecs.view()?);
    let count = evecs.len() / evals.len().max(1);
    // The heat kernel does not depend on it.
    let mass = vec![1.0; count];
    let basis = Eigenpairs { domain: Domain::Volume, mass: &mass, evals, evecs };
    let pairs = pairs.map(|pairs| indices::<2>("pairs", &pairs, count)).transpose()?;
    let values = run_borrowing(py, &Call { progress: None, threads: None }, |told| {
        let mut values = Vec::new();
        if let Some(pairs) = &pairs {
            basis.blocks(told, |_| Ok(()))?;
            let whole = basis.whole()?;
            for &t in &times {
                values.extend(descriptors::heat_kernel(whole, t, pairs).map_err(of_library)?);
            }
        } else {
            values.resize(times.len() * count, 0.0);
            basis.blocks(told, |rows| {
                let view = basis.view(rows.clone())?;
                for (&t, values) in times.iter().zip(values.chunks_exact_mut(count)) {
                    let found = descriptors::auto_diffusivity(view, t).map_err(of_library)?;
                    values[rows.clone()].copy_from_slice(&found);
                }
                Ok(())
            })?;
        }
        Ok(values)
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
    evecs: Columns<'py>,
    settings: &str,
    of: Option<PyReadonlyArray2<'py, i64>>,
) -> PyResult<Bound<'py, PyAny>> {
    let domain: Domain = domain.parse().map_err(|e| wrong("domain", e))?;
    let (mass, evals, evecs) = (mass.as_slice()?, evals.as_slice()?, evecs.view()?);
    let basis = Eigenpairs { domain, mass, evals, evecs };
    // Fields that are not given are the defaults'.
    let mut parameters =
        serde_json::to_value(SiHksParameters::default()).map_err(|e| wrong("parameters", e))?;
    let given: serde_json::Map<String, serde_json::Value> =
        serde_json::from_str(settings).map_err(|e| wrong("parameters", e))?;
    for (name, value) in given {
        parameters[&name] = value;
    }
    let mut parameters: SiHksParameters =
        serde_json::from_value(parameters).map_err(|e| wrong("parameters", e))?;
    let of = of.map(|of| indices::<1>("rows", &of, mass.len())).transpose()?;
    let (values, width) = run_borrowing(py, &Call { progress: None, threads: None }, |told| {
        parameters.validate().map_err(of_library)?;
        let whole = basis.whole()?;
        // Of the whole shape, whatever block of it is looked at.
        parameters.unit = Some(parameters.unit(whole));
        let mut values = Vec::new();
        let mut add = |view: EigenbasisView<'_>, of: Option<&[u32]>| {
            let found = descriptors::si_hks(view, &parameters, of).map_err(of_library)?;
            values.extend_from_slice(found.values());
            Ok(())
        };
        match of {
            Some(of) => {
                basis.blocks(told, |_| Ok(()))?;
                add(whole, Some(&of.concat()))?;
            }
            None => basis.blocks(told, |rows| add(basis.view(rows)?, None))?,
        }
        Ok((values, parameters.frequencies))
    })?;
    Ok(rows(py, values, width)?.into_any())
}
