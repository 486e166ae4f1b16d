//! Maximally stable volumes beside VLFeat's.
//!
//! The list in `data/vlfeat.txt` is VLFeat's own answer. The two agree region by region, with these
//! exceptions by design, none of which can arise on u8 volumes with VLFeat's neighbours:
//! * VLFeat knows 256 grey values and steps of 1; here values are of any type, and the step is a parameter;
//! * VLFeat knows 8 neighbours in images and 26 in volumes; here the tree decides;
//! * VLFeat finds bright regions in the inverted volume; here the tree grows the other way.
use mser3d_comptree::shape::Connectivity;
use mser3d_comptree::{ComponentTree, MsvParameters, Polarity, maximally_stable_volumes};

const DIMS: [usize; 3] = [20, 18, 14];

/// Blobs of several depths on a slope, with noise of 0 to 3 grey values.
fn volume() -> Vec<u8> {
    let mut state = 1u32;
    let [nx, ny, nz] = DIMS.map(|n| n as i32);
    let mut values = Vec::new();
    for (z, y, x) in (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (z, y, x)))) {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let distance = |at: [i32; 3]| {
            let [x, y, z] = [x - at[0], y - at[1], z - at[2]];
            [x * x + y * y + z * z, x * x + y * y + 2 * z * z]
        };
        let mut value = 150 + 2 * x - y;
        let [ball, _] = distance([5, 5, 6]);
        if ball < 16 {
            value = 40 + ball;
        }
        let [_, lens] = distance([14, 12, 7]);
        if lens < 20 {
            value = 60 + 2 * lens;
        }
        if lens < 6 {
            value = 20;
        }
        let [bright, _] = distance([14, 4, 5]);
        if bright < 12 {
            value = 230 - bright;
        }
        values.push((value + (state >> 30) as i32) as u8);
    }
    values
}

#[test]
fn every_region_is_vlfeats() {
    let values = volume();
    let tree =
        |polarity| ComponentTree::from_grid(DIMS, Connectivity::TwentySix, &values, 1.0, polarity).unwrap();
    let (dark, bright) = (tree(Polarity::Sublevel), tree(Polarity::Superlevel));
    let text = include_str!("data/vlfeat.txt");
    let mut searches = 0;
    for search in text.split("search ").skip(1) {
        let (heading, list) = search.split_once('\n').unwrap();
        let words: Vec<&str> = heading.split(' ').collect();
        let number = |i: usize| words[i].parse::<f64>().unwrap();
        let parameters = MsvParameters {
            delta: number(0),
            min_area: number(1),
            max_area: number(2),
            max_variation: number(3),
            min_diversity: number(4),
            ..Default::default()
        };
        let tree = if words[5] == "dark" { &dark } else { &bright };
        let mut found: Vec<(u32, u32)> = maximally_stable_volumes(tree, &parameters)
            .unwrap()
            .regions
            .iter()
            .map(|r| (r.altitude as u32, r.volume as u32))
            .collect();
        found.sort_unstable();
        let pair = |line: &str| {
            let (grey, voxels) = line.split_once(' ').unwrap();
            (grey.parse().unwrap(), voxels.parse().unwrap())
        };
        let expected: Vec<(u32, u32)> = list.lines().map(pair).collect();
        assert_eq!(found, expected, "{heading}");
        searches += 1;
    }
    assert_eq!(searches, 8);
}
