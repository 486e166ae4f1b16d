//! Connected components, solved one by one.
//!
//! Equal bodies side by side have the same eigenvalues. An iteration on all of them at once sees only as many
//! copies of an eigenvalue as its block has columns; one by one, each body has few.

use mser3d_shape::{Components, Domain, Eigenbasis};

use crate::{SolverUsed, SpectralError, Spectrum, SpectrumReport};

/// The rows of each component, ascending; components without a row that `takes_part` are left out.
pub(crate) fn members(parts: &Components, takes_part: impl Fn(usize) -> bool) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); parts.len()];
    for (row, &label) in parts.labels.iter().enumerate().filter(|&(row, _)| takes_part(row)) {
        members[label as usize].push(row as u32);
    }
    members.retain(|rows| !rows.is_empty());
    members
}

/// The `wanted` smallest eigenpairs of all bodies together, from those of each; `solve(body, count)`
/// computes the `count` smallest of one, its zero mode included, with rows as in `members[body]`.
///
/// Each body is first asked for its share by size, then for more until its highest eigenvalue lies above
/// the last one wanted. Where the exact zero modes alone are enough, nothing else is asked for.
pub(crate) fn merge(
    domain: Domain,
    mass: &[f64],
    members: &[Vec<u32>],
    wanted: usize,
    solve: impl Fn(usize, usize) -> Result<Spectrum, SpectralError>,
) -> Result<Spectrum, SpectralError> {
    let rows: usize = members.iter().map(Vec::len).sum();
    let share = |body: &Vec<u32>| (5 * wanted * body.len() / rows / 4 + 8).min(wanted).min(body.len());
    let mut counts: Vec<usize> =
        if members.len() >= wanted { vec![1; members.len()] } else { members.iter().map(share).collect() };
    let mut spectra: Vec<Option<Spectrum>> = vec![None; members.len()];
    let order = loop {
        for (body, spectrum) in spectra.iter_mut().enumerate() {
            if spectrum.as_ref().is_none_or(|s| s.basis.eigenvalues().len() < counts[body]) {
                *spectrum = Some(solve(body, counts[body])?);
            }
        }
        let order = smallest(&spectra, wanted);
        let zero_modes: usize = spectra.iter().flatten().map(|s| s.report.zero_modes).sum();
        let last = order.last().map_or(0.0, |&(value, ..)| value);
        let complete = |body: usize| {
            let highest = spectra[body].as_ref().and_then(|s| s.basis.eigenvalues().last().copied());
            counts[body] >= wanted.min(members[body].len()) || highest.is_some_and(|h| h > last)
        };
        let short: Vec<usize> = (0..members.len()).filter(|&b| !complete(b)).collect();
        if zero_modes >= wanted || short.is_empty() {
            break order;
        }
        for body in short {
            counts[body] = (2 * counts[body]).min(wanted).min(members[body].len());
        }
    };
    let mut functions = vec![0.0; mass.len() * order.len()];
    for (place, &(_, body, number)) in order.iter().enumerate() {
        if let Some(spectrum) = &spectra[body] {
            for (at, &row) in members[body].iter().enumerate() {
                functions[row as usize * order.len() + place] = spectrum.basis.at(at)[number];
            }
        }
    }
    let values = order.iter().map(|&(value, ..)| value).collect();
    let basis =
        Eigenbasis::new(domain, mass.to_vec(), values, functions).map_err(|_| SpectralError::Overflow)?;
    Ok(Spectrum { basis, report: combined(&spectra, wanted) })
}

/// The smallest eigenvalues of all bodies: value, body, number in the body. Zero modes come first, in the
/// order of the bodies.
fn smallest(spectra: &[Option<Spectrum>], wanted: usize) -> Vec<(f64, usize, usize)> {
    let mut all: Vec<(f64, usize, usize)> = Vec::new();
    for (body, spectrum) in spectra.iter().enumerate() {
        let values = spectrum.iter().flat_map(|s| s.basis.eigenvalues());
        all.extend(values.enumerate().map(|(number, &value)| (value, body, number)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)).then(a.2.cmp(&b.2)));
    all.truncate(wanted);
    all
}

/// The worst of all reports; the solver is that of the body with most work.
fn combined(spectra: &[Option<Spectrum>], wanted: usize) -> SpectrumReport {
    let reports = || spectra.iter().flatten().map(|s| &s.report);
    let worst = |value: fn(&SpectrumReport) -> f64| reports().map(value).fold(0.0, f64::max);
    SpectrumReport {
        solver: reports().max_by_key(|r| r.applications).map_or(SolverUsed::Dense, |r| r.solver),
        iterations: reports().map(|r| r.iterations).sum(),
        applications: reports().map(|r| r.applications).sum(),
        residual: worst(|r| r.residual),
        orthogonality: worst(|r| r.orthogonality),
        zero_modes: reports().map(|r| r.zero_modes).sum::<usize>().min(wanted),
    }
}
