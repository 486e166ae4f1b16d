//! Solids of small soups of triangles beside crossings that are counted in integers.

use arbitrary::Unstructured;
use mser3d_shape::{BitGrid, Frame, TriangleMesh};
use mser3d_voxelize::{InsideTest, Overlap, VoxelizeError, VoxelizeParameters, inside, voxelize};

/// Centres of voxels are at 0, ..., SIDE - 1 along each axis; corners of triangles at integers too, so ties abound.
const SIDE: usize = 9;

type Point = [i64; 3];

pub fn run(input: &[u8]) {
    let _ = soup(&mut Unstructured::new(input));
}

fn soup(input: &mut Unstructured) -> arbitrary::Result<()> {
    let kind = input.arbitrary::<u8>()?;
    // Halves, so that not all ties are with centres.
    let scale = if kind & 1 == 0 { 1 } else { 2 };
    let count = input.int_in_range(4..=10usize)?;
    let point = |input: &mut Unstructured| -> arbitrary::Result<Point> {
        let mut point = [0; 3];
        for x in &mut point {
            *x = input.int_in_range(0..=(SIDE as i64 - 1) * scale)?;
        }
        Ok(point)
    };
    if kind & 2 == 0 {
        // Tetrahedra that share corners, faces turned at random: every edge has an even number of triangles.
        let points: Vec<Point> = (0..count).map(|_| point(input)).collect::<Result<_, _>>()?;
        let mut triangles = Vec::new();
        for _ in 0..input.int_in_range(1..=4)? {
            let mut corners = [0u32; 4];
            for corner in &mut corners {
                *corner = input.int_in_range(0..=count as u32 - 1)?;
            }
            let [a, b, c, d] = corners;
            for face in [[a, c, b], [a, b, d], [b, c, d], [a, d, c]] {
                let [x, y, z] = face;
                triangles.push(if input.arbitrary::<bool>()? { [x, z, y] } else { face });
            }
        }
        check_parity(&points, &triangles, scale);
    } else {
        // Tetrahedra on their own, facing outwards: each centre is covered by as many as hold it.
        let mut points: Vec<Point> = Vec::new();
        let mut triangles = Vec::new();
        for _ in 0..input.int_in_range(1..=3)? {
            let first = points.len() as u32;
            let own: Vec<Point> = (0..4).map(|_| point(input)).collect::<Result<_, _>>()?;
            let faces = match volume(&own).signum() {
                0 => continue,
                1 => [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
                _ => [[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]],
            };
            if own.iter().any(|p| points.contains(p)) {
                continue;
            }
            points.extend(own);
            triangles.extend(faces.map(|face| face.map(|v: u32| v + first)));
        }
        check_covers(&points, &triangles, scale);
    }
    Ok(())
}

fn check_parity(points: &[Point], triangles: &[[u32; 3]], scale: i64) {
    let expected = voxels(|centre| {
        crossings(points, triangles, centre, scale).iter().map(|c| c.abs()).sum::<i64>() % 2 == 1
    });
    for test in [InsideTest::Parity, InsideTest::Vote] {
        compare(points, triangles, scale, test, Overlap::Auto, &expected);
    }
}

fn check_covers(points: &[Point], triangles: &[[u32; 3]], scale: i64) {
    let covers = |centre: Point| crossings(points, triangles, centre, scale).iter().sum::<i64>();
    for (overlap, holds) in [(Overlap::Join, (|n| n >= 1) as fn(i64) -> bool), (Overlap::Part, |n| n == 1)] {
        let expected = voxels(|centre| holds(covers(centre)));
        compare(points, triangles, scale, InsideTest::Winding, overlap, &expected);
    }
}

fn voxels(inside: impl Fn(Point) -> bool) -> Vec<bool> {
    let side = SIDE as i64;
    let centres = (0..side).flat_map(|k| (0..side).flat_map(move |j| (0..side).map(move |i| [i, j, k])));
    centres.map(inside).collect()
}

/// Where the line along x through a centre goes through triangles before the centre: 1 into the front, -1 out of it. The centre
/// is moved by infinitesimals, the largest along x, the smallest along z.
fn crossings(points: &[Point], triangles: &[[u32; 3]], centre: Point, scale: i64) -> Vec<i64> {
    let p = centre.map(|x| x * scale);
    let crossing = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| points[v as usize]);
        // On which side of an edge the line passes, seen along x.
        let turn = |u: Point, v: Point| {
            let [dy, dz] = [v[1] - u[1], v[2] - u[2]];
            let exact = dy * (p[2] - u[2]) - dz * (p[1] - u[1]);
            [exact, -dz, dy].into_iter().find(|x| *x != 0).map_or(0, i64::signum)
        };
        let turns = [turn(a, b), turn(b, c), turn(c, a)];
        if turns[0] == 0 || turns != [turns[0]; 3] {
            return 0;
        }
        let normal = normal(a, b, c);
        let height: i64 = (0..3).map(|i| normal[i] * (p[i] - a[i])).sum();
        let front = normal[0].signum();
        let beyond = if height == 0 { true } else { height.signum() == front };
        // A line goes in where the front looks against it.
        if beyond { -front } else { 0 }
    };
    triangles.iter().map(crossing).filter(|c| *c != 0).collect()
}

fn normal(a: Point, b: Point, c: Point) -> Point {
    let [e, f]: [Point; 2] = [[0, 1, 2].map(|i| b[i] - a[i]), [0, 1, 2].map(|i| c[i] - a[i])];
    [e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0]]
}

/// Six times the signed volume of a tetrahedron.
fn volume(points: &[Point]) -> i64 {
    let n = normal(points[0], points[1], points[2]);
    (0..3).map(|i| n[i] * (points[3][i] - points[0][i])).sum()
}

fn compare(
    points: &[Point],
    triangles: &[[u32; 3]],
    scale: i64,
    test: InsideTest,
    overlap: Overlap,
    expected: &[bool],
) {
    let vertices = points.iter().map(|p| p.map(|x| x as f64 / scale as f64)).collect();
    let Ok(mesh) = TriangleMesh::new(vertices, triangles.to_vec()) else { return };
    let frame = Frame::new([SIDE; 3], [-0.5; 3], [1.0; 3]).unwrap_or_else(|error| panic!("{error}"));
    let parameters = VoxelizeParameters {
        frame: Some(frame),
        inside: test,
        overlap,
        largest_only: false,
        ..VoxelizeParameters::default()
    };
    let occupancy = match voxelize(&mesh, &parameters) {
        Ok(solid) => solid.grid.occupancy().clone(),
        Err(error) => {
            // A thin or empty solid has no voxel; a mesh of points and lines no surface.
            let empty = !expected.contains(&true);
            let thin = matches!(error, VoxelizeError::Thin { .. });
            assert!(empty || !thin, "{error}: {} expected", expected.iter().filter(|x| **x).count());
            assert!(empty, "{error}: {points:?} {triangles:?}");
            return;
        }
    };
    check(&occupancy, expected, points, triangles, test, overlap);
    let (_, alone) = inside(&mesh, &parameters).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(alone, occupancy);
}

fn check(
    occupancy: &BitGrid,
    expected: &[bool],
    points: &[Point],
    triangles: &[[u32; 3]],
    test: InsideTest,
    overlap: Overlap,
) {
    for (number, expected) in expected.iter().enumerate() {
        let voxel = [number % SIDE, number / SIDE % SIDE, number / SIDE / SIDE].map(|x| x as u32);
        assert_eq!(
            occupancy.get(voxel),
            *expected,
            "{test} {overlap} at {voxel:?}: {points:?} {triangles:?}"
        );
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    (0..16u8)
        .map(|kind| (0..96u8).map(|i| if i == 0 { kind } else { i.wrapping_mul(kind | 1) }).collect())
        .collect()
}
