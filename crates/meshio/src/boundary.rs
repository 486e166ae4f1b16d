//! The boundary of volume cells: the faces that belong to one cell only, seen from outside.

use crate::cells::{NONE, Shape, Solid};
use std::collections::{HashMap, HashSet};

/// A triangle or quadrilateral; the fourth corner of a triangle is `NONE`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Face([u32; 4]);

impl Face {
    pub(crate) fn corners(&self) -> &[u32] {
        if self.0[3] == NONE { &self.0[..3] } else { &self.0 }
    }

    /// The corners without repetitions, as cells have them whose corners fall together; `None` if fewer
    /// than three are left.
    fn new(corners: impl Iterator<Item = u32>) -> Option<Self> {
        let mut face = [NONE; 4];
        let mut n = 0;
        for v in corners {
            if !face[..n].contains(&v) {
                face[n] = v;
                n += 1;
            }
        }
        (n >= 3).then_some(Self(face))
    }

    /// The smallest corner and the others in ascending order.
    fn key(&self) -> (u32, [u32; 3]) {
        let mut sorted = self.0;
        sorted.sort_unstable(); // `NONE` is the largest.
        (sorted[0], [sorted[1], sorted[2], sorted[3]])
    }

    /// One of two ways round, the same for equal sets of corners that turn alike.
    fn direct(&self) -> bool {
        let corners = self.corners();
        let (n, least) = (corners.len(), self.key().0);
        let at = corners.iter().position(|&v| v == least).unwrap_or(0);
        corners[(at + 1) % n] < corners[(at + n - 1) % n]
    }

    fn turned(self) -> Self {
        let [a, b, c, d] = self.0;
        if d == NONE { Self([a, c, b, d]) } else { Self([a, d, c, b]) }
    }
}

/// What is around cells.
#[derive(Default)]
pub(crate) struct Boundary {
    /// In the order of their cells, counter-clockwise from outside.
    pub faces: Vec<Face>,
    /// Vertices at the place of an earlier one.
    pub joined: usize,
    /// Cells left out because an earlier one has the same corners.
    pub repeated: usize,
    /// Cells without volume.
    pub flat: usize,
    /// Faces of more than two cells.
    pub crowded: usize,
    /// Faces that have two cells on the same side.
    pub same_side: usize,
}

/// The boundary of cells, whose corners are numbers of `vertices`. Vertices at equal positions count as one:
/// the first of them.
///
/// Sorts faces within the buckets of their smallest corner: linear in the number of cells, as long as no
/// vertex has very many.
pub(crate) fn boundary(vertices: &[[f64; 3]], solids: &mut Vec<Solid>) -> Boundary {
    let joined = join(vertices, solids);
    let mut found = match_faces(vertices, solids);
    if found.same_side + found.crowded > 0 {
        let before = solids.len();
        let mut seen = HashSet::new();
        solids.retain(|solid| {
            let mut corners = solid.corners;
            corners.sort_unstable();
            seen.insert((solid.shape, corners))
        });
        if solids.len() < before {
            found = Boundary { repeated: before - solids.len(), ..match_faces(vertices, solids) };
        }
    }
    cancel_split(&mut found.faces);
    Boundary { joined, ..found }
}

/// Renames corners to the first vertex at their position; how many vertices of cells lost their name.
fn join(vertices: &[[f64; 3]], solids: &mut [Solid]) -> usize {
    let mut used = vec![false; vertices.len()];
    for corner in solids.iter().flat_map(|s| s.corners).filter(|&v| v != NONE) {
        used[corner as usize] = true;
    }
    let mut first: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
    let mut names: Vec<u32> = (0..vertices.len() as u32).collect();
    let mut joined = 0;
    for v in (0..vertices.len()).filter(|&v| used[v]) {
        // -0.0 is 0.0.
        let position = vertices[v].map(|x| (x + 0.0).to_bits());
        names[v] = *first.entry(position).or_insert(v as u32);
        joined += usize::from(names[v] != v as u32);
    }
    if joined > 0 {
        let corners = solids.iter_mut().flat_map(|s| s.corners.iter_mut());
        corners.filter(|v| **v != NONE).for_each(|v| *v = names[*v as usize]);
    }
    joined
}

/// A face of a cell, in the bucket of its smallest corner.
#[derive(Clone, Copy, Default)]
struct Side {
    others: [u32; 3],
    cell: u32,
    number: u8,
    direct: bool,
}

/// How a cell lies.
#[derive(Clone, Copy, PartialEq)]
enum Turn {
    Outwards,
    Inwards,
    /// Its volume may be rounding; neighbours know better. The sign is what was computed.
    Flat(bool),
}

fn match_faces(vertices: &[[f64; 3]], solids: &[Solid]) -> Boundary {
    let mut found = Boundary::default();
    let mut turns: Vec<Turn> = Vec::with_capacity(solids.len());
    for solid in solids {
        let (turn, exactly) = turn(vertices, solid);
        turns.push(turn);
        found.flat += usize::from(exactly);
    }
    let outwards = |cell: usize| matches!(turns[cell], Turn::Outwards | Turn::Flat(true));
    // Counting sort by the smallest corner.
    let mut starts = vec![0usize; vertices.len() + 1];
    for solid in solids {
        faces(solid).for_each(|(_, face)| starts[face.key().0 as usize + 1] += 1);
    }
    for v in 0..vertices.len() {
        starts[v + 1] += starts[v];
    }
    let mut sides = vec![Side::default(); starts[vertices.len()]];
    let mut next = starts.clone();
    for (cell, solid) in solids.iter().enumerate() {
        for (number, face) in faces(solid) {
            let (least, others) = face.key();
            let direct = face.direct() == outwards(cell);
            sides[next[least as usize]] = Side { others, cell: cell as u32, number, direct };
            next[least as usize] += 1;
        }
    }
    drop(next);

    let mut outer: Vec<(u32, u8)> = Vec::new();
    let mut votes: HashMap<u32, i64> = HashMap::new();
    for v in 0..vertices.len() {
        let bucket = &mut sides[starts[v]..starts[v + 1]];
        bucket.sort_unstable_by_key(|s| (s.others, s.cell, s.number));
        for group in bucket.chunk_by(|a, b| a.others == b.others) {
            match group {
                [one] => outer.push((one.cell, one.number)),
                [a, b] => {
                    let flat = |s: &Side| matches!(turns[s.cell as usize], Turn::Flat(_));
                    let agree = a.direct != b.direct;
                    if flat(a) != flat(b) {
                        let cell = if flat(a) { a.cell } else { b.cell };
                        *votes.entry(cell).or_default() += if agree { 1 } else { -1 };
                    } else if !agree && !flat(a) {
                        found.same_side += 1;
                        outer.extend(group.iter().map(|s| (s.cell, s.number)));
                    }
                }
                more => {
                    found.crowded += 1;
                    // What the others leave over, so that the boundary stays closed.
                    let balance: i64 = more.iter().map(|s| if s.direct { 1 } else { -1 }).sum();
                    let over = more.iter().filter(|s| s.direct == (balance > 0));
                    outer.extend(over.take(balance.unsigned_abs() as usize).map(|s| (s.cell, s.number)));
                }
            }
        }
    }
    outer.sort_unstable();
    found.faces = outer
        .into_iter()
        .filter_map(|(cell, number)| {
            let (_, face) = faces(&solids[cell as usize]).find(|f| f.0 == number)?;
            let against = votes.get(&cell).is_some_and(|&vote| vote < 0);
            Some(if outwards(cell as usize) != against { face } else { face.turned() })
        })
        .collect();
    found
}

/// Removes each quadrilateral that lies on two triangles which another cell has in its place.
fn cancel_split(faces: &mut Vec<Face>) {
    let is_triangle = |f: &Face| f.0[3] == NONE;
    let triangles = faces.iter().enumerate().filter(|f| is_triangle(f.1));
    let mut left: HashMap<(u32, [u32; 3]), usize> = triangles.map(|(i, f)| (f.key(), i)).collect();
    if left.is_empty() || left.len() == faces.len() {
        return;
    }
    let mut gone = vec![false; faces.len()];
    for (number, &Face([a, b, c, d])) in faces.iter().enumerate().filter(|f| !is_triangle(f.1)) {
        for halves in [[[a, b, c], [a, c, d]], [[a, b, d], [b, c, d]]] {
            let halves = halves.map(|[a, b, c]| Face([a, b, c, NONE]));
            let other = |half: &Face| left.get(&half.key()).filter(|&&i| faces[i].direct() != half.direct());
            if let (Some(&first), Some(&second)) = (other(&halves[0]), other(&halves[1])) {
                for i in [number, first, second] {
                    gone[i] = true;
                }
                for half in &halves {
                    left.remove(&half.key());
                }
                break;
            }
        }
    }
    let mut gone = gone.into_iter();
    faces.retain(|_| !gone.next().unwrap_or(false));
}

/// The faces of a cell, counter-clockwise from outside when its volume is positive, with their numbers.
fn faces(solid: &Solid) -> impl Iterator<Item = (u8, Face)> + '_ {
    let table: &[&[u8]] = match solid.shape {
        Shape::Tetrahedron => &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[0, 3, 2]],
        Shape::Hexahedron => {
            &[&[0, 3, 2, 1], &[4, 5, 6, 7], &[0, 1, 5, 4], &[1, 2, 6, 5], &[2, 3, 7, 6], &[3, 0, 4, 7]]
        }
        Shape::Wedge => &[&[0, 2, 1], &[3, 4, 5], &[0, 1, 4, 3], &[1, 2, 5, 4], &[2, 0, 3, 5]],
        Shape::Pyramid => &[&[0, 3, 2, 1], &[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4]],
        _ => &[],
    };
    let face = |face: &&[u8]| Face::new(face.iter().map(|&i| solid.corners[usize::from(i)]));
    table.iter().enumerate().filter_map(move |(i, f)| face(f).map(|f| (i as u8, f)))
}

/// How a cell lies, and whether it has no volume but rounding.
fn turn(vertices: &[[f64; 3]], solid: &Solid) -> (Turn, bool) {
    let origin = vertices[solid.corners[0] as usize];
    let at = |v: u32| -> [f64; 3] { std::array::from_fn(|a| vertices[v as usize][a] - origin[a]) };
    let det = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    let mut volume = 0.0;
    for (_, face) in faces(solid) {
        let corners = face.corners();
        match *corners {
            [a, b, c, d] => {
                // The mean of both ways to cut it, so that neighbours see one face.
                let [a, b, c, d] = [a, b, c, d].map(at);
                volume += (det([a, b, c]) + det([a, c, d]) + det([a, b, d]) + det([b, c, d])) / 2.0;
            }
            _ => volume += det([corners[0], corners[1], corners[2]].map(at)),
        }
    }
    let corners = solid.corners.iter().filter(|&&v| v != NONE);
    let size = corners.flat_map(|&v| at(v)).fold(0.0f64, |m, x| m.max(x.abs()));
    let turn = if volume.abs() <= 1e-10 * size.powi(3) {
        Turn::Flat(volume >= 0.0)
    } else if volume > 0.0 {
        Turn::Outwards
    } else {
        Turn::Inwards
    };
    (turn, volume.abs() <= 1e-14 * size.powi(3))
}
