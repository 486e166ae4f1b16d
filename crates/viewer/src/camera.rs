use crate::vector::{Vec3, add, cross, dot, scale};

/// Which axis of the shape points up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Up {
    /// +y up; the front looks along +z. The habit of animation and of OBJ and glTF files.
    #[default]
    Y,
    /// +z up; the front looks along -y. The habit of CAD and of many scanners.
    Z,
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

    /// The camera's axes in the shape's coordinates.
    pub(crate) fn camera(self, up: Up) -> Camera {
        let (right, up, toward): (Vec3, Vec3, Vec3) = match up {
            Up::Y => ([1., 0., 0.], [0., 1., 0.], [0., 0., 1.]),
            Up::Z => ([1., 0., 0.], [0., 0., 1.], [0., -1., 0.]),
        };
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
