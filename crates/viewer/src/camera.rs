//! Where a picture is taken from: orthographic views.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{Vec3, add, cross, dot, scale, sub};

mser3d_shape::choice! {
    /// Which axis of the shape points up.
    pub enum Up("axis that points up") {
        /// +y up, as in animation and in most OBJ and glTF files
        ///
        /// The front looks along +z.
        #[default]
        Y = "y",
        /// +z up, as in CAD and in many scans
        ///
        /// The front looks along -y.
        Z = "z",
    }
}

impl Up {
    /// The picture's axes in the view from the front: right, up, and towards the viewer.
    pub fn axes(self) -> [Vec3; 3] {
        match self {
            Self::Y => [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]],
            Self::Z => [[1., 0., 0.], [0., 0., 1.], [0., -1., 0.]],
        }
    }
}

mser3d_shape::choice! {
    /// Views that have a name.
    pub enum NamedView("view") {
        /// From the front
        #[default]
        Front = "front",
        /// Between front and side, a little from above
        ThreeQuarter = "three-quarter",
        /// From the side at +x
        Side = "side",
        /// From the back
        Back = "back",
        /// From above
        Top = "top",
    }
}

impl From<NamedView> for View {
    fn from(view: NamedView) -> Self {
        match view {
            NamedView::Front => Self::FRONT,
            NamedView::ThreeQuarter => Self::THREE_QUARTER,
            NamedView::Side => Self::SIDE,
            NamedView::Back => Self::BACK,
            NamedView::Top => Self::TOP,
        }
    }
}

/// Where an orthographic camera stands: angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Turn about the up axis: 0 sees the front, 90 the side at +x, 180 the back.
    pub azimuth: f64,
    /// Height above the horizon: 90 looks straight down.
    pub elevation: f64,
}

impl View {
    /// From the front.
    pub const FRONT: Self = Self { azimuth: 0.0, elevation: 0.0 };
    /// From the side at +x.
    pub const SIDE: Self = Self { azimuth: 90.0, elevation: 0.0 };
    /// From the back.
    pub const BACK: Self = Self { azimuth: 180.0, elevation: 0.0 };
    /// Between front and side, a little from above.
    pub const THREE_QUARTER: Self = Self { azimuth: 35.0, elevation: 12.0 };
    /// From above.
    pub const TOP: Self = Self { azimuth: 0.0, elevation: 90.0 };

    /// The same from a place turned by so many degrees about the up axis.
    pub fn turned(self, degrees: f64) -> Self {
        Self { azimuth: self.azimuth + degrees, ..self }
    }

    /// The one of several views that shows most of a part of a surface: in which the triangles of the part
    /// that face the viewer have the largest projected area. That other parts may hide them is ignored. Of
    /// equal views the first; `None` if `views` is empty.
    ///
    /// `part` lists vertices; a triangle is of the part when its three corners are.
    pub fn facing(mesh: &TriangleMesh, part: &[u32], up: Up, views: &[Self]) -> Option<Self> {
        let mut inside = vec![false; mesh.vertices().len()];
        for &vertex in part {
            if let Some(inside) = inside.get_mut(vertex as usize) {
                *inside = true;
            }
        }
        let outward = if mesh.signed_volume() < 0.0 { -1.0 } else { 1.0 };
        let areas: Vec<Vec3> = (0..mesh.triangles().len())
            .filter(|&t| mesh.triangles()[t].iter().all(|&v| inside[v as usize]))
            .map(|t| mesh.corners(t))
            .map(|[a, b, c]| scale(cross(sub(b, a), sub(c, a)), outward))
            .collect();
        let seen = |view: Self| -> f64 {
            let toward = view.camera(up).toward;
            areas.iter().map(|&area| dot(area, toward).max(0.0)).sum()
        };
        let mut best: Option<(f64, Self)> = None;
        for &view in views {
            let area = seen(view);
            if best.is_none_or(|(most, _)| area > most) {
                best = Some((area, view));
            }
        }
        best.map(|(_, view)| view)
    }

    /// The camera's axes in the shape's coordinates.
    pub(crate) fn camera(self, up: Up) -> Camera {
        let [right, up, toward] = up.axes();
        let (sin, cos) = self.azimuth.to_radians().sin_cos();
        let level = add(scale(toward, cos), scale(right, sin));
        let right = add(scale(right, cos), scale(toward, -sin));
        let (sin, cos) = self.elevation.to_radians().sin_cos();
        let toward = add(scale(level, cos), scale(up, sin));
        Camera { right, up: cross(toward, right), toward }
    }
}

/// An orthonormal frame: picture right, picture up, towards the viewer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Camera {
    pub right: Vec3,
    pub up: Vec3,
    pub toward: Vec3,
}

impl Camera {
    /// A vector in the camera's frame.
    pub fn turn(&self, v: Vec3) -> Vec3 {
        [dot(self.right, v), dot(self.up, v), dot(self.toward, v)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vec3, b: Vec3) {
        assert!((0..3).all(|i| (a[i] - b[i]).abs() < 1e-12), "{a:?} {b:?}");
    }

    #[test]
    fn the_named_views_look_along_the_axes() {
        let toward = |view: View, up| view.camera(up).toward;
        near(toward(View::FRONT, Up::Y), [0., 0., 1.]);
        near(toward(View::SIDE, Up::Y), [1., 0., 0.]);
        near(toward(View::TOP, Up::Y), [0., 1., 0.]);
        near(toward(View::FRONT, Up::Z), [0., -1., 0.]);
        near(toward(View::SIDE, Up::Z), [1., 0., 0.]);
        near(View::BACK.camera(Up::Z).right, [-1., 0., 0.]);
    }

    #[test]
    fn a_part_faces_the_view_it_is_on() {
        let cube = crate::test_shapes::cube();
        let part = |axis: usize, side: f64| -> Vec<u32> {
            let (low, high) = cube.bounding_box().map(|b| (b.min[axis], b.max[axis])).unwrap();
            let wanted = if side < 0.0 { low } else { high };
            (0..cube.vertices().len() as u32)
                .filter(|&v| (cube.vertices()[v as usize][axis] - wanted).abs() < 1e-9)
                .collect()
        };
        let views = [View::FRONT, View::BACK, View::SIDE, View::TOP];
        let facing = |part: &[u32], up| View::facing(&cube, part, up, &views).unwrap();
        assert_eq!(facing(&part(2, 1.0), Up::Y), View::FRONT);
        assert_eq!(facing(&part(2, -1.0), Up::Y), View::BACK);
        assert_eq!(facing(&part(2, 1.0), Up::Z), View::TOP);
        assert_eq!(facing(&part(0, 1.0), Up::Z), View::SIDE);
        assert_eq!(facing(&[], Up::Y), View::FRONT);
        assert_eq!(View::facing(&cube, &[], Up::Y, &[]), None);
    }

    #[test]
    fn cameras_are_right_handed_and_upright() {
        for view in [View::FRONT, View::THREE_QUARTER, View { azimuth: 200.0, elevation: -30.0 }] {
            for up in [Up::Y, Up::Z] {
                let c = view.camera(up);
                near(cross(c.right, c.up), c.toward);
                assert!(c.turn(if up == Up::Y { [0., 1., 0.] } else { [0., 0., 1.] })[1] > 0.8);
            }
        }
    }
}
