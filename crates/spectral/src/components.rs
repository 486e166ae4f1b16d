//! Connected components, solved one by one.
//!
//! Equal bodies side by side have the same eigenvalues. An iteration on all of them at once sees only as many
//! copies of an eigenvalue as its block has columns; one by one, each body has few.

use mser3d_shape::{Components, Domain, Eigenbasis, Functions, FunctionsView};

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
    // Single precision of one body was chosen for its size, which this is not less than.
    let single = |s: &Spectrum| matches!(s.basis.functions(), FunctionsView::Single(_));
    let functions: Functions = if spectra.iter().flatten().any(single) {
        gather(mass.len(), members, &spectra, &order, |x| x as f32).into()
    } else {
        gather(mass.len(), members, &spectra, &order, |x| x).into()
    };
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

/// The eigenfunctions of all bodies, those of `order`, zero outside their own body.
fn gather<T: Copy + Default>(
    rows: usize,
    members: &[Vec<u32>],
    spectra: &[Option<Spectrum>],
    order: &[(f64, usize, usize)],
    rounded: impl Fn(f64) -> T,
) -> Vec<T> {
    let mut functions = vec![T::default(); rows * order.len()];
    let mut scratch = Vec::new();
    for (body, (members, spectrum)) in members.iter().zip(spectra).enumerate() {
        let here = order.iter().enumerate().filter(|(_, eigenpair)| eigenpair.1 == body);
        let own: Vec<(usize, usize)> = here.map(|(place, eigenpair)| (place, eigenpair.2)).collect();
        let (Some(spectrum), Some(&(_, last))) = (spectrum, own.last()) else { continue };
        for (at, &row) in members.iter().enumerate() {
            let values = spectrum.basis.row(at, 0..last + 1, &mut scratch);
            let target = &mut functions[row as usize * order.len()..][..order.len()];
            own.iter().for_each(|&(place, number)| target[place] = rounded(values[number]));
        }
    }
    functions
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bodies_of_which_one_is_in_single_precision_become_so_together() {
        // Two bodies of two rows each, which alternate.
        let members = [vec![0, 2], vec![1, 3]];
        let whole = |first: Functions, second: Functions| {
            let solve = |body: usize, _: usize| {
                let (values, functions) = [(vec![0.0, 3.0], &first), (vec![0.0, 2.0], &second)][body].clone();
                let basis = Eigenbasis::new(Domain::Volume, vec![0.5; 2], values, functions.clone());
                Ok(Spectrum::new(basis.unwrap(), SpectrumReport::new(SolverUsed::Dense)))
            };
            merge(Domain::Volume, &[0.5; 4], &members, 3, solve).unwrap().basis
        };
        let (first, second) = ([0.1, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 0.8]);
        let expected = [0.1, 0.0, 0.0, 0.0, 0.5, 0.6, 0.3, 0.0, 0.0, 0.0, 0.7, 0.8];
        let double = whole(first.to_vec().into(), second.to_vec().into());
        assert_eq!(double.eigenvalues(), [0.0, 0.0, 2.0]);
        assert_eq!(double.functions(), FunctionsView::Double(&expected));
        let single = |x: [f64; 4]| Functions::from(x.map(|x| x as f32).to_vec());
        for second in [single(second), second.to_vec().into()] {
            let found = whole(single(first), second);
            assert_eq!(found.functions(), FunctionsView::Single(&expected.map(|x| x as f32)));
        }
    }
}
