//! From any tree of merges to the canonical numbering.
use crate::order::NONE;
use crate::tree::Nodes;

/// A tree as an algorithm leaves it: parents at altitudes not below their children's, in any order.
/// Neighbours of equal altitude are still to be made one node.
pub(crate) struct RawTree {
    /// Parent of each raw node.
    pub parents: Vec<u32>,
    /// Levels that rise towards the root.
    pub levels: Vec<f64>,
    /// The raw node that each vertex hangs from.
    pub node_of: Vec<u32>,
}

/// Collapses equal altitudes and numbers the nodes in postorder, siblings by their smallest vertex.
/// Linear in time.
pub(crate) fn canonical(raw: RawTree) -> Nodes {
    let RawTree { mut parents, levels, mut node_of } = raw;
    collapse(&mut parents, &levels, &mut node_of);

    // Climb from the vertices in ascending order, each time up to what was reached before. A node is
    // first reached from its smallest vertex, so siblings are reached in the order wanted.
    let count = parents.len();
    let (mut first_child, mut last_child) = (vec![NONE; count], vec![NONE; count]);
    let mut next_sibling = vec![NONE; count];
    let mut reached = vec![false; count];
    let mut roots = Vec::new();
    for &start in &node_of {
        let mut node = start;
        while !reached[node as usize] {
            reached[node as usize] = true;
            let parent = parents[node as usize];
            if parent == NONE {
                roots.push(node);
                break;
            }
            match std::mem::replace(&mut last_child[parent as usize], node) {
                NONE => first_child[parent as usize] = node,
                sibling => next_sibling[sibling as usize] = node,
            }
            node = parent;
        }
    }
    drop((reached, last_child));

    // Postorder; `number` takes the place of the list of first children once that was followed.
    let mut order = Vec::new();
    for &root in &roots {
        let mut node = descend(root, &first_child);
        loop {
            order.push(node);
            if node == root {
                break;
            }
            node = match next_sibling[node as usize] {
                NONE => parents[node as usize],
                sibling => descend(sibling, &first_child),
            };
        }
    }
    drop(next_sibling);
    let mut number = first_child;
    for (new, &old) in order.iter().enumerate() {
        number[old as usize] = new as u32;
    }

    let mut ends = vec![0u32; order.len()];
    for node in &mut node_of {
        *node = number[*node as usize];
        ends[*node as usize] += 1;
    }
    let mut sum = 0;
    for end in &mut ends {
        sum += *end;
        *end = sum - *end;
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
        altitudes: order.iter().map(|&old| levels[old as usize]).collect(),
        ends,
        vertices,
    }
}

fn descend(mut node: u32, first_child: &[u32]) -> u32 {
    while first_child[node as usize] != NONE {
        node = first_child[node as usize];
    }
    node
}

/// Makes the highest of each chain of equal altitudes stand for all: afterwards every vertex, and the
/// parent of every node that stands for itself, is such a node.
fn collapse(parents: &mut [u32], levels: &[f64], node_of: &mut [u32]) {
    let absorbed =
        |node: u32, parent: u32| parent != NONE && levels[parent as usize] == levels[node as usize];
    // Each absorbed node is made to point at what stands for it, by compressing paths.
    let stand = |parents: &mut [u32], node: u32| {
        let mut top = node;
        while absorbed(top, parents[top as usize]) {
            top = parents[top as usize];
        }
        let mut at = node;
        while at != top {
            at = std::mem::replace(&mut parents[at as usize], top);
        }
        top
    };
    for node in 0..parents.len() as u32 {
        let top = stand(parents, node);
        let parent = parents[top as usize];
        if parent != NONE {
            parents[top as usize] = stand(parents, parent);
        }
    }
    for node in node_of {
        *node = stand(parents, *node);
    }
}
