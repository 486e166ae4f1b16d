//! Edges of a triangle mesh: what is closed, what is oriented, what is connected.

use mser3d_shape::DisjointSets;
use std::collections::HashMap;

/// One side of a triangle: the triangle, and whether it runs from the edge's greater vertex to the
/// smaller one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Side(u32);

impl Side {
    #[inline]
    pub fn triangle(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// 1 from the smaller to the greater vertex, -1 the other way.
    #[inline]
    pub fn direction(self) -> i32 {
        1 - 2 * (self.0 & 1) as i32
    }
}

/// The sides of all triangles, grouped by edge.
pub(crate) struct Edges {
    /// Start of the sides whose smaller vertex is v.
    starts: Vec<u32>,
    /// (greater vertex, side), sorted within each smaller vertex.
    sides: Vec<(u32, Side)>,
}

impl Edges {
    /// Triangles for which `keep` fails, or that use a vertex twice, have no sides.
    pub fn new(vertices: usize, triangles: &[[u32; 3]], keep: impl Fn(usize) -> bool) -> Self {
        let usable = |t: &usize| {
            let [a, b, c] = triangles[*t];
            a != b && b != c && c != a && keep(*t)
        };
        let mut starts = vec![0u32; vertices + 1];
        for t in (0..triangles.len()).filter(usable) {
            let [a, b, c] = triangles[t];
            for (u, v) in [(a, b), (b, c), (c, a)] {
                starts[u.min(v) as usize] += 1;
            }
        }
        let mut total = 0;
        for start in &mut starts {
            total += *start;
            *start = total;
        }
        let mut sides = vec![(0, Side(0)); total as usize];
        for t in (0..triangles.len()).rev().filter(usable) {
            let [a, b, c] = triangles[t];
            for (u, v) in [(a, b), (b, c), (c, a)] {
                let slot = &mut starts[u.min(v) as usize];
                *slot -= 1;
                sides[*slot as usize] = (u.max(v), Side((t as u32) << 1 | u32::from(u > v)));
            }
        }
        for v in 0..vertices {
            sides[starts[v] as usize..starts[v + 1] as usize].sort_unstable();
        }
        Self { starts, sides }
    }

    /// Each edge as its smaller vertex, its greater vertex and its sides, in ascending order.
    pub fn for_each(&self, mut visit: impl FnMut(u32, u32, &[(u32, Side)])) {
        for v in 0..self.starts.len() - 1 {
            let around = &self.sides[self.starts[v] as usize..self.starts[v + 1] as usize];
            for edge in around.chunk_by(|a, b| a.0 == b.0) {
                visit(v as u32, edge[0].0, edge);
            }
        }
    }
}

/// What the edges of a mesh say about it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct EdgeCounts {
    /// Edges.
    pub total: usize,
    /// With one side.
    pub boundary: usize,
    /// With three or more sides.
    pub non_manifold: usize,
    /// With an odd number of sides: rays near them count wrongly.
    pub odd: usize,
    /// With two sides that run the same way.
    pub inconsistent: usize,
    /// With more sides that run one way than the other: winding numbers near them are fractions.
    pub unbalanced: usize,
}

impl EdgeCounts {
    pub fn of(edges: &Edges) -> Self {
        let mut counts = Self::default();
        edges.for_each(|_, _, sides| {
            let net: i32 = sides.iter().map(|s| s.1.direction()).sum();
            counts.total += 1;
            counts.boundary += usize::from(sides.len() == 1);
            counts.non_manifold += usize::from(sides.len() > 2);
            counts.odd += sides.len() % 2;
            counts.inconsistent += usize::from(sides.len() == 2 && net != 0);
            counts.unbalanced += usize::from(net != 0);
        });
        counts
    }
}

/// For each vertex the first one at the same position, or `None` if all positions differ.
pub(crate) fn weld(vertices: &[[f64; 3]]) -> Option<Vec<u32>> {
    let mut first = HashMap::with_capacity(vertices.len());
    let map: Vec<u32> = vertices
        .iter()
        .enumerate()
        // Adding zero makes -0 and 0 one position.
        .map(|(i, p)| *first.entry(p.map(|x| (x + 0.0).to_bits())).or_insert(i as u32))
        .collect();
    (first.len() < vertices.len()).then_some(map)
}

/// Triangles that repeat the vertices of an earlier one, in any order; two that are closed back to back
/// on their own are not counted.
pub(crate) fn duplicates(triangles: &[[u32; 3]], edges: &Edges) -> Vec<usize> {
    let third = |t: usize, u: u32, v: u32| triangles[t].into_iter().find(|&w| w != u && w != v);
    let mut found = Vec::new();
    edges.for_each(|u, v, sides| {
        // Two sides that run opposite ways are the ordinary case.
        if let [(_, a), (_, b)] = sides
            && a.direction() != b.direction()
        {
            return;
        }
        for (i, &(_, side)) in sides.iter().enumerate().skip(1) {
            let apex = third(side.triangle(), u, v);
            if sides[..i].iter().any(|&(_, other)| third(other.triangle(), u, v) == apex) {
                found.push(side.triangle());
            }
        }
    });
    found.sort_unstable();
    found.dedup();
    found
}

/// Triangles joined across edges with two sides.
pub(crate) fn manifold_components(triangles: usize, edges: &Edges) -> DisjointSets {
    let mut sets = DisjointSets::new(triangles);
    edges.for_each(|_, _, sides| {
        if let [(_, a), (_, b)] = sides {
            sets.union(a.triangle() as u32, b.triangle() as u32);
        }
    });
    sets
}

/// Which triangles to turn over so that neighbours across two-sided edges run opposite ways, and how
/// many components have no such orientation (like a Moebius strip). In each component the greater
/// area keeps its orientation.
pub(crate) fn consistent_orientation(
    triangles: usize,
    edges: &Edges,
    area: impl Fn(usize) -> f64,
) -> (Vec<bool>, usize) {
    const NONE: u32 = u32::MAX;
    let mut neighbours = vec![[(NONE, false); 3]; triangles];
    let mut degree = vec![0u8; triangles];
    edges.for_each(|_, _, sides| {
        if let [(_, a), (_, b)] = sides {
            let same = a.direction() == b.direction();
            for (t, other) in [(a.triangle(), b.triangle()), (b.triangle(), a.triangle())] {
                neighbours[t][degree[t] as usize] = (other as u32, same);
                degree[t] += 1;
            }
        }
    });
    let mut flip = vec![false; triangles];
    let mut seen = vec![false; triangles];
    let (mut stack, mut part, mut one_sided) = (Vec::new(), Vec::new(), 0);
    for seed in 0..triangles {
        if seen[seed] || degree[seed] == 0 {
            continue;
        }
        seen[seed] = true;
        part.clear();
        stack.push(seed);
        let (mut conflict, mut turned, mut kept) = (false, 0.0, 0.0);
        while let Some(t) = stack.pop() {
            part.push(t);
            *(if flip[t] { &mut turned } else { &mut kept }) += area(t);
            for &(other, same) in &neighbours[t][..degree[t] as usize] {
                let other = other as usize;
                if !seen[other] {
                    (seen[other], flip[other]) = (true, flip[t] ^ same);
                    stack.push(other);
                } else if flip[other] != flip[t] ^ same {
                    conflict = true;
                }
            }
        }
        one_sided += usize::from(conflict);
        if conflict {
            part.iter().for_each(|&t| flip[t] = false);
        } else if turned > kept {
            part.iter().for_each(|&t| flip[t] = !flip[t]);
        }
    }
    (flip, one_sided)
}
