//! Connected pieces of parts.

use mser3d_shape::DisjointSets;

use super::borders::BodyLinks;

/// The connected pieces of the parts of a body.
pub(super) struct Pieces {
    /// The piece of each element.
    of_element: Vec<u32>,
    /// The part and the volume of each piece.
    pieces: Vec<(u32, f64)>,
}

impl Pieces {
    pub fn new(labels: &[u32], body: &BodyLinks) -> Self {
        let mut sets = DisjointSets::new(labels.len());
        body.each(|from, to, _| {
            if to < from && labels[from as usize] == labels[to as usize] {
                sets.union(from, to);
            }
        });
        let mut of_element = vec![u32::MAX; labels.len()];
        let mut pieces: Vec<(u32, f64)> = Vec::new();
        for (v, &part) in (0..).zip(labels) {
            let first = sets.find(v) as usize;
            if of_element[first] == u32::MAX {
                of_element[first] = pieces.len() as u32;
                pieces.push((part, 0.0));
            }
            of_element[v as usize] = of_element[first];
            pieces[of_element[first] as usize].1 += body.mass[v as usize];
        }
        Self { of_element, pieces }
    }

    /// How many are at least this large.
    pub fn count(&self, smallest: f64) -> usize {
        self.pieces.iter().filter(|(_, volume)| *volume >= smallest).count()
    }

    /// The largest piece of each part, of several the first.
    fn largest(&self, parts: usize) -> Vec<Option<u32>> {
        let mut largest: Vec<Option<u32>> = vec![None; parts];
        for (number, &(part, volume)) in (0..).zip(&self.pieces) {
            let most = &mut largest[part as usize];
            if most.is_none_or(|m| self.pieces[m as usize].1 < volume) {
                *most = Some(number);
            }
        }
        largest
    }
}

/// Gives pieces that are smaller than this, and not the largest of their part, to the part that they share most border with.
/// Returns the pieces that there are then.
pub(super) fn join_crumbs(labels: &mut [u32], parts: usize, body: &BodyLinks, smallest: f64) -> Pieces {
    let all = Pieces::new(labels, body);
    let largest = all.largest(parts);
    let is_crumb = |piece: u32| {
        let (part, volume) = all.pieces[piece as usize];
        volume < smallest && largest[part as usize] != Some(piece)
    };
    if !(0..all.pieces.len() as u32).any(is_crumb) {
        return all;
    }
    // The border that each crumb shares with each part.
    let mut shared = vec![Vec::new(); all.pieces.len()];
    for (v, &label) in (0..).zip(labels.iter()) {
        let piece = all.of_element[v as usize];
        if is_crumb(piece) {
            let borders = &mut shared[piece as usize];
            borders.resize(parts, 0.0);
            let others = body.around(v).filter(|&(to, _)| labels[to as usize] != label);
            others.for_each(|(to, area)| borders[labels[to as usize] as usize] += area);
        }
    }
    for (label, piece) in labels.iter_mut().zip(&all.of_element) {
        let borders = &shared[*piece as usize];
        let most = borders.iter().copied().fold(0.0, f64::max);
        if let Some(part) = borders.iter().position(|&area| area > 0.0 && area == most) {
            *label = part as u32;
        }
    }
    Pieces::new(labels, body)
}

/// Makes each piece of at least this size that is not the largest of its part a part of its own, numbered after the others.
/// Returns which part each of the new ones was a piece of.
pub(super) fn split(labels: &mut [u32], parts: usize, all: &Pieces, smallest: f64) -> Vec<usize> {
    let largest = all.largest(parts);
    let mut from = Vec::new();
    let new: Vec<Option<u32>> = (0..)
        .zip(&all.pieces)
        .map(|(number, &(part, volume))| {
            (volume >= smallest && largest[part as usize] != Some(number)).then(|| {
                from.push(part as usize);
                (parts + from.len() - 1) as u32
            })
        })
        .collect();
    for (label, piece) in labels.iter_mut().zip(&all.of_element) {
        *label = new[*piece as usize].unwrap_or(*label);
    }
    from
}

/// Gives the elements of a part to the parts around it, from its border inwards, if they reach all of it; else nothing
/// changes. Returns whether they do.
pub(super) fn grow_into(labels: &mut Vec<u32>, part: u32, body: &BodyLinks) -> bool {
    let mut grown = labels.clone();
    let mut left: Vec<u32> = (0..labels.len() as u32).filter(|&v| labels[v as usize] == part).collect();
    while !left.is_empty() {
        // The neighbour of another part with the largest border, of several that of the part with the smallest number.
        let taken = |&v: &u32| {
            let others = body.around(v).filter(|&(to, _)| grown[to as usize] != part);
            let next = others.map(|(to, area)| (area, grown[to as usize]));
            next.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))).map(|(_, other)| (v, other))
        };
        let layer: Vec<(u32, u32)> = left.iter().filter_map(taken).collect();
        if layer.is_empty() {
            return false;
        }
        layer.iter().for_each(|&(v, other)| grown[v as usize] = other);
        left.retain(|&v| grown[v as usize] == part);
    }
    *labels = grown;
    true
}
