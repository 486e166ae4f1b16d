//! Polygons are cut into triangles.

/// The faces of a file, cut into triangles as they come.
#[derive(Default)]
pub(crate) struct Faces {
    pub triangles: Vec<[u32; 3]>,
    /// Faces of more than three corners.
    pub polygons: usize,
    /// Faces of fewer than three corners, which bound nothing.
    pub skipped: usize,
}

/// Beyond this many corners a polygon is always cut as a fan: clipping ears takes up to cubic time.
const MAX_EARS: usize = 256;

impl Faces {
    /// Adds a face whose corners are numbers of `vertices` (checked by the caller).
    ///
    /// A polygon becomes the fan from its first corner where that has no flipped triangle, so that
    /// poses of one mesh get the same triangles; a concave one is cut by clipping ears (Meisters
    /// 1975) in the plane of Newell's normal.
    pub(crate) fn push(&mut self, corners: &[u32], vertices: &[[f64; 3]]) {
        match *corners {
            [] | [_] | [_, _] => self.skipped += 1,
            [a, b, c] => self.triangles.push([a, b, c]),
            [first, ref others @ ..] => {
                self.polygons += 1;
                let points = flatten(corners, vertices);
                let fan = || (1..points.len() - 1).map(|i| [0, i, i + 1]);
                if points.len() > MAX_EARS || fan().all(|t| turn(t.map(|i| points[i])) >= 0.0) {
                    self.triangles.extend(others.windows(2).map(|w| [first, w[0], w[1]]));
                } else {
                    self.triangles.extend(ears(&points).into_iter().map(|t| t.map(|i| corners[i])));
                }
            }
        }
    }
}

/// The polygon seen along its normal, so that it turns counter-clockwise.
fn flatten(corners: &[u32], vertices: &[[f64; 3]]) -> Vec<[f64; 2]> {
    let origin = vertices[corners[0] as usize];
    let points: Vec<[f64; 3]> =
        corners.iter().map(|&v| std::array::from_fn(|a| vertices[v as usize][a] - origin[a])).collect();
    let mut normal = [0.0; 3];
    for (i, p) in points.iter().enumerate() {
        let q = points[(i + 1) % points.len()];
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            normal[a] += p[b] * q[c] - p[c] * q[b];
        }
    }
    let axis = (0..3).max_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(2);
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        std::mem::swap(&mut u, &mut v);
    }
    points.iter().map(|p| [p[u], p[v]]).collect()
}

/// Twice the signed area of a triangle.
fn turn([a, b, c]: [[f64; 2]; 3]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// n - 2 triangles. For a polygon that crosses itself no answer is right, but it gets one too.
fn ears(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
    let mut left: Vec<usize> = (0..points.len()).collect();
    let mut triangles = Vec::with_capacity(points.len() - 2);
    while left.len() > 3 {
        let n = left.len();
        let corner = |i: usize| [left[(i + n - 1) % n], left[i], left[(i + 1) % n]];
        let is_ear = |&i: &usize| {
            let ear = corner(i);
            let [a, b, c] = ear.map(|j| points[j]);
            let holds = |p: [f64; 2]| [[a, b, p], [b, c, p], [c, a, p]].iter().all(|&t| turn(t) >= 0.0);
            turn([a, b, c]) > 0.0
                && !left.iter().any(|&j| {
                    let p = points[j];
                    !ear.contains(&j) && p != a && p != b && p != c && holds(p)
                })
        };
        // Clipping starts at the second corner, as the fan from the first corner does.
        let ear = (1..n).chain([0]).find(is_ear).unwrap_or(1);
        triangles.push(corner(ear));
        left.remove(ear);
    }
    triangles.push([left[0], left[1], left[2]]);
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(triangles: &[[u32; 3]], vertices: &[[f64; 3]]) -> (f64, f64) {
        let signed: Vec<f64> = triangles
            .iter()
            .map(|t| turn(t.map(|v| [vertices[v as usize][0], vertices[v as usize][1]])) / 2.0)
            .collect();
        (signed.iter().sum(), signed.iter().map(|a| a.abs()).sum())
    }

    fn cut(outline: &[[f64; 2]]) -> (Faces, Vec<[f64; 3]>) {
        let vertices: Vec<[f64; 3]> = outline.iter().map(|p| [p[0], p[1], 0.0]).collect();
        let mut faces = Faces::default();
        faces.push(&(0..outline.len() as u32).collect::<Vec<_>>(), &vertices);
        (faces, vertices)
    }

    #[test]
    fn a_convex_polygon_is_a_fan() {
        let (faces, _) = cut(&[[0., 0.], [2., 0.], [3., 1.], [1., 2.], [0., 1.]]);
        assert_eq!(faces.triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(faces.polygons, 1);
    }

    #[test]
    fn concave_polygons_are_covered_once() {
        // An arrow head whose fan from the first corner would leave it, and a comb.
        let arrow = [[2., 0.], [0., 2.], [-2., 0.], [0., 0.5]];
        let arrow: Vec<_> = [1, 2, 3, 0].map(|i: usize| arrow[(i + 3) % 4]).to_vec();
        let mut comb: Vec<[f64; 2]> = vec![[0., 0.], [9., 0.]];
        comb.extend((0..9).rev().flat_map(|i| [[i as f64 + 0.9, 5.], [i as f64 + 0.5, 1.]]));
        for (outline, expected) in [(arrow, 3.0), (comb, 0.0)] {
            for start in 0..outline.len() {
                let mut turned = outline.clone();
                turned.rotate_left(start);
                for mirrored in [false, true] {
                    if mirrored {
                        turned.reverse();
                    }
                    let (faces, vertices) = cut(&turned);
                    let (signed, covered) = area(&faces.triangles, &vertices);
                    assert_eq!(faces.triangles.len(), outline.len() - 2);
                    assert!((signed.abs() - covered).abs() < 1e-12, "covered twice from corner {start}");
                    assert!(expected == 0.0 || (covered - expected).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn faces_without_area_are_counted_or_kept() {
        let (faces, _) = cut(&[[0., 0.], [1., 1.]]);
        assert_eq!((faces.triangles.len(), faces.skipped), (0, 1));
        let (faces, _) = cut(&[[0., 0.]; 5]);
        assert_eq!(faces.triangles.len(), 3);
    }
}
