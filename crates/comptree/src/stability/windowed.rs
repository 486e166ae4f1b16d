//! Eq. 5 with the derivative over a window of altitude: not in the paper, after the delta of MSER (Matas et
//! al. 2002).
use std::collections::VecDeque;

use super::branches::{self, Branch};
use super::levels::Levels;
use super::region::Candidate;

/// Instabilities that differ by less than this fraction tie: the width of a window is rounded.
const TIE: f64 = 1e-12;

/// The maximally stable nodes of every branch whose top has the volume `smallest`, and the last node
/// before each real merge.
pub(super) fn maxima(levels: &Levels<'_>, window: f64, smallest: f64) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    branches::for_each(levels, smallest, |branch| {
        let instability = instability(branch, window);
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
            if merge.is_some() || instability[i] <= least * (1.0 + TIE) {
                candidates.push(Candidate { node: branch.nodes[i], stability: 1.0 / instability[i], merge });
            }
        }
    });
    candidates
}

/// The stability of every node on a branch, NaN of the others.
pub(super) fn stability(levels: &Levels<'_>, window: f64, smallest: f64) -> Vec<f64> {
    let mut stability = vec![f64::NAN; levels.tree.len()];
    branches::for_each(levels, smallest, |branch| {
        for (&node, instability) in branch.nodes.iter().zip(instability(branch, window)) {
            stability[node as usize] = 1.0 / instability;
        }
    });
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
    let mut queue: VecDeque<usize> = VecDeque::new();
    let mut next = 0;
    let least = |i: usize| {
        while next < levels.len() && levels[next] <= levels[i] + window {
            while queue.back().is_some_and(|&b| values[b] >= values[next]) {
                queue.pop_back();
            }
            queue.push_back(next);
            next += 1;
        }
        while queue.front().is_some_and(|&f| levels[f] < levels[i] - window) {
            queue.pop_front();
        }
        queue.front().map_or(values[i], |&f| values[f])
    };
    (0..levels.len()).map(least).collect()
}
