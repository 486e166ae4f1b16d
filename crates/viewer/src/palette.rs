//! Colours of regions and of scalar fields.

use mser3d_shape::Graph;

use crate::Rgb;

/// Ten colours that colour-blind viewers can tell apart, also under shading.
///
/// The first seven are those of Okabe and Ito (2008); each of the other three was chosen as far as possible
/// from all before it. Any two are at least 0.07 apart by [`Rgb::distance`].
pub const PALETTE: [Rgb; 10] = [
    Rgb::hex(0x56B4E9),
    Rgb::hex(0xE69F00),
    Rgb::hex(0x009E73),
    Rgb::hex(0xD55E00),
    Rgb::hex(0xF0E442),
    Rgb::hex(0x0072B2),
    Rgb::hex(0xCC79A7),
    Rgb::hex(0x8A5A2B),
    Rgb::hex(0x4A3FC4),
    Rgb::hex(0x882255),
];

/// The colour of what belongs to no region.
pub const NO_REGION: Rgb = Rgb::hex(0xCFCFCF);

/// One colour of [`PALETTE`] per region, so that regions that touch are easy to tell apart.
///
/// `labels` holds the region of each voxel or vertex (negative: none), the innermost where regions
/// are nested; `neighbours` is their graph; `others` lists pairs of regions that should differ too,
/// such as overlapping ones. Regions are served in the order of their numbers: each takes, of the
/// colours at least 0.1 ([`Rgb::distance`]) from those of its neighbours, one that is used least so
/// far, the first in the palette's order. So up to ten regions usually get ten colours, and the same
/// input always gets the same colours.
///
/// Cost: O(edges + regions^2). Labels beyond the graph's vertices or `regions` are ignored.
///
/// ```
/// use mser3d_shape::Graph;
/// let path = Graph::from_edges(4, &[[0, 1], [1, 2], [2, 3]])?;
/// let colours = mser3d_viewer::region_colours(2, &[0, 0, 1, -1], &path, &[]);
/// assert!(colours[0].distance(colours[1]) > 0.1);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn region_colours(regions: usize, labels: &[i32], neighbours: &Graph, others: &[[u32; 2]]) -> Vec<Rgb> {
    let region = |v: u32| labels.get(v as usize).and_then(|&l| u32::try_from(l).ok());
    let touching =
        (0..neighbours.len() as u32).filter_map(|u| region(u).map(|r| (u, r))).flat_map(|(u, r)| {
            let around = neighbours.neighbours(u).iter();
            around.filter_map(move |&v| region(v)).filter(move |&q| q != r).map(move |q| [r, q])
        });
    let mut pairs: Vec<[u32; 2]> = touching
        .chain(others.iter().copied())
        .filter(|p| p[0] != p[1] && p.iter().all(|&r| (r as usize) < regions))
        .map(|[p, q]| [p.max(q), p.min(q)])
        .collect();
    pairs.sort_unstable();
    pairs.dedup();

    const CLEAR: f64 = 0.1;
    let mut used = [0u32; PALETTE.len()];
    let mut chosen: Vec<usize> = Vec::with_capacity(regions);
    let mut rest = pairs.as_slice();
    for r in 0..regions {
        let mine = rest.partition_point(|p| p[0] as usize == r);
        let (conflicts, later) = rest.split_at(mine);
        rest = later;
        let gap = |c: usize| {
            let of = |p: &[u32; 2]| PALETTE[c].distance(PALETTE[chosen[p[1] as usize]]);
            conflicts.iter().map(of).fold(CLEAR, f64::min)
        };
        // Clear of the neighbours first, then rare, then early in the palette.
        let rank = |&c: &usize| (std::cmp::Reverse((gap(c) * 1e6) as u64), used[c], c);
        let best = (0..PALETTE.len()).min_by_key(rank).unwrap_or(0);
        used[best] += 1;
        chosen.push(best);
    }
    chosen.into_iter().map(|c| PALETTE[c]).collect()
}

/// Colours of a second shape's regions that follow its matches: `matches` pairs a region of the
/// first shape with one of the second; unmatched regions of the second become [`NO_REGION`].
pub fn linked_colours(first: &[Rgb], matches: &[[u32; 2]], second_regions: usize) -> Vec<Rgb> {
    let mut colours = vec![NO_REGION; second_regions];
    for &[a, b] in matches {
        if let (Some(&colour), Some(slot)) = (first.get(a as usize), colours.get_mut(b as usize)) {
            *slot = colour;
        }
    }
    colours
}

/// A sequential colour map for a scalar: dark blue at 0, green, light yellow at 1.
///
/// Lightness and the blue-yellow axis rise linearly in Oklab, so equal steps look equal, also in grey
/// print and to red-green-blind eyes; the green in the middle only helps the others. Values outside
/// 0 to 1 are clipped, NaN gives [`NO_REGION`].
pub fn sequential(value: f64) -> Rgb {
    if value.is_nan() {
        return NO_REGION;
    }
    let t = value.clamp(0.0, 1.0);
    let green = -0.085 * (std::f64::consts::PI * t).sin() - 0.03 * t;
    Rgb::from_oklab([0.30 + 0.63 * t, green, -0.13 + 0.26 * t])
}

/// The values mapped by [`sequential`] from their smallest to their largest; NaN gives [`NO_REGION`].
pub fn sequential_colours(values: &[f64]) -> Vec<Rgb> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().fold(f64::INFINITY, f64::min);
    let high = finite().fold(f64::NEG_INFINITY, f64::max);
    let width = if high > low { high - low } else { 1.0 };
    values.iter().map(|v| sequential((v - low) / width)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_two_palette_colours_are_told_apart_by_colour_blind_eyes() {
        for (i, p) in PALETTE.iter().enumerate() {
            for q in PALETTE[..i].iter().chain([&NO_REGION, &Rgb::WHITE]) {
                assert!(p.distance(*q) > 0.07, "{p} {q}: {}", p.distance(*q));
            }
        }
    }

    #[test]
    fn neighbours_differ_clearly_even_when_colours_run_out() {
        // 60 regions in a ring, each of one vertex, with long chords.
        let n = 60u32;
        let edges: Vec<[u32; 2]> = (0..n).flat_map(|v| [[v, (v + 1) % n], [v, (v + 7) % n]]).collect();
        let graph = Graph::from_edges(n as usize, &edges).unwrap();
        let labels: Vec<i32> = (0..n as i32).collect();
        let colours = region_colours(n as usize, &labels, &graph, &[]);
        for [u, v] in edges {
            assert!(colours[u as usize].distance(colours[v as usize]) >= 0.1, "{u} {v}");
        }
        assert_eq!(colours, region_colours(n as usize, &labels, &graph, &[]));
    }

    #[test]
    fn few_regions_that_do_not_touch_get_different_colours() {
        let graph = Graph::from_edges(10, &[]).unwrap();
        let labels: Vec<i32> = (0..10).collect();
        assert_eq!(region_colours(10, &labels, &graph, &[]), PALETTE);
    }

    #[test]
    fn listed_pairs_differ_and_bad_labels_are_ignored() {
        let graph = Graph::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
        let colours = region_colours(2, &[7, -1, 0], &graph, &[[0, 1], [0, 9]]);
        assert!(colours[0].distance(colours[1]) >= 0.1);
    }

    #[test]
    fn the_sequential_map_gets_lighter_in_equal_steps() {
        let lightness: Vec<f64> = (0..=20).map(|i| sequential(f64::from(i) / 20.0).oklab()[0]).collect();
        for w in lightness.windows(2) {
            assert!((w[1] - w[0] - 0.0315).abs() < 0.008, "{w:?}");
        }
        assert_eq!(sequential(f64::NAN), NO_REGION);
        assert_eq!(sequential_colours(&[3.0, 5.0]), [sequential(0.0), sequential(1.0)]);
        assert_eq!(sequential_colours(&[4.0, 4.0]), [sequential(0.0); 2]);
    }

    #[test]
    fn matches_carry_their_colours_over() {
        assert_eq!(linked_colours(&PALETTE, &[[3, 1], [0, 5]], 2), [NO_REGION, PALETTE[3]]);
    }
}
