//! Vertices of limbs that all but touch belong to their own limb.

use mser3d::DiscreteShape;
use mser3d::shape::{Frame, TriangleMesh};
use mser3d::voxelize::VoxelizeParameters;

/// Slices along z.
const SLICES: u32 = 10;

/// A fork: two prongs of 4 x 9, apart by 0.3, on a base; 10 deep. Turned inside out if asked.
fn fork(turned: bool) -> TriangleMesh {
    let outline =
        [[0.0, 0.0], [8.3, 0.0], [8.3, 12.0], [4.3, 12.0], [4.3, 3.0], [4.0, 3.0], [4.0, 12.0], [0.0, 12.0]];
    let n = outline.len() as u32;
    let vertices =
        (0..=SLICES).flat_map(|z| outline.map(|[x, y]| [x, y, f64::from(z)])).collect::<Vec<[f64; 3]>>();
    let mut triangles = Vec::new();
    for z in 0..SLICES {
        for i in 0..n {
            let [a, b] = [z * n + i, z * n + (i + 1) % n];
            triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
        }
    }
    // The U as triangles, seen from z = infinity.
    let cap = [[0, 1, 4], [0, 4, 5], [1, 2, 3], [1, 3, 4], [0, 5, 7], [5, 6, 7]];
    triangles.extend(cap.map(|t| t.map(|i| SLICES * n + i)));
    triangles.extend(cap.map(|[a, b, c]| [a, c, b]));
    if turned {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn a_vertex_belongs_to_the_prong_that_it_is_on() {
    // Centres at 3.4 and 4.4: the inner wall of the left prong, at 4, is nearer to those of the right one. And the other way.
    for (first, nearer) in [(0.4, 4.4), (-0.1, 3.9)] {
        for turned in [false, true] {
            let mesh = fork(turned);
            let frame = Frame::new([10, 14, 12], [first - 0.5, -0.6, -0.6], [1.0; 3]).unwrap();
            let parameters = VoxelizeParameters { frame: Some(frame), ..Default::default() };
            let (shape, _) = DiscreteShape::volume(&mesh, &parameters).unwrap();
            let mut walls = 0;
            for (vertex, element) in mesh.vertices().iter().zip(shape.element_of_vertex()) {
                let voxel = shape.positions().at(element.unwrap());
                let away = (0..3).map(|a| (voxel[a] - vertex[a]).powi(2)).sum::<f64>().sqrt();
                assert!(away < 2.0, "{vertex:?} {voxel:?}");
                if vertex[1] == 12.0 {
                    assert_eq!(voxel[0] < 4.15, vertex[0] < 4.15, "{vertex:?} {voxel:?} {nearer}");
                    walls += usize::from((vertex[0] - 4.15).abs() < 1.0);
                }
            }
            assert_eq!(walls, 2 * (SLICES as usize + 1));
        }
    }
}
