//! The problems: bodies at several sizes, a mesh's surface, and solids whose spectra are hard to find
//! completely.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::laplace::{Operator, cotangent_laplacian, grid_laplacian};
use mser3d::shape::{BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d::voxelize::{Pitch, VoxelizeParameters, voxelize};

use crate::comparisons::refine::refined;
use crate::solved::mesh;

/// A problem.
#[derive(Clone)]
pub struct Case {
    pub name: String,
    pub shape: Shape,
    pub eigenpairs: usize,
    pub tolerance: f64,
}

/// Where the operator comes from.
#[derive(Clone)]
pub enum Shape {
    /// The solid inside a mesh file, with about so many voxels.
    Body(PathBuf, usize),
    /// The surface of a mesh file, refined to so many vertices.
    Surface(PathBuf, usize),
    /// A solid given by its voxels: dimensions and inside test.
    Solid([usize; 3], fn([f64; 3]) -> bool),
}

/// What is handed to a solver.
pub enum Problem {
    Grid(Box<VoxelGrid>),
    Mesh(TriangleMesh),
}

impl Case {
    /// Voxels or vertices, about.
    pub fn size(&self) -> usize {
        match &self.shape {
            Shape::Body(_, size) | Shape::Surface(_, size) => *size,
            Shape::Solid(dims, _) => dims.iter().product(),
        }
    }

    /// Whether this is about completeness rather than speed.
    pub fn is_for_completeness(&self) -> bool {
        matches!(self.shape, Shape::Solid(..))
    }

    /// Makes the problem; the same on every call.
    pub fn problem(&self) -> Result<Problem, Box<dyn Error>> {
        Ok(match &self.shape {
            Shape::Body(path, voxels) => {
                let parameters = VoxelizeParameters { pitch: Pitch::Voxels(*voxels), ..Default::default() };
                Problem::Grid(Box::new(voxelize(&mesh(path)?, &parameters)?.grid))
            }
            Shape::Surface(path, vertices) => Problem::Mesh(refined(&mesh(path)?, *vertices)?),
            Shape::Solid(dims, inside) => {
                let frame = Frame::new(*dims, [0.0; 3], [1.0; 3])?;
                let mut bits = BitGrid::empty(*dims)?;
                for voxel in BitGrid::full(*dims)?.ones() {
                    bits.set(voxel, inside(frame.centre(voxel)));
                }
                Problem::Grid(Box::new(VoxelGrid::solid(frame, bits)?))
            }
        })
    }
}

impl Problem {
    /// The operator of the problem.
    pub fn operator(&self) -> Result<Operator, Box<dyn Error>> {
        Ok(match self {
            Self::Grid(grid) => grid_laplacian(grid),
            Self::Mesh(mesh) => cotangent_laplacian(mesh)?,
        })
    }
}

/// All cases; those on other people's data only where it is there.
pub fn cases() -> Vec<Case> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let human = root.join("fixtures/human_rest.off");
    let makehuman = root.join("../shared/data/makehuman/00_rest.off");
    let figures = [("human", human), ("makehuman", makehuman)];
    let figures = figures.iter().filter(|(_, path)| path.exists());

    let mut cases = Vec::new();
    for (name, path) in figures {
        let mut add = |size: &str, shape: &dyn Fn(PathBuf) -> Shape, eigenpairs: usize, tolerance| {
            let name = format!("{name}-{size}-k{eigenpairs}");
            cases.push(Case { name, shape: shape(path.clone()), eigenpairs, tolerance });
        };
        add("45K", &|path| Shape::Body(path, 45_000), 100, 1e-9);
        add("45K", &|path| Shape::Body(path, 45_000), 200, 1e-9);
        add("surface-31K", &|path| Shape::Surface(path, 31_000), 100, 1e-8);
        add("surface-31K", &|path| Shape::Surface(path, 31_000), 200, 1e-8);
        add("350K", &|path| Shape::Body(path, 350_000), 100, 1e-9);
        add("1M", &|path| Shape::Body(path, 1_000_000), 100, 1e-8);
        add("10M", &|path| Shape::Body(path, 10_000_000), 50, 1e-6);
    }
    cases.extend(hard_solids());
    cases
}

/// Cases that differ in one size only, to see how the cost grows with it.
pub struct Series {
    /// What grows.
    pub size: &'static str,
    pub title: String,
    pub cases: Vec<(usize, Case)>,
}

/// The human of `fixtures/` at several resolutions, and with several numbers of eigenpairs.
pub fn series() -> Vec<Series> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../fixtures/human_rest.off");
    let body = |voxels, eigenpairs| Case {
        name: format!("growth-body-{voxels}-k{eigenpairs}"),
        shape: Shape::Body(path.clone(), voxels),
        eigenpairs,
        tolerance: 1e-9,
    };
    let surface = |vertices, eigenpairs| Case {
        name: format!("growth-surface-{vertices}-k{eigenpairs}"),
        shape: Shape::Surface(path.clone(), vertices),
        eigenpairs,
        tolerance: 1e-8,
    };
    let voxels = [11_000, 22_000, 45_000, 90_000, 180_000, 360_000, 720_000];
    let vertices = [8_000, 16_000, 32_000, 64_000, 128_000];
    let pairs = [25, 50, 100, 200, 400];
    vec![
        Series {
            size: "voxels",
            title: "A solid, k = 100, residual 1e-9".into(),
            cases: voxels.map(|n| (n, body(n, 100))).into(),
        },
        Series {
            size: "k",
            title: "A solid of 45 thousand voxels, residual 1e-9".into(),
            cases: pairs.map(|k| (k, body(45_000, k))).into(),
        },
        Series {
            size: "vertices",
            title: "A surface, k = 100, residual 1e-8".into(),
            cases: vertices.map(|n| (n, surface(n, 100))).into(),
        },
        Series {
            size: "k",
            title: "A surface of 32 thousand vertices, residual 1e-8".into(),
            cases: pairs.map(|k| (k, surface(32_000, k))).into(),
        },
    ]
}

fn hard_solids() -> impl Iterator<Item = Case> {
    fn in_ball([x, y, z]: [f64; 3], centre: [f64; 3], radius: f64) -> bool {
        (x - centre[0]).powi(2) + (y - centre[1]).powi(2) + (z - centre[2]).powi(2) <= radius * radius
    }
    let solids: [(&str, [usize; 3], fn([f64; 3]) -> bool); 6] = [
        ("ball", [40; 3], |c| in_ball(c, [20.0; 3], 20.0)),
        ("cube", [30; 3], |_| true),
        ("plate", [120, 110, 2], |_| true),
        ("rod", [4, 1800, 4], |_| true),
        // Odd diameters, so that the single middle voxel between the two is a neck of one voxel.
        ("two-balls", [63, 31, 31], |c| {
            in_ball(c, [15.5; 3], 15.5)
                || in_ball(c, [47.5, 15.5, 15.5], 15.5)
                || in_ball(c, [31.5, 15.5, 15.5], 0.6)
        }),
        ("three-parts", [80, 30, 30], |c| {
            let in_box = (31.0..51.0).contains(&c[0]) && c[1] < 25.0;
            let in_rod = c[0] > 60.0 && c[0] < 70.0 && c[1] < 10.0;
            in_ball(c, [15.0; 3], 15.0) || in_box || in_rod
        }),
    ];
    solids.into_iter().map(|(name, dims, inside)| Case {
        name: name.into(),
        shape: Shape::Solid(dims, inside),
        eigenpairs: 100,
        tolerance: 1e-9,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hard_solids_have_the_parts_they_are_named_for() {
        let parts = |name: &str| {
            let case = hard_solids().find(|case| case.name == name).unwrap();
            match case.problem().unwrap() {
                Problem::Grid(grid) => (grid.component_count(), grid),
                Problem::Mesh(_) => unreachable!(),
            }
        };
        assert_eq!(parts("three-parts").0, 3);
        let (count, balls) = parts("two-balls");
        assert_eq!(count, 1);
        let neck = balls.voxels().filter(|v| v[0] == 31).count();
        assert_eq!(neck, 1);
    }
}
