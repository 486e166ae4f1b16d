//! The canonical numbering of nodes: postorder, siblings by their smallest vertex. Not in a paper.
use crate::tree::NONE;
use crate::tree::Nodes;

/// What a walk through a tree reads of a node, together in memory.
#[derive(Clone, Copy)]
struct Kin {
    parent: u32,
    first_child: u32,
    last_child: u32,
    next_sibling: u32,
}

/// Nodes with children before parents and siblings by their smallest vertex; `node_of` gives the node of
/// each vertex. Linear in time.
pub(crate) fn postorder(parents: &[u32], node_of: &[u32]) -> Vec<u32> {
    // Climbing from the vertices in ascending order, each time up to what was reached before, a node is
    // first reached from its smallest vertex: siblings are reached in the order wanted.
    let unknown = Kin { parent: NONE, first_child: NONE, last_child: NONE, next_sibling: NONE };
    let mut kin: Vec<Kin> = parents.iter().map(|&parent| Kin { parent, ..unknown }).collect();
    let mut reached = vec![false; parents.len()];
    let mut roots = Vec::new();
    for &start in node_of {
        let mut node = start;
        while !std::mem::replace(&mut reached[node as usize], true) {
            let parent = kin[node as usize].parent;
            if parent == NONE {
                roots.push(node);
                break;
            }
            match std::mem::replace(&mut kin[parent as usize].last_child, node) {
                NONE => kin[parent as usize].first_child = node,
                sibling => kin[sibling as usize].next_sibling = node,
            }
            node = parent;
        }
    }
    let descend = |mut node: u32| {
        while kin[node as usize].first_child != NONE {
            node = kin[node as usize].first_child;
        }
        node
    };
    let mut order = Vec::with_capacity(parents.len());
    for root in roots {
        let mut node = descend(root);
        loop {
            order.push(node);
            if node == root {
                break;
            }
            node = match kin[node as usize] {
                Kin { next_sibling: NONE, parent, .. } => parent,
                Kin { next_sibling, .. } => descend(next_sibling),
            };
        }
    }
    order
}

/// Numbers the nodes of a tree in postorder and sorts the vertices by node.
pub(crate) fn canonical(parents: &[u32], altitudes: &[f64], mut node_of: Vec<u32>) -> Nodes {
    let order = postorder(parents, &node_of);
    let mut number = vec![0u32; parents.len()];
    order.iter().enumerate().for_each(|(new, &old)| number[old as usize] = new as u32);
    let mut ends = vec![0u32; order.len()];
    for node in &mut node_of {
        *node = number[*node as usize];
        ends[*node as usize] += 1;
    }
    let mut sum = 0;
    for end in &mut ends {
        let count = std::mem::replace(end, sum);
        sum += count;
    }
    let mut vertices = vec![0u32; node_of.len()];
    for (v, &node) in node_of.iter().enumerate() {
        let at = &mut ends[node as usize];
        vertices[*at as usize] = v as u32;
        *at += 1;
    }
    let parent = |&old: &u32| match parents[old as usize] {
        NONE => NONE,
        parent => number[parent as usize],
    };
    Nodes {
        parents: order.iter().map(parent).collect(),
        altitudes: order.iter().map(|&old| altitudes[old as usize]).collect(),
        ends,
        vertices,
    }
}
