//! Eigenfunctions in single precision: the same weights and signatures, but for the rounding of the values.

use super::common::{box_basis, sheet_basis, truncated};
use mser3d_descriptors::*;
use mser3d_shape::{BitGrid, Eigenbasis, Frame, VoxelGrid};

const DIMS: [usize; 3] = [9, 7, 5];

fn with(basis: &Eigenbasis, functions: impl Into<mser3d_shape::Functions>) -> Eigenbasis {
    let (mass, values) = (basis.mass().to_vec(), basis.eigenvalues().to_vec());
    Eigenbasis::new(basis.domain(), mass, values, functions).unwrap()
}

/// All numbers that are made of a basis, those of one kind together.
fn all(basis: &Eigenbasis) -> Vec<(&'static str, Vec<f64>)> {
    let n = basis.len() as u32;
    let t = TimeScale::Relative(0.3).on(basis).unwrap();
    let edges: Vec<[u32; 2]> = (1..n).map(|v| [v / 2, v]).collect();
    let regions = [(0..n / 3).collect::<Vec<u32>>(), (n / 4..n).collect()];
    let some: Vec<u32> = (0..n).step_by(3).collect();
    let signature = |vertices: &[u32]| si_hks(basis, &SiHksParameters::default(), Some(vertices));
    vec![
        ("auto-diffusivity", auto_diffusivity(basis, t).unwrap()),
        ("at two times", auto_diffusivities(basis, &[t, 3.0 * t]).unwrap().concat()),
        ("heat kernel", heat_kernel(basis, t, &edges).unwrap()),
        ("inverse heat kernel", inverse_heat_kernel(basis, t, &edges).unwrap()),
        ("diffusion distance", diffusion_distance(basis, t, &edges).unwrap()),
        ("commute time", commute_time(basis).unwrap()),
        ("hks", hks(basis, &HksParameters::default(), Some(&some)).unwrap().values().to_vec()),
        ("si-hks", si_hks(basis, &SiHksParameters::default(), None).unwrap().values().to_vec()),
        ("regions", region_descriptors(&regions, basis.mass(), signature).unwrap().values().to_vec()),
        ("means", region_means(basis, &regions).concat()),
    ]
}

/// Measured: at most 8.0e-8 of the largest number of its kind, of the reciprocals of a heat kernel; of the signatures 6.1e-8.
#[test]
fn single_precision_changes_nothing_beyond_its_rounding() {
    for basis in [truncated(&box_basis(DIMS, 0.3), 60), truncated(&sheet_basis([17, 11], 2.0), 60)] {
        let rounded: Vec<f32> = basis.functions().values().map(|x| x as f32).collect();
        let widened: Vec<f64> = rounded.iter().map(|&x| x.into()).collect();
        let single = all(&with(&basis, rounded));
        // Sums are in double precision: the bits are those of the same values in doubles.
        assert_eq!(single, all(&with(&basis, widened)));
        for ((what, found), (_, expected)) in single.iter().zip(all(&basis)) {
            let scale = expected.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
            let worst = found.iter().zip(&expected).fold(0.0, |a: f64, (x, y)| a.max((x - y).abs() / scale));
            assert!(worst < 1e-6, "{what}: {worst:e}");
        }
    }
}

#[test]
fn sides_and_maps_are_those_of_the_same_values_in_doubles() {
    let basis = truncated(&box_basis(DIMS, 0.3), 60);
    let rounded: Vec<f32> = basis.functions().values().map(|x| x as f32).collect();
    let widened: Vec<f64> = rounded.iter().map(|&x| x.into()).collect();
    let (single, double) = (with(&basis, rounded), with(&basis, widened));
    let frame = Frame::new(DIMS, [0.0; 3], [0.3; 3]).unwrap();
    let grid = VoxelGrid::solid(frame, BitGrid::full(DIMS).unwrap()).unwrap();
    let fields = |basis: &Eigenbasis| {
        chirality_of_solid(basis, &grid, basis.unit_time(), &ChiralityParameters::default()).unwrap()
    };
    assert_eq!(fields(&single), fields(&double));

    let points: Vec<u32> = (0..basis.len() as u32).collect();
    let weights = vec![1.0; points.len()];
    let regions = [vec![0, 1, 9, 10], (200..260).collect()];
    let map = |basis: &Eigenbasis| {
        let shape = MapShape { basis, regions: &regions, points: &points, weights: &weights };
        dense_map(&shape, &shape, &[[0, 0], [1, 1]], &DenseMapParameters::default()).unwrap()
    };
    assert_eq!(map(&single), map(&double));
}
