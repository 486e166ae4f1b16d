//! Facts of heat diffusion, on the closed-form spectrum of a box.

use super::common::{box_basis, sheet_basis, truncated, with_threads};
use mser3d_descriptors::*;
use mser3d_shape::{Domain, Eigenbasis};

fn all_pairs(n: usize) -> Vec<[u32; 2]> {
    (0..n as u32).flat_map(|u| (0..n as u32).map(move |v| [u, v])).collect()
}

fn close(a: f64, b: f64, relative: f64) -> bool {
    (a - b).abs() <= relative * a.abs().max(b.abs())
}

#[test]
fn heat_is_positive_everywhere_and_its_amount_is_kept() {
    for basis in [box_basis([6, 5, 4], 0.3), sheet_basis([9, 7], 0.3)] {
        let n = basis.len();
        // Not so early that the far corner's heat, about (t/h^2)^d/d! at graph distance d, is below rounding.
        for t in [0.2, 1.0, 50.0] {
            let kernel = heat_kernel(&basis, t, &all_pairs(n)).unwrap();
            assert!(kernel.iter().all(|&h| h > 0.0), "{t}");
            for row in kernel.chunks(n) {
                let amount: f64 = row.iter().zip(basis.mass()).map(|(h, m)| h * m).sum();
                assert!(close(amount, 1.0, 1e-12));
            }
        }
    }
}

#[test]
fn the_auto_diffusivity_is_the_kernels_diagonal_and_integrates_to_the_heat_trace() {
    let basis = box_basis([7, 5, 3], 0.5);
    let diagonal: Vec<[u32; 2]> = (0..basis.len() as u32).map(|v| [v, v]).collect();
    for t in [0.01, 0.3, 20.0] {
        let heat = auto_diffusivity(&basis, t).unwrap();
        assert_eq!(heat, heat_kernel(&basis, t, &diagonal).unwrap());
        let integral: f64 = heat.iter().zip(basis.mass()).map(|(h, m)| h * m).sum();
        let trace: f64 = basis.eigenvalues().iter().map(|l| (-l * t).exp()).sum();
        assert!(close(integral, trace, 1e-12));
        assert!(close(heat_trace(&basis, t).unwrap(), trace, 1e-14));
    }
}

#[test]
fn one_pass_for_several_times_gives_the_bits_of_several_passes() {
    let basis = box_basis([7, 5, 3], 0.5);
    let times = [0.01, 20.0, 0.3];
    let each: Vec<Vec<f64>> = times.iter().map(|&t| auto_diffusivity(&basis, t).unwrap()).collect();
    assert_eq!(auto_diffusivities(&basis, &times).unwrap(), each);
    assert_eq!(auto_diffusivities(&basis, &[]).unwrap(), [[0.0; 0]; 0]);
    assert!(auto_diffusivities(&basis, &[1.0, 0.0]).is_err());
}

#[test]
fn region_means_are_those_of_each_eigenfunction_by_volume() {
    let mass = vec![1.0, 2.0, 3.0];
    let basis = Eigenbasis::new(Domain::Volume, mass, vec![0.0, 1.0], vec![1.0, 5.0, 1.0, -1.0, 1.0, 2.0]);
    let regions: [&[u32]; 3] = [&[0, 2], &[1], &[]];
    let means = region_means(&basis.unwrap(), &regions);
    assert_eq!(means[..2], [[1.0, (5.0 + 3.0 * 2.0) / 4.0], [1.0, -1.0]]);
    assert!(means[2].iter().all(|mean| mean.is_nan()));
}

#[test]
fn the_kernel_of_a_box_is_the_product_of_the_kernels_of_its_sides() {
    let (t, solid, sheet) = (0.7, box_basis([5, 4, 1], 1.0), sheet_basis([5, 4], 1.0));
    let flat = heat_kernel(&sheet, t, &all_pairs(20)).unwrap();
    for (h, k) in heat_kernel(&solid, t, &all_pairs(20)).unwrap().iter().zip(flat) {
        assert!(close(*h, k, 1e-10));
    }
}

#[test]
fn skipped_modes_make_no_difference() {
    let basis = box_basis([8, 7, 6], 1.0);
    let edges = all_pairs(20);
    for t in [0.5, 5.0, 40.0, 1000.0] {
        let naive = |u: u32, v: u32| -> f64 {
            let (u, v) = (basis.at(u as usize), basis.at(v as usize));
            basis.eigenvalues().iter().enumerate().map(|(i, l)| (-l * t).exp() * u[i] * v[i]).sum()
        };
        for (h, &[u, v]) in heat_kernel(&basis, t, &edges).unwrap().iter().zip(&edges) {
            assert!((h - naive(u, v)).abs() <= 1e-14 * naive(u, u).max(naive(v, v)));
        }
    }
}

#[test]
fn the_diffusion_distance_is_the_distance_between_heat_distributions() {
    let basis = box_basis([5, 4, 3], 0.5);
    let (n, t) = (basis.len(), 0.4);
    let kernel = heat_kernel(&basis, t, &all_pairs(n)).unwrap();
    let edges = [[0, 1], [3, 59], [17, 17]];
    for (d, [u, v]) in diffusion_distance(&basis, t, &edges).unwrap().iter().zip(edges) {
        let (u, v) = (u as usize * n, v as usize * n);
        let squares = (0..n).map(|w| basis.mass()[w] * (kernel[u + w] - kernel[v + w]).powi(2));
        assert!((d - squares.sum::<f64>().sqrt()).abs() < 1e-12);
    }
}

/// Eq. 7: on a shape scaled by s, lambda becomes lambda / s^2 and phi becomes s^(-3/2) phi, so H_t at time
/// s^2 t becomes s^-3 H_t; on a surface phi becomes phi / s and H becomes s^-2 H.
#[test]
fn weights_follow_the_scaling_law() {
    let s = 2.5;
    let pairs = [
        (box_basis([6, 5, 4], 0.4), box_basis([6, 5, 4], 0.4 * s), 3, 0),
        (sheet_basis([8, 6], 0.4), sheet_basis([8, 6], 0.4 * s), 2, 1),
    ];
    for (small, large, dimension, commute_power) in pairs {
        let time = TimeScale::Relative(0.3);
        let (t, scaled) = (time.on(&small).unwrap(), time.on(&large).unwrap());
        assert!(close(scaled, s * s * t, 1e-12));
        let (a, b) = (auto_diffusivity(&small, t).unwrap(), auto_diffusivity(&large, scaled).unwrap());
        assert!(a.iter().zip(&b).all(|(a, b)| close(*a, s.powi(dimension) * b, 1e-11)));
        let (a, b) = (commute_time(&small).unwrap(), commute_time(&large).unwrap());
        assert!(a.iter().zip(&b).all(|(a, b)| close(*a, s.powi(commute_power) * b, 1e-11)));
        let invariant = -f64::from(dimension) / 2.0;
        let [a, b] = [&small, &large].map(|basis| power_diffusivity(basis, invariant).unwrap());
        assert!(a.iter().zip(&b).all(|(a, b)| close(*a, *b, 1e-11)));
    }
}

#[test]
fn the_green_function_is_the_integral_of_the_heat_kernel_without_its_limit() {
    let basis = box_basis([4, 3, 2], 1.0);
    let green = power_diffusivity(&basis, -1.0).unwrap();
    let limit = 1.0 / basis.measure();
    // Simpson's rule in log t, from where H is still constant to where it has reached its limit.
    let (from, to, steps) = (1e-8f64.ln(), 1e3f64.ln(), 2000);
    let step = (to - from) / f64::from(steps);
    let mut integral = vec![0.0; basis.len()];
    for i in 0..=steps {
        let t = (from + f64::from(i) * step).exp();
        let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        for (sum, h) in integral.iter_mut().zip(auto_diffusivity(&basis, t).unwrap()) {
            *sum += weight * step / 3.0 * t * (h - limit);
        }
    }
    assert!(green.iter().zip(&integral).all(|(g, i)| close(*g, *i, 1e-6)));
}

#[test]
fn heat_stays_longest_in_corners() {
    let basis = box_basis([6, 6, 6], 1.0);
    for weight in [auto_diffusivity(&basis, 3.0).unwrap(), commute_time(&basis).unwrap()] {
        let best = (0..basis.len()).max_by(|a, b| weight[*a].total_cmp(&weight[*b])).unwrap();
        assert!([0, 5, 5].contains(&(best % 6)) && [0, 5].contains(&(best / 6 % 6)));
        assert!(weight[0] > weight[1] && weight[1] > weight[7]);
    }
}

#[test]
fn a_truncated_kernel_below_zero_weighs_infinitely() {
    let basis = truncated(&box_basis([12, 4, 4], 1.0), 6);
    let edges = all_pairs(basis.len());
    let (kernel, weights) =
        (heat_kernel(&basis, 0.5, &edges).unwrap(), inverse_heat_kernel(&basis, 0.5, &edges).unwrap());
    assert!(kernel.iter().any(|&h| h < 0.0));
    for (h, w) in kernel.into_iter().zip(weights) {
        assert_eq!(w, if h > 0.0 { 1.0 / h } else { f64::INFINITY });
    }
}

#[test]
fn commute_time_drops_one_zero_mode_for_each_component() {
    // Two equal boxes apart: each eigenvalue twice. The null space is spanned by any rotation of the two
    // indicators, and solvers return its eigenvalues as small positive numbers.
    let part = box_basis([4, 3, 2], 1.0);
    let (n, k) = (part.len(), part.eigenvalues().len());
    let (c, s) = (0.6, 0.8);
    let mut functions = Vec::new();
    for (half, mix) in [[c, s], [-s, c]].into_iter().enumerate() {
        for v in 0..n {
            for (i, &phi) in part.at(v).iter().enumerate() {
                let own = |side: usize| if side == half { phi } else { 0.0 };
                functions.extend(if i == 0 { mix.map(|m| m * phi) } else { [own(0), own(1)] });
            }
        }
    }
    let mut values: Vec<f64> = part.eigenvalues().iter().flat_map(|&l| [l, l]).collect();
    (values[0], values[1]) = (1e-17, 3e-13);
    assert_eq!(functions.len(), 2 * n * 2 * k);
    let both = Eigenbasis::new(Domain::Volume, vec![1.0; 2 * n], values, functions).unwrap();
    assert_eq!(zero_modes(&both), 2);
    let (one, two) = (commute_time(&part).unwrap(), commute_time(&both).unwrap());
    assert!(one.iter().chain(&one).zip(&two).all(|(a, b)| close(*a, *b, 1e-12)));

    let constant = truncated(&both, 2);
    assert_eq!(commute_time(&constant), Err(DescriptorError::OnlyZeroModes { eigenpairs: 2 }));
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let basis = box_basis([15, 12, 10], 1.0);
    let edges: Vec<[u32; 2]> = (1..basis.len() as u32).map(|v| [v / 2, v]).collect();
    let run = || {
        (
            auto_diffusivity(&basis, 3.0).unwrap(),
            inverse_heat_kernel(&basis, 3.0, &edges).unwrap(),
            commute_time(&basis).unwrap(),
        )
    };
    assert_eq!(with_threads(1, run), with_threads(2, run));
}

#[test]
fn wrong_input_is_named() {
    let basis = box_basis([2, 2, 1], 1.0);
    for t in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = auto_diffusivity(&basis, t).unwrap_err();
        assert!(error.to_string().starts_with("the time scale is"), "{error}");
    }
    let error = heat_kernel(&basis, 1.0, &[[0, 1], [2, 4]]).unwrap_err();
    assert_eq!(error.to_string(), "edge 1 names vertex 4, but there are 4 vertices (numbered from 0)");
    let empty = Eigenbasis::new(Domain::Volume, vec![], vec![0.0], Vec::<f64>::new()).unwrap();
    assert_eq!(
        auto_diffusivity(&empty, 1.0),
        Err(DescriptorError::EmptyBasis { vertices: 0, eigenpairs: 1 })
    );
}
