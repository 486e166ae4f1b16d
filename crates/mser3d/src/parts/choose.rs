//! Which candidates become parts.

use std::cmp::Ordering;

use super::borders::BodyLinks;
use super::candidates::{Candidate, Candidates};
use super::pieces::{Pieces, grow_into};
use super::{PartCount, PartParameters};

/// The largest share of the smaller of two regions that may lie in both if they count as disjoint, and outside of the larger
/// one if they count as nested.
const FRINGE: f64 = 0.05;

/// The share of its volume that a part keeps at least when others are cut out of it. The trunk may lose more to limbs.
const KEPT: f64 = 1.0 / 3.0;

/// The least narrowness of a part that is no limb: it is nearly as long as its border is across.
const NARROW: f64 = 1.75;

/// The parts of a body.
pub(super) struct Chosen {
    pub parts: Vec<ChosenPart>,
    /// The part of each element of the body.
    pub labels: Vec<u32>,
}

/// A part, and those of its group.
#[derive(Default)]
pub(super) struct ChosenPart {
    pub trunk: bool,
    pub region: Option<usize>,
    pub twins: Vec<usize>,
}

impl Candidates {
    /// Takes groups in the order of their scores, as long as there are not too many parts and all keep enough.
    pub fn choose(
        &self,
        body: &BodyLinks,
        measure: f64,
        mass: &[f64],
        parameters: &PartParameters,
    ) -> Chosen {
        let smallest = parameters.min_volume_fraction * measure;
        let mut kept = Layout { candidates: &self.all, places: Vec::new(), volumes: vec![measure] };
        let (limbs, others) = self.ranked(parameters);
        for group in limbs {
            kept = self.take(kept, group, true, body, mass, parameters);
        }
        // Parts of limbs before parts of the trunk: a hand before the chest.
        let limbs = kept.places.clone();
        let in_limb = |&c: &usize| limbs.iter().any(|&limb| self.inside(c, limb, mass));
        let (of_limbs, of_trunk): (Vec<&[usize]>, Vec<&[usize]>) =
            others.into_iter().partition(|group| group.iter().all(in_limb));
        for group in of_limbs.into_iter().chain(of_trunk) {
            kept = self.take(kept, group, false, body, mass, parameters);
        }
        let mut labels = kept.labels(body.elements);
        // Limbs that leave next to nothing share it.
        let no_trunk = kept.volumes[0] < smallest && grow_into(&mut labels, 0, body);
        let first = usize::from(no_trunk);
        labels.iter_mut().for_each(|label| *label -= first as u32);
        let parts = (0..=kept.places.len()).skip(first).map(|part| match part.checked_sub(1) {
            None => ChosenPart { trunk: true, ..ChosenPart::default() },
            Some(own) => {
                let place = kept.places[own];
                let group = self.groups.iter().find(|group| group.contains(&place));
                let twin = |other: &usize| *other != place && group.is_some_and(|g| g.contains(other));
                let twins = (1..).zip(&kept.places).filter(|(_, other)| twin(other));
                let twins = twins.map(|(part, _): (usize, _)| part - first).collect();
                ChosenPart { trunk: false, region: self.all[place].region, twins }
            }
        });
        Chosen { parts: parts.collect(), labels }
    }

    /// The layout with a group more, if it fits, all parts keep enough, and there are not too many.
    fn take<'c>(
        &self,
        kept: Layout<'c>,
        group: &[usize],
        limbs: bool,
        body: &BodyLinks,
        mass: &[f64],
        parameters: &PartParameters,
    ) -> Layout<'c> {
        if group.iter().any(|&new| kept.places.iter().any(|&old| !self.fit(old, new, mass, limbs))) {
            return kept;
        }
        let smallest = parameters.min_volume_fraction * kept.volumes.iter().sum::<f64>();
        let (next, labels) = kept.with(group, body);
        let enough = |(part, &volume): (usize, &f64)| match part.checked_sub(1) {
            Some(place) => volume >= smallest.max(KEPT * self.all[next.places[place]].volume),
            None => limbs || volume >= smallest.max(KEPT * kept.volumes[0]),
        };
        let too_many = match parameters.count {
            PartCount::Auto => false,
            PartCount::Count(count) => Pieces::new(&labels, body).count(smallest) > count,
        };
        if !too_many && next.volumes.iter().enumerate().all(enough) { next } else { kept }
    }

    /// The groups of limbs by lifetime, the longest first; and if parts are asked for by number, all other groups that hang by
    /// something narrow, the narrowest first.
    fn ranked(&self, parameters: &PartParameters) -> (Vec<&[usize]>, Vec<&[usize]>) {
        let of_group = |group: &[usize], score: fn(&Candidate) -> f64| {
            group.iter().map(|&c| score(&self.all[c])).fold(f64::INFINITY, f64::min)
        };
        let lifetime = |group: &[usize]| of_group(group, |c| c.score.lifetime);
        let narrowness = |group: &[usize]| of_group(group, |c| c.score.narrowness);
        let all = self.groups.iter().map(|group| &group[..]);
        let (mut limbs, mut others): (Vec<&[usize]>, Vec<&[usize]>) =
            all.partition(|group| lifetime(group) >= parameters.min_lifetime);
        let by_narrowness = |a: &[usize], b: &[usize]| narrowness(b).total_cmp(&narrowness(a));
        limbs.sort_by(|a, b| lifetime(b).total_cmp(&lifetime(a)).then(by_narrowness(a, b)));
        others.retain(|group| parameters.count != PartCount::Auto && narrowness(group) >= NARROW);
        others.sort_by(|a, b| by_narrowness(a, b));
        (limbs, others)
    }

    /// Whether a candidate lies in another, but for a fringe.
    fn inside(&self, a: usize, b: usize, mass: &[f64]) -> bool {
        self.all[a].volume < self.all[b].volume && self.shared(a, b, mass) >= 1.0 - FRINGE
    }

    /// Whether two candidates are nested or disjoint, but for a fringe. Nested limbs of two trees are one limb, seen at two
    /// times.
    fn fit(&self, a: usize, b: usize, mass: &[f64], limbs: bool) -> bool {
        let share = self.shared(a, b, mass);
        share <= FRINGE || share >= 1.0 - FRINGE && !(limbs && self.all[a].tree != self.all[b].tree)
    }

    /// The share of the smaller of two candidates that lies in the larger.
    fn shared(&self, a: usize, b: usize, mass: &[f64]) -> f64 {
        let (small, large) = match self.all[a].volume.total_cmp(&self.all[b].volume) {
            Ordering::Greater => (&self.all[b], &self.all[a]),
            _ => (&self.all[a], &self.all[b]),
        };
        let inside = small.elements.members().filter(|&e| large.elements.contains(e));
        inside.map(|e| mass[e]).sum::<f64>() / small.volume
    }
}

/// Candidates that are parts; the trunk is the part before them.
struct Layout<'c> {
    candidates: &'c [Candidate],
    places: Vec<usize>,
    /// Of each part.
    volumes: Vec<f64>,
}

impl Layout<'_> {
    /// The same with a group more, and the part of each element then.
    fn with(&self, group: &[usize], body: &BodyLinks) -> (Self, Vec<u32>) {
        let places: Vec<usize> = self.places.iter().chain(group).copied().collect();
        let mut next = Self { candidates: self.candidates, volumes: vec![0.0; places.len() + 1], places };
        let labels = next.labels(body.elements);
        labels.iter().zip(body.mass).for_each(|(&label, mass)| next.volumes[label as usize] += mass);
        (next, labels)
    }

    /// The part of each element: the smallest candidate that has it.
    fn labels(&self, elements: &[u32]) -> Vec<u32> {
        let of = |place: usize| &self.candidates[self.places[place]];
        let mut order: Vec<usize> = (0..self.places.len()).collect();
        order.sort_by(|&a, &b| of(b).volume.total_cmp(&of(a).volume));
        let mut labels = vec![0; elements.len()];
        for place in order {
            let members = &of(place).elements;
            let inside = elements.iter().zip(&mut labels).filter(|(e, _)| members.contains(**e as usize));
            inside.for_each(|(_, label)| *label = place as u32 + 1);
        }
        labels
    }
}
