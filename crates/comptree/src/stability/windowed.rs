//! Eq. 5 with the derivative over a window of altitude: not in the paper, after the delta of MSER (Matas et
//! al. 2002).
use super::branches::{Branch, branches};
use super::levels::Levels;
use super::parameters::{AltitudeScale, StabilityParameters};
use super::region::{Candidate, Merge};

/// Instabilities that differ by less than this fraction tie: the width of a window is rounded.
const TIE: f64 = 1e-12;

/// The stability, over log altitude, of the sharpest corner of a solid without parts under the heat kernel. A region that
/// a merge ends must exceed it.
///
/// In each direction normal to a face the kernel is that of a half-line, (1 + exp(-x^2/t)) / sqrt(4 pi t) at a distance of
/// x. Along a line `s = x dl/dx = 2u / (e^u + 1)` with u = x^2/t, which is at most 0.557. In a corner of a plate two such
/// functions are multiplied and the volume grows with x^2, so it is a half of that, 0.279; in one of a cube a third. Voxels
/// and the window move it by a tenth.
const CORNER: f64 = 0.31;

/// The same of the end of a rod, which heat leaves in one direction only. A region without a border of its own must exceed
/// it: one that no merge ends, or that ends where it meets copies of itself, as one half of a cylinder meets the other.
///
/// 0.557 as for [`CORNER`]; up to 0.64 at windows of 0.3 where both ends of a short rod warm each other.
const ROD: f64 = 0.65;

/// The maximally stable nodes of every part, and its last node if a real merge ends it; how many of them have no border
/// of their own.
pub(super) fn maxima(
    levels: &Levels<'_>,
    parameters: &StabilityParameters,
    smallest: f64,
) -> (Vec<Candidate>, usize) {
    let (window, min_lifetime) = (parameters.window, parameters.min_lifetime());
    let must_be_sharp = parameters.sharp_borders && levels.scale == AltitudeScale::Log;
    let (mut candidates, mut blunt) = (Vec::new(), 0);
    let branches = branches(levels, smallest, min_lifetime);
    for branch in branches.into_iter().filter(|branch| branch.lasts(min_lifetime)) {
        let instability = instability(&branch, window);
        let least = least_in_window(&branch.levels, &instability, window);
        let tie = |a: f64, b: f64| (a - b).abs() <= TIE * a.max(b);
        let mut start = 0;
        for i in 0..instability.len() {
            if i + 1 < instability.len() && tie(instability[i], instability[i + 1]) {
                continue;
            }
            // A plateau, most often of one node, and its neighbours on the branch: where levels are
            // further apart than the window, there is still something to compare with.
            let plateau = std::mem::replace(&mut start, i + 1)..i + 1;
            let beside = plateau.start.saturating_sub(1)..(i + 2).min(instability.len());
            let least =
                plateau.map(|j| least[j]).chain(beside.map(|j| instability[j])).fold(f64::INFINITY, f64::min);
            let merge = branch.merge.filter(|_| i + 1 == instability.len());
            if merge.is_none() && instability[i] > least * (1.0 + TIE) {
                continue;
            }
            let stability = 1.0 / instability[i];
            // A whole component of the graph borders on nothing.
            let whole = i + 1 == instability.len() && merge.is_none();
            let own_border = merge.is_some_and(|merge| !merge.copies);
            let least = if own_border { CORNER } else { ROD };
            if must_be_sharp && !whole && stability < least {
                blunt += 1;
                continue;
            }
            let merge = merge
                .map(|merge| Merge { growth: merge.volume / branch.volumes[i], lifetime: branch.lifetime() });
            candidates.push(Candidate { node: branch.nodes[i], stability, merge });
        }
    }
    (candidates, blunt)
}

/// The stability of every node on a branch, NaN of the others.
pub(super) fn stability(levels: &Levels<'_>, parameters: &StabilityParameters, smallest: f64) -> Vec<f64> {
    let mut stability = vec![f64::NAN; levels.tree.len()];
    for branch in branches(levels, smallest, parameters.min_lifetime()) {
        for (&node, instability) in branch.nodes.iter().zip(instability(&branch, parameters.window)) {
            stability[node as usize] = 1.0 / instability;
        }
    }
    stability
}

/// `(d vol / d l) / vol` of each node, the derivative taken over the clipped window.
fn instability(branch: &Branch, window: f64) -> Vec<f64> {
    let Branch { levels, volumes, end, .. } = branch;
    let (mut below, mut above) = (0, 0);
    let change = |i: usize| {
        let low = (levels[i] - window).max(levels[0]);
        let high = (levels[i] + window).min(*end);
        // The component at a level is the last that is complete there.
        while below + 1 < levels.len() && levels[below + 1] <= low {
            below += 1;
        }
        while above + 1 < levels.len() && levels[above + 1] <= high {
            above += 1;
        }
        (volumes[above] - volumes[below]) / volumes[i] / (high - low).max(1e-12)
    };
    (0..levels.len()).map(change).map(|x| if x.is_nan() { 0.0 } else { x }).collect()
}

/// The least value among all nodes within the window of each, by a queue of rising values.
fn least_in_window(levels: &[f64], values: &[f64], window: f64) -> Vec<f64> {
    let mut queue: Vec<usize> = Vec::with_capacity(levels.len());
    let (mut front, mut next) = (0, 0);
    let least = |i: usize| {
        while next < levels.len() && levels[next] <= levels[i] + window {
            while queue.len() > front && queue.pop_if(|b| values[*b] >= values[next]).is_some() {}
            queue.push(next);
            next += 1;
        }
        while queue.get(front).is_some_and(|&f| levels[f] < levels[i] - window) {
            front += 1;
        }
        queue.get(front).map_or(values[i], |&f| values[f])
    };
    (0..levels.len()).map(least).collect()
}
