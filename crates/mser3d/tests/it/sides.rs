//! Left and right of figures made of boxes.

use mser3d::shape::{BitGrid, Frame, VoxelGrid};
use mser3d::{Descriptor, DescriptorKind, Detector, Features, Input, Parameters, Region, Sidedness};

/// Voxels along x, y and z.
const DIMS: [usize; 3] = [64, 72, 28];

/// First and last voxel of a box.
type Part = [[u32; 3]; 2];

const TRUNK: Part = [[23, 24, 8], [40, 51, 19]];
const HEAD: Part = [[27, 52, 9], [36, 65, 18]];
const ARMS: [Part; 2] = [[[2, 42, 10], [22, 48, 17]], [[41, 42, 10], [61, 48, 17]]];
const LEGS: [Part; 2] = [[[24, 3, 10], [30, 23, 17]], [[33, 3, 10], [39, 23, 17]]];
/// They point to the front, z.
const FEET: [Part; 2] = [[[24, 0, 10], [30, 6, 26]], [[33, 0, 10], [39, 6, 26]]];
const NOSE: Part = [[30, 55, 19], [33, 61, 25]];

fn figure(parts: &[Part]) -> VoxelGrid {
    let mut bits = BitGrid::empty(DIMS).unwrap();
    for [first, last] in parts {
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                (first[0]..=last[0]).for_each(|x| bits.set([x, y, z], true));
            }
        }
    }
    let frame = Frame::new(DIMS, [0.0; 3], [1.0; 3]).unwrap();
    VoxelGrid::solid(frame, bits).unwrap()
}

/// The mirror image: x runs the other way.
fn mirrored(part: &Part) -> Part {
    let back = |x: u32| DIMS[0] as u32 - 1 - x;
    let [[x0, y0, z0], [x1, y1, z1]] = *part;
    [[back(x1), y0, z0], [back(x0), y1, z1]]
}

fn body() -> Vec<Part> {
    [&[TRUNK, HEAD][..], &ARMS, &LEGS].concat()
}

fn with_front() -> Vec<Part> {
    [body(), FEET.to_vec(), vec![NOSE]].concat()
}

fn detect(grid: &VoxelGrid) -> Features {
    let mut parameters = Parameters::default();
    parameters.reliability.deformations = Some(0);
    Detector::new(parameters).detect(Input::Solid(grid)).unwrap()
}

/// The places of a region's voxels, ascending, of its mirror image if asked.
fn places(features: &Features, region: &Region, mirror: bool) -> Vec<[u32; 3]> {
    let voxels: Vec<[u32; 3]> = features.shape.grid().unwrap().voxels().collect();
    let back = |[x, y, z]: [u32; 3]| [if mirror { DIMS[0] as u32 - 1 - x } else { x }, y, z];
    let mut places: Vec<[u32; 3]> = region.elements.iter().map(|&e| back(voxels[e as usize])).collect();
    places.sort_unstable();
    places
}

#[test]
fn twins_are_mirror_images_on_opposite_sides() {
    let features = detect(&figure(&with_front()));
    let sidedness = features.bodies[0].sidedness;
    assert!(matches!(sidedness, Sidedness::Sided { certainty } if certainty > 0.5), "{sidedness:?}");
    let middle = 0.5 * DIMS[0] as f64;
    let (mut pairs, mut signs) = (0, Vec::new());
    for (number, region) in features.regions.iter().enumerate() {
        let (side, across) = (region.side.unwrap(), region.centroid[0] - middle);
        let Some(twin) = region.twin else {
            assert!(across.abs() < 1.0 && side.abs() < 0.1, "{across} {side}");
            continue;
        };
        let other = &features.regions[twin];
        assert_eq!(other.twin, Some(number));
        assert_eq!(places(&features, other, true), places(&features, region, false));
        assert_eq!((side.abs(), other.side), (1.0, Some(-side)));
        signs.push(side * across.signum());
        pairs += 1;
    }
    // Both arms and both legs, all of one side with one sign.
    assert!(pairs >= 4, "{pairs}");
    assert!(signs.iter().all(|s| *s == signs[0]), "{signs:?}");
}

#[test]
fn a_mirrored_body_has_its_sides_exchanged_and_nothing_else() {
    // One arm is lifted, so that the figure is not its own mirror image.
    let lifted = [[41, 45, 10], [61, 51, 17]];
    let parts = [&with_front()[..3], &[lifted], &with_front()[4..]].concat();
    let image: Vec<Part> = parts.iter().map(mirrored).collect();
    let (one, other) = (detect(&figure(&parts)), detect(&figure(&image)));
    assert_eq!(one.regions.len(), other.regions.len());
    let width = one.descriptors.width();
    let plain = Descriptor::from(DescriptorKind::SizedSiHks);
    assert!(width > 7 && one.parameters.descriptor != plain);
    let mirrored = one.parameters.descriptor.first_mirrored().unwrap();
    let mut twins = 0;
    for (number, region) in one.regions.iter().enumerate() {
        let wanted = places(&one, region, true);
        let same = |r: &Region| r.elements.len() == wanted.len() && places(&other, r, false) == wanted;
        let place = other.regions.iter().position(same).expect("the same region");
        let found = &other.regions[place];
        let twin = |features: &Features, r: &Region, mirror| {
            r.twin.map(|t| places(features, &features.regions[t], mirror))
        };
        assert_eq!(twin(&one, region, true), twin(&other, found, false));
        twins += usize::from(region.twin.is_some());
        let (a, b) = (region.side.unwrap(), found.side.unwrap());
        assert!((a + b).abs() < 1e-3, "{a} {b}");
        for (i, (a, b)) in one.descriptors.row(number).iter().zip(other.descriptors.row(place)).enumerate() {
            let expected = if i < mirrored { *a } else { -a };
            assert!((b - expected).abs() < 1e-2, "{number} {i}: {a} {b}");
        }
    }
    assert!(twins >= 4, "{twins}");
}

#[test]
fn the_same_front_and_back_has_no_sides() {
    let features = detect(&figure(&body()));
    let sidedness = features.bodies[0].sidedness;
    assert!(matches!(sidedness, Sidedness::Alike { certainty } if certainty < 0.1), "{sidedness:?}");
    assert!(features.regions.iter().filter(|r| r.twin.is_some()).count() >= 4);
    assert!(features.regions.iter().all(|r| r.side.is_none()));
    // Next to nothing is added to the descriptor.
    assert!(features.descriptors.rows().all(|row| row[7..].iter().all(|x| x.abs() < 0.5)));
}

#[test]
fn of_four_equal_arms_none_are_twins() {
    let (x, z) = (DIMS[0] as u32, DIMS[2] as u32);
    let (across, along) = ([2, x - 3], [x / 2 - 30, x / 2 + 29]);
    let half = 4;
    let [cy, cz] = [36, z / 2];
    let flat = |a: [u32; 2], b: [u32; 2]| [[a[0], b[0], cz - half], [a[1], b[1], cz + half - 1]];
    let cross = [
        flat(across, [cy - half, cy + half - 1]),
        flat([x / 2 - half, x / 2 + half - 1], [cy - 30, cy + 29]),
    ];
    assert_eq!(along, across);
    let features = detect(&figure(&cross));
    assert!(features.regions.len() >= 4);
    assert_eq!(features.bodies[0].sidedness, Sidedness::NoTwins);
    assert!(features.regions.iter().all(|r| (r.twin, r.side) == (None, None)));
}

#[test]
fn other_descriptors_know_the_sides_too() {
    let grid = figure(&with_front());
    let of = |kind: DescriptorKind| {
        let mut parameters = Parameters { descriptor: kind.into(), ..Parameters::default() };
        parameters.reliability.deformations = Some(0);
        Detector::new(parameters).detect(Input::Solid(&grid)).unwrap()
    };
    let default = of(DescriptorKind::SidedSiHks);
    for kind in [DescriptorKind::SizedSiHks, DescriptorKind::SiHks, DescriptorKind::Hks] {
        let features = of(kind);
        assert_eq!(features.regions, default.regions, "{kind}");
        assert!(features.descriptors.width() <= 7);
    }
    // Without sides the numbers are the first ones of the default.
    let plain = of(DescriptorKind::SizedSiHks);
    assert!(plain.descriptors.rows().zip(default.descriptors.rows()).all(|(a, b)| a == &b[..7]));
}
