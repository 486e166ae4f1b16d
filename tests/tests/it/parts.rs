//! Parts of the figures: what a person would draw, in any pose.

use mser3d::{Domain, Features, Input, Parameters, Part, PartCount, PartParameters, Partition, partition};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_tests::{coarse, features, fixture, mirror};

fn parted(name: &str, domain: Domain, count: PartCount) -> (Features, Partition) {
    parted_at(coarse(20_000, 60), name, domain, count)
}

fn parted_at(parameters: Parameters, name: &str, domain: Domain, count: PartCount) -> (Features, Partition) {
    let mesh = fixture(name);
    let input = if domain == Domain::Surface { Input::Surface(&mesh) } else { Input::Volume(&mesh) };
    let features = features(input, &parameters);
    let found = partition(&features, Some(&mesh), &PartParameters { count, ..Default::default() }).unwrap();
    (features, found)
}

/// The pieces that a part falls into.
fn pieces(part: &Part, features: &Features) -> usize {
    let grid = features.shape.grid().unwrap();
    let graph = grid.graph(Default::default()).unwrap();
    let inside = |v: u32| part.elements.binary_search(&v).is_ok();
    let links: Vec<[u32; 2]> = graph.edges().filter(|e| e.iter().all(|&v| inside(v))).collect();
    let number = |v: u32| part.elements.binary_search(&v).unwrap() as u32;
    let links: Vec<[u32; 2]> = links.into_iter().map(|e| e.map(number)).collect();
    mser3d::shape::Graph::from_edges(part.elements.len(), &links).unwrap().components().len()
}

/// The sizes of the groups of twins, one number for each part that has some.
fn twins(found: &Partition) -> usize {
    found.parts.iter().filter(|part| part.twins.len() == 1).count()
}

#[test]
fn six_parts_of_a_human_are_trunk_head_arms_and_legs() {
    for domain in [Domain::Volume, Domain::Surface] {
        let (features, found) = parted("human_rest.off", domain, PartCount::Count(6));
        assert_eq!((found.parts.len(), twins(&found)), (6, 4), "{domain}");
        assert!(found.parts[0].trunk && found.parts[0].volume_fraction > 0.3);
        let (mut arms, mut legs, mut heads) = (Vec::new(), Vec::new(), Vec::new());
        for part in &found.parts[1..] {
            match part.centroid {
                [x, y, _] if x.abs() > 0.2 && y > 1.0 => arms.push(part),
                [x, y, _] if x.abs() > 0.05 && y < 0.7 => legs.push(part),
                [x, y, _] if x.abs() < 0.02 && y > 1.5 => heads.push(part),
                strange => panic!("a part around {strange:?}"),
            }
            if domain == Domain::Volume {
                assert_eq!(pieces(part, &features), 1);
            }
        }
        assert_eq!((arms.len(), legs.len(), heads.len()), (2, 2, 1), "{domain}");
        for [left, right] in [[arms[0], arms[1]], [legs[0], legs[1]]] {
            assert!(
                (left.volume / right.volume - 1.0).abs() < 0.01 && left.centroid[0] * right.centroid[0] < 0.0
            );
        }
        // The mirror image of a vertex is in the twin, but for some at the borders.
        let symmetry = mirror("human");
        let odd = (0..symmetry.len()).filter(|&v| {
            let [own, other] = [v, symmetry[v] as usize].map(|v| found.part_of_vertex[v].unwrap() as usize);
            own != other && !found.parts[own].twins.contains(&other)
        });
        assert!(odd.count() < symmetry.len() / 100, "{domain}");
    }
}

#[test]
fn limbs_are_found_by_themselves_in_any_pose() {
    for (name, count) in [
        ("human_rest.off", 6),
        ("human_kick.off", 6),
        ("human_sit.off", 6),
        ("human_wave.off", 6),
        ("human_crouch.off", 6),
        ("quadruped_rest.off", 7),
        ("quadruped_gallop.off", 7),
        ("quadruped_graze.off", 7),
    ] {
        let (_, found) = parted(name, Domain::Volume, PartCount::Auto);
        assert_eq!((found.parts.len(), twins(&found)), (count, 4), "{name}");
        assert!(found.parts[0].trunk, "{name}");
    }
}

#[test]
fn wind_changes_no_part_of_a_plant() {
    let [rest, wind] = ["plant_rest.off", "plant_wind.off"]
        .map(|name| parted_at(coarse(45_000, 100), name, Domain::Volume, PartCount::Auto).1);
    let vertices = |found: &Partition, part: usize| -> Vec<usize> {
        let of_vertex = found.part_of_vertex.iter().enumerate();
        of_vertex.filter(|(_, p)| **p == Some(part as u32)).map(|(v, _)| v).collect()
    };
    // Six leaves, the flower, and the pot with the stem.
    assert_eq!((rest.parts.len(), wind.parts.len()), (8, 8));
    assert!(rest.parts[0].trunk && rest.parts[1].centroid[1] > 0.55);
    for part in 0..rest.parts.len() {
        let own = vertices(&rest, part);
        let overlap = |other: usize| {
            let other = vertices(&wind, other);
            let shared = own.iter().filter(|v| other.binary_search(v).is_ok()).count();
            shared as f64 / (own.len() + other.len() - shared) as f64
        };
        let best = (0..wind.parts.len()).map(overlap).fold(0.0, f64::max);
        assert!(best > 0.9, "part {part} is found again at {best}");
    }
}

#[test]
fn there_are_never_more_parts_than_asked_for() {
    let mesh = fixture("quadruped_rest.off");
    let features = features(Input::Volume(&mesh), &coarse(8000, 40));
    let mut last = 0;
    for count in 1..=20 {
        let asked = PartParameters { count: PartCount::Count(count), ..Default::default() };
        let found = partition(&features, Some(&mesh), &asked).unwrap();
        assert!(found.parts.len() <= count && found.parts.len() >= last, "{count}");
        last = found.parts.len();
        assert!(found.parts.iter().all(|part| part.volume_fraction > 0.005), "{count}");
    }
    assert!(last >= 11);
}

#[test]
fn the_legs_of_a_running_fox_are_twins_by_their_sides() {
    let Some(folder) = mser3d_tests::real_shapes() else { return };
    let moment = ReadOptions { animation: Some("Run".into()), time: 0.35, ..Default::default() };
    let mesh = read_mesh(&folder.join("gltf/Fox.glb"), &moment).unwrap().mesh;
    let features = features(Input::Volume(&mesh), &coarse(45_000, 100));
    let found = partition(&features, Some(&mesh), &PartParameters::default()).unwrap();
    let legs: Vec<&Part> = found.parts.iter().filter(|part| part.volume_fraction < 0.1).collect();
    assert_eq!(legs.len(), 4);
    // It looks along z; x is across.
    let before = |part: &Part| part.centroid[2] > found.parts[0].centroid[2];
    for leg in legs {
        let [twin] = leg.twins[..] else { panic!("{:?} has no twin", leg.centroid) };
        let twin = &found.parts[twin];
        assert!(
            leg.centroid[0] * twin.centroid[0] < 0.0 && before(leg) == before(twin),
            "{:?}",
            leg.centroid
        );
    }
}
