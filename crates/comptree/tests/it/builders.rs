//! All ways to build a tree give the same tree.
use super::common::{check_structure, components_by_threshold, components_of, facts_by_kruskal, facts_of};
use mser3d_comptree::{ComponentTree, GreyValue, Polarity, TreeError};
use mser3d_shape::{BitGrid, Connectivity, Frame, VoxelGrid};
use proptest::prelude::*;

const CONNECTIVITIES: [Connectivity; 2] = [Connectivity::Six, Connectivity::TwentySix];

/// The edges of a box by the definition of connectivity: by the distance of positions.
fn edges(dims: [usize; 3], connectivity: Connectivity) -> Vec<[u32; 2]> {
    let n = dims.iter().product::<usize>();
    let at = |v: usize| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]];
    let mut edges = Vec::new();
    for u in 0..n {
        for v in u + 1..n {
            let [a, b] = [at(u), at(v)];
            let apart: Vec<usize> = (0..3).map(|i| a[i].abs_diff(b[i])).collect();
            let (sum, most) = (apart.iter().sum::<usize>(), apart.iter().max().copied().unwrap_or(0));
            let linked = match connectivity {
                Connectivity::Six => sum == 1,
                Connectivity::TwentySix => most == 1,
            };
            if linked {
                edges.push([u as u32, v as u32]);
            }
        }
    }
    edges
}

fn polarity() -> impl Strategy<Value = Polarity> {
    prop_oneof![Just(Polarity::Sublevel), Just(Polarity::Superlevel)]
}

/// A box and a value for each voxel: few values, many values, or a smooth field.
fn field() -> impl Strategy<Value = ([usize; 3], Vec<f64>)> {
    (1usize..7, 1usize..6, 1usize..5).prop_flat_map(|(x, y, z)| {
        let n = x * y * z;
        let few = prop::collection::vec((0u8..4).prop_map(f64::from), n);
        let many = prop::collection::vec(-1e3f64..1e3, n);
        let smooth = (0.1f64..2.0, 0.1f64..2.0).prop_map(move |(a, b)| {
            (0..n).map(|i| (a * i as f64).sin() + (b * (i / x) as f64).cos()).collect()
        });
        (Just([x, y, z]), prop_oneof![few, many, smooth])
    })
}

proptest! {
    #[test]
    fn a_grid_is_its_graph((dims, values) in field(), polarity in polarity()) {
        // As a volume, and as an image: there six neighbours are four, and 26 are eight.
        let [x, y, z] = dims;
        let boxes = [dims, [x, y * z, 1]];
        for (dims, connectivity) in boxes.into_iter().flat_map(|dims| CONNECTIVITIES.map(|c| (dims, c))) {
            let edges = edges(dims, connectivity);
            let grid = ComponentTree::from_grid(dims, connectivity, &values, 1.0, polarity).unwrap();
            let graph = ComponentTree::from_vertex_weights(&edges, &values, 1.0, polarity).unwrap();
            prop_assert_eq!(&grid, &graph);
            check_structure(&grid);
            let enter = |a: f64, b: f64| if polarity == Polarity::Sublevel { a.max(b) } else { a.min(b) };
            let weighted: Vec<_> = edges.iter().map(|&e| (e, enter(values[e[0] as usize], values[e[1] as usize]))).collect();
            prop_assert_eq!(components_of(&grid), components_by_threshold(values.len(), Some(&values), &weighted, polarity));
        }
    }

    #[test]
    fn voxel_grids_follow_their_links(
        (dims, values) in field(),
        occupied in prop::collection::vec(any::<bool>(), 120),
        linked in prop::collection::vec(0u8..4, 360),
        polarity in polarity(),
    ) {
        let mut mask = BitGrid::empty(dims).unwrap();
        let positions = (0..values.len()).map(|v| [v % dims[0], v / dims[0] % dims[1], v / dims[0] / dims[1]].map(|c| c as u32));
        for (v, position) in positions.clone().enumerate() {
            mask.set(position, occupied[v % occupied.len()]);
        }
        let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
        let solid = VoxelGrid::solid(frame, mask.clone()).unwrap();
        let mut links = solid.links().clone();
        for (v, position) in positions.enumerate() {
            for axis in 0..3 {
                if linked[(3 * v + axis) % linked.len()] == 0 {
                    links[axis].set(position, false);
                }
            }
        }
        let cut: Vec<[u32; 2]> = solid.diagonal_pairs().filter(|[u, v]| (u + v) % 3 == 0).collect();
        let parted = VoxelGrid::new(frame, mask.clone(), links).unwrap().with_cut_diagonals(cut).unwrap();
        let values = &values[..solid.len()];
        for grid in [&solid, &parted] {
            for connectivity in CONNECTIVITIES {
                let implicit = ComponentTree::from_voxel_grid(grid, connectivity, values, 1.0, polarity).unwrap();
                let graph = grid.graph(connectivity).unwrap();
                let sum = |u: u32, v: u32| values[u as usize] + values[v as usize];
                let by_edge = ComponentTree::from_voxel_grid_edges(grid, connectivity, sum, 1.0, polarity).unwrap();
                let edges: Vec<[u32; 2]> = graph.edges().collect();
                let weights: Vec<f64> = edges.iter().map(|&[u, v]| sum(u, v)).collect();
                let listed = ComponentTree::from_edge_weights(grid.len(), &edges, &weights, 1.0, polarity).unwrap();
                prop_assert_eq!(by_edge, listed);
                prop_assert_eq!(&implicit, &ComponentTree::from_graph(&graph, values, 1.0, polarity).unwrap());
                if grid == &solid {
                    let masked = ComponentTree::from_mask(&mask, connectivity, values, 1.0, polarity).unwrap();
                    prop_assert_eq!(&implicit, &masked);
                }
            }
        }
    }

    #[test]
    fn a_vertex_tree_is_the_edge_tree_of_the_larger_end((dims, values) in field(), polarity in polarity()) {
        let edges = edges(dims, Connectivity::Six);
        let enter = |a: f64, b: f64| if polarity == Polarity::Sublevel { a.max(b) } else { a.min(b) };
        let weights: Vec<f64> = edges.iter().map(|&[u, v]| enter(values[u as usize], values[v as usize])).collect();
        let by_edge = ComponentTree::from_edge_weights(values.len(), &edges, &weights, 1.0, polarity).unwrap();
        let by_vertex = ComponentTree::from_vertex_weights(&edges, &values, 1.0, polarity).unwrap();
        // But for single vertices, which only a vertex tree has as nodes.
        let larger = |tree| components_of(tree).into_iter().filter(|c| c.0.len() > 1).collect::<Vec<_>>();
        prop_assert_eq!(larger(&by_edge), larger(&by_vertex));
    }

    #[test]
    fn the_type_of_grey_values_does_not_matter(values in prop::collection::vec(0u8..100, 60)) {
        fn of<V: GreyValue>(values: impl Iterator<Item = V>) -> ComponentTree {
            ComponentTree::from_grid([5, 4, 3], Connectivity::Six, &values.collect::<Vec<V>>(), 1.0, Polarity::Superlevel).unwrap()
        }
        let reference = of(values.iter().map(|&v| f64::from(v)));
        prop_assert_eq!(&reference, &of(values.iter().copied()));
        prop_assert_eq!(&reference, &of(values.iter().map(|&v| u16::from(v))));
        prop_assert_eq!(&reference, &of(values.iter().map(|&v| i16::from(v))));
        prop_assert_eq!(&reference, &of(values.iter().map(|&v| f32::from(v))));
    }
}

/// Large enough for several threads: white noise, smooth waves, grey values, and extreme ranges.
fn large_fields() -> Vec<Vec<f64>> {
    let n = 48 * 47 * 46usize;
    let mut state = 1u64;
    let mut noise = move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        state as f64 / u64::MAX as f64
    };
    let white: Vec<f64> = (0..n).map(|_| noise()).collect();
    let at = |v: usize| [v % 48, v / 48 % 47, v / 48 / 47].map(|c| c as f64);
    let smooth: Vec<f64> = (0..n).map(|v| at(v).map(|c| (c * 0.37).sin()).iter().sum()).collect();
    let grey = smooth.iter().map(|v| (v * 20.0).round()).collect();
    let skewed =
        white.iter().map(|v| (v * 600.0).exp() * if *v < 0.01 { f64::INFINITY } else { 1.0 }).collect();
    let close = white.iter().map(|v| if *v < 0.001 { 1e9 } else { 1.0 + v * 1e-13 }).collect();
    vec![white, smooth, grey, skewed, close]
}

#[test]
fn large_fields_agree_with_kruskals_algorithm() {
    let dims = [48, 47, 46];
    let frame = Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap();
    let solid = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
    let edges: Vec<[u32; 2]> = solid.graph(Connectivity::Six).unwrap().edges().collect();
    for values in large_fields() {
        let value = |v: u32| values[v as usize];
        let tree =
            ComponentTree::from_grid(dims, Connectivity::Six, &values, 1.0, Polarity::Sublevel).unwrap();
        let weights: Vec<f64> = edges.iter().map(|&[u, v]| value(u).max(value(v))).collect();
        assert!(facts_of(&tree) == facts_by_kruskal(values.len(), &edges, &weights));

        // Infinity from infinity is NaN.
        let difference = |u, v| if value(u) == value(v) { 0.0 } else { (value(u) - value(v)).abs() };
        let tree =
            ComponentTree::from_grid_edges(dims, Connectivity::Six, difference, 1.0, Polarity::Sublevel)
                .unwrap();
        let weights: Vec<f64> = edges.iter().map(|&[u, v]| difference(u, v)).collect();
        assert!(facts_of(&tree) == facts_by_kruskal(values.len(), &edges, &weights));
        let listed =
            ComponentTree::from_edge_weights(values.len(), &edges, &weights, 1.0, Polarity::Sublevel)
                .unwrap();
        assert!(tree == listed);
    }
}

#[test]
fn the_number_of_threads_does_not_matter() {
    let dims = [48, 47, 46];
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    for values in large_fields() {
        for connectivity in CONNECTIVITIES {
            let build =
                || ComponentTree::from_grid(dims, connectivity, &values, 1.0, Polarity::Superlevel).unwrap();
            let one = pool(1).install(build);
            assert!(one == pool(2).install(build) && one == pool(5).install(build));
            let product = |u: u32, v: u32| values[u as usize] + values[v as usize];
            let build = || {
                ComponentTree::from_grid_edges(dims, connectivity, product, 1.0, Polarity::Superlevel)
                    .unwrap()
            };
            let one = pool(1).install(build);
            assert!(one == pool(2).install(build) && one == pool(5).install(build));
        }
    }
}

#[test]
fn too_many_voxels_are_refused_before_anything_is_allocated() {
    let error = |dims| {
        ComponentTree::from_grid::<u8>(dims, Connectivity::Six, &[], 1.0, Polarity::Sublevel).unwrap_err()
    };
    assert!(matches!(error([2048, 1024, 1024]), TreeError::TooMany { count: 0x8000_0000, .. }));
    assert!(matches!(error([usize::MAX; 3]), TreeError::TooMany { .. }));
    assert!(matches!(error([4, 4, 4]), TreeError::SizeMismatch { found: 0, expected: 64, .. }));
}

#[test]
fn an_empty_mask_gives_the_empty_tree() {
    let mask = BitGrid::empty([4, 4, 4]).unwrap();
    let tree =
        ComponentTree::from_mask::<f64>(&mask, Connectivity::Six, &[], 1.0, Polarity::Sublevel).unwrap();
    assert!(tree.is_empty());
    let none =
        ComponentTree::from_grid::<u16>([0, 5, 5], Connectivity::Six, &[], 1.0, Polarity::Sublevel).unwrap();
    assert!(none.is_empty());
}

#[test]
fn a_nan_anywhere_is_found() {
    let weight = |u: u32, v: u32| if (u, v) == (3, 7) { f64::NAN } else { 1.0 };
    let error = ComponentTree::from_grid_edges([4, 4, 1], Connectivity::Six, weight, 1.0, Polarity::Sublevel);
    assert_eq!(error.unwrap_err().to_string().find("the weight of an edge of vertex 3 is NaN"), Some(0));
    let mut values = vec![0.0f32; 70 * 1000];
    values[69_123] = f32::NAN;
    let error =
        ComponentTree::from_grid([70, 1000, 1], Connectivity::TwentySix, &values, 1.0, Polarity::Superlevel);
    assert_eq!(error.unwrap_err(), TreeError::NotANumber { what: "vertex", index: 69_123 });
}

#[test]
fn one_voxel_is_one_node() {
    let vertex =
        ComponentTree::from_grid([1, 1, 1], Connectivity::Six, &[3u8], 2.0, Polarity::Sublevel).unwrap();
    assert_eq!((vertex.len(), vertex.altitude(0), vertex.volume(0)), (1, 3.0, 2.0));
    let never = |_, _| -> f64 { unreachable!("one voxel has no neighbours") };
    let edge =
        ComponentTree::from_grid_edges([1, 1, 1], Connectivity::TwentySix, never, 2.0, Polarity::Sublevel)
            .unwrap();
    assert_eq!((edge.len(), edge.altitude(0), edge.vertices(0)), (1, f64::NEG_INFINITY, &[0][..]));
}

#[test]
fn equal_values_are_one_node_for_each_part() {
    // Large enough for several threads; a wall without voxels parts the mask.
    let dims = [64, 64, 33];
    let mut mask = BitGrid::full(dims).unwrap();
    for (y, x) in (0..64).flat_map(|y| (0..64).map(move |x| (y, x))) {
        mask.set([x, y, 20], false);
    }
    let grid = VoxelGrid::solid(Frame::new(dims, [0.0; 3], [1.0; 3]).unwrap(), mask).unwrap();
    let values = vec![7.5f32; grid.len()];
    for connectivity in CONNECTIVITIES {
        let vertex =
            ComponentTree::from_voxel_grid(&grid, connectivity, &values, 1.0, Polarity::Superlevel).unwrap();
        let zero = |_, _| 0.0;
        let edge =
            ComponentTree::from_voxel_grid_edges(&grid, connectivity, zero, 1.0, Polarity::Sublevel).unwrap();
        for (tree, altitude) in [(vertex, 7.5), (edge, 0.0)] {
            let roots: Vec<(f64, f64)> = tree.roots().map(|r| (tree.altitude(r), tree.volume(r))).collect();
            assert_eq!(roots, [(altitude, 12.0 * 4096.0), (altitude, 20.0 * 4096.0)]);
            assert_eq!(tree.leaves().count(), tree.len());
        }
    }
}
