//! Quarter turns and mirror images: the same regions, to the voxel.

use mser3d::shape::TriangleMesh;
use mser3d::{Detector, Features, Input};

use mser3d_tests::{coarse, fixture};

/// A signed order of the axes: coordinate a of the image is `sign[a]` times coordinate `order[a]`.
#[derive(Clone, Copy, Debug)]
struct Swap {
    order: [usize; 3],
    sign: [f64; 3],
}

impl Swap {
    /// All 48; the 24 that keep right and left are turns.
    fn all() -> Vec<Self> {
        let orders = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
        let signs = |bits: i32| [0, 1, 2].map(|a| if bits >> a & 1 == 1 { -1.0 } else { 1.0 });
        orders
            .into_iter()
            .flat_map(|order| (0..8).map(move |bits| Self { order, sign: signs(bits) }))
            .collect()
    }

    fn is_turn(&self) -> bool {
        let even = matches!(self.order, [0, 1, 2] | [1, 2, 0] | [2, 0, 1]);
        even == (self.sign.iter().product::<f64>() > 0.0)
    }

    fn of(&self, mesh: &TriangleMesh) -> TriangleMesh {
        let image = |p: &[f64; 3]| [0, 1, 2].map(|a| self.sign[a] * p[self.order[a]]);
        // A mirror image is turned inside out; its triangles are turned over.
        let triangle = |&[a, b, c]: &[u32; 3]| if self.is_turn() { [a, b, c] } else { [a, c, b] };
        let triangles = mesh.triangles().iter().map(triangle).collect();
        TriangleMesh::new(mesh.vertices().iter().map(image).collect(), triangles).unwrap()
    }

    fn back(&self, p: [f64; 3]) -> [f64; 3] {
        let mut original = [0.0; 3];
        (0..3).for_each(|a| original[self.order[a]] = self.sign[a] * p[a]);
        original
    }
}

/// The voxels of each region as whole numbers of half pitches from the body's middle, turned back; in order.
fn regions(features: &Features, mesh: &TriangleMesh, swap: &Swap) -> Vec<Vec<[i64; 3]>> {
    let bounds = mesh.bounding_box().unwrap();
    let grid = features.shape.grid().unwrap();
    let spacing = swap.back(grid.frame().spacing()).map(f64::abs);
    let place = |&e: &u32| -> [i64; 3] {
        let p = swap.back(features.shape.positions().at(e));
        let middle = [0, 1, 2].map(|a| (bounds.min[a] + bounds.max[a]) / 2.0);
        [0, 1, 2].map(|a| (2.0 * (p[a] - middle[a]) / spacing[a]).round() as i64)
    };
    let mut all: Vec<Vec<[i64; 3]>> = features
        .regions
        .iter()
        .map(|region| {
            let mut voxels: Vec<[i64; 3]> = region.elements.iter().map(place).collect();
            voxels.sort_unstable();
            voxels
        })
        .collect();
    all.sort();
    all
}

fn same_in_all(mesh: &TriangleMesh, voxels: usize, swaps: &[Swap]) {
    let detector = Detector::new(coarse(voxels, 40));
    let of = |swap: &Swap| detector.detect(Input::Volume(&swap.of(mesh))).unwrap();
    let first = of(&swaps[0]);
    let expected = regions(&first, mesh, &swaps[0]);
    let eigenvalues = first.bodies[0].basis.eigenvalues();
    assert!(expected.len() > 4);
    for swap in swaps {
        let found = of(swap);
        for (a, b) in found.bodies[0].basis.eigenvalues().iter().zip(eigenvalues) {
            assert!((a - b).abs() <= 1e-9 * b.abs(), "{swap:?}: {a} {b}");
        }
        let found = regions(&found, mesh, swap);
        let only = |a: &[Vec<[i64; 3]>], b: &[Vec<[i64; 3]>]| -> Vec<usize> {
            a.iter().filter(|region| !b.contains(region)).map(Vec::len).collect()
        };
        let lost = (only(&expected, &found), only(&found, &expected));
        assert_eq!(lost, Default::default(), "{swap:?}: sizes of regions that were lost, and of new ones");
    }
}

#[test]
fn regions_turn_with_the_body_and_its_mirror_image() {
    same_in_all(&fixture("human_rest.off"), 5000, &Swap::all());
    let few: Vec<Swap> = Swap::all().into_iter().step_by(7).collect();
    same_in_all(&fixture("quadruped_rest.off"), 5000, &few);
}

/// All of it on real bodies: `cargo test --release -p mser3d-tests -- --ignored turns`.
#[test]
#[ignore = "takes minutes"]
fn regions_of_real_bodies_turn_with_them() {
    for name in ["data/odedstein/spot.obj", "data/people/woman_rest.off", "data/makehuman/03_walk.off"] {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared").join(name);
        if !path.exists() {
            eprintln!("skipped: {name} is not there");
            continue;
        }
        let mesh = mser3d_meshio::read_mesh(&path, &Default::default()).unwrap().mesh;
        same_in_all(&mesh, 45_000, &Swap::all());
    }
}
