//! The boundary of shells as closed loops, each to be closed by a cone of its own.

use mser3d_shape::DisjointSets;

/// A side of a triangle that no other side of its shell runs against.
#[derive(Clone, Copy)]
pub(crate) struct BoundarySide {
    pub from: u32,
    pub to: u32,
    pub shell: u32,
}

/// The number of each side's loop, and how many loops there are.
///
/// Where holes meet in a vertex, they are walked apart: a loop passes no vertex twice. A cone over several
/// holes would reach all through the body, and no tree finds the few such triangles that matter at a point.
/// The walk does not depend on which way the boundary runs, so that a mirror image has the same loops.
pub(crate) fn loops(vertices: usize, boundary: &[BoundarySide]) -> (Vec<u32>, u32) {
    let mut sets = DisjointSets::new(vertices);
    boundary.iter().for_each(|side| {
        sets.union(side.from, side.to);
    });
    let mut order: Vec<u32> = (0..boundary.len() as u32).collect();
    let mut component = |side: u32| (boundary[side as usize].shell, sets.find(boundary[side as usize].from));
    order.sort_by_cached_key(|&side| component(side));
    let mut number = vec![0; boundary.len()];
    let mut count = 0;
    for part in order.chunk_by(|&a, &b| component(a) == component(b)) {
        walk(part, boundary, &mut number, &mut count);
    }
    (number, count)
}

/// Walks through the sides of one component.
fn walk(part: &[u32], boundary: &[BoundarySide], number: &mut [u32], count: &mut u32) {
    let ends = |side: u32| (boundary[side as usize].from, boundary[side as usize].to);
    // Along the least edge away from the least vertex.
    let least = part.iter().map(|&s| ends(s)).map(|(a, b)| (a.min(b), a.max(b), a > b)).min();
    let backwards = least.is_some_and(|l| l.2);
    let step = |side: u32| if backwards { (ends(side).1, ends(side).0) } else { ends(side) };
    let mut sides = part.to_vec();
    sides.sort_by_key(|&side| step(side));
    let mut used = vec![false; sides.len()];
    // Places in `sides` on the way here, none of whose first vertices repeat.
    let mut path: Vec<usize> = Vec::new();
    let mut on_path = std::collections::HashMap::new();
    for start in 0..sides.len() {
        let mut next = (!used[start]).then_some(start);
        while let Some(at) = next {
            used[at] = true;
            let (from, to) = step(sides[at]);
            on_path.insert(from, path.len());
            path.push(at);
            if let Some(&first) = on_path.get(&to) {
                for passed in path.drain(first..) {
                    on_path.remove(&step(sides[passed]).0);
                    number[sides[passed] as usize] = *count;
                }
                *count += 1;
            }
            let here = sides.partition_point(|&side| step(side).0 < to);
            next = (here..sides.len()).take_while(|&i| step(sides[i]).0 == to).find(|&i| !used[i]);
        }
        // Boundaries of surfaces are closed, so nothing should be left.
        if !path.is_empty() {
            path.drain(..).for_each(|passed| number[sides[passed] as usize] = *count);
            on_path.clear();
            *count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn holes_that_meet_in_a_vertex_are_two_loops_either_way() {
        let around = [(3, 5), (5, 9), (9, 3), (3, 7), (7, 8), (8, 3), (20, 21), (21, 20)];
        let sides = |turn: bool| -> Vec<BoundarySide> {
            let side = |&(a, b): &(u32, u32)| BoundarySide {
                from: if turn { b } else { a },
                to: if turn { a } else { b },
                shell: 0,
            };
            around.iter().map(side).collect()
        };
        let (number, count) = loops(30, &sides(false));
        assert_eq!(count, 3);
        assert!(number[0] == number[1] && number[1] == number[2] && number[3] == number[5]);
        assert!(number[0] != number[3] && number[6] == number[7]);
        assert_eq!(loops(30, &sides(true)), (number, count));
    }
}
