//! Gmsh's types of elements.

use crate::cells::{Kind, Shape};

/// The kind of an element by its number in Gmsh, and how many nodes it has. Corners come first.
pub(super) fn kind(number: i64) -> Option<(Kind, usize)> {
    use Shape::*;
    let straight = |shape, corners| Some((Kind::new(shape, corners), corners));
    let curved = |shape, corners, nodes| Some((Kind::curved(shape, corners), nodes));
    match number {
        1 => straight(Line, 2),
        2 => straight(Polygon, 3),
        3 => straight(Polygon, 4),
        4 => straight(Tetrahedron, 4),
        5 => straight(Hexahedron, 8),
        6 => straight(Wedge, 6),
        7 => straight(Pyramid, 5),
        8 => curved(Line, 2, 3),
        9 => curved(Polygon, 3, 6),
        10 => curved(Polygon, 4, 9),
        11 => curved(Tetrahedron, 4, 10),
        12 => curved(Hexahedron, 8, 27),
        13 => curved(Wedge, 6, 18),
        14 => curved(Pyramid, 5, 14),
        15 => straight(Point, 1),
        16 => curved(Polygon, 4, 8),
        17 => curved(Hexahedron, 8, 20),
        18 => curved(Wedge, 6, 15),
        19 => curved(Pyramid, 5, 13),
        20 => curved(Polygon, 3, 9),
        21 => curved(Polygon, 3, 10),
        22 => curved(Polygon, 3, 12),
        23 | 24 => curved(Polygon, 3, 15),
        25 => curved(Polygon, 3, 21),
        26 => curved(Line, 2, 4),
        27 => curved(Line, 2, 5),
        28 => curved(Line, 2, 6),
        29 => curved(Tetrahedron, 4, 20),
        30 => curved(Tetrahedron, 4, 35),
        31 => curved(Tetrahedron, 4, 56),
        36 => curved(Polygon, 4, 16),
        37 => curved(Polygon, 4, 25),
        38 => curved(Polygon, 4, 36),
        90 => curved(Wedge, 6, 40),
        91 => curved(Wedge, 6, 75),
        92 => curved(Hexahedron, 8, 64),
        93 => curved(Hexahedron, 8, 125),
        118 => curved(Pyramid, 5, 30),
        119 => curved(Pyramid, 5, 55),
        _ => None,
    }
}
