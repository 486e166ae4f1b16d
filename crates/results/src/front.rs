//! Which way a body looks, from its parts.

use mser3d_shape::vector::{Vec3, dot, scale, sub};
use mser3d_viewer::Up;

use crate::parts::twin_of;
use crate::{PartRecord, Results};

/// How much longer the distances of joints have to be across the body than along it.
const CLEAR: f64 = 3.0;
/// How far from the trunk's centre a head's neck is, as a share of the trunk's length, where the body looks along its trunk.
const HEAD_AHEAD: f64 = 0.25;
/// How far ahead a neck is on a body that stands on four legs, at least, as a multiple of how far it is above the trunk's centre: one that
/// leans on two legs has its head ahead too, or behind.
const HEAD_LEVEL: f64 = 0.5;
/// How far a foot reaches before its shin, as a share of the leg's height.
const TOES_AHEAD: f64 = 0.02;

impl Results {
    /// The azimuth, in degrees, from which the body is seen from the front; none where that can't be told.
    ///
    /// A body with limbs that are mirror images has a direction across: between the joints of two twins, where limbs meet the trunk,
    /// which a pose moves least. It looks at a right angle to that, level: towards the largest single limb, its head, if that is far ahead of
    /// the trunk's centre, as on four legs; else to where the toes of the lowest limb point.
    pub fn front(&self, up: Up) -> Option<f64> {
        let parts = self.record.parts.as_ref()?;
        let [right, up, toward] = up.axes();
        let joints = self.joints(parts);
        // The spread of the joints' distances, in the plane of the ground.
        let level = |v: Vec3| [dot(v, right), dot(v, toward)];
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for part in parts {
            let twin = twin_of(part, parts, &self.record.regions).filter(|twin| part.id < *twin);
            let pair = twin.and_then(|twin| Some([joints[part.id as usize]?, joints[twin as usize]?]));
            if let Some([a, b]) = pair {
                let [x, y] = level(sub(a, b));
                (xx, xy, yy) = (xx + x * x, xy + x * y, yy + y * y);
            }
        }
        let (mean, half) = (0.5 * (xx + yy), (0.25 * (xx - yy).powi(2) + xy * xy).sqrt());
        if mean + half <= CLEAR * (mean - half).max(0.0) || mean + half <= 0.0 {
            return None;
        }
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        // At a right angle to the direction across.
        let ahead = [-angle.sin(), angle.cos()];
        let along = |v: Vec3| level(v)[0] * ahead[0] + level(v)[1] * ahead[1];
        let sign = self.head(parts, &joints, up, along).or_else(|| self.toes(parts, up, along))?;
        Some((sign * ahead[0]).atan2(sign * ahead[1]).to_degrees())
    }

    /// Where each part meets a trunk.
    pub(crate) fn joints(&self, parts: &[PartRecord]) -> Vec<Option<Vec3>> {
        let mut sums = vec![([0.0; 3], 0.0); parts.len()];
        let part =
            |v: u32| usize::try_from(self.vertex_part[v as usize]).ok().filter(|&part| part < parts.len());
        for triangle in self.mesh.triangles() {
            for (a, b) in [(0, 1), (1, 2), (2, 0)].map(|(a, b)| (triangle[a], triangle[b])) {
                let (Some(p), Some(q)) = (part(a), part(b)) else { continue };
                for (p, q) in [(p, q), (q, p)] {
                    if !parts[p].trunk && parts[q].trunk {
                        let (a, b) = (self.mesh.vertices()[a as usize], self.mesh.vertices()[b as usize]);
                        (0..3).for_each(|i| sums[p].0[i] += 0.5 * (a[i] + b[i]));
                        sums[p].1 += 1.0;
                    }
                }
            }
        }
        sums.into_iter().map(|(sum, count)| (count > 0.0).then(|| scale(sum, 1.0 / count))).collect()
    }

    /// 1 if the largest single limb is ahead, -1 if behind, none if neither.
    fn head(
        &self,
        parts: &[PartRecord],
        joints: &[Option<Vec3>],
        up: Vec3,
        along: impl Fn(Vec3) -> f64,
    ) -> Option<f64> {
        // Parts are sorted by volume.
        let head =
            parts.iter().find(|p| !p.trunk && p.twins.is_empty() && joints[p.id as usize].is_some())?;
        let trunk = parts.iter().find(|p| p.trunk && p.body == head.body)?;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (vertex, part) in self.mesh.vertices().iter().zip(&self.vertex_part) {
            if *part == trunk.id as i32 {
                let x = along(*vertex);
                (low, high) = (low.min(x), high.max(x));
            }
        }
        let from_centre = sub(joints[head.id as usize]?, trunk.centroid);
        let ahead = along(from_centre);
        let far =
            ahead.abs() > HEAD_AHEAD * (high - low) && ahead.abs() > HEAD_LEVEL * dot(from_centre, up).abs();
        far.then_some(ahead.signum())
    }

    /// 1 if the toes of the lowest limb point ahead, -1 if back, none if neither.
    fn toes(&self, parts: &[PartRecord], up: Vec3, along: impl Fn(Vec3) -> f64) -> Option<f64> {
        let height = |v: &u32| dot(self.mesh.vertices()[*v as usize], up);
        let vertices = |part: &PartRecord| -> Vec<u32> {
            let own = (0u32..).zip(&self.vertex_part).filter(|(_, p)| **p == part.id as i32);
            own.map(|(vertex, _)| vertex).collect()
        };
        let lowest = parts.iter().filter(|part| !part.twins.is_empty()).map(vertices).min_by(|a, b| {
            let low = |list: &Vec<u32>| list.iter().map(height).fold(f64::INFINITY, f64::min);
            low(a).total_cmp(&low(b))
        })?;
        // From the side: how far ahead, and how high.
        let side_view = |v: &u32| [along(self.mesh.vertices()[*v as usize]), height(v)];
        let leg: Vec<[f64; 2]> = lowest.iter().map(side_view).collect();
        // A leg may lean: heights are measured along its shin, and the foot is compared with where the shin meets the ground.
        let [ankle, calf] = [middle(&leg, 0.12, 0.2)?, middle(&leg, 0.24, 0.4)?];
        let (x, y) = (calf[0] - ankle[0], calf[1] - ankle[1]);
        let shin = [x / x.hypot(y), y / x.hypot(y)];
        let along_shin = |p: &[f64; 2]| {
            let [x, y] = [p[0] - ankle[0], p[1] - ankle[1]];
            [x * shin[1] - y * shin[0], x * shin[0] + y * shin[1]]
        };
        let leg: Vec<[f64; 2]> = leg.iter().map(along_shin).collect();
        let ahead = middle(&leg, 0.0, 0.08)?[0] / extent(&leg).1;
        (ahead.abs() > TOES_AHEAD).then_some(ahead.signum())
    }
}

/// The lowest height, and how far it is from there to the highest.
fn extent(side_view: &[[f64; 2]]) -> (f64, f64) {
    let heights = side_view.iter().map(|p| p[1]);
    let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
    (low, high - low)
}

/// The middle of what is between two heights, shares of the whole from its lowest point on.
fn middle(side_view: &[[f64; 2]], from: f64, to: f64) -> Option<[f64; 2]> {
    let (low, whole) = extent(side_view);
    let inside = |p: &&[f64; 2]| (low + from * whole..low + to * whole).contains(&p[1]);
    let (count, sum) = side_view
        .iter()
        .filter(inside)
        .fold((0.0, [0.0; 2]), |(count, [x, y]), p| (count + 1.0, [x + p[0], y + p[1]]));
    (count > 0.0).then(|| sum.map(|x| x / count))
}
