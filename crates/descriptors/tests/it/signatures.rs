//! Facts of the heat kernel signatures and the descriptors of regions.

use super::common::{box_basis, sheet_basis, truncated, with_threads};
use mser3d_descriptors::*;
use mser3d_shape::Eigenbasis;
use std::f64::consts::{LN_2, PI};

/// Eq. 9 and its Fourier transform, as written.
fn naive_si_hks(basis: &Eigenbasis, params: &SiHksParameters) -> Vec<f64> {
    let (samples, unit) = (params.samples(), params.unit(basis));
    let mut all = Vec::new();
    for v in 0..basis.len() {
        let phi = basis.at(v);
        let slope = |j: usize| {
            let t = unit * 2f64.powf(params.tau_start + j as f64 / params.samples_per_octave as f64);
            let (mut heat, mut loss) = (0.0, 0.0);
            for (l, phi) in basis.eigenvalues().iter().zip(&*phi) {
                heat += (-l * t).exp() * phi * phi;
                loss += l * (-l * t).exp() * phi * phi;
            }
            -LN_2 * t * loss / heat
        };
        let slopes: Vec<f64> = (0..samples).map(slope).collect();
        for f in 0..params.frequencies {
            let (mut re, mut im) = (0.0, 0.0);
            for (j, slope) in slopes.iter().enumerate() {
                let angle = -2.0 * PI * (f * j) as f64 / samples as f64;
                re += slope * angle.cos();
                im += slope * angle.sin();
            }
            all.push(re.hypot(im));
        }
    }
    all
}

fn largest_relative_error(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let scale = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    found.iter().zip(expected).fold(0.0, |worst, (a, b)| worst.max((a - b).abs() / scale))
}

#[test]
fn si_hks_is_eq_9_as_written() {
    let odd = SiHksParameters {
        tau_start: -2.0,
        tau_end: 9.0,
        samples_per_octave: 7,
        frequencies: 4,
        ..Default::default()
    };
    for params in [SiHksParameters::default(), odd] {
        for basis in
            [box_basis([5, 4, 3], 0.2), sheet_basis([7, 5], 3.0), truncated(&box_basis([9, 3, 3], 1.0), 20)]
        {
            let found = si_hks(&basis, &params, None).unwrap();
            assert_eq!(found.len(), basis.len());
            assert!(largest_relative_error(found.values(), &naive_si_hks(&basis, &params)) < 1e-12);
        }
    }
}

#[test]
fn a_selection_gives_the_same_rows() {
    let basis = box_basis([7, 6, 5], 1.0);
    let params = SiHksParameters::default();
    let all = si_hks(&basis, &params, None).unwrap();
    let chosen: Vec<u32> = (0..basis.len() as u32).rev().step_by(3).collect();
    let some = si_hks(&basis, &params, Some(&chosen)).unwrap();
    assert_eq!(some.len(), chosen.len());
    for (row, &v) in some.rows().zip(&chosen) {
        assert_eq!(row, all.row(v as usize));
    }
    assert!(si_hks(&basis, &params, Some(&[])).unwrap().is_empty());
    let error = si_hks(&basis, &params, Some(&[0, 210])).unwrap_err();
    assert!(error.to_string().starts_with("selection entry 1 names vertex 210"), "{error}");
}

/// Scaling shifts the log-time axis. Scaled to the reference volume first, nothing is left of it; with a
/// fixed unit, what the ends of the range cut off.
#[test]
fn si_hks_does_not_change_with_scale() {
    let own = SiHksParameters::default();
    let cases = [
        (box_basis([12, 8, 6], 1.0), box_basis([12, 8, 6], 2.0)),
        (sheet_basis([20, 12], 1.0), sheet_basis([20, 12], 2.0)),
    ];
    for (small, large) in cases {
        let (a, b) = (si_hks(&small, &own, None).unwrap(), si_hks(&large, &own, None).unwrap());
        assert!(largest_relative_error(b.values(), a.values()) < 1e-10);

        // The slope is 0 at both ends of this range, so the shift loses nothing.
        let fixed =
            SiHksParameters { unit: Some(1.0), tau_start: -16.0, tau_end: 16.0, ..Default::default() };
        let (a, b) = (si_hks(&small, &fixed, None).unwrap(), si_hks(&large, &fixed, None).unwrap());
        assert!(largest_relative_error(b.values(), a.values()) < 1e-4);

        // Heat kernel signatures do change: by s^dimension at the same relative time.
        let [a, b] = [&small, &large].map(|basis| hks(basis, &HksParameters::default(), None).unwrap());
        let factor = f64::from(1 << small.domain().dimension());
        assert!((a.values()[0] / b.values()[0] / factor - 1.0).abs() < 1e-9);
    }
}

#[test]
fn late_times_do_not_underflow() {
    let mut params = SiHksParameters { tau_start: 1.0, tau_end: 200.0, ..Default::default() };
    let basis = box_basis([4, 3, 2], 1.0);
    assert!(si_hks(&basis, &params, None).unwrap().values().iter().all(|x| x.is_finite()));

    // Without the zero mode the slowest mode rules: log H falls like -lambda_1 t, and its slope is exact
    // where H itself is far below the smallest number.
    let functions: Vec<f64> = (0..basis.len()).flat_map(|v| basis.at(v)[1..].to_vec()).collect();
    let values = basis.eigenvalues()[1..].to_vec();
    let basis = Eigenbasis::new(basis.domain(), basis.mass().to_vec(), values, functions).unwrap();
    params = SiHksParameters { unit: Some(1.0), tau_start: 12.0, tau_end: 13.0, frequencies: 1, ..params };
    let expected: f64 =
        (0..16).map(|j| LN_2 * basis.eigenvalues()[0] * 2f64.powf(12.0 + f64::from(j) / 16.0)).sum();
    let found = si_hks(&basis, &params, Some(&[0])).unwrap();
    assert!((found.values()[0] / expected - 1.0).abs() < 1e-12);
}

#[test]
fn hks_is_the_auto_diffusivity_at_each_time() {
    let basis = sheet_basis([9, 8], 0.5);
    let params = HksParameters { times: vec![TimeScale::Absolute(0.2), TimeScale::Relative(0.3)] };
    let rows = hks(&basis, &params, None).unwrap();
    for (column, time) in params.times.iter().enumerate() {
        let heat = auto_diffusivity(&basis, time.on(&basis).unwrap()).unwrap();
        assert!(rows.rows().zip(heat).all(|(row, h)| row[column] == h));
    }
    assert!(hks(&basis, &HksParameters { times: vec![] }, None).is_err());
    assert!(hks(&basis, &HksParameters { times: vec![TimeScale::Relative(-1.0)] }, None).is_err());
}

#[test]
fn a_regions_descriptor_is_the_weighted_mean_and_each_vertex_is_described_once() {
    let mass = [1.0, 2.0, 3.0, 4.0, 0.0];
    let regions = [vec![0, 1], vec![1, 3, 0], vec![3, 4]];
    let mut asked = Vec::new();
    let means = region_descriptors(&regions, &mass, |vertices| {
        asked = vertices.to_vec();
        let rows = vertices.iter().flat_map(|&v| [f64::from(v), 1.0]).collect();
        Descriptors::new(2, rows)
    });
    assert_eq!(asked, [0, 1, 3, 4]);
    let means = means.unwrap();
    assert_eq!(means.row(0), [2.0 / 3.0, 1.0]);
    assert_eq!(means.row(1), [14.0 / 7.0, 1.0]);
    assert_eq!(means.row(2), [3.0, 1.0]);

    let ones = |vertices: &[u32]| Descriptors::new(1, vec![1.0; vertices.len()]);
    let error = region_descriptors(&[vec![0], vec![4]], &mass, ones).unwrap_err();
    assert_eq!(error, DescriptorError::EmptyRegion { region: 1 });
    let error = region_descriptors(&[vec![0, 5]], &mass, ones).unwrap_err();
    assert!(error.to_string().starts_with("region 0 names vertex 5"));
    let none: [Vec<u32>; 0] = [];
    assert!(region_descriptors(&none, &mass, ones).unwrap().is_empty());
    assert!(region_descriptors(&[vec![0]], &mass, |_| Descriptors::new(1, vec![])).is_err());
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let basis = box_basis([11, 9, 7], 1.0);
    let run = || {
        let regions = [(0..300).collect::<Vec<u32>>(), (100..693).collect()];
        region_descriptors(&regions, basis.mass(), |v| si_hks(&basis, &SiHksParameters::default(), Some(v)))
            .unwrap()
    };
    assert_eq!(with_threads(1, run), with_threads(2, run));
}

#[test]
fn wrong_parameters_are_named() {
    let wrong = |change: fn(&mut SiHksParameters)| {
        let mut params = SiHksParameters::default();
        change(&mut params);
        params.validate().unwrap_err().to_string()
    };
    assert!(wrong(|p| p.reference_volume = 0.0).starts_with("reference_volume is 0"));
    assert!(wrong(|p| p.reference_area = f64::NAN).starts_with("reference_area is NaN"));
    assert!(wrong(|p| p.unit = Some(-1.0)).starts_with("unit is -1"));
    assert!(wrong(|p| p.tau_end = f64::INFINITY).starts_with("tau_end is inf"));
    assert!(wrong(|p| p.tau_end = 1.0).contains("between 2 and 65536"));
    assert!(wrong(|p| p.samples_per_octave = usize::MAX).contains("between 2 and 65536"));
    assert!(wrong(|p| p.frequencies = 194).starts_with("frequencies is 194"));
    assert!(wrong(|p| p.frequencies = 0).starts_with("frequencies is 0"));
}
