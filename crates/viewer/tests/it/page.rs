//! Facts about the page's text; how it works in a browser is tested by `cargo xtask browser-test`.

use base64::Engine;
use mser3d_shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d_viewer::{
    PALETTE, PageData, PageGrey, PagePart, PageParts, PageRegion, PageShape, PageTree, RegionPair, Up,
    ViewerError, page,
};
use serde_json::Value;

fn tetrahedron() -> TriangleMesh {
    let corners = vec![[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    TriangleMesh::new(corners, vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]).unwrap()
}

fn grid() -> VoxelGrid {
    let frame = Frame::new([2, 1, 1], [0.0; 3], [0.5; 3]).unwrap();
    VoxelGrid::solid(frame, BitGrid::full([2, 1, 1]).unwrap()).unwrap()
}

fn region<'a>(vertices: &'a [u32], voxels: &'a [u32], volume: f64) -> PageRegion<'a> {
    PageRegion {
        colour: PALETTE[0].middle,
        parent: None,
        altitude: 0.5,
        stability: f64::INFINITY,
        reliability: None,
        lifetime: None,
        twin: None,
        side: None,
        volume,
        volume_fraction: 0.5,
        vertices,
        voxels,
        node: Some([0, 0]),
    }
}

fn parts() -> PageParts<'static> {
    let part = |region: Option<u32>, twins| PagePart {
        colour: PALETTE[1].middle,
        trunk: region.is_none(),
        region,
        twins,
        side: None,
        volume: 1.0,
        volume_fraction: 0.5,
    };
    let list = vec![part(None, vec![1]), part(Some(1), vec![0])];
    PageParts { list, vertices: &[0, 1, -1, 0], voxels: &[0, 1] }
}

fn tree() -> PageTree<'static> {
    PageTree {
        name: "t = 1".into(),
        superlevel: true,
        parents: &[1, u32::MAX],
        altitudes: &[2.0, 1.0],
        volumes: &[0.125, 0.25],
        entry: &[0, 1],
    }
}

fn shape<'a>(mesh: &'a TriangleMesh, grid: &'a VoxelGrid) -> PageShape<'a> {
    PageShape {
        name: "a </script><b>".into(),
        front: Some(-90.0),
        mesh,
        grid: Some(grid),
        vertex_voxel: &[0, 1, 0, -1],
        regions: vec![region(&[0, 1, 3], &[0, 1], 2.0), region(&[1], &[1], 1.0)],
        parts: Some(parts()),
        grey: Some(PageGrey { dims: [2, 1, 1], step: 1, values: vec![7, 250] }),
        trees: vec![tree()],
        facts: vec![["pitch".into(), "0.5".into()]],
    }
}

fn data<'a>(shapes: Vec<PageShape<'a>>) -> PageData<'a> {
    PageData { title: "x < y & z".into(), shapes, matches: vec![], part_matches: vec![], up: Up::Y }
}

/// The text between a mark and the next closing script tag.
fn script<'a>(html: &'a str, mark: &str) -> &'a str {
    let from = html.find(mark).unwrap() + mark.len();
    &html[from..from + html[from..].find("</script>").unwrap()]
}

#[test]
fn the_page_holds_its_data_and_asks_for_nothing_else() {
    let (mesh, grid) = (tetrahedron(), grid());
    let mut one = shape(&mesh, &grid);
    (one.regions[1].twin, one.regions[1].side) = (Some(0), Some(-0.5));
    let html = page(&data(vec![one])).unwrap();
    assert!(!html.contains("{{") && html.contains("<title>x &lt; y &amp; z</title>"));
    // The only addresses are the name of the SVG namespace and where words are explained.
    let known = ["-equiv", "://www.w3.org/2000/svg\"", "s://github.com/mser3d/mser3d/blob/main/\""];
    assert!(html.split("http").skip(1).all(|rest| known.iter().any(|known| rest.starts_with(known))));
    assert!(html.contains("default-src 'none'"));

    let head: Value = serde_json::from_str(script(&html, "id=\"head\">")).unwrap();
    let one = &head["shapes"][0];
    assert_eq!(one["name"], "a </script><b>");
    assert_eq!(one["closed"], true);
    assert_eq!(one["regions"][0]["stability"], Value::Null);
    let sides =
        |region: usize| (one["regions"][region]["twin"].clone(), one["regions"][region]["side"].clone());
    assert_eq!(sides(0), (Value::Null, Value::Null));
    assert_eq!(sides(1), (0.into(), (-0.5).into()));
    let bytes = base64::engine::general_purpose::STANDARD.decode(script(&html, "id=\"arrays\">")).unwrap();
    let labels = |part: &Value| -> Vec<i16> {
        let (start, length) =
            (part["start"].as_u64().unwrap() as usize, part["length"].as_u64().unwrap() as usize);
        bytes[start..start + 2 * length].chunks(2).map(|b| i16::from_le_bytes([b[0], b[1]])).collect()
    };
    // The innermost region counts.
    assert_eq!(labels(&one["label"]), [0, 1, -1, 0]);
    assert_eq!(labels(&one["grid"]["label"]), [0, 1]);
    assert_eq!((labels(&one["part"]), labels(&one["grid"]["part"])), (vec![0, 1, -1, 0], vec![0, 1]));
    let at = one["grey"]["values"]["start"].as_u64().unwrap() as usize;
    assert_eq!((&one["grey"]["dims"], &bytes[at..at + 2]), (&serde_json::json!([2, 1, 1]), &[7, 250][..]));
    let part = &one["parts"][0];
    assert_eq!((&part["vertices"], &part["voxels"], &part["trunk"]), (&2.into(), &1.into(), &true.into()));
    assert_eq!((&part["twins"], &one["parts"][1]["region"]), (&serde_json::json!([1]), &1.into()));
    assert_eq!(one["trees"][0]["parents"], serde_json::json!([0]));
}

/// The place of a heading in a page on GitHub: its words in small letters, with hyphens between them.
fn place(heading: &str) -> String {
    let kept = heading.trim().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
    kept.map(|c| if c == ' ' { '-' } else { c.to_ascii_lowercase() }).collect()
}

#[test]
fn words_are_explained_where_there_is_something_to_read() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    if !root.join("ARCHITECTURE.md").is_file() {
        println!("skipped: the documentation is not here");
        return;
    }
    let (mesh, grid) = (tetrahedron(), grid());
    let html = page(&data(vec![shape(&mesh, &grid)])).unwrap();
    let from = html.find("const WORDS = {").unwrap();
    let words = &html[from..from + html[from..].find("};").unwrap()];
    let targets = words.split('"').filter(|text| text.contains(".md"));
    let mut count = 0;
    for target in targets {
        let (file, heading) = target.split_once('#').map_or((target, None), |(f, h)| (f, Some(h)));
        let text = std::fs::read_to_string(root.join(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        let has = |wanted: &str| {
            text.lines()
                .filter_map(|l| l.strip_prefix('#'))
                .any(|l| place(l.trim_start_matches('#')) == wanted)
        };
        assert!(heading.is_none_or(has), "{target}");
        count += 1;
    }
    assert!(count >= 8, "{words}");
}

#[test]
fn the_same_data_give_the_same_bytes() {
    let (mesh, grid) = (tetrahedron(), grid());
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| page(&data(vec![shape(&mesh, &grid), shape(&mesh, &grid)])).unwrap())
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn data_that_do_not_fit_are_named() {
    let (mesh, grid) = (tetrahedron(), grid());
    let good = || shape(&mesh, &grid);
    let error = |shapes| page(&data(shapes)).unwrap_err().to_string();
    assert!(error(vec![]).starts_with("number of shapes on a page is 0"));

    let mut wrong = good();
    wrong.regions[1].vertices = &[1, 4];
    assert_eq!(error(vec![wrong]), "region 1 names vertex 4, but there are only 4 (numbered from 0)");
    let mut wrong = good();
    wrong.regions[0].twin = Some(2);
    assert_eq!(error(vec![wrong]), "region 0 names region 2, but there are only 2 (numbered from 0)");
    let mut wrong = good();
    wrong.grey = Some(PageGrey { dims: [2, 1, 1], step: 2, values: vec![7, 250] });
    assert!(error(vec![wrong]).starts_with("grey values along an axis: 2 given, 1 needed"));
    let mut wrong = good();
    wrong.grey.as_mut().unwrap().values = vec![];
    assert!(error(vec![wrong]).starts_with("grey values: 0 given, 2 needed"));
    let with_parts = |change: fn(&mut PageParts<'_>)| {
        let mut wrong = good();
        change(wrong.parts.as_mut().unwrap());
        error(vec![wrong])
    };
    let told = with_parts(|parts| parts.list[0].twins = vec![2]);
    assert_eq!(told, "part 0 names part 2, but there are only 2 (numbered from 0)");
    let told = with_parts(|parts| parts.list[1].region = Some(2));
    assert_eq!(told, "part 1 names region 2, but there are only 2 (numbered from 0)");
    let told = with_parts(|parts| parts.vertices = &[0, 1, 2, 0]);
    assert_eq!(told, "vertex 2 names part 2, but there are only 2 (numbered from 0)");
    assert!(with_parts(|parts| parts.voxels = &[0]).starts_with("parts of voxels: 1 given, 2 needed"));
    let mut wrong = good();
    wrong.trees[0].entry = &[0];
    assert!(error(vec![wrong]).starts_with("entry nodes of a tree: 1 given, 2 needed"));
    let mut wrong = good();
    wrong.trees[0].parents = &[u32::MAX, 0];
    assert!(error(vec![wrong]).starts_with("parent of a tree's node is 0 for node 1"));
    let mut wrong = good();
    wrong.vertex_voxel = &[0, 2, 0, -1];
    assert_eq!(error(vec![wrong]), "vertex 1 names voxel 2, but there are only 2 (numbered from 0)");
    let mut wrong = good();
    wrong.regions[0].node = Some([1, 0]);
    assert_eq!(error(vec![wrong]), "region 0 names tree 1, but there are only 1 (numbered from 0)");

    let matches = vec![RegionPair { first: 0, second: 2, distance: 0.1, mistake: false }];
    let pair = PageData { matches, ..data(vec![good(), good()]) };
    assert!(matches!(page(&pair), Err(ViewerError::OutOfRange { what: "match", index: 2, .. })));
    let part_matches = vec![RegionPair { first: 9, second: 0, distance: 0.1, mistake: false }];
    let pair = PageData { part_matches, ..data(vec![good(), good()]) };
    assert!(page(&pair).unwrap_err().to_string().starts_with("match 0 names part 9"));
    let wrong = PageShape { front: Some(f64::NAN), ..good() };
    assert!(error(vec![wrong]).contains("azimuth of a front"));
}

/// A sheet of n x n vertices in gentle waves.
fn sheet(n: u32) -> TriangleMesh {
    let at = |v: u32| {
        let [x, y] = [v % n, v / n].map(|i| f64::from(i) / f64::from(n));
        [x, y, 0.1 * (9.0 * x).sin() * (7.0 * y).cos()]
    };
    let cell = |i: u32, j: u32| {
        let v = j * n + i;
        [[v, v + 1, v + n], [v + 1, v + n + 1, v + n]]
    };
    let triangles = (0..n - 1).flat_map(|j| (0..n - 1).flat_map(move |i| cell(i, j))).collect();
    TriangleMesh::new((0..n * n).map(at).collect(), triangles).unwrap()
}

#[test]
fn pages_stay_small_and_say_what_they_leave_out() {
    let dims = [36; 3];
    let frame = Frame::new(dims, [0.0; 3], [1.0 / 36.0; 3]).unwrap();
    let grid = VoxelGrid::solid(frame, BitGrid::full(dims).unwrap()).unwrap();
    let voxels = grid.len() as u32;
    // A chain of nodes, each voxel in its own.
    let parents: Vec<u32> = (1..voxels).chain([u32::MAX]).collect();
    let altitudes: Vec<f64> = (0..voxels).map(|v| -f64::from(v)).collect();
    let volumes: Vec<f64> = (1..=voxels).map(f64::from).collect();
    let entry: Vec<u32> = (0..voxels).collect();
    for (n, thinned) in [(224, false), (708, true)] {
        let mesh = sheet(n);
        let vertices = n * n;
        let vertex_voxel: Vec<i32> = (0..vertices).map(|v| (v % voxels) as i32).collect();
        let rows: Vec<Vec<u32>> = (1..=30).map(|r| (0..vertices / 31 * r).collect()).collect();
        let cubes: Vec<Vec<u32>> = (1..=30).map(|r| (0..voxels / 31 * r).collect()).collect();
        let (none, all) = (vec![-1; vertices as usize], vec![0; voxels as usize]);
        let parts = PageParts { list: parts().list, vertices: &none, voxels: &all };
        let name = |t: u32| format!("t = {t}");
        let tree = |t| PageTree {
            name: name(t),
            superlevel: true,
            parents: &parents,
            altitudes: &altitudes,
            volumes: &volumes,
            entry: &entry,
        };
        let shape = PageShape {
            name: "sheet".into(),
            front: None,
            mesh: &mesh,
            grid: Some(&grid),
            vertex_voxel: &vertex_voxel,
            regions: rows.iter().zip(&cubes).map(|(r, c)| region(r, c, r.len() as f64)).collect(),
            parts: Some(parts),
            grey: None,
            trees: (0..4).map(tree).collect(),
            facts: vec![],
        };
        let html = page(&data(vec![shape])).unwrap();
        assert!(html.len() < 10_000_000, "{} bytes for {vertices} vertices", html.len());
        let head: Value = serde_json::from_str(script(&html, "id=\"head\">")).unwrap();
        let one = &head["shapes"][0];
        let drawn = one["position"]["length"].as_u64().unwrap() / 3;
        // Numbers are of all vertices, however many are drawn.
        assert_eq!(one["regions"][29]["vertices"], rows[29].len());
        assert_eq!(one["vertexVoxel"]["length"], drawn);
        if thinned {
            assert!((30_000..=60_000).contains(&drawn), "{drawn}");
            assert_eq!(one["facts"][0][1], format!("{drawn} of {vertices} vertices; numbers are of all"));
        } else {
            assert_eq!((drawn, one["facts"].as_array().unwrap().len()), (u64::from(vertices), 0));
        }
    }
}
