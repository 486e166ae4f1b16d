//! Where a part ends: the area of borders between elements, and the narrowest border along a branch.

use std::borrow::Cow;

use mser3d_comptree::{CommonAncestors, ComponentTree};
use mser3d_shape::vector::{norm, sub};
use mser3d_shape::{Connectivity, Faces, TriangleMesh, VoxelGrid};

use crate::weighing::KEPT_ELEMENTS;
use crate::{DiscreteShape, Elements, Error, Weight};

/// The linked neighbours of each element, and the border that it shares with each: the area of a voxel's face, or on a
/// surface the length of the border between the cells around two vertices.
#[derive(Clone)]
pub(super) enum Links {
    /// Neighbours in rows, and where these begin.
    Listed { offsets: Vec<usize>, to: Vec<u32>, borders: Borders },
    /// Those of a large grid, which lists would take too much memory for; and the area of a face across each axis.
    OfGrid(VoxelGrid, [f64; 3]),
}

/// The area of each border, or of all of them: voxels are mostly cubes, and what is not there has not to be read.
#[derive(Clone)]
pub(super) enum Borders {
    Each(Vec<f64>),
    Alike(f64),
}

impl Links {
    /// Neighbours by faces of linked voxels, or by edges of the mesh.
    pub fn of(shape: &DiscreteShape) -> Result<Self, Error> {
        match shape.elements() {
            Elements::Voxels { grid, .. } => {
                let spacing = grid.frame().spacing();
                let faces = [0, 1, 2].map(|axis: usize| spacing[(axis + 1) % 3] * spacing[(axis + 2) % 3]);
                if grid.len() > KEPT_ELEMENTS {
                    return Ok(Self::OfGrid(grid.clone(), faces));
                }
                if faces[0] == faces[1] && faces[1] == faces[2] {
                    let (offsets, to) = grid.graph(Connectivity::Six)?.into_rows();
                    return Ok(Self::Listed { offsets, to, borders: Borders::Alike(faces[0]) });
                }
                let pairs = (0..3).flat_map(|axis| grid.linked_pairs(axis).map(move |p| (p, faces[axis])));
                Ok(Self::of_pairs(grid.len(), &pairs.collect::<Vec<_>>()))
            }
            Elements::Vertices { mesh, .. } => Ok(Self::of_mesh(mesh)),
        }
    }

    /// Number of elements.
    fn len(&self) -> usize {
        match self {
            Self::Listed { offsets, .. } => offsets.len() - 1,
            Self::OfGrid(grid, _) => grid.len(),
        }
    }

    /// Neighbours by edges of a mesh.
    pub fn of_mesh(mesh: &TriangleMesh) -> Self {
        Self::of_pairs(mesh.vertices().len(), &dual_edges(mesh))
    }

    /// Borders of pairs that are given twice, each time the smaller element first, add up. Neighbours ascend.
    fn of_pairs(len: usize, pairs: &[([u32; 2], f64)]) -> Self {
        let mut ends = vec![0; len + 1];
        pairs.iter().flat_map(|(pair, _)| pair).for_each(|&v| ends[v as usize + 1] += 1);
        (0..len).for_each(|v| ends[v + 1] += ends[v]);
        // Each row begins where the one before it ends; what is put there moves its beginning to its end.
        let mut rows = vec![(0, 0.0); 2 * pairs.len()];
        for &([u, v], area) in pairs {
            for (from, to) in [(u, v), (v, u)] {
                let at = &mut ends[from as usize];
                rows[*at] = (to, area);
                *at += 1;
            }
        }
        let (mut offsets, mut start) = (vec![0; len + 1], 0);
        let (mut to, mut areas) = (Vec::with_capacity(rows.len()), Vec::with_capacity(rows.len()));
        for v in 0..len {
            let row = &mut rows[start..ends[v]];
            row.sort_by_key(|(to, _)| *to);
            for of_one in row.chunk_by(|a, b| a.0 == b.0) {
                to.push(of_one[0].0);
                areas.push(of_one[1..].iter().fold(of_one[0].1, |sum, (_, area)| sum + area));
            }
            (start, offsets[v + 1]) = (ends[v], to.len());
        }
        Self::Listed { offsets, to, borders: Borders::Each(areas) }
    }

    /// The neighbours of an element, ascending, and the border shared with each.
    // Where it is not inlined, each look at a neighbour decides what links are.
    #[inline(always)]
    pub fn around(&self, element: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        let (listed, each, alike, faces) = match self {
            Self::Listed { offsets, to, borders } => {
                let range = offsets[element as usize]..offsets[element as usize + 1];
                let (each, alike) = match borders {
                    Borders::Each(areas) => (&areas[range.clone()], 0.0),
                    Borders::Alike(area) => (&[][..], *area),
                };
                (&to[range], each, alike, None)
            }
            Self::OfGrid(grid, areas) => (&[][..], &[][..], 0.0, Some((grid.faces_of(element), areas))),
        };
        let area = move |i: usize| each.get(i).copied().unwrap_or(alike);
        let listed = listed.iter().enumerate().map(move |(i, &to)| (to, area(i)));
        let across = |(faces, areas): (Faces, &[f64; 3])| {
            let areas = *areas;
            faces.ascending().map(move |(to, axis)| (to, areas[axis]))
        };
        listed.chain(faces.into_iter().flat_map(across))
    }

    /// Calls back with each element in turn, and each of those [around](Self::around) it.
    #[inline(always)]
    fn each(&self, mut found: impl FnMut(u32, u32, f64)) {
        match self {
            // Several times as fast as looking for each element.
            Self::OfGrid(grid, areas) => {
                for (from, faces) in (0..).zip(grid.faces(0..grid.len() as u32)) {
                    faces.ascending().for_each(|(to, axis)| found(from, to, areas[axis]));
                }
            }
            Self::Listed { .. } => {
                for from in 0..self.len() as u32 {
                    self.around(from).for_each(|(to, area)| found(from, to, area));
                }
            }
        }
    }

    /// How many parts to divide a unit of area into, so that as many of the largest border as there are links can be counted.
    fn parts_of_area(&self) -> f64 {
        let (links, largest) = match self {
            Self::OfGrid(grid, areas) => (6 * grid.len(), areas.iter().copied().fold(0.0, f64::max)),
            Self::Listed { to, borders: Borders::Alike(area), .. } => (to.len(), *area),
            Self::Listed { to, borders: Borders::Each(areas), .. } => {
                (to.len(), areas.iter().copied().fold(0.0, f64::max))
            }
        };
        if largest > 0.0 { (i64::MAX / 8 / links.max(1) as i64) as f64 / largest } else { 1.0 }
    }

    /// The same of some elements, ascending, numbered by their places among them.
    fn among(&self, elements: &[u32]) -> Self {
        let mut number = vec![u32::MAX; self.len()];
        elements.iter().zip(0..).for_each(|(&element, place)| number[element as usize] = place);
        let alike = match self {
            Self::Listed { borders: Borders::Alike(area), .. } => Some(*area),
            _ => None,
        };
        let (mut offsets, mut to, mut areas) = (vec![0], Vec::new(), Vec::new());
        for &element in elements {
            for (other, area) in self.around(element).filter(|(other, _)| number[*other as usize] != u32::MAX)
            {
                to.push(number[other as usize]);
                if alike.is_none() {
                    areas.push(area);
                }
            }
            offsets.push(to.len());
        }
        Self::Listed { offsets, to, borders: alike.map_or(Borders::Each(areas), Borders::Alike) }
    }
}

/// The elements of a body, numbered by their places in it, and their neighbours there.
pub(super) struct BodyLinks<'b> {
    /// Their numbers in the shape, ascending.
    pub elements: &'b [u32],
    links: Cow<'b, Links>,
    /// Volume or area of each; empty where it is not asked for.
    pub mass: &'b [f64],
}

impl<'b> BodyLinks<'b> {
    pub fn new(elements: &'b [u32], links: &'b Links, mass: &'b [f64]) -> Self {
        // Mostly a body is all there is.
        let all = elements.len() == links.len();
        let links = if all { Cow::Borrowed(links) } else { Cow::Owned(links.among(elements)) };
        Self { elements, links, mass }
    }

    /// Calls back with each element in turn, and each of those around it.
    #[inline(always)]
    pub fn each(&self, found: impl FnMut(u32, u32, f64)) {
        self.links.each(found);
    }

    /// The neighbours of an element, and the border shared with each.
    #[inline]
    pub fn around(&self, element: u32) -> impl Iterator<Item = (u32, f64)> + '_ {
        self.links.around(element)
    }
}

/// The border between the barycentric cells of the two ends of each edge, in each triangle.
fn dual_edges(mesh: &TriangleMesh) -> Vec<([u32; 2], f64)> {
    let sides = |t: usize| {
        let (corners, at) = (mesh.triangles()[t], mesh.corners(t));
        let mean: [f64; 3] = std::array::from_fn(|a| (at[0][a] + at[1][a] + at[2][a]) / 3.0);
        [(0, 1), (1, 2), (2, 0)].map(|(i, j)| {
            let middle = std::array::from_fn(|a| 0.5 * (at[i][a] + at[j][a]));
            let pair = [corners[i].min(corners[j]), corners[i].max(corners[j])];
            (pair, norm(sub(mean, middle)))
        })
    };
    let all = (0..mesh.triangles().len()).flat_map(sides);
    all.filter(|(pair, _)| pair[0] != pair[1]).collect()
}

/// A node of a tree, its volume and the area of its border.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bordered {
    pub node: u32,
    pub volume: f64,
    pub border: f64,
    /// The largest border of a node down the branch, over its own: more than 1 if it is narrower than what it closes off.
    pub bulge: f64,
}

/// How far down a branch bulges are looked for, as a share of the volume.
const TIP: f64 = 0.05;

/// The area of the border of each node of a body's tree, from one look at the links: with its ends in two nodes, a link is a border
/// of both and of all above them, up to the smallest that has both. In the tree of a weight of elements that is one of the two.
///
/// Areas are summed as whole numbers of tiny parts, so that what cancels leaves nothing.
pub(super) fn of_nodes(tree: &ComponentTree, body: &BodyLinks, weight: Weight) -> Vec<f64> {
    let entry = tree.nodes_of_vertices();
    let parts_of_area = body.links.parts_of_area();
    let parts = |area: f64| (area * parts_of_area).round_ties_even() as i64;
    let mut borders = vec![0i64; tree.len()];
    // What each element adds to the border of the node in which it enters, and of all above.
    let mut added = vec![0i64; entry.len()];
    if weight.may_be_of_links() {
        let ancestors = CommonAncestors::new(tree);
        body.each(|from, to, area| {
            added[from as usize] += parts(area);
            let both = ancestors.of(entry[from as usize], entry[to as usize]);
            both.into_iter().for_each(|both| borders[both as usize] -= parts(area));
        });
    } else {
        body.each(|from, to, area| {
            let (own, other) = (entry[from as usize], entry[to as usize]);
            added[from as usize] += parts(area) * (i64::from(other > own) - i64::from(other < own));
        });
    }
    for node in 0..tree.len() as u32 {
        let own: i64 = tree.own_vertices(node).iter().map(|&v| added[v as usize]).sum();
        borders[node as usize] += own;
        if let Some(parent) = tree.parent(node) {
            borders[parent as usize] += borders[node as usize];
        }
    }
    borders.into_iter().map(|border| border as f64 / parts_of_area).collect()
}

/// The node down the branch from `top` that has the largest V^2 / A, for the volume V and the area A of its border, among those
/// with at least the share `kept` of the volume of `top`.
///
/// A tree's limb ends where it merges, and there it has often reached round into the body already. This takes the border back,
/// as long as its area falls more than twice as fast as the volume, which it does not along a limb, even a tapering one.
pub(super) fn narrowest(tree: &ComponentTree, borders: &[f64], top: u32, kept: f64) -> Bordered {
    let chain = down(tree, top, TIP * tree.volume(top));
    let border = |node: u32| borders[node as usize];
    let score = |node: u32, other: u32| tree.volume(node).powi(2) * border(other);
    let large = chain.iter().take_while(|&&node| tree.volume(node) >= kept * tree.volume(top));
    let better = |best: u32, node: u32| if score(node, best) > score(best, node) { node } else { best };
    let best = large.fold(top, |best, &node| better(best, node));
    let below = chain.iter().skip_while(|&&node| node != best);
    let bulge = below.map(|&node| border(node)).fold(0.0, f64::max) / border(best);
    Bordered { node: best, volume: tree.volume(best), border: border(best), bulge }
}

/// A node and those below it along the largest children, down to a volume.
pub(super) fn down(tree: &ComponentTree, top: u32, smallest: f64) -> Vec<u32> {
    let largest = |&node: &u32| {
        // Of equal ones the first.
        let order = |a: &u32, b: &u32| tree.volume(*a).total_cmp(&tree.volume(*b)).then(b.cmp(a));
        tree.children(node).max_by(order).filter(|&child| tree.volume(child) >= smallest)
    };
    std::iter::successors(Some(top), largest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mser3d_comptree::Polarity;
    use mser3d_shape::{BitGrid, Frame, SplitMix64};

    #[test]
    fn borders_of_nodes_are_those_that_are_counted() {
        let (dims, mut random) = ([9, 8, 7], SplitMix64::new(5));
        let frame = Frame::new(dims, [0.0; 3], [1.0, 1.5, 0.7]).unwrap();
        let mut inside = BitGrid::empty(dims).unwrap();
        let all = BitGrid::full(dims).unwrap();
        all.ones().filter(|_| random.uniform() < 0.9).for_each(|voxel| inside.set(voxel, true));
        let grid = VoxelGrid::solid(frame, inside).unwrap();
        let edges: Vec<[u32; 2]> = grid.graph(Connectivity::Six).unwrap().edges().collect();
        let heights: Vec<f64> = (0..grid.len()).map(|_| (20.0 * random.uniform()).floor()).collect();
        let lengths: Vec<f64> = edges.iter().map(|_| (20.0 * random.uniform()).floor()).collect();
        let trees = [
            ComponentTree::from_vertex_weights(&edges, &heights, 1.0, Polarity::Sublevel).unwrap(),
            ComponentTree::from_edge_weights(grid.len(), &edges, &lengths, 1.0, Polarity::Sublevel).unwrap(),
        ];
        let elements: Vec<u32> = (0..grid.len() as u32).collect();
        let shape = DiscreteShape::solid(grid.clone(), Connectivity::Six);
        let faces = [1.5 * 0.7, 0.7, 1.5];
        for links in [Links::of(&shape).unwrap(), Links::OfGrid(grid, faces)] {
            let body = BodyLinks::new(&elements, &links, &[]);
            for (tree, weight) in trees.iter().zip([Weight::Heat, Weight::Edge]) {
                for (node, border) in (0..).zip(of_nodes(tree, &body, weight)) {
                    let mut own = vec![false; elements.len()];
                    tree.vertices(node).iter().for_each(|&v| own[v as usize] = true);
                    let out = tree.vertices(node).iter().flat_map(|&v| body.around(v));
                    let counted: f64 = out.filter(|(to, _)| !own[*to as usize]).map(|(_, area)| area).sum();
                    assert!((border - counted).abs() <= 1e-9 * counted, "{border} {counted}");
                }
            }
        }
    }

    #[test]
    fn the_links_of_a_large_grid_are_those_that_are_listed() {
        let (dims, mut random) = ([40, 7, 5], SplitMix64::new(3));
        for spacing in [[1.0; 3], [1.0, 2.0, 3.0]] {
            let frame = Frame::new(dims, [0.0; 3], spacing).unwrap();
            let mut inside = BitGrid::empty(dims).unwrap();
            let all = BitGrid::full(dims).unwrap();
            all.ones().filter(|_| random.uniform() < 0.8).for_each(|voxel| inside.set(voxel, true));
            let grid = VoxelGrid::solid(frame, inside).unwrap();
            let [x, y, z] = spacing;
            let of_grid = Links::OfGrid(grid.clone(), [y * z, z * x, x * y]);
            let listed = Links::of(&DiscreteShape::solid(grid, Connectivity::Six)).unwrap();
            assert_eq!(of_grid.len(), listed.len());
            for voxel in 0..listed.len() as u32 {
                assert!(of_grid.around(voxel).eq(listed.around(voxel)));
            }
            let some: Vec<u32> = (0..listed.len() as u32).step_by(3).collect();
            let (a, b) = (of_grid.among(&some), listed.among(&some));
            assert!((0..a.len() as u32).all(|element| a.around(element).eq(b.around(element))));
        }
    }
}
