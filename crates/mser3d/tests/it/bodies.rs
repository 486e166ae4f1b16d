//! Shapes of several bodies, and surfaces that fall apart along seams.

use mser3d::shape::{BitGrid, Connectivity, Frame, TriangleMesh, VoxelGrid};
use mser3d::spectral::EigenpairRange;
use mser3d::voxelize::Pitch;
use mser3d::{
    Bodies, Detector, DiscreteShape, Domain, Elements, Error, Features, Input, Parameters, Warning,
};

use crate::{club, cuboid, parameters, regions, shared};

/// Both meshes in one, the second moved.
fn both(a: &TriangleMesh, b: &TriangleMesh, by: [f64; 3]) -> TriangleMesh {
    let first = a.vertices().len() as u32;
    let moved = b.vertices().iter().map(|p| std::array::from_fn(|i| p[i] + by[i]));
    let vertices = a.vertices().iter().copied().chain(moved).collect();
    let triangles = b.triangles().iter().map(|t| t.map(|v| v + first));
    TriangleMesh::new(vertices, a.triangles().iter().copied().chain(triangles).collect()).unwrap()
}

/// A large club and a small one beyond its handle.
fn two_clubs(apart: f64) -> TriangleMesh {
    both(&club(1.0), &club(0.5), [12.0 + apart, 0.0, 0.0])
}

fn with(bodies: Bodies) -> Parameters {
    Parameters { bodies, ..parameters() }
}

fn detect(bodies: Bodies, input: Input) -> Features {
    Detector::new(with(bodies)).detect(input).unwrap()
}

/// Triangles with vertices of their own.
fn soup(mesh: &TriangleMesh) -> TriangleMesh {
    let vertices = (0..mesh.triangles().len()).flat_map(|t| mesh.corners(t)).collect();
    let triangles = (0..mesh.triangles().len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// A closed tube around the x axis with bumps, fine enough to be searched as a surface.
fn vase(around: u32, along: u32) -> TriangleMesh {
    let ring = |i: u32| {
        let x = f64::from(i) / f64::from(along - 1);
        let radius = 0.05 + 0.3 * (9.0 * x).sin().powi(2) * (1.2 - x);
        (0..around).map(move |j| {
            let angle = f64::from(j) / f64::from(around) * std::f64::consts::TAU;
            [4.0 * x, radius * angle.cos(), radius * angle.sin()]
        })
    };
    let mut vertices: Vec<[f64; 3]> = (0..along).flat_map(ring).collect();
    let mut triangles = Vec::new();
    for i in 0..along - 1 {
        for j in 0..around {
            let next = (j + 1) % around;
            let [a, b, c, d] =
                [i * around + j, i * around + next, (i + 1) * around + j, (i + 1) * around + next];
            triangles.extend([[a, c, b], [b, c, d]]);
        }
    }
    vertices.extend([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
    let (first, last) = (vertices.len() as u32 - 2, (along - 1) * around);
    for j in 0..around {
        let next = (j + 1) % around;
        triangles.extend([[first, j, next], [first + 1, last + next, last + j]]);
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

#[test]
fn vertices_of_a_body_that_is_left_out_have_no_region() {
    for apart in [0.5, 30.0] {
        let mesh = two_clubs(apart);
        let features = detect(Bodies::Largest, Input::Volume(&mesh));
        // The large one alone, on the same grid.
        let mut parameters = with(Bodies::Largest);
        parameters.voxelize.frame = Some(*features.shape.grid().unwrap().frame());
        let alone = Detector::new(parameters).detect(Input::Volume(&club(1.0))).unwrap();
        assert!(alone.warnings.iter().all(|w| !matches!(w, Warning::SmallerComponents { .. })));
        assert_eq!(regions(&features), regions(&alone));
        let elements = features.shape.element_of_vertex();
        assert_eq!(&elements[..16], alone.shape.element_of_vertex());
        assert_eq!(&elements[16..], [None; 16]);
        assert_eq!(features.region_of_vertex()[16..], [None; 16]);
        let voxelization = features.voxelization.as_ref().unwrap();
        let dropped = voxelization.dropped_voxels;
        let fraction = dropped as f64 / (dropped + features.shape.len()) as f64;
        let (components, bodies, domain) = (1, vec![dropped], Domain::Volume);
        let warning = Warning::SmallerComponents { components, elements: dropped, fraction, bodies, domain };
        assert!(features.warnings.contains(&warning), "{:?}", features.warnings);
        assert!((fraction - 1.0 / 9.0).abs() < 0.03, "{fraction}: about an eighth of the large one");
        assert_eq!((voxelization.dropped_components, voxelization.topology.components), (1, 1));
        // What the voxelizer says of a solid of which it dropped the rest itself.
        let mut parameters = features.parameters.voxelize.clone();
        parameters.largest_only = true;
        assert_eq!(voxelization, &mser3d::voxelize::voxelize(&mesh, &parameters).unwrap());
    }
}

#[test]
fn specks_that_a_thin_part_leaves_behind_are_not_bodies() {
    // A pyramid that ends in a needle: its tip has a voxel here and there, or none.
    let (mut vertices, mut triangles) = cuboid([0.0, 0.0, 0.0], [4.0, 4.0, 4.0]);
    vertices.extend((1..40).flat_map(|i| {
        let (x, r) = (4.0 + 0.25 * f64::from(i), 0.8 / f64::from(i));
        [[x, 2.0 - r, 2.0], [x, 2.0 + r, 2.0 - r], [x, 2.0 + r, 2.0 + r]]
    }));
    for i in 0..38u32 {
        let ring = |i: u32, j: u32| 8 + 3 * i + j % 3;
        for j in 0..3 {
            let [a, b, c, d] = [ring(i, j), ring(i, j + 1), ring(i + 1, j), ring(i + 1, j + 1)];
            triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    triangles.extend([[8, 10, 9], [8 + 3 * 38, 9 + 3 * 38, 10 + 3 * 38]]);
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let features = detect(Bodies::Largest, Input::Volume(&both(&mesh, &mesh, [0.1, 0.1, 0.1])));
    assert!(features.shape.element_of_vertex().iter().all(Option::is_some));
}

/// A mask of cubes in a row, of these sides, a voxel apart.
fn cubes(sides: &[u32]) -> VoxelGrid {
    let length = sides.iter().sum::<u32>() as usize + sides.len();
    let most = *sides.iter().max().unwrap();
    let mut inside = BitGrid::empty([length, most as usize, most as usize]).unwrap();
    let mut x = 0;
    for &side in sides {
        for i in 0..side * side * side {
            inside.set([x + i % side, i / side % side, i / side / side], true);
        }
        x += side + 1;
    }
    VoxelGrid::solid(Frame::new(inside.dims(), [0.0; 3], [1.0; 3]).unwrap(), inside).unwrap()
}

#[test]
fn specks_are_never_searched_and_small_bodies_are_if_none_is_much_larger() {
    let bodies = |bodies, sides: &[u32]| {
        let features = detect(bodies, Input::Solid(&cubes(sides)));
        let sizes: Vec<usize> = features.bodies.iter().map(|b| b.elements.len()).collect();
        let dropped = features.warnings.iter().find_map(|w| match w {
            Warning::SmallerComponents { components, elements, bodies, .. } => {
                Some((*components, *elements, bodies.clone()))
            }
            _ => None,
        });
        (sizes, dropped)
    };
    let sides = [1, 12, 5, 2, 4];
    assert_eq!(bodies(Bodies::Largest, &sides), (vec![1728], Some((4, 198, vec![125, 64]))));
    assert_eq!(bodies(Bodies::All, &sides), (vec![1728, 125, 64], Some((2, 9, vec![]))));
    assert_eq!(bodies(Bodies::Join, &sides), (vec![1917], Some((2, 9, vec![]))));
    // The largest body has to have as many eigenpairs as are asked for, the others have what they can.
    let two = |count| {
        let mut parameters = with(Bodies::All);
        parameters.spectrum.eigenpairs = EigenpairRange::Count(count);
        Detector::new(parameters).detect(Input::Solid(&cubes(&[3, 4, 1])))
    };
    assert!(two(65).is_err());
    let two = two(30).unwrap();
    assert_eq!(two.bodies.iter().map(|b| b.elements.len()).collect::<Vec<_>>(), [64, 27]);
    assert_eq!(two.warnings[0], Warning::FewEigenpairs { wanted: 30, available: 27 });
    assert!(two.warnings[1].to_string().starts_with("1 smaller component with 1 voxel (1.09 %) was dropped"));
}

#[test]
fn a_body_too_small_for_a_voxel_has_no_labels_unless_it_is_close() {
    let pebble = |x: f64| {
        let (vertices, triangles) = cuboid([x, 0.0, 0.0], [x + 0.01, 0.01, 0.01]);
        both(&club(1.0), &TriangleMesh::new(vertices, triangles).unwrap(), [0.0; 3])
    };
    let elements = |mesh: &TriangleMesh| {
        let features = detect(Bodies::Largest, Input::Volume(mesh));
        assert!(features.shape.element_of_vertex()[..16].iter().all(Option::is_some));
        features.shape.element_of_vertex()[16..].to_vec()
    };
    assert_eq!(elements(&pebble(14.0)), [None; 8]);
    assert!(elements(&pebble(10.1)).iter().all(Option::is_some));
}

#[test]
fn a_mesh_that_the_grid_parts_has_labels_where_it_is_searched() {
    // Two boxes and a rod between them that is thinner than a voxel, in one piece.
    let rings: [(f64, f64); 6] = [(0.0, 2.0), (4.0, 2.0), (4.0, 0.03), (7.0, 0.03), (7.0, 1.2), (9.4, 1.2)];
    let corner = |x: f64, r: f64| [[x, -r, -r], [x, r, -r], [x, r, r], [x, -r, r]];
    let vertices: Vec<[f64; 3]> = rings.iter().flat_map(|&(x, r)| corner(x, r)).collect();
    let mut triangles = vec![[0, 2, 1], [0, 3, 2], [20, 21, 22], [20, 22, 23]];
    for ring in 0..5u32 {
        for i in 0..4 {
            let [a, b] = [4 * ring + i, 4 * ring + (i + 1) % 4];
            triangles.extend([[a, b, b + 4], [a, b + 4, a + 4]]);
        }
    }
    // The rod off the middle, so that no centre lies in it.
    let moved = |(i, p): (usize, &[f64; 3])| match i {
        8..16 => [p[0], p[1] + 0.11, p[2] + 0.11],
        _ => *p,
    };
    let vertices = vertices.iter().enumerate().map(moved).collect();
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let features = detect(Bodies::Largest, Input::Volume(&mesh));
    assert_eq!(features.voxelization.as_ref().unwrap().dropped_components, 1);
    let elements = features.shape.element_of_vertex();
    assert!(elements[..8].iter().all(Option::is_some) && elements[16..].iter().all(Option::is_none));
    assert_eq!(detect(Bodies::All, Input::Volume(&mesh)).bodies.len(), 2);
}

#[test]
fn each_body_on_its_own_is_the_body_alone() {
    let mesh = two_clubs(1.0);
    let all = detect(Bodies::All, Input::Volume(&mesh));
    assert_eq!(all.bodies.len(), 2);
    assert!(all.bodies[0].measure() > all.bodies[1].measure());
    assert_eq!(all.trees.iter().map(|t| t.body).collect::<Vec<_>>(), [0, 0, 0, 0, 1, 1, 1, 1]);
    assert!(all.regions.is_sorted_by(|a, b| a.volume >= b.volume));
    let grid = all.shape.grid().unwrap();
    assert_eq!(all.bodies.iter().map(|b| b.elements.len()).sum::<usize>(), grid.len());
    assert!(all.shape.element_of_vertex().iter().all(Option::is_some));
    for (number, body) in all.bodies.iter().enumerate() {
        let alone = grid.restrict(|v| body.number_of(v).is_some());
        let alone = detect(Bodies::Largest, Input::Solid(&alone));
        let mine: Vec<usize> = (0..all.regions.len()).filter(|&r| all.regions[r].body == number).collect();
        assert_eq!(mine.len(), alone.regions.len());
        assert!(!mine.is_empty());
        assert_eq!(body.basis.eigenvalues(), alone.bodies[0].basis.eigenvalues());
        for (&r, other) in mine.iter().zip(&alone.regions) {
            let region = &all.regions[r];
            let elements: Vec<u32> = other.elements.iter().map(|&e| body.elements[e as usize]).collect();
            assert_eq!(region.elements, elements);
            assert_eq!(region.parent, other.parent.map(|p| mine[p]));
            assert_eq!(
                (region.tree, region.volume_fraction),
                (other.tree + alone.trees.len() * number, other.volume_fraction)
            );
            assert!((0..3).all(|a| (region.centroid[a] - other.centroid[a]).abs() < 1e-9));
            // Its vertices are those whose voxel it has.
            let has = |v: u32| all.shape.element_of_vertex()[v as usize];
            let vertices = (0..mesh.vertices().len() as u32)
                .filter(|&v| has(v).is_some_and(|e| elements.binary_search(&e).is_ok()));
            assert_eq!(region.vertices, vertices.collect::<Vec<_>>());
        }
        let of_body = all.tree(alone.trees.len() * number).unwrap();
        assert_eq!(of_body.nodes_of_vertices(), alone.tree(0).unwrap().nodes_of_vertices());
        let rows: Vec<&[f64]> = mine.iter().map(|&r| all.descriptors.row(r)).collect();
        assert_eq!(rows, alone.descriptors.rows().collect::<Vec<_>>());
    }
}

#[test]
fn one_body_is_the_same_by_any_choice() {
    let mesh = club(1.0);
    let [largest, all, join] = [Bodies::Largest, Bodies::All, Bodies::Join].map(|bodies| {
        let features = detect(bodies, Input::Volume(&mesh));
        assert_eq!(features.bodies.len(), 1);
        (regions(&features), features.descriptors.values().to_vec(), features.warnings.clone())
    });
    assert_eq!(largest, all);
    assert_eq!(largest, join);
}

#[test]
fn joined_bodies_share_a_spectrum_and_that_is_said() {
    let joined = detect(Bodies::Join, Input::Volume(&two_clubs(1.0)));
    assert_eq!((joined.bodies.len(), joined.bodies[0].spectrum.zero_modes), (1, 2));
    assert!(joined.warnings.contains(&Warning::Apart { parts: 2 }));
    // The small one as a whole is a region.
    let grid = joined.shape.grid().unwrap();
    let small = grid.components().sizes[1];
    assert!(joined.regions.iter().any(|r| r.elements.len() == small));
    // The voxelizer's own switch is not the way.
    let mut parameters = parameters();
    parameters.voxelize.largest_only = false;
    let error = Detector::new(parameters).detect(Input::Volume(&club(1.0))).err().unwrap().to_string();
    assert!(error.contains("largest_only") && error.contains("join"), "{error}");
}

#[test]
fn masks_of_several_bodies_are_as_meshes() {
    let whole = detect(Bodies::Join, Input::Volume(&two_clubs(1.0)));
    let mask = whole.shape.grid().unwrap();
    for bodies in [Bodies::Largest, Bodies::All, Bodies::Join] {
        let of_mask = detect(bodies, Input::Solid(mask));
        let mut parameters = with(bodies);
        parameters.voxelize.frame = Some(*mask.frame());
        let of_mesh = Detector::new(parameters).detect(Input::Volume(&two_clubs(1.0))).unwrap();
        assert_eq!(regions(&of_mask), regions(&of_mesh), "{bodies}");
        assert_eq!(of_mask.descriptors.values(), of_mesh.descriptors.values());
        assert_eq!(of_mask.warnings, of_mesh.warnings);
    }
    // A shape that was made before is not cut down.
    let shape = DiscreteShape::solid(mask.clone(), Connectivity::Six);
    let taken = detect(Bodies::Largest, Input::Shape(Box::new(shape.clone())));
    assert_eq!((taken.shape.len(), taken.bodies.len()), (mask.len(), 1));
    assert_eq!(detect(Bodies::All, Input::Shape(Box::new(shape))).bodies.len(), 2);
}

#[test]
fn progress_rises_over_several_bodies_and_can_cancel() {
    let heard = std::sync::Mutex::new(Vec::new());
    let hear = |p: mser3d::Progress| {
        heard.lock().unwrap().push(p);
        std::ops::ControlFlow::Continue(())
    };
    let mesh = two_clubs(1.0);
    Detector::new(with(Bodies::All)).with_progress(&hear).detect(Input::Volume(&mesh)).unwrap();
    let heard = heard.into_inner().unwrap();
    assert!(heard.is_sorted_by_key(|p| (p.stage as usize as f64, p.done)), "{heard:?}");
    assert!(heard.is_sorted_by_key(|p| p.overall) && heard.iter().all(|p| (0.0..=1.0).contains(&p.done)));
    let stop = |p: mser3d::Progress| match p.stage == mser3d::Stage::Spectrum && p.done > 0.5 {
        true => std::ops::ControlFlow::Break(()),
        false => std::ops::ControlFlow::Continue(()),
    };
    let stopped = Detector::new(with(Bodies::All)).with_progress(&stop).detect(Input::Volume(&mesh));
    assert_eq!(stopped.err(), Some(Error::Cancelled));
}

#[test]
fn pieces_of_a_surface_are_bodies() {
    let one = vase(12, 60);
    let mesh = both(&one, &vase(10, 40), [0.0, 5.0, 0.0]);
    let alone = detect(Bodies::Largest, Input::Surface(&one));
    assert!(!alone.regions.is_empty() && alone.warnings.is_empty(), "{:?}", alone.warnings);
    let largest = detect(Bodies::Largest, Input::Surface(&mesh));
    assert_eq!(regions(&largest), regions(&alone));
    assert_eq!(largest.shape.element_of_vertex()[one.vertices().len()..], [None; 402]);
    let warning = largest.warnings[0].to_string();
    assert!(warning.starts_with("1 smaller body with 402 vertices (4"), "{warning}");
    let all = detect(Bodies::All, Input::Surface(&mesh));
    assert_eq!((all.bodies.len(), all.shape.len()), (2, mesh.vertices().len()));
    let mine = all.regions.iter().filter(|r| r.body == 0);
    assert!(mine.zip(&alone.regions).all(|(a, b)| a.elements == b.elements && a.vertices == b.vertices));
    let join = detect(Bodies::Join, Input::Surface(&mesh));
    assert!(join.warnings.contains(&Warning::Apart { parts: 2 }));
    // A vertex that no triangle uses is no body, and changes nothing.
    let stray: Vec<[f64; 3]> = one.vertices().iter().copied().chain([[9.0; 3]]).collect();
    let stray = TriangleMesh::new(stray, one.triangles().to_vec()).unwrap();
    for bodies in [Bodies::Largest, Bodies::All] {
        let features = detect(bodies, Input::Surface(&stray));
        assert_eq!((features.bodies.len(), features.warnings.len()), (1, 0));
        assert_eq!(features.shape.len(), stray.vertices().len());
    }
}

#[test]
fn a_surface_that_repeats_vertices_is_welded() {
    let whole = vase(12, 60);
    let split = soup(&whole);
    let [of_whole, of_split] = [&whole, &split].map(|mesh| detect(Bodies::Largest, Input::Surface(mesh)));
    let merged = split.vertices().len() - whole.vertices().len();
    assert_eq!(of_split.warnings, [Warning::MergedVertices { vertices: merged }]);
    assert_eq!(of_split.bodies[0].spectrum.zero_modes, 1);
    let Elements::Vertices { mesh, .. } = of_split.shape.elements() else { panic!() };
    assert_eq!(mesh.vertices().len(), whole.vertices().len());
    let sorted = |mut lists: Vec<Vec<[u64; 3]>>| {
        lists.sort();
        lists
    };
    assert!(!of_whole.regions.is_empty());
    assert_eq!(sorted(positions(&of_split, &split)), sorted(positions(&of_whole, &whole)));
}

/// The positions of the vertices of each region, each once.
fn positions(features: &Features, mesh: &TriangleMesh) -> Vec<Vec<[u64; 3]>> {
    let of = |vertices: &Vec<u32>| {
        let mut list: Vec<[u64; 3]> =
            vertices.iter().map(|&v| mesh.vertices()[v as usize].map(f64::to_bits)).collect();
        list.sort_unstable();
        list.dedup();
        list
    };
    features.regions.iter().map(|r| of(&r.vertices)).collect()
}

#[test]
fn seams_of_a_real_figure_change_nothing() {
    let read = |name| shared(&format!("cases/unwelded_surface/{name}.off"));
    let (Some(welded), Some(seams), Some(split)) = (read("welded"), read("uv_seams"), read("all_split"))
    else {
        return;
    };
    let detect = |mesh| Detector::default().detect(Input::Surface(mesh)).unwrap();
    let features = detect(&welded);
    let expected = positions(&features, &welded);
    assert_eq!((expected.len(), features.warnings.len()), (9, 0));
    for (mesh, merged) in [(&seams, 170), (&split, 18768)] {
        let features = detect(mesh);
        assert_eq!(features.warnings, [Warning::MergedVertices { vertices: merged }]);
        let found = positions(&features, mesh);
        // Rounding depends on the order of the vertices. It must not decide which of two twins a trunk is joined with.
        let other = expected.iter().filter(|region| !found.contains(region)).count();
        assert_eq!((found.len(), other), (expected.len(), 0));
    }
}

#[test]
fn a_ball_beside_a_hand_has_no_labels() {
    let Some(mesh) = shared("cases/stray_body/human_and_ball.off") else { return };
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(20_000);
    let features = Detector::new(parameters).detect(Input::Volume(&mesh)).unwrap();
    let elements = features.shape.element_of_vertex();
    let ball = mesh.vertices().len() - 162;
    assert!(elements[..ball].iter().all(Option::is_some));
    assert_eq!(&elements[ball..], [None; 162]);
    let grid = features.shape.grid().unwrap();
    let nearest = grid.nearest_voxels(&mesh.vertices()[..ball]);
    assert!(elements.iter().zip(nearest).all(|(&element, voxel)| element == Some(voxel)));
}

#[test]
fn bodies_far_apart_cost_no_more_than_bodies_close_by() {
    let Some(mesh) = shared("cases/far_apart/d20.off") else { return };
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(20_000);
    parameters.spectrum.eigenpairs = 10.into();
    let features = Detector::new(parameters).detect(Input::Volume(&mesh)).unwrap();
    let elements = features.shape.element_of_vertex();
    assert!(elements[..642].iter().all(Option::is_some) && elements[642..].iter().all(Option::is_none));
    assert!(features.run.stages[0].seconds < 5.0, "{:?}", features.run.stages);
}

#[test]
fn an_estimate_counts_what_will_be_searched() {
    let elements = |bodies, input: Input| with(bodies).estimate(&input).elements;
    let (apart, overlapping) = (two_clubs(1.0), two_clubs(-9.0));
    let share = 3000.0 * 8.0 / 9.0;
    assert!((elements(Bodies::Largest, Input::Volume(&apart)) as f64 - share).abs() < 2.0);
    for (bodies, mesh) in [
        (Bodies::All, &apart),
        (Bodies::Join, &apart),
        (Bodies::Largest, &overlapping),
        (Bodies::Largest, &club(1.0)),
    ] {
        assert_eq!(elements(bodies, Input::Volume(mesh)), 3000, "{bodies}");
    }
    let whole = vase(12, 60);
    assert_eq!(elements(Bodies::Largest, Input::Surface(&soup(&whole))), whole.vertices().len());
    let estimate = with(Bodies::Largest).estimate(&Input::Volume(&apart));
    let stages = estimate.stages;
    let sum = stages.voxelize + stages.spectrum + stages.regions + stages.reliability + stages.descriptors;
    assert!(stages.voxelize > 0.0 && estimate.seconds > sum && estimate.seconds < sum + 0.1);
}
