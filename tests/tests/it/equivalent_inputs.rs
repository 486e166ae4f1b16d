//! The same shape in other words: other numbers of threads, orders of faces, corners and vertices, other places and sizes. The
//! regions are the same, to the voxel where arithmetic is exact, else within the bound that each test states.

use mser3d::shape::{IndexSet, TriangleMesh};
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Features, Input, Parameters};

use mser3d_tests::{coarse, fixture, solid_features, vertex_sets};

const FIGURES: [&str; 3] = ["human_touch.off", "quadruped_rest.off", "plant_rest.off"];

/// All of a result that numbers of threads and orders must not change, bit by bit.
fn bits(features: &Features) -> Vec<u64> {
    let mut bits: Vec<u64> = Vec::new();
    let mut put = |x: f64| bits.push(x.to_bits());
    for body in &features.bodies {
        body.basis.eigenvalues().iter().copied().chain(body.basis.functions().values()).for_each(&mut put);
    }
    for region in &features.regions {
        region.elements.iter().for_each(|&e| put(f64::from(e)));
        let parent = region.parent.map_or(-1.0, |p| p as f64);
        [parent, region.altitude, region.stability, region.volume].into_iter().for_each(&mut put);
        region.side.into_iter().chain(region.reliability).for_each(&mut put);
    }
    features.descriptors.values().iter().for_each(|&x| put(x));
    if let Some(partition) = &features.partition {
        partition.part_of_element.iter().for_each(|&part| put(f64::from(part)));
    }
    bits
}

fn elements(features: &Features) -> Vec<&[u32]> {
    features.regions.iter().map(|region| &region.elements[..]).collect()
}

/// Numbers from a seed, the same every time.
fn shuffled(count: usize, seed: u64) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    order.sort_by_key(|&i| {
        (u64::from(i) ^ seed).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29).wrapping_mul(seed | 1)
    });
    order
}

#[test]
fn threads_and_the_chunks_that_follow_from_them_change_no_bit() {
    let mesh = fixture("human_rest.off");
    // Beyond 65,536 elements trees are built in pieces, whose number is that of the threads.
    for (voxels, eigenpairs, copies) in [(70_000, 12, 0), (4000, 40, 2)] {
        let mut parameters = coarse(voxels, eigenpairs);
        parameters.reliability.deformations = Some(copies);
        let run = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| solid_features(&mesh, &parameters))
        };
        let one = run(1);
        assert!(one.regions.len() > 5 && one.shape.len() > voxels * 9 / 10);
        for threads in [2, 5] {
            assert!(bits(&run(threads)) == bits(&one), "{threads} threads, {voxels} voxels");
        }
    }
}

/// A mesh with its vertices, faces and corners in another order, and the new number of each vertex.
fn reordered(mesh: &TriangleMesh, seed: u64) -> (TriangleMesh, Vec<u32>) {
    let order = shuffled(mesh.vertices().len(), seed);
    let mut place = vec![0; order.len()];
    (0u32..).zip(&order).for_each(|(new, &old)| place[old as usize] = new);
    let vertices = order.iter().map(|&old| mesh.vertices()[old as usize]).collect();
    let faces = shuffled(mesh.triangles().len(), seed ^ 77);
    let triangles = faces.iter().map(|&face| {
        let mut corners = mesh.triangles()[face as usize].map(|v| place[v as usize]);
        corners.rotate_left(((u64::from(face) ^ seed) % 3) as usize);
        corners
    });
    (TriangleMesh::new(vertices, triangles.collect()).unwrap(), place)
}

#[test]
fn the_order_of_vertices_faces_and_corners_changes_no_voxel() {
    for name in FIGURES {
        let mesh = fixture(name);
        // With a pitch of its own the grid is the same to the last bit, and so is all that follows.
        let mut fixed = coarse(4000, 40);
        fixed.voxelize.pitch = Pitch::Size((mesh.signed_volume() / 4000.0).cbrt());
        // Without one, the volume that it is made of is summed in the order of the faces.
        for (parameters, exact) in [(fixed, true), (coarse(4000, 40), false)] {
            let first = solid_features(&mesh, &parameters);
            assert!(first.regions.len() > 4, "{name}: {}", first.regions.len());
            for seed in [1, 2] {
                let (other, place) = reordered(&mesh, seed);
                let found = solid_features(&other, &parameters);
                assert_eq!(elements(&found), elements(&first), "{name}");
                assert!(!exact || bits(&found) == bits(&first), "{name}");
                for (a, b) in first.regions.iter().zip(&found.regions) {
                    let mut moved: Vec<u32> = a.vertices.iter().map(|&v| place[v as usize]).collect();
                    moved.sort_unstable();
                    assert_eq!(moved, b.vertices, "{name}: vertices of a region");
                }
            }
        }
    }
}

#[test]
fn the_order_of_vertices_and_faces_of_a_surface_changes_no_region() {
    let parameters = coarse(4000, 40);
    let detect =
        |mesh: &TriangleMesh| Detector::new(parameters.clone()).detect(Input::Surface(mesh)).unwrap();
    for name in FIGURES {
        let mesh = fixture(name);
        let first = detect(&mesh);
        let (other, place) = reordered(&mesh, 3);
        let found = detect(&other);
        let of = |features: &Features, place: &dyn Fn(u32) -> u32| {
            let mut sets: Vec<Vec<u32>> = features
                .regions
                .iter()
                .map(|region| {
                    let mut set: Vec<u32> = region.vertices.iter().map(|&v| place(v)).collect();
                    set.sort_unstable();
                    set
                })
                .collect();
            sets.sort();
            sets
        };
        assert!(first.regions.len() > 2, "{name}: {}", first.regions.len());
        assert_eq!(of(&first, &|v| place[v as usize]), of(&found, &|v| v), "{name}");
    }
}

/// Coordinates as multiples of 2^-20, so that sums with whole numbers below 2^30 are exact.
fn rounded(mesh: &TriangleMesh) -> TriangleMesh {
    mapped(mesh, |p| p.map(|x| (x * 1_048_576.0).round() / 1_048_576.0))
}

fn mapped(mesh: &TriangleMesh, map: impl Fn([f64; 3]) -> [f64; 3]) -> TriangleMesh {
    mesh.with_vertices(mesh.vertices().iter().map(|&p| map(p)).collect()).unwrap()
}

/// A pitch of a power of two for about this many voxels.
fn dyadic(mesh: &TriangleMesh, voxels: f64) -> Parameters {
    let mut parameters = coarse(4000, 40);
    let pitch = (mesh.signed_volume() / voxels).cbrt().log2().round().exp2();
    parameters.voxelize.pitch = Pitch::Size(pitch);
    parameters
}

#[test]
fn shifts_by_whole_voxels_and_far_from_the_origin_move_the_regions_and_change_no_voxel() {
    for name in FIGURES {
        let mesh = rounded(&fixture(name));
        let parameters = dyadic(&mesh, 4000.0);
        let Pitch::Size(pitch) = parameters.voxelize.pitch else { panic!("a pitch") };
        let first = solid_features(&mesh, &parameters);
        assert!(first.regions.len() > 4, "{name}: {}", first.regions.len());
        for shift in [[1.0, -2.0, 5.0], [-1000.0, 0.0, 77.0], [1e6, 1e6, -1e6], [1e8, -3e7, 1e8]] {
            let by = shift.map(|s: f64| s * pitch);
            let found = solid_features(&mapped(&mesh, |p| [0, 1, 2].map(|a| p[a] + by[a])), &parameters);
            assert_eq!(elements(&found), elements(&first), "{name}: {shift:?}");
            let parents = |f: &Features| f.regions.iter().map(|r| r.parent).collect::<Vec<_>>();
            assert_eq!(parents(&found), parents(&first));
            for (a, b) in first.regions.iter().zip(&found.regions) {
                assert_eq!((a.volume, &a.vertices), (b.volume, &b.vertices), "{name}");
                let far = (0..3).map(|i| (b.centroid[i] - by[i] - a.centroid[i]).abs()).fold(0.0, f64::max);
                // What is left of a centroid when the shift is taken away again.
                assert!(far <= 1e-6 * pitch * (1.0 + shift[0].abs() * 1e-6), "{name}: {far:e}");
            }
        }
    }
}

#[test]
fn powers_of_two_as_a_size_change_no_voxel() {
    for name in FIGURES {
        let mesh = fixture(name);
        let parameters = coarse(4000, 40);
        let first = solid_features(&mesh, &parameters);
        for exponent in [-30, -1, 3, 20] {
            let found =
                solid_features(&mapped(&mesh, |p| p.map(|x| x * f64::from(exponent).exp2())), &parameters);
            assert_eq!(elements(&found), elements(&first), "{name}: 2^{exponent}");
            for (a, b) in first.regions.iter().zip(&found.regions) {
                assert_eq!(&a.vertices, &b.vertices, "{name}: 2^{exponent}");
            }
        }
    }
}

/// The overlap of each region of one with the best region of the other, of vertices of the mesh: 2 |a ∩ b| / (|a| + |b|).
fn overlaps(a: &Features, b: &Features) -> Vec<f64> {
    let [a, b] = [a, b].map(vertex_sets);
    let overlap = |x: &IndexSet, y: &IndexSet| {
        let shared = x.members().filter(|&v| y.contains(v)).count() as f64;
        2.0 * shared / (x.members().count() + y.members().count()) as f64
    };
    a.iter().map(|x| b.iter().map(|y| overlap(x, y)).fold(0.0, f64::max)).collect()
}

/// A factor that is no power of two, and a place that is no whole number of voxels away, round all coordinates: voxels whose centre
/// is on the surface, to the last bits, may change, and with them regions that are at a threshold. Measured: of 1,024 regions 1,020
/// are found again to the vertex, four with an overlap of 0.95.
#[test]
fn any_size_and_place_keep_the_regions_within_a_bound() {
    let mut all = Vec::new();
    for name in FIGURES {
        let mesh = fixture(name);
        let parameters = coarse(4000, 40);
        let first = solid_features(&mesh, &parameters);
        let others =
            [(7.0, 100.0), (0.3, -0.1), (1e-3, 5.0), (1e5, 0.0), (1.0, 1e6), (std::f64::consts::PI, 3e4)];
        for (factor, shift) in others {
            let found = solid_features(&mapped(&mesh, |p| p.map(|x| factor * x + shift)), &parameters);
            let [was, is] = [&first, &found].map(|f| f.regions.len());
            assert!(was.abs_diff(is) <= 1, "{name}: {factor} x + {shift}: {is} regions, {was} expected");
            let [was, is] = [&first, &found].map(|f| f.shape.len());
            assert!(was.abs_diff(is) <= 4, "{name}: {factor} x + {shift}: {is} voxels, {was} expected");
            all.extend(overlaps(&first, &found));
            all.extend(overlaps(&found, &first));
        }
    }
    all.sort_by(f64::total_cmp);
    let again = all.iter().filter(|overlap| **overlap >= 0.97).count();
    println!("{again} of {} regions overlap by 0.97; the least: {:?}", all.len(), &all[..8]);
    assert!(again * 100 >= all.len() * 99 && all[0] > 0.9, "{:?}", &all[..8]);
}
