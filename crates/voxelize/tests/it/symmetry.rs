//! Quarter turns and mirror images of a mesh give the turned or mirrored solid, exactly.

use crate::common::*;
use mser3d_shape::{TriangleMesh, VoxelGrid};
use mser3d_voxelize::*;

/// Coordinate a of the image is coordinate `from[a]` of the original times `sign[a]`.
#[derive(Clone, Copy, Debug)]
struct Swap {
    from: [usize; 3],
    sign: [f64; 3],
}

/// All 48: 24 turns and 24 mirror images.
fn swaps() -> impl Iterator<Item = Swap> {
    let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
    orders.into_iter().flat_map(|from| {
        (0..8).map(move |s| Swap {
            from,
            sign: std::array::from_fn(|a| if s >> a & 1 == 1 { -1.0 } else { 1.0 }),
        })
    })
}

impl Swap {
    /// The image; its triangles are turned over where it is mirrored, as a modeller would.
    fn apply(&self, mesh: &TriangleMesh) -> TriangleMesh {
        let image = moved(mesh, |p| std::array::from_fn(|a| self.sign[a] * p[self.from[a]]));
        let odd = (0..3).any(|a| self.from[a] == a) && self.from != [0, 1, 2];
        let mirrored = (self.sign.iter().product::<f64>() < 0.0) != odd;
        if mirrored { inside_out(&image) } else { image }
    }

    fn voxel(&self, voxel: [u32; 3], dims: [usize; 3]) -> [u32; 3] {
        std::array::from_fn(|a| {
            let (i, n) = (voxel[self.from[a]], dims[self.from[a]] as u32);
            if self.sign[a] < 0.0 { n - 1 - i } else { i }
        })
    }

    /// Fails unless the second solid is the image of the first, voxel by voxel and link by link.
    fn check(&self, original: &VoxelGrid, image: &VoxelGrid, name: &str) {
        let dims = original.frame().dims();
        assert_eq!(image.frame().dims(), self.from.map(|a| dims[a]), "{name} {self:?}");
        assert_eq!(original.len(), image.len(), "{name} {self:?}");
        let links = |grid: &VoxelGrid| grid.links().each_ref().map(|l| l.count_ones());
        assert_eq!(links(image), self.from.map(|a| links(original)[a]), "{name} {self:?}");
        for voxel in original.voxels() {
            let there = self.voxel(voxel, dims);
            assert!(image.occupancy().get(there), "{name} {self:?}: {voxel:?}");
            for a in 0..3 {
                let mut next = voxel;
                next[self.from[a]] += 1;
                if next[self.from[a]] as usize == dims[self.from[a]] {
                    continue;
                }
                let lower = if self.sign[a] < 0.0 { self.voxel(next, dims) } else { there };
                let linked = original.links()[self.from[a]].get(voxel);
                assert_eq!(image.links()[a].get(lower), linked, "{name} {self:?}: {voxel:?} along {a}");
            }
        }
    }
}

fn all_images_agree(name: &str, mesh: &TriangleMesh, parameters: &VoxelizeParameters) -> Voxelization {
    images_agree(name, mesh, parameters, 1)
}

/// Every n-th image.
fn images_agree(name: &str, mesh: &TriangleMesh, parameters: &VoxelizeParameters, n: usize) -> Voxelization {
    let original = voxelize(mesh, parameters).unwrap();
    for swap in swaps().step_by(n) {
        swap.check(&original.grid, &voxelize(&swap.apply(mesh), parameters).unwrap().grid, name);
    }
    original
}

fn pitched(pitch: Pitch) -> VoxelizeParameters {
    VoxelizeParameters { pitch, largest_only: false, ..Default::default() }
}

/// A figure whose hand touches its thigh, far from the origin: links are cut.
#[test]
fn a_figure_in_contact_with_itself() {
    let mesh = fixture("human_touch.off");
    for (pitch, shift) in [(Pitch::Voxels(9_000), 0.0), (Pitch::Size(0.023), 12.34)] {
        let mesh = moved(&mesh, |p| p.map(|x| x + shift));
        assert!(all_images_agree("touch", &mesh, &pitched(pitch)).cut_links > 0);
    }
}

/// Holes of all sizes: the winding number decides there, and no rounding may.
#[test]
fn open_meshes() {
    let figure = fixture("human_press.off");
    let top = figure.bounding_box().unwrap().max[1];
    let beheaded = altered(&figure, |_, t| {
        t.iter().all(|&v| figure.vertices()[v as usize][1] < 0.83 * top).then_some(t)
    });
    let mut random = Random(3);
    let holed = altered(&figure, |_, t| (random.next() > 0.03).then_some(t));
    // Half of it, and full of holes: winding numbers are fractions all over.
    let torn = altered(&figure, |_, t| {
        (figure.vertices()[t[0] as usize][2] < 0.02 && random.next() > 0.2).then_some(t)
    });
    let bowl = altered(&sphere([0.1, 0.2, -0.3], 1.0, 4), |i, t| (i > 300).then_some(t));
    for (name, mesh) in [("beheaded", &beheaded), ("holed", &holed), ("torn", &torn), ("bowl", &bowl)] {
        let solid = images_agree(name, mesh, &pitched(Pitch::Voxels(4_000)), 5);
        assert!(matches!(solid.reason, Reason::Open { .. }) && solid.ambiguous_voxels > 0);
    }
}

/// Flat sides and slopes of 45 degrees, on grids whose pitch divides their size.
#[test]
fn boxes_and_octahedra() {
    let octahedron = sphere([1.0, 2.0, 3.0], 1.0, 0);
    let block = cuboid([0.1, 0.2, 0.3], [1.1, 1.7, 0.7]);
    // An L of two boxes as one outline: its inner sides are flat too.
    let outline = [[0., 0.], [6., 0.], [6., 2.], [2., 2.], [2., 5.], [0., 5.]];
    for pitch in [Pitch::Resolution(24), Pitch::Resolution(25), Pitch::Voxels(5_000), Pitch::Size(0.1)] {
        for (name, mesh) in [("octahedron", &octahedron), ("box", &block)] {
            all_images_agree(name, mesh, &pitched(pitch));
        }
        all_images_agree("L", &prism(&outline, 1.0), &pitched(pitch));
    }
}

/// Thin bodies along the axes have their volume, at least to 3 %, or a warning says by how much they do not; so
/// do their images.
#[test]
fn plates_sheets_and_tubes() {
    let angle = |t: f64| [[0., 0.], [1., 0.], [1., t], [t, t], [t, 1.], [0., 1.]];
    let plates = |d: f64| cuboid([0.3, 0.1, 0.2], [1.3, 1.1, 0.2 + d]);
    // A box without its inner part, open at neither end.
    let tube = |d: f64| {
        let inner = inside_out(&cuboid([d, d, d], [0.3 - d, 0.4 - d, 2.0 - d]));
        together(&[cuboid([0.0; 3], [0.3, 0.4, 2.0]), inner])
    };
    let bump =
        |d: f64| together(&[cuboid([0.0; 3], [1.0, 1.0, d]), cuboid([0.4, 0.4, 0.0], [0.6, 0.6, 0.15])]);
    let mut shapes: Vec<(String, TriangleMesh, f64)> = Vec::new();
    for d in [0.011, 0.012, 0.014, 0.016, 0.02, 0.023, 0.03, 0.037] {
        shapes.push((format!("plate {d}"), plates(d), d));
        shapes.push((format!("angle {d}"), prism(&angle(d), 0.8), 0.8 * (2.0 * d - d * d)));
        shapes.push((
            format!("tube {d}"),
            tube(d),
            0.24 - (0.3 - 2.0 * d) * (0.4 - 2.0 * d) * (2.0 - 2.0 * d),
        ));
        shapes.push((format!("bump {d}"), bump(d), d + 0.04 * (0.15 - d)));
    }
    for (name, mesh, volume) in &shapes {
        for pitch in [Pitch::Voxels(45_000), Pitch::Voxels(20_000), Pitch::Resolution(100)] {
            let solid = voxelize(mesh, &pitched(pitch)).unwrap();
            let error = solid.grid.volume() / volume - 1.0;
            let fitted = solid.grid.frame().spacing();
            eprintln!("{name} {pitch:?}: {:+.2} %, {} voxels of {fitted:?}", 100.0 * error, solid.grid.len());
            let said = solid.warnings.iter().any(|w| matches!(w, Warning::Volume { .. }));
            assert!(error.abs() < 0.03 || said, "{name} {pitch:?}: {error}");
            if pitch == Pitch::Voxels(45_000) {
                assert!(error.abs() < 0.03, "{name}: {error}");
                assert!(
                    (solid.grid.len() as f64 / 45_000.0 - 1.0).abs() < 0.4,
                    "{name}: {}",
                    solid.grid.len()
                );
            }
            let cubes = fitted.iter().all(|h| *h == fitted[0]);
            assert_eq!(cubes, !solid.warnings.contains(&Warning::Fitted { spacing: fitted }));
        }
    }
    for (name, mesh, _) in [&shapes[17], &shapes[18], &shapes[19], &shapes[20]] {
        images_agree(name, mesh, &pitched(Pitch::Voxels(20_000)), 7);
    }
    // A pitch that is given stays, and the volume is said to be wrong.
    let solid = voxelize(&plates(0.02), &pitched(Pitch::Size(0.0076))).unwrap();
    assert_eq!(solid.grid.frame().spacing(), [0.0076; 3]);
    let Some(Warning::Volume { voxels, mesh, .. }) = solid.warnings.first() else { panic!() };
    assert!(
        (mesh - 0.02).abs() < 1e-12 && (voxels - solid.grid.volume()).abs() < 1e-12 && voxels / mesh > 1.1
    );
}

/// A prism over a polygon that is star-shaped about its first corner.
fn prism(outline: &[[f64; 2]], height: f64) -> TriangleMesh {
    let n = outline.len() as u32;
    let vertices = [0.0, height].iter().flat_map(|&z| outline.iter().map(move |p| [p[0], p[1], z])).collect();
    let mut triangles = Vec::new();
    for i in 0..n {
        let (a, b) = (i, (i + 1) % n);
        triangles.extend([[a, b, b + n], [a, b + n, a + n]]);
        if (1..n - 1).contains(&i) {
            triangles.extend([[0, b, a], [n, a + n, b + n]]);
        }
    }
    TriangleMesh::new(vertices, triangles).unwrap()
}

/// The surface of a mask, as faces of its voxels: at the mask's own pitch it is the mask again.
#[test]
fn stairs_of_voxels() {
    let inside = |[x, y, z]: [i32; 3]| {
        let [x, y, z] = [x, y, z].map(|i| f64::from(i) - 4.7);
        x * x + 1.7 * y * y + z * z + x * y < 19.0
    };
    let cells = || (0..11).flat_map(|z| (0..11).flat_map(move |y| (0..11).map(move |x| [x, y, z])));
    let mut faces = Vec::new();
    for cell in cells().filter(|&c| inside(c)) {
        for axis in 0..3 {
            for side in [0, 1] {
                let mut next = cell;
                next[axis] += 2 * side - 1;
                if inside(next) {
                    continue;
                }
                let corner = |du: i32, dv: i32| {
                    let mut p = cell;
                    p[axis] += side;
                    p[(axis + 1) % 3] += du;
                    p[(axis + 2) % 3] += dv;
                    p.map(|x| 0.1 * f64::from(x))
                };
                let mut face = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                if side == 0 {
                    face.reverse();
                }
                faces.push(face);
            }
        }
    }
    let triangles =
        (0..faces.len() as u32).flat_map(|f| [[4 * f, 4 * f + 1, 4 * f + 2], [4 * f, 4 * f + 2, 4 * f + 3]]);
    let mesh = TriangleMesh::new(faces.concat(), triangles.collect()).unwrap();
    let solid = all_images_agree("stairs", &mesh, &pitched(Pitch::Size(0.1)));
    assert_eq!(solid.grid.len(), cells().filter(|&c| inside(c)).count());
    for pitch in [Pitch::Size(0.05), Pitch::Voxels(3_000)] {
        all_images_agree("stairs", &mesh, &pitched(pitch));
    }
}

/// Real shapes, closed and open, when they are there.
#[test]
fn real_bodies() {
    for name in [
        "makehuman/06_kick.off",
        "odedstein/spot_low_resolution.obj",
        "odedstein/fish.obj",
        "people/man_rest.off",
    ] {
        let Some(mesh) = shared(&format!("data/{name}")) else { continue };
        let solid = all_images_agree(name, &mesh, &pitched(Pitch::Voxels(20_000)));
        eprintln!(
            "{name}: {} voxels, {:?}, {} ambiguous",
            solid.grid.len(),
            solid.reason,
            solid.ambiguous_voxels
        );
    }
}
