//! Which of the header's statements places the voxels.
use super::header::Version;
use crate::Affine;
use crate::bytes::Fields;
use crate::error::Fault;

/// Where the voxels lie, and by which statement.
pub(super) struct Placed {
    pub affine: Affine,
    pub by: String,
    /// Whether x, y and z are right, anterior and superior.
    pub anatomical: bool,
}

/// The general affine map (sform), else rotation and offset (qform), else the spacing alone: methods 3, 2 and 1 of
/// the format.
pub(super) fn placed(
    fields: &Fields,
    version: Version,
    dims: [usize; 3],
    notes: &mut Vec<String>,
) -> Result<Placed, Fault> {
    let two = version == Version::Two;
    let number = |one: usize, other: usize, i: usize| {
        if two { fields.f64(other + 8 * i) } else { fields.f32(one + 4 * i) }
    };
    let code = |one: usize, other: usize| if two { fields.i32(other) } else { fields.i16(one) };
    let steps: [f64; 3] = std::array::from_fn(|axis| number(76, 104, axis + 1));
    let spacing = steps.map(usual);
    let (qform, sform) = match version {
        Version::Analyze => (0, 0),
        _ => (code(252, 344), code(254, 348)),
    };
    let unusable = |what: &str, e: &dyn std::fmt::Display| format!("the {what} is left out: it is {e}");
    let mut by_sform = None;
    if sform > 0 {
        let row = |i: usize| std::array::from_fn::<f64, 4, _>(|j| number(280, 400, 4 * i + j));
        match Affine::new([row(0), row(1), row(2)]) {
            Ok(affine) => by_sform = Some(affine),
            Err(error) => notes.push(unusable("sform", &error)),
        }
    }
    let mut by_qform = None;
    if qform > 0 {
        let quaternion = std::array::from_fn(|i| number(256, 352, i));
        let offset = std::array::from_fn(|i| number(268, 376, i));
        let flip = if number(76, 104, 0) < 0.0 { -1.0 } else { 1.0 };
        // The last component is worth no more than the precision of the others.
        let least = 3.0 * if two { f64::EPSILON } else { f64::from(f32::EPSILON) };
        match turned(quaternion, least, [spacing[0], spacing[1], flip * spacing[2]], offset) {
            Ok(affine) => by_qform = Some(affine),
            Err(error) => notes.push(unusable("qform", &error)),
        }
    }
    if let (Some(s), Some(q)) = (&by_sform, &by_qform) {
        let apart = furthest(s, q, dims);
        let voxel = s.spacing().into_iter().fold(f64::INFINITY, f64::min);
        if apart > 0.1 * voxel {
            notes.push(format!(
                "sform and qform disagree by up to {:.3} ({:.1} voxels); the sform is used",
                apart,
                apart / voxel
            ));
        }
    }
    if by_sform.is_none() && steps.iter().zip(&dims).any(|(h, &n)| n > 1 && !h.is_normal()) {
        notes.push(format!("pixdim is {steps:?}: voxels without a usable size were given the size 1"));
    }
    let anatomical = true;
    if let Some(affine) = by_sform {
        return Ok(Placed { affine, by: format!("sform ({})", meaning(sform)), anatomical });
    }
    if let Some(affine) = by_qform {
        return Ok(Placed { affine, by: format!("qform ({})", meaning(qform)), anatomical });
    }
    notes.push(
        match version {
            Version::Analyze => {
                "Analyze 7.5 does not say which way the axes run: left and right may be swapped"
            }
            _ => "neither sform nor qform: the file does not say which way the axes run",
        }
        .to_owned(),
    );
    let affine = Affine::along_axes([0.0; 3], spacing)?;
    Ok(Placed { affine, by: "pixdim alone, from the first voxel on".to_owned(), anatomical: false })
}

/// What a code says that the world is.
fn meaning(code: i64) -> String {
    match code {
        1 => "scanner".to_owned(),
        2 => "aligned to another scan".to_owned(),
        3 => "Talairach".to_owned(),
        4 => "MNI 152".to_owned(),
        5 => "other template".to_owned(),
        _ => format!("code {code}"),
    }
}

/// A length that may be left out, as that of the third axis of an image.
fn usual(length: f64) -> f64 {
    if length.is_normal() { length.abs() } else { 1.0 }
}

/// The map whose rotation is the unit quaternion (a, b, c, d), of which a is what is missing to length 1.
pub(super) fn turned(
    bcd: [f64; 3],
    least: f64,
    steps: [f64; 3],
    offset: [f64; 3],
) -> Result<Affine, mser3d_shape::ShapeError> {
    let squares: f64 = bcd.iter().map(|x| x * x).sum();
    let rest = 1.0 - squares;
    let a = if rest < least { 0.0 } else { rest.sqrt() };
    let [b, c, d] = bcd;
    let s = 2.0 / (a * a + squares);
    let columns = [
        [1.0 - s * (c * c + d * d), s * (b * c + a * d), s * (b * d - a * c)],
        [s * (b * c - a * d), 1.0 - s * (b * b + d * d), s * (c * d + a * b)],
        [s * (b * d + a * c), s * (c * d - a * b), 1.0 - s * (b * b + c * c)],
    ];
    Affine::from_steps(offset, std::array::from_fn(|i| columns[i].map(|x| x * steps[i])))
}

/// The quaternion's b, c and d of the nearest rotation to the axes' directions, and whether the last is flipped.
pub(super) fn quaternion(affine: &Affine) -> ([f64; 3], bool) {
    let flipped = affine.determinant() < 0.0;
    let [x, y, z] = affine.directions();
    let z = if flipped { z.map(|v| -v) } else { z };
    // Shepperd's method: the largest of the four components first, the others divided by it.
    let squares = [
        1.0 + x[0] + y[1] + z[2],
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
    ];
    let largest = (0..4).fold(0, |m, i| if squares[i] > squares[m] { i } else { m });
    let half = squares[largest].max(0.0).sqrt() / 2.0;
    let (wx, wy, wz) = (y[2] - z[1], z[0] - x[2], x[1] - y[0]);
    let (xy, xz, yz) = (x[1] + y[0], x[2] + z[0], y[2] + z[1]);
    let by = |v: f64| v / (4.0 * half);
    let [a, b, c, d] = match largest {
        0 => [half, by(wx), by(wy), by(wz)],
        1 => [by(wx), half, by(xy), by(xz)],
        2 => [by(wy), by(xy), half, by(yz)],
        _ => [by(wz), by(xz), by(yz), half],
    };
    let sign = if a < 0.0 { -1.0 } else { 1.0 };
    ([sign * b, sign * c, sign * d], flipped)
}

/// How far a voxel of one map is from the same voxel of the other, at most.
pub(super) fn furthest(one: &Affine, other: &Affine, dims: [usize; 3]) -> f64 {
    let corner = |c: usize| std::array::from_fn(|a| if c >> a & 1 == 1 { dims[a] as f64 - 1.0 } else { 0.0 });
    let apart = |c| {
        let (p, q) = (one.position(corner(c)), other.position(corner(c)));
        (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
    };
    (0..8).map(apart).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quaternions_give_back_every_right_turn_and_oblique_ones() {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (seed >> 40) as f64 / (1u64 << 24) as f64 - 0.5
        };
        for i in 0..400 {
            // Half of them turn by two right angles about something, where a is 0.
            let q: [f64; 4] = std::array::from_fn(|k| if k == 0 && i % 2 == 0 { 0.0 } else { random() });
            let q = if i < 20 { q.map(|x: f64| x.signum() * f64::from(x.abs() > 0.25)) } else { q };
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length == 0.0 {
                continue;
            }
            let sign = if q[0] < 0.0 { -1.0 } else { 1.0 };
            let bcd = [q[1], q[2], q[3]].map(|x| sign * x / length);
            for flip in [1.0, -1.0] {
                let affine = turned(bcd, 1e-12, [2.0, 3.0, 4.0 * flip], [5.0, 6.0, 7.0]).unwrap();
                let (found, flipped) = quaternion(&affine);
                assert_eq!(flipped, flip < 0.0);
                let again = turned(found, 1e-12, [2.0, 3.0, 4.0 * flip], [5.0, 6.0, 7.0]).unwrap();
                assert!(furthest(&affine, &again, [100; 3]) < 1e-4, "{affine:?} {again:?}");
            }
        }
    }
}
