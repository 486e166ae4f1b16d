//! Which region has which colour.

use std::cmp::Reverse;

use mser3d_shape::Graph;

use crate::{Hue, NO_REGION, PALETTE, Rgb};

/// What a region's colour says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionTraits {
    /// The smallest region that contains it.
    pub parent: Option<u32>,
    /// A number that it shares with its mirror images, and with nothing else: they have one hue. None for what is left
    /// [`NO_REGION`].
    pub family: Option<u32>,
    /// On which side of the body it is, from -1 to 1: its tone ([`Hue::tone`]).
    pub side: Option<f64>,
}

/// One colour per region: a hue for each family, a tone for each side.
///
/// `labels` holds the region of each voxel or vertex (negative: none), the innermost where regions are nested; `neighbours`
/// is their graph.
///
/// No two families have the same hue, as long as regions can do without one. There are eight hues. If there are more families,
/// those of which least is seen take the colour of the region around them, and only a line shows where they are; first those that
/// are one of several between one branching and the next. Where that is not
/// enough, because many regions are in no other, hues are used again: first those that are used least, of these the one that is
/// farthest from the hues of neighbours.
///
/// Two members of a family that touch have different tones, also where sides are not known. The same input always gets the same colours.
/// Cost: O(edges + regions^2). Labels beyond the graph's vertices or the regions are ignored.
///
/// ```
/// use mser3d_shape::Graph;
/// use mser3d_viewer::{PALETTE, RegionTraits, region_colours};
/// let path = Graph::from_edges(4, &[[0, 1], [1, 2], [2, 3]])?;
/// // Two twins with sides.
/// let [left, right] = [-1.0, 1.0].map(|side| RegionTraits { family: Some(0), side: Some(side), parent: None });
/// let colours = region_colours(&[left, right], &[0, -1, -1, 1], &path);
/// assert_eq!(colours, [PALETTE[0].dark, PALETTE[0].light]);
/// # Ok::<(), mser3d_shape::ShapeError>(())
/// ```
pub fn region_colours(regions: &[RegionTraits], labels: &[i32], neighbours: &Graph) -> Vec<Rgb> {
    let families = Families::new(regions, labels);
    let shown = families.shown();
    let region = |v: u32| {
        let label = labels.get(v as usize).and_then(|&l| usize::try_from(l).ok())?;
        families.around(label, &shown)
    };
    let touching = (0..neighbours.len() as u32)
        .filter_map(|u| region(u).map(|r| (u, r)))
        .flat_map(|(u, r)| neighbours.neighbours(u).iter().filter_map(move |&v| region(v).map(|q| [r, q])));
    let nested = (0..regions.len()).filter_map(|r| {
        let own = families.around(r, &shown)?;
        let parent = families.parent(own)?;
        families.around(parent, &shown).map(|parent| [own, parent])
    });
    let mut pairs: Vec<[usize; 2]> =
        touching.chain(nested).filter(|p| p[0] != p[1]).flat_map(|[p, q]| [[p, q], [q, p]]).collect();
    pairs.sort_unstable();
    pairs.dedup();

    let mut used = [0u32; PALETTE.len()];
    let mut hue_of: Vec<Option<Hue>> = vec![None; families.members.len()];
    let mut colours = vec![NO_REGION; regions.len()];
    for (family, members) in families.members.iter().enumerate().filter(|(family, _)| shown[*family]) {
        let beside = |r: usize| {
            let start = pairs.partition_point(|p| p[0] < r);
            pairs[start..].iter().take_while(move |p| p[0] == r).map(|p| p[1])
        };
        let around: Vec<Hue> = members
            .iter()
            .flat_map(|&r| beside(r))
            .filter_map(|r| families.of[r].filter(|f| *f != family).and_then(|f| hue_of[f]))
            .collect();
        let gap = |c: usize| around.iter().map(|hue| PALETTE[c].distance(*hue)).fold(f64::INFINITY, f64::min);
        // Unlike the neighbours first, then rare, then far from the neighbours, then early in the palette.
        let rank = |&c: &usize| {
            (
                gap(c) == 0.0 || around.contains(&PALETTE[c]),
                used[c],
                Reverse((gap(c).min(0.1) * 1e6) as u64),
                c,
            )
        };
        let best = (0..PALETTE.len()).min_by_key(rank).unwrap_or(0);
        used[best] += 1;
        let hue = PALETTE[best];
        hue_of[family] = Some(hue);
        for (place, &r) in members.iter().enumerate() {
            let taken: Vec<Rgb> =
                beside(r).filter(|q| members[..place].contains(q)).map(|q| colours[q]).collect();
            let own = hue.tone(regions[r].side);
            let free = [own, hue.light, hue.dark, hue.middle].into_iter().find(|tone| !taken.contains(tone));
            colours[r] = free.unwrap_or(own);
        }
    }
    let of_ancestor = |r: usize| families.around(r, &shown).map_or(NO_REGION, |r| colours[r]);
    (0..regions.len()).map(of_ancestor).collect()
}

/// Regions by family.
struct Families<'a> {
    regions: &'a [RegionTraits],
    /// The regions of each family, ascending; families by their first region.
    members: Vec<Vec<usize>>,
    /// The family of each region, by its place in `members`.
    of: Vec<Option<usize>>,
    /// In how many places each region is the innermost.
    seen: Vec<usize>,
}

impl<'a> Families<'a> {
    fn new(regions: &'a [RegionTraits], labels: &[i32]) -> Self {
        let mut members: Vec<Vec<usize>> = Vec::new();
        let mut numbers: Vec<u32> = Vec::new();
        let mut of = vec![None; regions.len()];
        for (r, traits) in regions.iter().enumerate() {
            let Some(number) = traits.family else { continue };
            let family = numbers.iter().position(|&n| n == number).unwrap_or_else(|| {
                numbers.push(number);
                members.push(Vec::new());
                numbers.len() - 1
            });
            members[family].push(r);
            of[r] = Some(family);
        }
        let mut seen = vec![0; regions.len()];
        for label in labels.iter().filter_map(|&l| usize::try_from(l).ok()) {
            if let Some(count) = seen.get_mut(label) {
                *count += 1;
            }
        }
        Self { regions, members, of, seen }
    }

    fn parent(&self, region: usize) -> Option<usize> {
        self.regions[region].parent.map(|p| p as usize).filter(|&p| p < self.regions.len())
    }

    /// The region whose colour this one has: itself, or the next around it that is shown. None if it is left out, or in
    /// such a one.
    fn around(&self, region: usize, shown: &[bool]) -> Option<usize> {
        let mut region = (region < self.regions.len()).then_some(region)?;
        // A chain of parents that does not end is no nesting.
        for _ in 0..self.regions.len() {
            if shown[self.of[region]?] {
                return Some(region);
            }
            region = self.parent(region)?;
        }
        None
    }

    /// Which families have a hue of their own: one after the other goes that of which least is seen, first of those without which the
    /// regions branch as before.
    fn shown(&self) -> Vec<bool> {
        let mut shown = vec![true; self.members.len()];
        for _ in PALETTE.len()..shown.len() {
            let of_region: Vec<Option<usize>> =
                (0..self.regions.len()).map(|r| self.around(r, &shown)).collect();
            let mut seen = vec![0; shown.len()];
            // The shown regions right inside each.
            let mut children = vec![0; self.regions.len()];
            let outside = |r: usize| self.parent(r).and_then(|parent| of_region[parent]);
            for (r, around) in of_region.iter().enumerate() {
                let Some(around) = *around else { continue };
                if let Some(family) = self.of[around] {
                    seen[family] += self.seen[r];
                }
                if let Some(parent) = outside(r).filter(|_| around == r) {
                    children[parent] += 1;
                }
            }
            let in_a_chain =
                |&r: &usize| children[r] == 1 || outside(r).is_some_and(|parent| children[parent] == 1);
            let all_outside = |family: usize| {
                let has_other = |&r: &usize| {
                    let mut around = outside(r);
                    while around.is_some_and(|a| self.of[a] == Some(family)) {
                        around = around.and_then(outside);
                    }
                    around.is_some()
                };
                self.members[family].iter().all(has_other)
            };
            let least = (0..shown.len())
                .filter(|&family| shown[family] && all_outside(family))
                .min_by_key(|&f| (!self.members[f].iter().all(in_a_chain), seen[f], Reverse(f)));
            let Some(least) = least else { break };
            shown[least] = false;
        }
        shown
    }
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

/// The colour of a region by its label; [`NO_REGION`] for a negative one, and for one without a colour.
pub fn label_colour(colours: &[Rgb], label: i32) -> Rgb {
    usize::try_from(label).ok().and_then(|l| colours.get(l)).copied().unwrap_or(NO_REGION)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn family(family: u32) -> RegionTraits {
        RegionTraits { family: Some(family), ..Default::default() }
    }

    #[test]
    fn neighbours_differ_clearly_even_when_colours_run_out() {
        // 60 regions in a ring, each of one vertex, with long chords.
        let n = 60u32;
        let edges: Vec<[u32; 2]> = (0..n).flat_map(|v| [[v, (v + 1) % n], [v, (v + 7) % n]]).collect();
        let graph = Graph::from_edges(n as usize, &edges).unwrap();
        let labels: Vec<i32> = (0..n as i32).collect();
        let regions: Vec<RegionTraits> = (0..n).map(family).collect();
        let colours = region_colours(&regions, &labels, &graph);
        for [u, v] in edges {
            assert!(colours[u as usize].distance(colours[v as usize]) >= 0.05, "{u} {v}");
        }
        assert_eq!(colours, region_colours(&regions, &labels, &graph));
    }

    #[test]
    fn no_hue_is_used_twice_while_there_are_others() {
        // All touch all.
        let edges: Vec<[u32; 2]> = (0..8).flat_map(|u| (0..u).map(move |v| [u, v])).collect();
        let graph = Graph::from_edges(8, &edges).unwrap();
        let regions: Vec<RegionTraits> = (0..8).map(family).collect();
        let labels: Vec<i32> = (0..8).collect();
        let mut colours = region_colours(&regions, &labels, &graph);
        colours.sort_unstable();
        let mut wanted = PALETTE.map(|hue| hue.middle);
        wanted.sort_unstable();
        assert_eq!(colours, wanted);
        assert_eq!(
            region_colours(&regions, &labels, &Graph::from_edges(8, &[]).unwrap()),
            PALETTE.map(|hue| hue.middle)
        );
    }

    #[test]
    fn twins_have_one_hue_and_a_tone_by_side() {
        let graph = Graph::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
        let side = |side| RegionTraits { side, ..family(4) };
        let [p, q] = [PALETTE[0], PALETTE[1]];
        let found = region_colours(&[side(Some(1.0)), side(Some(-1.0)), family(0)], &[0, 1, 2], &graph);
        assert_eq!(found, [p.light, p.dark, q.middle]);
        // Apart, and of no known side, they are equal; not where they touch.
        assert_eq!(
            region_colours(&[side(None), family(0), side(None)], &[0, 1, 2], &graph),
            [p.middle, q.middle, p.middle]
        );
        assert_eq!(region_colours(&[side(None), side(None)], &[0, 1, -1], &graph), [p.middle, p.light]);
    }

    #[test]
    fn what_is_seen_least_takes_the_colour_around_it() {
        // Ten regions, each in the one before; the fourth and the seventh are seen in one place, the others in two.
        let regions: Vec<RegionTraits> =
            (0..10u32).map(|r| RegionTraits { parent: r.checked_sub(1), ..family(r) }).collect();
        let labels: Vec<i32> = (0..10).flat_map(|r| vec![r; if r == 3 || r == 6 { 1 } else { 2 }]).collect();
        let path: Vec<[u32; 2]> = (1..labels.len() as u32).map(|v| [v - 1, v]).collect();
        let colours = region_colours(&regions, &labels, &Graph::from_edges(labels.len(), &path).unwrap());
        assert_eq!((colours[3], colours[6]), (colours[2], colours[5]));
        let mut different = colours;
        different.sort_unstable();
        different.dedup();
        assert_eq!(different.len(), 8);
    }

    #[test]
    fn what_branches_keeps_its_colour() {
        // In region 0 a chain of eight, each seen in four places, and beside it a region that is seen once.
        let regions: Vec<RegionTraits> = (0..10u32)
            .map(|r| RegionTraits { parent: if r == 9 { Some(0) } else { r.checked_sub(1) }, ..family(r) })
            .collect();
        let labels: Vec<i32> = (0..10).flat_map(|r| vec![r; if r == 9 { 1 } else { 4 }]).collect();
        let colours = region_colours(&regions, &labels, &Graph::from_edges(labels.len(), &[]).unwrap());
        assert!(colours[..9].iter().all(|&colour| colour != colours[9]));
        assert_eq!((colours[8], colours[6]), (colours[7], colours[5]));
    }

    #[test]
    fn bad_labels_and_circles_are_ignored() {
        let graph = Graph::from_edges(3, &[[0, 1], [1, 2]]).unwrap();
        let circle = |parent, number| RegionTraits { parent: Some(parent), ..family(number) };
        let colours = region_colours(&[circle(1, 0), circle(0, 1)], &[7, -1, 0], &graph);
        assert!(colours[0].distance(colours[1]) >= 0.05);
        let outside = region_colours(&[circle(9, 0), RegionTraits::default()], &[0, 1, 1], &graph);
        assert_eq!(outside, [PALETTE[0].middle, NO_REGION]);
    }

    #[test]
    fn matched_regions_share_their_colour() {
        let first = PALETTE.map(|hue| hue.middle);
        assert_eq!(linked_colours(&first, &[[3, 1], [0, 5]], 2), [NO_REGION, first[3]]);
    }
}
