//! Parts: every element in exactly one, the few that a person would draw.

use mser3d::shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d::{
    Bodies, Detector, Error, Features, Input, Parameters, PartCount, PartParameters, Partition, partition,
};

use crate::{club, cuboid, parameters};

/// A solid of unit voxels around the middle of a cube.
fn solid(half: i32, inside: impl Fn([i32; 3]) -> bool) -> VoxelGrid {
    let side = (2 * half + 1) as usize;
    let mut bits = BitGrid::empty([side; 3]).unwrap();
    for k in 0..side as u32 {
        for j in 0..side as u32 {
            for i in 0..side as u32 {
                bits.set([i, j, k], inside([i, j, k].map(|c| c as i32 - half)));
            }
        }
    }
    let corner = -f64::from(half) - 0.5;
    VoxelGrid::solid(Frame::new([side; 3], [corner; 3], [1.0; 3]).unwrap(), bits).unwrap()
}

fn within(p: [i32; 3], centre: [i32; 3], radius: i32) -> bool {
    (0..3).map(|a| (p[a] - centre[a]).pow(2)).sum::<i32>() <= radius.pow(2)
}

fn detect(input: Input, parameters: Parameters) -> Features {
    Detector::new(parameters).detect(input).unwrap()
}

fn parts(features: &Features, count: PartCount) -> Partition {
    let found = partition(features, None, &PartParameters { count, ..Default::default() }).unwrap();
    check(features, &found);
    found
}

/// What is true of all partitions.
fn check(features: &Features, found: &Partition) {
    let mut seen = vec![0; features.shape.len()];
    for (number, part) in found.parts.iter().enumerate() {
        assert!(part.elements.is_sorted() && !part.elements.is_empty());
        for &element in &part.elements {
            seen[element as usize] += 1;
            assert_eq!(found.part_of_element[element as usize] as usize, number);
        }
        for &vertex in &part.vertices {
            assert_eq!(found.part_of_vertex[vertex as usize], Some(number as u32));
        }
        for &twin in &part.twins {
            assert!(twin != number && found.parts[twin].twins.contains(&number));
            assert_eq!((found.parts[twin].body, found.parts[twin].trunk), (part.body, false));
        }
        assert!(part.region.is_none_or(|r| features.regions[r].body == part.body));
    }
    assert!(seen.iter().all(|&times| times == 1), "every element is in one part");
    assert!(found.parts.is_sorted_by(|a, b| a.volume >= b.volume));
    for body in 0..features.bodies.len() {
        let own = found.parts.iter().filter(|part| part.body == body);
        let sum: f64 = own.map(|part| part.volume_fraction).sum();
        assert!((sum - 1.0).abs() < 1e-9);
    }
    let vertices: usize = found.parts.iter().map(|part| part.vertices.len()).sum();
    assert_eq!(vertices, found.part_of_vertex.iter().flatten().count());
}

fn six_arms() -> VoxelGrid {
    solid(19, |p| (0..3).any(|a| (0..3).all(|b| p[b].abs() <= if a == b { 19 } else { 3 })))
}

#[test]
fn six_equal_arms_come_together_or_not_at_all() {
    let grid = six_arms();
    let features = detect(Input::Solid(&grid), parameters());
    for count in [PartCount::Auto, PartCount::Count(7), PartCount::Count(9)] {
        let found = parts(&features, count);
        assert_eq!(found.parts.len(), 7, "{count}");
        let (hub, arms) = found.parts.split_last().unwrap();
        assert!(hub.trunk && hub.centroid.iter().all(|c| c.abs() < 1e-9) && hub.twins.is_empty());
        for arm in arms {
            assert_eq!((arm.twins.len(), arm.elements.len()), (5, arms[0].elements.len()));
            let along = arm.centroid.iter().filter(|c| c.abs() > 5.0).count();
            assert!(along == 1 && arm.volume_fraction > 0.12, "{:?}", arm.centroid);
        }
    }
    for count in 1..7 {
        assert_eq!(parts(&features, PartCount::Count(count)).parts.len(), 1, "{count}");
    }
}

#[test]
fn a_dumbbell_is_cut_at_its_bar_and_a_rod_is_not_cut() {
    let grid = solid(24, |p| {
        within(p, [-16, 0, 0], 8)
            || within(p, [16, 0, 0], 8)
            || p[0].abs() < 16 && p[1].pow(2) + p[2].pow(2) <= 9
    });
    let features = detect(Input::Solid(&grid), parameters());
    let found = parts(&features, PartCount::Auto);
    let [left, right, bar] = &found.parts[..] else { panic!("{}", found.parts.len()) };
    assert_eq!(left.elements.len(), right.elements.len());
    assert!(left.centroid[0] < -14.0 && right.centroid[0] > 14.0 && bar.centroid[0].abs() < 1e-9);
    assert!(left.trunk && right.trunk && !bar.trunk && bar.volume_fraction > 0.05);
    // Two are its halves, cut in the middle of the bar.
    let halves = parts(&features, PartCount::Count(2));
    let [one, other] = &halves.parts[..] else { panic!("{}", halves.parts.len()) };
    assert!((one.volume_fraction - 0.5).abs() < 0.01 && one.centroid[0] * other.centroid[0] < 0.0);
    for shape in [
        solid(24, |p| p[1].pow(2) + p[2].pow(2) <= 16),
        solid(10, |p| within(p, [0; 3], 10)),
        solid(7, |_| true),
    ] {
        let features = detect(Input::Solid(&shape), parameters());
        let found = parts(&features, PartCount::Auto);
        assert_eq!(found.parts.len(), 1);
        assert!(found.parts[0].trunk && found.parts[0].region.is_none());
    }
}

#[test]
fn the_handle_of_a_club_is_a_part_of_mesh_voxels_and_surface() {
    let mesh = club(1.0);
    let asked = Parameters { parts: Some(PartParameters::default()), ..parameters() };
    let features = detect(Input::Volume(&mesh), asked);
    let found = features.partition.as_ref().unwrap();
    check(&features, found);
    let [block, handle] = &found.parts[..] else { panic!("{}", found.parts.len()) };
    // What sticks out has 8.64 of 72.64.
    assert!((handle.volume_fraction - 8.64 / 72.64).abs() < 0.015, "{}", handle.volume_fraction);
    assert!(block.trunk && !handle.trunk && handle.centroid[0] > 6.5);
    assert!(features.regions[handle.region.unwrap()].centroid[0] > 6.0);
    // The four corners at the end of the handle are its vertices.
    let far = |v: &u32| mesh.vertices()[*v as usize][0] > 9.0;
    assert_eq!(
        (handle.vertices.iter().filter(|v| far(v)).count(), block.vertices.iter().any(far)),
        (4, false)
    );
    assert_eq!(features.run.stages.len(), 5);
}

#[test]
fn each_body_has_parts_of_its_own() {
    let (large, small) = (club(1.0), club(0.6));
    let first = large.vertices().len() as u32;
    let moved = small.vertices().iter().map(|p| [p[0] + 14.0, p[1], p[2]]);
    let vertices = large.vertices().iter().copied().chain(moved).collect();
    let triangles = small.triangles().iter().map(|t| t.map(|v| v + first));
    let mesh =
        TriangleMesh::new(vertices, large.triangles().iter().copied().chain(triangles).collect()).unwrap();
    let with = |bodies| detect(Input::Volume(&mesh), Parameters { bodies, ..parameters() });

    let found = parts(&with(Bodies::All), PartCount::Count(2));
    let bodies: Vec<(usize, bool)> = found.parts.iter().map(|part| (part.body, part.trunk)).collect();
    assert_eq!(bodies, [(0, true), (1, true), (0, false), (1, false)]);
    assert!(found.part_of_vertex.iter().all(Option::is_some));

    // What was not searched is in no part.
    let found = parts(&with(Bodies::Largest), PartCount::Auto);
    let none = found.part_of_vertex.iter().filter(|part| part.is_none()).count();
    assert_eq!((found.parts.len(), none), (2, small.vertices().len()));

    // Heat does not flow from one body to the other: there is nothing narrower.
    let found = parts(&with(Bodies::Join), PartCount::Count(2));
    assert!(found.parts[1].centroid[0] > 13.0 && (found.parts[1].volume_fraction - 0.178).abs() < 0.01);
}

#[test]
fn parts_do_not_depend_on_which_regions_were_selected() {
    use mser3d::comptree::StabilityRule;
    let mesh = club(1.0);
    let usual = detect(Input::Volume(&mesh), parameters());
    for rule in [StabilityRule::Paper, StabilityRule::Baseline] {
        let mut other = parameters();
        other.stability.rule = rule;
        let other = detect(Input::Volume(&mesh), other);
        let [a, b] = [&usual, &other].map(|features| parts(features, PartCount::Count(3)));
        assert_eq!(a.part_of_element, b.part_of_element);
    }
}

#[test]
fn what_cannot_be_asked_for_is_an_error() {
    let (vertices, triangles) = cuboid([0.0; 3], [1.0; 3]);
    let mesh = TriangleMesh::new(vertices, triangles).unwrap();
    let usual = PartParameters::default();
    for (parts, word) in [
        (PartParameters { count: PartCount::Count(0), ..usual.clone() }, "parts.count"),
        (PartParameters { min_volume_fraction: f64::NAN, ..usual.clone() }, "parts.min_volume_fraction"),
        (PartParameters { min_lifetime: 0.0, ..usual.clone() }, "parts.min_lifetime"),
        (PartParameters { smoothing: 1e9, ..usual }, "parts.smoothing"),
    ] {
        let asked = Parameters { parts: Some(parts), ..parameters() };
        let error = Detector::new(asked).detect(Input::Volume(&mesh)).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter(_)) && error.to_string().contains(word), "{error}");
    }
    assert_eq!("auto".parse(), Ok(PartCount::Auto));
    assert_eq!("6".parse(), Ok(PartCount::Count(6)));
    for text in ["0", "-1", "few", "", "2.5"] {
        assert!(text.parse::<PartCount>().is_err(), "{text}");
    }
}
