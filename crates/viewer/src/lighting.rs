//! Light on a matte surface: a key light, a fill light and a sky.

/// What is seen at a sample.
pub(crate) struct Surface {
    /// Linear light that the surface reflects.
    pub colour: [f32; 3],
    /// In the camera's frame: picture right, up, towards the viewer.
    pub normal: [f64; 3],
    /// Share of the sky that reaches it.
    pub openness: f32,
}

/// Towards the key light, upper left before the shape.
const KEY: [f32; 3] = [-0.424, 0.566, 0.707];
/// Towards the fill light, right before the shape.
const FILL: [f32; 3] = [0.811, 0.162, 0.562];

/// The light a surface sends to the viewer. The weights are set so that a face towards the viewer in
/// the open shows about its own colour: pictures match their legends.
pub(crate) fn light(surface: &Surface, occlusion: f32) -> [f32; 3] {
    let n = surface.normal.map(|x| x as f32);
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt().max(1e-12);
    // The far side of a surface (inside an open mesh or a cut) is lit like the near side, dimmer.
    let back = n[2] < 0.0;
    let sign = if back { -1.0 / length } else { 1.0 / length };
    let n = n.map(|x| x * sign);
    let dot = |d: [f32; 3]| n[0] * d[0] + n[1] * d[1] + n[2] * d[2];
    let open = 1.0 - occlusion * (1.0 - if back { 0.5 } else { surface.openness });
    // Half-Lambert wraps the light around the form, so that no side falls flat.
    let wrap = |d: [f32; 3]| {
        let h = 0.5 + 0.5 * dot(d);
        h * h
    };
    let sky = 0.5 + 0.5 * n[1];
    let diffuse = 0.62 * wrap(KEY) * (0.4 + 0.6 * open)
        + 0.22 * wrap(FILL) * (0.4 + 0.6 * open)
        + (0.20 + 0.16 * sky) * open * open;
    // A broad faint highlight (Blinn-Phong) tells curved from flat.
    let half = [-0.230, 0.306, 0.924];
    let gloss = 0.05 * dot(half).max(0.0).powi(24) * open;
    surface.colour.map(|c| c * diffuse * if back { 0.6 } else { 1.0 } + gloss)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seen(normal: [f64; 3], openness: f32) -> f32 {
        light(&Surface { colour: [0.5; 3], normal, openness }, 1.0)[0]
    }

    #[test]
    fn a_face_towards_the_viewer_shows_about_its_colour() {
        assert!((seen([0., 0., 1.], 1.0) - 0.5).abs() < 0.06, "{}", seen([0., 0., 1.], 1.0));
    }

    #[test]
    fn light_comes_from_above_left_and_folds_are_dark() {
        assert!(seen([-0.5, 0.5, 0.7], 1.0) > seen([0.5, -0.5, 0.7], 1.0));
        assert!(seen([0., 0., 1.], 0.2) < 0.7 * seen([0., 0., 1.], 1.0));
    }
}
