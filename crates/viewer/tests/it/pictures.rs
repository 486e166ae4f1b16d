//! Facts about whole pictures.

use mser3d_shape::{BitGrid, Frame, Subdivision, TriangleMesh, VoxelGrid};
use mser3d_viewer::{
    Background, Colours, Cut, Gallery, GalleryPicture, GalleryRow, Image, Model, NO_REGION, PALETTE, Panel,
    RenderOptions, Rgb, View, ViewerError, gallery, render,
};

/// The palette's colours without sides.
fn middles() -> [Rgb; 8] {
    PALETTE.map(|hue| hue.middle)
}

/// A torus around the y axis: radii 1 and 0.4.
fn torus() -> TriangleMesh {
    let (m, n) = (96u32, 48u32);
    let angle = |i: u32, of: u32| std::f64::consts::TAU * f64::from(i) / f64::from(of);
    let point = |i: u32, j: u32| {
        let r = 1.0 + 0.4 * angle(j, n).cos();
        [r * angle(i, m).sin(), 0.4 * angle(j, n).sin(), r * angle(i, m).cos()]
    };
    let points = (0..m * n).map(|v| point(v / n, v % n)).collect();
    let at = |i: u32, j: u32| i % m * n + j % n;
    let quads = (0..m * n).map(|v| (v / n, v % n)).flat_map(|(i, j)| {
        [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
    });
    TriangleMesh::new(points, quads.collect()).unwrap()
}

/// The torus as voxels.
fn torus_voxels() -> VoxelGrid {
    let frame = Frame::new([70, 20, 70], [-1.4, -0.4, -1.4], [0.04; 3]).unwrap();
    let mut inside = BitGrid::empty([70, 20, 70]).unwrap();
    for v in BitGrid::full([70, 20, 70]).unwrap().ones() {
        let [x, y, z] = frame.centre(v);
        inside.set(v, (x.hypot(z) - 1.0).hypot(y) < 0.4);
    }
    VoxelGrid::solid(frame, inside).unwrap()
}

fn plain() -> RenderOptions {
    RenderOptions { height: 300, lines: 0.0, occlusion: 0.0, ..RenderOptions::default() }
}

fn draw(model: &Model, view: View, options: &RenderOptions) -> Image {
    render(&[Panel { model, view, caption: String::new() }], options).unwrap()
}

/// Pixels that are nearer to this colour's hue than to any other of the given ones.
fn count(image: &Image, colour: Rgb, others: &[Rgb]) -> usize {
    let hue = |c: Rgb| {
        let [_, a, b] = c.oklab();
        [a, b]
    };
    let (wanted, others): (_, Vec<[f64; 2]>) = (hue(colour), others.iter().map(|o| hue(*o)).collect());
    let apart = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    let is = |p: &&Rgb| {
        let seen = hue(**p);
        others.iter().all(|o| apart(seen, wanted) < apart(seen, *o))
    };
    image.pixels().iter().filter(is).count()
}

/// Pixels per unit of length: the shape fills the height or a third of the width.
fn scale(image: &Image, options: &RenderOptions, width: f64) -> f64 {
    (image.width() as f64 - 2.0 * options.height as f64 * options.margin) / width
}

#[test]
fn a_shape_covers_the_area_of_its_projection() {
    let blue = PALETTE[5].middle;
    let model = Model::from_mesh(&torus(), Colours::Uniform(blue)).unwrap();
    let image = draw(&model, View::TOP, &plain());
    let covered = count(&image, blue, &[Rgb::WHITE]) as f64;
    let expected =
        std::f64::consts::PI * (1.4f64.powi(2) - 0.6f64.powi(2)) * scale(&image, &plain(), 2.8).powi(2);
    assert!((covered / expected - 1.0).abs() < 0.02, "{covered} {expected}");
}

#[test]
fn region_borders_divide_the_area_in_proportion() {
    let mesh = torus();
    let labels: Vec<i32> = mesh.vertices().iter().map(|p| if p[0] < 0.3 { 0 } else { -1 }).collect();
    let colours = [PALETTE[5].middle];
    let model = Model::from_mesh(&mesh, Colours::Regions { labels: &labels, colours: &colours }).unwrap();
    let image = draw(&model, View::TOP, &plain());
    let blue = count(&image, PALETTE[5].middle, &[Rgb::WHITE]) as f64 / scale(&image, &plain(), 2.8).powi(2);
    // Area of the ring left of x = 0.3, by the area of circular segments.
    let right = |r: f64| r * r * (0.3 / r).acos() - 0.3 * (r * r - 0.09).sqrt();
    let expected = std::f64::consts::PI * (1.96 - 0.36) - right(1.4) + right(0.6);
    assert!((blue / expected - 1.0).abs() < 0.03, "{blue} {expected}");
}

#[test]
fn a_section_shows_the_inside_and_only_it() {
    let (mesh, grid) = (torus(), torus_voxels());
    let (skin, flesh) = (PALETTE[5].middle, PALETTE[1].middle);
    let cut = Cut { normal: [0., 0., 1.], offset: 0.0 };
    let voxels = vec![flesh; grid.len()];
    let model = Model::from_section(&mesh, Colours::Uniform(skin), &grid, &voxels, &cut).unwrap();
    let image = draw(&model, View::FRONT, &plain());
    // Two discs of radius 0.4.
    let found = count(&image, flesh, &[Rgb::WHITE, skin]) as f64 / scale(&image, &plain(), 2.8).powi(2);
    assert!((found / (2.0 * std::f64::consts::PI * 0.16) - 1.0).abs() < 0.03, "{found}");
    // From behind, the cut is hidden.
    assert_eq!(count(&draw(&model, View::BACK, &plain()), flesh, &[Rgb::WHITE, skin]), 0);
}

#[test]
fn an_open_surface_is_filled_by_its_voxels() {
    let (mesh, grid) = (torus(), torus_voxels());
    let open = TriangleMesh::new(mesh.vertices().to_vec(), mesh.triangles()[20..].to_vec()).unwrap();
    let cut = Cut { normal: [0., 0., 1.], offset: 0.01 };
    let voxels = vec![PALETTE[1].middle; grid.len()];
    let model =
        Model::from_section(&open, Colours::Uniform(PALETTE[5].middle), &grid, &voxels, &cut).unwrap();
    let image = draw(&model, View::FRONT, &plain());
    let found = count(&image, PALETTE[1].middle, &[Rgb::WHITE, PALETTE[5].middle]) as f64;
    let expected = 2.0 * std::f64::consts::PI * 0.16 * scale(&image, &plain(), 2.8).powi(2);
    assert!((found / expected - 1.0).abs() < 0.08, "{found} {expected}");
}

#[test]
fn voxels_keep_their_own_colours() {
    let grid = torus_voxels();
    let colours: Vec<Rgb> =
        grid.voxels().map(|v| if v[0] < 35 { PALETTE[5].middle } else { PALETTE[1].middle }).collect();
    let model = Model::from_voxels(&grid, &colours, None).unwrap();
    let image = draw(&model, View::TOP, &plain());
    let [left, right] = [(5, 1), (1, 5)]
        .map(|(a, b)| count(&image, PALETTE[a].middle, &[Rgb::WHITE, PALETTE[b].middle]) as f64);
    assert!((left / right - 1.0).abs() < 0.01, "{left} {right}");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let mesh = torus();
    let heights: Vec<f64> = mesh.vertices().iter().map(|p| p[1]).collect();
    let colours = mser3d_viewer::sequential_colours(&heights);
    let sheet = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let model = Model::from_mesh(&mesh, Colours::Vertices(&colours)).unwrap();
            render(&Panel::around(&model), &RenderOptions { height: 200, ..Default::default() }).unwrap()
        })
    };
    assert_eq!(sheet(1), sheet(4));
}

#[test]
fn panels_share_one_scale_and_wrap_into_rows() {
    let mesh = torus();
    let half = mesh.with_vertices(mesh.vertices().iter().map(|p| p.map(|x| x / 2.0)).collect()).unwrap();
    let [big, small] =
        [&mesh, &half].map(|m| Model::from_mesh(m, Colours::Uniform(PALETTE[5].middle)).unwrap());
    let panels = [&big, &small].map(|model| Panel { model, view: View::TOP, caption: String::new() });
    let row = render(&panels, &plain()).unwrap();
    let column = render(&panels, &RenderOptions { columns: 1, ..plain() }).unwrap();
    let half_of = |image: &Image, left: bool| {
        let picked = image
            .pixels()
            .iter()
            .enumerate()
            .filter(|(i, p)| (i % image.width() < row.height()) == left && **p != Rgb::WHITE);
        picked.count() as f64
    };
    assert!((half_of(&row, true) / half_of(&row, false) - 4.0).abs() < 0.2);
    assert_eq!(column.height(), 2 * row.height());
}

#[test]
fn mistakes_are_named() {
    let mesh = torus();
    let error = |colours| Model::from_mesh(&mesh, colours).unwrap_err();
    assert!(matches!(error(Colours::Vertices(&[NO_REGION])), ViewerError::SizeMismatch { found: 1, .. }));
    let mut labels = vec![0; mesh.vertices().len()];
    labels[7] = 3;
    let text = error(Colours::Regions { labels: &labels, colours: &middles()[..3] }).to_string();
    assert_eq!(text, "vertex 7 names region 3, but there are only 3 (numbered from 0)");
    let empty = TriangleMesh::new(vec![[0.0; 3]], vec![]).unwrap();
    assert!(matches!(Model::from_mesh(&empty, Colours::Uniform(NO_REGION)), Err(ViewerError::Empty { .. })));
    let model = Model::from_mesh(&mesh, Colours::Uniform(NO_REGION)).unwrap();
    let wrong = RenderOptions { supersampling: 0, ..Default::default() };
    assert!(matches!(render(&Panel::around(&model), &wrong), Err(ViewerError::InvalidParameter(_))));
    assert!(matches!(render(&[], &Default::default()), Err(ViewerError::Empty { .. })));
    let nowhere = Cut { normal: [0.0; 3], offset: 0.0 };
    let grid = torus_voxels();
    let colours = vec![NO_REGION; grid.len()];
    assert!(matches!(
        Model::from_voxels(&grid, &colours, Some(&nowhere)),
        Err(ViewerError::InvalidParameter(_))
    ));
}

#[test]
fn a_flat_or_tiny_shape_is_drawn_without_trouble() {
    for size in [1e-300, 1.0, 1e150] {
        let corners = vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0]];
        let mesh = TriangleMesh::new(corners, vec![[0, 1, 2]]).unwrap();
        let model = Model::from_mesh(&mesh, Colours::Uniform(PALETTE[5].middle)).unwrap();
        let sheet = render(&Panel::around(&model), &plain()).unwrap();
        assert!(count(&sheet, PALETTE[5].middle, &[Rgb::WHITE]) > 1000, "{size}");
    }
    let point = TriangleMesh::new(vec![[2.0; 3]], vec![[0, 0, 0]]).unwrap();
    let model = Model::from_mesh(&point, Colours::Uniform(PALETTE[5].middle)).unwrap();
    let sheet = render(&Panel::around(&model), &plain()).unwrap();
    assert_eq!(count(&sheet, PALETTE[5].middle, &[Rgb::WHITE]), 0);
}

#[test]
fn colouring_anew_is_as_good_as_making_anew() {
    let torus = torus();
    let n = torus.vertices().len() as i32;
    let labels: Vec<i32> = (0..n).map(|v| if v < n / 3 { 1 } else { -1 }).collect();
    let options = RenderOptions { height: 100, ..RenderOptions::default() };
    let regions = Colours::Regions { labels: &labels, colours: &middles() };
    let made = Model::from_mesh(&torus, regions).unwrap();
    for colours in [Colours::Uniform(NO_REGION), Colours::Vertices(&vec![PALETTE[3].middle; n as usize])] {
        let anew = Model::from_mesh(&torus, colours).unwrap().with_regions(&labels, &middles()).unwrap();
        assert_eq!(draw(&anew, View::THREE_QUARTER, &options), draw(&made, View::THREE_QUARTER, &options));
    }
    assert!(matches!(made.with_regions(&labels[1..], &middles()), Err(ViewerError::SizeMismatch { .. })));
    assert!(matches!(made.with_regions(&labels, &middles()[..1]), Err(ViewerError::OutOfRange { .. })));
}

/// How many pixels differ by more than a shade.
fn different(a: &Image, b: &Image) -> usize {
    let far = |p: &Rgb, q: &Rgb| p.0.iter().zip(&q.0).any(|(p, q)| p.abs_diff(*q) > 8);
    a.pixels().iter().zip(b.pixels()).filter(|(p, q)| far(p, q)).count()
}

#[test]
fn a_divided_surface_looks_the_same_and_takes_regions_of_its_own() {
    let torus = torus();
    let options = RenderOptions { height: 200, ..RenderOptions::default() };
    let whole = Model::from_mesh(&torus, Colours::Uniform(NO_REGION)).unwrap();
    let fine = Subdivision::new(&torus, 0.02, usize::MAX).unwrap();
    let divided = whole.divided(&fine).unwrap();
    let [before, after] = [&whole, &divided].map(|model| draw(model, View::THREE_QUARTER, &options));
    assert!(different(&before, &after) < before.pixels().len() / 500);

    // A region between the vertices of the torus.
    let first = torus.vertices().len();
    let labels: Vec<i32> =
        (0..fine.mesh().vertices().len()).map(|v| if v < first { -1 } else { 0 }).collect();
    let red = middles()[0];
    let seen = draw(&divided.with_regions(&labels, &[red]).unwrap(), View::THREE_QUARTER, &options);
    assert!(different(&seen, &after) > before.pixels().len() / 20);

    let other = TriangleMesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]).unwrap();
    let other = Subdivision::new(&other, 0.02, usize::MAX).unwrap();
    assert!(matches!(whole.divided(&other), Err(ViewerError::SizeMismatch { .. })));
}

#[test]
fn a_smooth_border_is_shorter_than_a_jagged_one() {
    let torus = torus();
    // Half of the torus, the border a step to and fro from vertex to vertex.
    let label = |(v, p): (usize, &[f64; 3])| i32::from(p[0] > if v % 2 == 0 { 0.08 } else { -0.08 });
    let labels: Vec<i32> = torus.vertices().iter().enumerate().map(label).collect();
    let regions = Colours::Regions { labels: &labels, colours: &middles() };
    let rough = Model::from_mesh(&torus, regions).unwrap();
    let smooth = rough.clone().with_smooth_borders(0.15);
    let options =
        RenderOptions { height: 300, supersampling: 1, lines: 0.0, occlusion: 0.0, ..Default::default() };
    // How often neighbouring pixels are of different regions.
    let length = |model: &Model| {
        let image = draw(model, View::TOP, &options);
        let (first, second) = (middles()[0], middles()[1]);
        let nearer = |p: &Rgb| -> Option<bool> {
            let far = |q: Rgb| p.0.iter().zip(q.0).map(|(a, b)| u32::from(a.abs_diff(b))).sum::<u32>();
            (*p != Rgb::WHITE).then(|| far(first) < far(second))
        };
        let sides: Vec<Option<bool>> = image.pixels().iter().map(nearer).collect();
        let changes = |a: Option<bool>, b: Option<bool>| a.is_some() && b.is_some() && a != b;
        let width = image.width();
        (0..sides.len() - width).filter(|&i| changes(sides[i], sides[i + width])).count()
    };
    // The straight border runs up and down the picture: seen along columns, it hardly changes.
    assert!(length(&rough) > 40, "{}", length(&rough));
    assert!(length(&smooth) < length(&rough) / 3, "{} of {}", length(&smooth), length(&rough));
}

#[test]
fn on_a_dark_ground_letters_are_light_and_axes_have_room() {
    let model = Model::from_mesh(&torus(), Colours::Uniform(NO_REGION)).unwrap();
    let panel = Panel { model: &model, view: View::FRONT, caption: "front".into() };
    let white = RenderOptions { height: 120, ..RenderOptions::default() };
    let dark = RenderOptions { background: Background::Dark, ..white.clone() };
    let axes = RenderOptions { axes: true, ..dark.clone() };
    let [on_white, on_dark, with_axes] =
        [white, dark, axes].map(|options| render(std::slice::from_ref(&panel), &options).unwrap());
    let light = |image: &Image| {
        let bottom = image.width() * (image.height() - 15);
        let luminance = |p: &Rgb| p.0.iter().map(|c| u32::from(*c)).sum::<u32>() / 3;
        let least = image.pixels()[bottom..].iter().map(luminance).min().unwrap();
        (least, image.pixels()[bottom..].iter().map(luminance).max().unwrap())
    };
    assert_eq!(light(&on_white).1, 255);
    assert!(light(&on_white).0 < 120);
    assert!(light(&on_dark).0 < 40 && light(&on_dark).1 > 120, "{:?}", light(&on_dark));
    assert!(with_axes.width() > on_dark.width() + 60);
}

#[test]
fn a_gallery_holds_its_pictures_and_nothing_else() {
    let picture = |label: &str| GalleryPicture {
        image: Image::new(61, 40, PALETTE[2].middle).unwrap(),
        label: label.into(),
        numbers: "a < b".into(),
    };
    let rows = vec![
        GalleryRow { subject: picture("x"), others: vec![picture("\"{{rows}}\""), picture("z")] },
        GalleryRow { subject: picture("y"), others: vec![] },
    ];
    let html = gallery(&Gallery { title: "<b>".into(), lead: "{{title}}".into(), rows }).unwrap();
    assert_eq!(html.matches("<img src=\"data:image/png;base64,").count(), 4);
    assert_eq!(html.matches("width=\"31\" height=\"20\"").count(), 4);
    assert!(
        html.contains("<h1>&lt;b&gt;</h1>\n<p>{{title}}</p>")
            && html.contains("alt=\"&quot;{{rows}}&quot;\"")
    );
    assert!(html.contains("a &lt; b") && !html.contains("<script") && !html.contains("http:"));
}

#[test]
fn a_region_has_its_number_where_it_has_room() {
    let torus = torus();
    let labels: Vec<i32> = (0..96 * 48).map(|v| i32::from(v / 48 >= 48)).collect();
    let model = |texts: [&str; 2]| {
        let colours = [PALETTE[0].middle, PALETTE[5].middle];
        let model =
            Model::from_mesh(&torus, Colours::Regions { labels: &labels, colours: &colours }).unwrap();
        model.with_labels(texts.map(str::to_owned).into())
    };
    let draw = |model: &Model| {
        let panel = Panel { model, view: View::TOP, caption: String::new() };
        render(&[panel], &RenderOptions { height: 200, ..Default::default() }).unwrap()
    };
    let plain = draw(&model(["", ""]));
    let changed = |texts| {
        let numbered = draw(&model(texts));
        let pairs = plain.pixels().iter().zip(numbered.pixels()).enumerate();
        pairs.filter(|(_, (a, b))| a != b).map(|(at, _)| at % plain.width()).collect::<Vec<usize>>()
    };
    // The first half of the torus is at +x, right in the picture.
    let (right, left) = (changed(["7", ""]), changed(["", "7"]));
    assert!(right.len() > 30 && right.iter().all(|x| *x > plain.width() / 2), "{right:?}");
    assert!(left.len() > 30 && left.iter().all(|x| *x < plain.width() / 2), "{left:?}");
    assert!(changed(["a text that is far too long for a region", ""]).is_empty());
}
