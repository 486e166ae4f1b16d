//! Which branches are parts: bumps, nearly simultaneous merges, and parts that meet copies of themselves.
use mser3d_comptree::{ComponentTree, Polarity, StabilityParameters, stable_regions};

/// Arms that meet in a hub, vertex 0, at a weight of `exp(-level)`: each arm is a chain of vertices whose levels rise
/// from a start to its meeting level.
fn star(arms: &[(usize, f64, f64)]) -> ComponentTree {
    let (mut edges, mut levels) =
        (Vec::new(), vec![arms.iter().map(|a| a.2).fold(f64::NEG_INFINITY, f64::max)]);
    for &(length, start, end) in arms {
        for i in 0..length {
            let inner = if i + 1 == length { 0 } else { levels.len() as u32 + 1 };
            edges.push([levels.len() as u32, inner]);
            levels.push(start + (end - start) * (i as f64 / length as f64).powi(4));
        }
    }
    let weights: Vec<f64> = levels.iter().map(|level| (-level).exp()).collect();
    ComponentTree::from_vertex_weights(&edges, &weights, 1.0, Polarity::Superlevel).unwrap()
}

fn found(tree: &ComponentTree, min_lifetime: Option<f64>) -> Vec<(f64, Option<(f64, f64)>)> {
    let parameters = StabilityParameters { min_lifetime, ..Default::default() };
    let regions = stable_regions(tree, &parameters).unwrap().regions;
    let round = |x: f64| (x * 1e3).round() / 1e3;
    let ends: Vec<_> = regions.iter().filter(|r| r.merge.is_some()).collect();
    ends.iter().map(|r| (r.volume, r.merge.map(|m| (round(m.growth), round(m.lifetime))))).collect()
}

#[test]
fn arms_that_join_nearly_at_once_are_one_merge() {
    // Two arms meet 0.01 before a third one joins them: in which order is an accident. The union of two is no region, and
    // each arm is as large a part of the whole as it would be if all three met at once.
    let mut chain = star(&[(40, 0.0, 2.0), (50, 0.0, 2.0)]);
    assert_eq!(found(&chain, None).len(), 2);
    // A tree over a path: two arms around a pass at 2, and then a third one behind a pass at 2.01.
    let arm = |length: usize| (0..length).map(move |i| 2.0 * (i as f64 / length as f64).powi(4));
    let mut levels: Vec<f64> = arm(40).collect();
    levels.push(2.0);
    levels.extend(arm(60).collect::<Vec<_>>().into_iter().rev());
    levels.push(2.01);
    levels.extend(arm(50));
    let n = levels.len();
    let edges: Vec<[u32; 2]> = (1..n as u32).map(|v| [v - 1, v]).collect();
    // The middle arm is open on both sides: its vertices fall and rise again.
    let weights: Vec<f64> = levels.iter().map(|level| (-level).exp()).collect();
    chain = ComponentTree::from_vertex_weights(&edges, &weights, 1.0, Polarity::Superlevel).unwrap();
    let joined = found(&chain, None);
    let volumes: Vec<f64> = joined.iter().map(|r| r.0).collect();
    assert_eq!(volumes, [60.0, 50.0, 40.0]);
    for (volume, merge) in joined {
        assert_eq!(merge.map(|m| m.0), Some((1e3 * n as f64 / volume).round() / 1e3));
    }
    // Without a minimum the union of the first two is a region too.
    let all: Vec<f64> = found(&chain, Some(0.0)).iter().map(|r| r.0).collect();
    assert!(all.contains(&101.0), "{all:?}");
}

#[test]
fn a_bump_does_not_end_the_part_that_it_sits_on() {
    // A leg with a bump of 5 vertices that lasts 0.05, and a body of another size: the leg ends at the body.
    let mut levels: Vec<f64> = (0..30).map(|i| f64::from(i) * 0.03).collect();
    levels.extend([0.95, 0.90, 0.90, 0.90, 0.90, 0.90]);
    levels.extend((0..10).map(|i| 0.95 + f64::from(i) * 0.02));
    let leg = levels.len();
    levels.push(2.0);
    levels.extend((0..120).map(|i| 1.9 - f64::from(i) * 0.01));
    let edges: Vec<[u32; 2]> = (1..levels.len() as u32).map(|v| [v - 1, v]).collect();
    let weights: Vec<f64> = levels.iter().map(|level| (-level).exp()).collect();
    let tree = ComponentTree::from_vertex_weights(&edges, &weights, 1.0, Polarity::Superlevel).unwrap();
    let ends: Vec<f64> = found(&tree, None).iter().map(|r| r.0).collect();
    assert_eq!(ends, [120.0, leg as f64]);
    let cut: Vec<f64> = found(&tree, Some(0.0)).iter().map(|r| r.0).collect();
    assert!(cut.contains(&30.0) && cut.contains(&(leg as f64)), "{cut:?}");
}

#[test]
fn copies_of_a_part_need_a_sharper_border() {
    // An arm whose volume grows evenly up to the merge: stability 30 / (30 * 0.3 / 0.75) * 0.3 / 0.3 = 0.75 at the end
    // for a rise of 0.75 in all, and less for a smaller one.
    let arms = |rise: f64, other: f64| {
        let arm = |length: f64| (0..length as usize).map(move |i| rise * i as f64 / length);
        let mut levels: Vec<f64> = arm(300.0).collect();
        levels.push(rise);
        levels.extend(arm(other).collect::<Vec<_>>().into_iter().rev());
        let edges: Vec<[u32; 2]> = (1..levels.len() as u32).map(|v| [v - 1, v]).collect();
        let weights: Vec<f64> = levels.iter().map(|level| (-level).exp()).collect();
        let tree = ComponentTree::from_vertex_weights(&edges, &weights, 1.0, Polarity::Superlevel).unwrap();
        found(&tree, None).len()
    };
    // Stability is the rise here, as the relative change over the window of 0.3 is 0.3 / rise.
    assert_eq!((arms(0.7, 300.0), arms(0.6, 300.0)), (2, 0));
    assert_eq!((arms(0.6, 200.0), arms(0.15, 200.0)), (2, 0));
}
