//! Facts about the operators that hold whatever solves them.

use mser3d_laplace::{
    GridStencil, LaplaceError, Operator, aggregate_grid, cotangent_laplacian, grid_laplacian, sprs::TriMat,
};
use mser3d_shape::{BitGrid, Domain, Frame, TriangleMesh, VoxelGrid};

fn lumpy_grid(spacing: [f64; 3]) -> VoxelGrid {
    let dims = [9, 8, 7];
    let mut inside = BitGrid::full(dims).unwrap();
    for v in [[0, 0, 0], [4, 4, 3], [5, 4, 3], [8, 7, 6], [4, 0, 3]] {
        inside.set(v, false);
    }
    let grid = VoxelGrid::solid(Frame::new(dims, [0.0; 3], spacing).unwrap(), inside.clone()).unwrap();
    let mut links = grid.links().clone();
    links[1].set([2, 2, 2], false); // one cut link
    VoxelGrid::new(*grid.frame(), inside, links).unwrap()
}

fn apply(operator: &Operator, x: &[f64]) -> Vec<f64> {
    let mut y = vec![0.0; x.len()];
    for (&value, (row, column)) in operator.stiffness().iter() {
        y[row] += value * x[column];
    }
    y
}

#[test]
fn assembled_operators_are_laplacians() {
    let grid = grid_laplacian(&lumpy_grid([0.5, 1.0, 2.0]));
    let octahedron = octahedron();
    let mesh = cotangent_laplacian(&octahedron).unwrap();
    for operator in [grid, mesh] {
        // The checked constructor verifies symmetry and masses.
        Operator::new(operator.domain(), operator.stiffness().clone(), operator.mass().to_vec()).unwrap();
        assert!((0..operator.len()).all(|row| operator.sums_to_zero(row)));
        assert!(operator.is_known_semidefinite());
        assert_eq!(operator.components().len(), 1);
    }
}

#[test]
fn the_grid_reproduces_a_quadratic_inside() {
    // L (x^2) = -2 away from the boundary, at any spacing.
    let frame = Frame::new([7, 6, 5], [-1.0, 3.0, 0.0], [0.5, 0.25, 2.0]).unwrap();
    let grid = VoxelGrid::solid(frame, BitGrid::full(frame.dims()).unwrap()).unwrap();
    let operator = grid_laplacian(&grid);
    for axis in 0..3 {
        let values: Vec<f64> = grid.voxels().map(|v| frame.centre(v)[axis].powi(2)).collect();
        let result = apply(&operator, &values);
        for (v, voxel) in grid.voxels().enumerate() {
            if voxel[axis] > 0 && (voxel[axis] as usize) < frame.dims()[axis] - 1 {
                assert!((result[v] / operator.mass()[v] + 2.0).abs() < 1e-9);
            }
        }
    }
}

#[test]
fn the_stencil_is_the_matrix_divided_by_the_mass() {
    let grid = lumpy_grid([0.5, 1.0, 2.0]);
    let (operator, stencil) = (grid_laplacian(&grid), GridStencil::new(&grid));
    let x: Vec<f64> = (0..grid.len()).map(|v| ((v * v) as f64).sin()).collect();
    let expected = apply(&operator, &x);
    for v in 0..grid.len() {
        let difference = |slot: usize| x[v] - x[stencil.neighbours()[v][slot] as usize];
        let value: f64 = (0..3).map(|a| stencil.weights()[a] * (difference(2 - a) + difference(3 + a))).sum();
        assert!((value * stencil.voxel_volume() - expected[v]).abs() < 1e-12);
    }
}

fn octahedron() -> TriangleMesh {
    let vertices =
        vec![[1., 0., 0.], [-1., 0., 0.], [0., 1., 0.], [0., -1., 0.], [0., 0., 1.], [0., 0., -1.]];
    let triangles =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn cotangents_of_equilateral_triangles() {
    // Every edge of an octahedron has two opposite angles of 60 degrees: W_uv = -cot 60.
    let operator = cotangent_laplacian(&octahedron()).unwrap();
    assert_eq!(operator.domain(), Domain::Surface);
    assert!((operator.stiffness().get(0, 2).unwrap() + 1.0 / 3f64.sqrt()).abs() < 1e-12);
    assert_eq!(operator.stiffness().get(0, 1).copied().unwrap_or(0.0), 0.0);
    let area: f64 = operator.mass().iter().sum();
    assert!((area - 4.0 * 3f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_flipped_triangle_changes_nothing_and_a_degenerate_one_adds_nothing() {
    let mesh = octahedron();
    let mut triangles = mesh.triangles().to_vec();
    triangles[3].swap(0, 1);
    triangles.push([0, 0, 1]);
    triangles.push([0, 6, 1]); // a sliver through an otherwise unused vertex at the centre
    let mut vertices = mesh.vertices().to_vec();
    vertices.push([0.0; 3]);
    let other = cotangent_laplacian(&TriangleMesh::new(vertices, triangles).unwrap()).unwrap();
    let operator = cotangent_laplacian(&mesh).unwrap();
    assert_eq!(other.mass()[6], 0.0);
    for (&value, (row, column)) in operator.stiffness().iter() {
        assert!((other.stiffness().get(row, column).unwrap() - value).abs() < 1e-14);
    }
}

#[test]
fn a_mesh_without_area_is_an_error() {
    let flat = TriangleMesh::new(vec![[0.0; 3]; 3], vec![[0, 1, 2]]).unwrap();
    assert!(cotangent_laplacian(&flat).unwrap_err().to_string().contains("no triangle with an area (of 1)"));
}

#[test]
fn aggregation_keeps_components_volume_and_cut_links() {
    let grid = lumpy_grid([1.0; 3]).restrict(|v| v % 9 != 4); // a wall of empty voxels: two bodies
    for factor in [1, 2, 3] {
        let coarse = aggregate_grid(&grid, factor);
        assert_eq!(coarse.operator.components().len(), grid.components().len());
        assert!((coarse.operator.mass().iter().sum::<f64>() - grid.volume()).abs() < 1e-9);
    }
    let fine = grid_laplacian(&grid);
    let same = aggregate_grid(&grid, 1).operator;
    assert_eq!(same.mass(), fine.mass());
    for (&value, (row, column)) in fine.stiffness().iter() {
        assert!((same.stiffness().get(row, column).unwrap() - value).abs() < 1e-12);
    }
}

/// The matrix [[a, b], [c, d]] with masses.
fn two(entries: [[f64; 2]; 2], mass: [f64; 2]) -> Result<Operator, LaplaceError> {
    let mut stiffness = TriMat::new((2, 2));
    for (row, values) in entries.iter().enumerate() {
        for (column, &value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
            stiffness.add_triplet(row, column, value);
        }
    }
    Operator::new(Domain::Surface, stiffness.to_csr(), mass.to_vec())
}

#[test]
fn any_symmetric_matrix_is_an_operator_and_no_other() {
    // Free ends, held ends, one end held by a millionth, not known to be semidefinite though it is,
    // indefinite.
    for (entries, sums_to_zero, known) in [
        ([[1.0, -1.0], [-1.0, 1.0]], [true, true], true),
        ([[2.0, -1.0], [-1.0, 2.0]], [false, false], true),
        ([[1.0, -1.0], [-1.0, 1.0 + 1e-6]], [true, false], true),
        ([[1.0, 2.0], [2.0, 5.0]], [false, false], false),
        ([[-1.0, 1.0], [1.0, -1.0]], [true, true], false),
        ([[0.0; 2]; 2], [true, true], true),
    ] {
        let operator = two(entries, [1.0, 2.0]).unwrap();
        assert_eq!([0, 1].map(|row| operator.sums_to_zero(row)), sums_to_zero, "{entries:?}");
        assert_eq!(operator.is_known_semidefinite(), known, "{entries:?}");
        assert_eq!(operator.restrict(&[0, 1]).is_known_semidefinite(), known);
    }
    let held = [[2.0, -1.0], [-1.0, 2.0]];
    for (entries, mass, reason) in [
        ([[2.0, -1.0], [-1.5, 2.0]], [1.0; 2], "not symmetric"),
        ([[f64::NAN, -1.0], [-1.0, 2.0]], [1.0; 2], "not finite"),
        (held, [1.0, -1.0], "the mass is negative"),
        (held, [f64::INFINITY, 1.0], "the mass is negative or not finite"),
        (held, [1.0, 0.0], "stiffness but no mass"),
    ] {
        let error = two(entries, mass).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
    let error = Operator::new(Domain::Surface, TriMat::new((2, 2)).to_csc(), vec![1.0; 3]).unwrap_err();
    assert_eq!(error, LaplaceError::SizeMismatch { rows: 2, columns: 2, masses: 3 });
}
