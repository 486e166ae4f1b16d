//! Smooth borders: diffusion-generated motion by mean curvature (Merriman, Bence and Osher 1992), for a short time.

use mser3d_shape::TriangleMesh;
use mser3d_shape::vector::{dot, sub};
use rayon::prelude::*;

use super::borders::{BodyLinks, Links};

/// Most steps on a mesh: where edges are far shorter than voxels, more would take long.
const MOST_STEPS: f64 = 60.0;

/// Shares that differ by less are equal: what they are sums of comes in another order on the other side of a symmetric shape.
const TIE: f64 = 1e-9;

/// The steps after which the diffusion on a grid has this standard deviation, in voxels: a step takes half of an element to
/// its neighbours, which has the variance 1/6 along each axis.
pub(super) fn steps_on_grid(deviation: f64) -> usize {
    (6.0 * deviation.powi(2)).round() as usize
}

/// Smooths borders along the surface of a mesh, by a standard deviation that is a length. Where its edges are longer, nothing
/// changes.
pub(super) fn smooth_vertices(labels: &mut [Option<u32>], parts: usize, mesh: &TriangleMesh, deviation: f64) {
    let edges = mesh.edge_graph();
    if edges.edge_count() == 0 || edges.len() != labels.len() {
        return;
    }
    let squared = |[u, v]: [u32; 2]| {
        let along = sub(mesh.vertices()[u as usize], mesh.vertices()[v as usize]);
        dot(along, along)
    };
    let mean = edges.edges().map(squared).sum::<f64>() / edges.edge_count() as f64;
    // On a surface, half of half a step's variance goes along each of two axes.
    let steps = (4.0 * deviation * deviation / mean).min(MOST_STEPS).round() as usize;
    let kept: Vec<u32> = (0u32..).zip(labels.iter()).filter_map(|(v, label)| label.map(|_| v)).collect();
    let mut own: Vec<u32> = labels.iter().flatten().copied().collect();
    let links = Links::of_mesh(mesh);
    smooth(&mut own, parts, &BodyLinks::new(&kept, &links, &[]), steps);
    kept.iter().zip(own).for_each(|(&v, part)| labels[v as usize] = Some(part));
}

/// As [`smooth`], with fewer steps where a part would lose half of its volume.
pub(super) fn smooth_with_care(labels: &mut Vec<u32>, parts: usize, body: &BodyLinks, mut steps: usize) {
    let volumes = |labels: &[u32]| {
        let mut volumes = vec![0.0; parts];
        labels.iter().zip(body.mass).for_each(|(&label, mass)| volumes[label as usize] += mass);
        volumes
    };
    let before = volumes(labels);
    while steps > 0 {
        let mut smoothed = labels.clone();
        smooth(&mut smoothed, parts, body, steps);
        if volumes(&smoothed).iter().zip(&before).all(|(after, before)| *after >= 0.5 * before) {
            *labels = smoothed;
            return;
        }
        steps /= 2;
    }
}

/// Diffuses the indicator function of each part for some steps, and gives each element to the part that has most of it then;
/// of several, to the one with the smallest number.
fn smooth(labels: &mut [u32], parts: usize, body: &BodyLinks, steps: usize) {
    if steps == 0 || parts < 2 {
        return;
    }
    let band = band(labels, body, steps);
    let border = |&v: &u32| body.around(v).fold(0.0, |total, (_, area)| total + area);
    let borders: Vec<f64> = band.iter().map(border).collect();
    // The place of each element of the band, and after them of what is around it, where nothing changes.
    let mut place = vec![u32::MAX; labels.len()];
    band.iter().zip(0..).for_each(|(&v, at)| place[v as usize] = at);
    let mut wider = band.clone();
    for &v in &band {
        body.around(v).for_each(|(to, _)| {
            if place[to as usize] == u32::MAX {
                place[to as usize] = wider.len() as u32;
                wider.push(to);
            }
        });
    }
    let share = |part: u32| -> Vec<f64> {
        let mut now: Vec<f64> =
            wider.iter().map(|&v| f64::from(u8::from(labels[v as usize] == part))).collect();
        let mut next = now.clone();
        for _ in 0..steps {
            for (at, (&v, &total)) in band.iter().zip(&borders).enumerate() {
                let sum =
                    body.around(v).fold(0.0, |sum, (to, area)| sum + area * now[place[to as usize] as usize]);
                let mean = if total > 0.0 { sum / total } else { now[at] };
                next[at] = 0.5 * (now[at] + mean);
            }
            std::mem::swap(&mut now, &mut next);
        }
        now.truncate(band.len());
        now
    };
    let shares: Vec<Vec<f64>> = (0..parts as u32).into_par_iter().map(share).collect();
    let mut best: Vec<(f64, u32)> = vec![(f64::NEG_INFINITY, 0); band.len()];
    for (part, shares) in (0..).zip(shares) {
        for (share, best) in shares.into_iter().zip(&mut best) {
            if share > best.0 + TIE {
                *best = (share, part);
            }
        }
    }
    band.iter().zip(best).for_each(|(&v, (_, part))| labels[v as usize] = part);
}

/// The elements within some steps from a border, ascending: farther away nothing changes in as many steps.
fn band(labels: &[u32], body: &BodyLinks, steps: usize) -> Vec<u32> {
    let mut known = vec![false; labels.len()];
    body.each(|from, to, _| known[from as usize] |= labels[from as usize] != labels[to as usize]);
    let mut band: Vec<u32> =
        (0u32..).zip(&known).filter_map(|(v, &at_border)| at_border.then_some(v)).collect();
    let mut from = 0;
    for _ in 0..steps {
        let to = band.len();
        for at in from..to {
            for (next, _) in body.around(band[at]) {
                if !std::mem::replace(&mut known[next as usize], true) {
                    band.push(next);
                }
            }
        }
        from = to;
    }
    band.sort_unstable();
    band
}
