//! Maps from element to element, on boxes whose eigenfunctions are known.

use mser3d_descriptors::{DenseMapParameters, DescriptorError, MapShape, dense_map};
use mser3d_shape::Eigenbasis;

use crate::common::*;

/// Voxels along x, y and z: no two axes are alike.
const DIMS: [usize; 3] = [11, 7, 4];
const COUNT: usize = DIMS[0] * DIMS[1] * DIMS[2];

fn voxel(number: usize) -> [usize; 3] {
    [number % DIMS[0], number / DIMS[0] % DIMS[1], number / (DIMS[0] * DIMS[1])]
}

fn number([x, y, z]: [usize; 3]) -> u32 {
    (x + DIMS[0] * (y + DIMS[1] * z)) as u32
}

/// The voxel that mirrors another one along x.
fn mirror(voxel: [usize; 3]) -> [usize; 3] {
    [DIMS[0] - 1 - voxel[0], voxel[1], voxel[2]]
}

/// Four regions, none in the middle.
fn regions(place: impl Fn([usize; 3]) -> [usize; 3]) -> Vec<Vec<u32>> {
    let inside: [fn([usize; 3]) -> bool; 4] =
        [|v| v[0] < 3, |v| v[0] > 6 && v[1] < 3, |v| v[1] > 4, |v| v[2] == 0 && v[0] < 6];
    let members =
        |inside: &fn([usize; 3]) -> bool| (0..COUNT).map(voxel).filter(|&v| inside(v)).collect::<Vec<_>>();
    inside.iter().map(|i| members(i).into_iter().map(|v| number(place(v))).collect()).collect()
}

const PAIRS: [[usize; 2]; 4] = [[0, 0], [1, 1], [2, 2], [3, 3]];

fn shape<'a>(
    basis: &'a Eigenbasis,
    regions: &'a [Vec<u32>],
    points: &'a [u32],
    weights: &'a [f64],
) -> MapShape<'a> {
    MapShape { basis, regions, points, weights }
}

#[test]
fn a_shape_is_mapped_to_itself_and_to_its_mirror_image() {
    let basis = truncated(&box_basis(DIMS, 0.1), 60);
    // The same shape in another size, with the signs of some eigenfunctions changed.
    let other = truncated(&box_basis(DIMS, 0.3), 60);
    let sign = |at: usize| if at.is_multiple_of(3) { -1.0 } else { 1.0 };
    let functions: Vec<f64> = other.functions().values().enumerate().map(|(i, x)| sign(i % 60) * x).collect();
    let other =
        Eigenbasis::new(other.domain(), other.mass().to_vec(), other.eigenvalues().to_vec(), functions)
            .unwrap();
    let (points, weights): (Vec<u32>, _) = ((0..COUNT as u32).collect(), vec![1.0; COUNT]);
    let (own, mirrored) = (regions(|v| v), regions(mirror));
    for samples in [8000, 150] {
        let params = DenseMapParameters { samples, ..DenseMapParameters::default() };
        let map = |regions: &[Vec<u32>]| {
            let first = shape(&basis, &own, &points, &weights);
            dense_map(&first, &shape(&other, regions, &points, &weights), &PAIRS, &params).unwrap()
        };
        assert_eq!(map(&own), points, "{samples} samples");
        let expected: Vec<u32> = (0..COUNT).map(|v| number(mirror(voxel(v)))).collect();
        assert_eq!(map(&mirrored), expected, "{samples} samples");
        assert_eq!(with_threads(1, || map(&own)), with_threads(3, || map(&own)));
    }
}

#[test]
fn points_are_named_by_their_place() {
    let basis = truncated(&box_basis(DIMS, 0.1), 60);
    let own = regions(|v| v);
    let (some, weights) = ([200, 7, 35], [1.0, 2.0, 0.5]);
    let first = shape(&basis, &own, &some, &weights);
    let second = shape(&basis, &own, &[35, 200], &weights[..2]);
    let params = DenseMapParameters::default();
    assert_eq!(dense_map(&first, &second, &PAIRS, &params).unwrap(), [2, 0]);
    // Without rounds the places among the regions decide.
    let coarse = DenseMapParameters { rounds: Vec::new(), signatures: 0.0, ..params };
    assert_eq!(dense_map(&first, &second, &PAIRS, &coarse).unwrap(), [2, 0]);
}

#[test]
fn what_cannot_be_mapped_is_refused() {
    let basis = truncated(&box_basis(DIMS, 0.1), 10);
    let zero = truncated(&basis, 1);
    let own = regions(|v| v);
    let params = DenseMapParameters::default();
    let good = shape(&basis, &own, &[0, 1], &[1.0; 2]);
    let map = |second: MapShape, pairs: &[[usize; 2]]| dense_map(&good, &second, pairs, &params);
    assert!(map(good, &PAIRS).is_ok());
    assert!(map(good, &[]).unwrap_err().to_string().contains("matched regions"));
    assert!(map(good, &[[0, 4]]).unwrap_err().to_string().contains("regions"));
    let flat = shape(&zero, &own, &[0, 1], &[1.0; 2]);
    assert!(matches!(map(flat, &PAIRS), Err(DescriptorError::OnlyZeroModes { .. })));
    let short = shape(&basis, &own, &[0, 1], &[1.0]);
    assert!(matches!(map(short, &PAIRS), Err(DescriptorError::SizeMismatch { found: 1, expected: 2, .. })));
    let beyond = shape(&basis, &own, &[0, 9999], &[1.0; 2]);
    assert!(matches!(map(beyond, &PAIRS), Err(DescriptorError::IndexOutOfRange { index: 9999, .. })));
    let empty = vec![Vec::new(); 4];
    let empty = shape(&basis, &empty, &[0, 1], &[1.0; 2]);
    assert!(matches!(map(empty, &PAIRS), Err(DescriptorError::EmptyRegion { region: 0 })));
    for wrong in [
        DenseMapParameters { times: vec![], ..params.clone() },
        DenseMapParameters { times: vec![0.0], ..params.clone() },
        DenseMapParameters { signature_times: vec![f64::NAN], ..params.clone() },
        DenseMapParameters { places: -1.0, ..params.clone() },
        DenseMapParameters { rounds: vec![0], ..params.clone() },
        DenseMapParameters { samples: 0, ..params.clone() },
    ] {
        assert!(matches!(dense_map(&good, &good, &PAIRS, &wrong), Err(DescriptorError::InvalidParameter(_))));
    }
}
