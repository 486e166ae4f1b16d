//! Vertices at equal positions become one.

use std::collections::HashMap;

/// Vertices merged by position, numbered by first occurrence.
#[derive(Default)]
pub(crate) struct Weld {
    numbers: HashMap<(usize, [u64; 3]), u32>,
    /// The merged vertex of each vertex of the file.
    pub map: Vec<u32>,
}

impl Weld {
    /// Takes the next vertex of the file; true if no vertex before it had its position and group.
    ///
    /// Positions are equal when they compare equal as numbers: -0.0 is 0.0.
    pub(crate) fn push(&mut self, group: usize, position: [f64; 3]) -> bool {
        let next = self.numbers.len() as u32;
        let number = *self.numbers.entry((group, position.map(|x| (x + 0.0).to_bits()))).or_insert(next);
        self.map.push(number);
        number == next
    }
}

/// The triangles over merged vertices, and how many were left out because merging made two of their
/// corners equal.
pub(crate) fn collapse(triangles: impl Iterator<Item = [u32; 3]>, map: &[u32]) -> (Vec<[u32; 3]>, usize) {
    let mut dropped = 0;
    let kept = triangles
        .map(|t| t.map(|v| map[v as usize]))
        .filter(|&[a, b, c]| {
            let flat = a == b || b == c || c == a;
            dropped += usize::from(flat);
            !flat
        })
        .collect();
    (kept, dropped)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_of_both_signs_are_one_position() {
        let mut weld = Weld::default();
        let new: Vec<bool> = [[0.0, 1.0, 2.0], [-0.0, 1.0, 2.0], [0.0, 1.0, -2.0], [0.0, 1.0, 2.0]]
            .map(|p| weld.push(0, p))
            .into();
        assert_eq!(new, [true, false, true, false]);
        assert_eq!(weld.map, [0, 0, 1, 0]);
    }

    #[test]
    fn triangles_that_collapse_are_counted() {
        let (kept, dropped) = collapse([[0, 1, 2], [0, 1, 3]].into_iter(), &[0, 1, 1, 2]);
        assert_eq!((kept, dropped), (vec![[0, 1, 2]], 1));
    }
}
