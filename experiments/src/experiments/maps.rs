//! `cargo xtask maps`: how far a map between two shapes, made from matched regions, leads from the true place.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use mser3d::Parameters;
use mser3d::descriptors::{
    DenseMapParameters, MapPoints, MapShape, MatchParameters, dense_map, match_regions,
};
use mser3d::shape::{Graph, TriangleMesh};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::VoxelizeParameters;
use mser3d::{Described, Region};
use mser3d_meshio::write_off;
use rayon::prelude::*;

use crate::comparisons::python::{Python, PythonArguments, answer};
use crate::pose_sets::{PoseSet, SetArguments};
use crate::solved::Solved;

/// What `cargo xtask maps` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    #[command(flatten)]
    python: PythonArguments,
    /// Where maps.md is written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// Vertices of each shape whose error is measured.
const MEASURED: usize = 500;

/// What makes a map.
const METHODS: [&str; 3] = ["places among the regions", "with eigenfunctions (`--write map`)", "pyFM"];

/// A shape with its regions.
struct Found {
    regions: Vec<Region>,
    described: Described,
}

/// Errors of all pairs of a set, by method.
#[derive(Default)]
struct Errors {
    of_pairs: Vec<Vec<f64>>,
    /// The mean of each pair, on that side of the body where it is less; none where the symmetry is not known.
    either: Vec<f64>,
}

/// Measures all sets, and writes the page.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let python = Python::find(&arguments.python, &[&["numpy"], &["pyfmaps"]])?;
    let version = python.probe("functional_map.py")["pyFM"].as_str().map(str::to_owned);
    if version.is_none() {
        eprintln!("pyFM is not here; --install gets it");
    }
    let mut rows = String::new();
    for set in arguments.sets.read()? {
        eprintln!("{}", set.name);
        let pairs: Vec<[usize; 2]> = (1..set.poses.len()).flat_map(|pose| [[0, pose], [pose, 0]]).collect();
        let mut errors: [Errors; METHODS.len()] = Default::default();
        let shapes: Vec<Surface> = set.poses.iter().map(|(_, mesh)| Surface::new(mesh)).collect();
        let maps = ours(&set, arguments.sets.voxels, &pairs)?;
        for (&[to, _], maps) in pairs.iter().zip(&maps) {
            for (errors, map) in errors.iter_mut().zip(maps) {
                errors.add(&shapes[to], map, set.null.mirror());
            }
        }
        if version.is_some() {
            for (&[to, _], map) in pairs.iter().zip(of_pyfm(&python, &set, &pairs)?) {
                errors[2].add(&shapes[to], &map, set.null.mirror());
            }
        }
        for (method, errors) in METHODS.iter().zip(&errors) {
            if !errors.of_pairs.is_empty() {
                errors.write(&mut rows, &set.name, method)?;
            }
        }
    }
    let text = page(arguments.sets.voxels, version.as_deref(), &rows);
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("maps.md"), &text)?;
    print!("{text}");
    Ok(())
}

/// Maps of the vertices of the second of each pair to the first, without and with the rounds of eigenfunctions.
fn ours(
    set: &PoseSet,
    voxels: usize,
    pairs: &[[usize; 2]],
) -> Result<Vec<[Vec<Option<u32>>; 2]>, Box<dyn Error>> {
    let solved = set.solve(voxels, &VoxelizeParameters::default(), &SpectrumParameters::default())?;
    let parameters =
        Parameters { reference_measure: set.reference_measure(&solved), ..Parameters::default() };
    let find = |solved: &Solved| -> Result<Found, Box<dyn Error>> {
        let regions = solved.regions(&parameters)?;
        let described = solved.describe(&regions, &parameters)?;
        Ok(Found { regions, described })
    };
    let found = solved.iter().map(find).collect::<Result<Vec<_>, _>>()?;
    let points: Vec<MapPoints> = solved
        .iter()
        .zip(&set.poses)
        .map(|(solved, (_, mesh))| MapPoints::new(solved.shape().element_of_vertex(), &mesh.vertex_areas()))
        .collect();
    let elements: Vec<Vec<Vec<u32>>> =
        found.iter().map(|f| f.regions.iter().map(|region| region.elements.clone()).collect()).collect();
    let shape = |i: usize| MapShape {
        basis: solved[i].basis(),
        regions: &elements[i],
        points: &points[i].elements,
        weights: &points[i].weights,
    };
    let map = |&[to, from]: &[usize; 2]| -> Result<[Vec<Option<u32>>; 2], Box<dyn Error>> {
        let side = |i: usize| (&found[i].described.descriptors, &found[i].described.sides.cosines);
        let matches = match_regions(side(from), side(to), &MatchParameters::default())?;
        let matched: Vec<[usize; 2]> = matches.iter().map(|m| [m.partner.reference, m.query]).collect();
        let finer = DenseMapParameters::default();
        let coarse = DenseMapParameters { rounds: Vec::new(), signatures: 0.0, ..finer.clone() };
        let map = |parameters: &DenseMapParameters| -> Result<Vec<Option<u32>>, Box<dyn Error>> {
            let map = dense_map(&shape(to), &shape(from), &matched, parameters)?;
            Ok(points[from].vertices(&map, &points[to]))
        };
        Ok([map(&coarse)?, map(&finer)?])
    };
    pairs.iter().map(map).collect()
}

/// The same by functional maps between the surfaces.
fn of_pyfm(
    python: &Python,
    set: &PoseSet,
    pairs: &[[usize; 2]],
) -> Result<Vec<Vec<Option<u32>>>, Box<dyn Error>> {
    let folder = python.folder.join("maps");
    std::fs::create_dir_all(&folder)?;
    let mut command = python.script("functional_map.py");
    let output = folder.join("maps.i32");
    command.arg(&output);
    for (number, (_, mesh)) in set.poses.iter().enumerate() {
        let path = folder.join(format!("{number}.off"));
        write_off(&path, mesh)?;
        command.arg(path);
    }
    answer(&mut command)?;
    let vertices = set.null.mesh().vertices().len();
    let bytes = std::fs::read(&output)?;
    let numbers: Vec<Option<u32>> =
        bytes.as_chunks::<4>().0.iter().map(|&b| u32::try_from(i32::from_le_bytes(b)).ok()).collect();
    if numbers.len() != pairs.len() * vertices {
        return Err("functional_map.py wrote another number of vertices".into());
    }
    Ok(numbers.chunks_exact(vertices).map(<[_]>::to_vec).collect())
}

/// A mesh on which ways are measured along edges.
struct Surface {
    edges: Graph,
    positions: Vec<[f64; 3]>,
    /// The root of the area.
    unit: f64,
}

impl Surface {
    fn new(mesh: &TriangleMesh) -> Self {
        Self { edges: mesh.edge_graph(), positions: mesh.vertices().to_vec(), unit: mesh.area().sqrt() }
    }

    /// How far some vertices of another pose are mapped from their place, over the root of the area. What no edges lead to, and
    /// what has no map, counts as 1.
    fn errors(&self, map: &[Option<u32>], place: impl Fn(u32) -> u32 + Sync) -> Vec<f64> {
        let step = self.positions.len().div_ceil(MEASURED).max(1);
        let vertices: Vec<usize> = (0..self.positions.len()).step_by(step).collect();
        let error = |&vertex: &usize| {
            let found = map.get(vertex).copied().flatten()?;
            let way = self.way(place(vertex as u32), found)? / self.unit;
            Some(way.min(1.0))
        };
        vertices.par_iter().map(|vertex| error(vertex).unwrap_or(1.0)).collect()
    }

    /// The length of the shortest way along edges, by Dijkstra's algorithm.
    fn way(&self, from: u32, to: u32) -> Option<f64> {
        // Distances are not negative, so their bits sort as they do.
        let mut queue = BinaryHeap::from([Reverse((0u64, from))]);
        let mut reached = vec![f64::INFINITY; self.positions.len()];
        reached[from as usize] = 0.0;
        while let Some(Reverse((bits, at))) = queue.pop() {
            let way = f64::from_bits(bits);
            if at == to {
                return Some(way);
            }
            if way > reached[at as usize] {
                continue;
            }
            for &next in self.edges.neighbours(at) {
                let [p, q] = [at, next].map(|v| self.positions[v as usize]);
                let longer = way + (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt();
                if longer < reached[next as usize] {
                    reached[next as usize] = longer;
                    queue.push(Reverse((longer.to_bits(), next)));
                }
            }
        }
        None
    }
}

impl Errors {
    fn add(&mut self, surface: &Surface, map: &[Option<u32>], symmetry: Option<&[u32]>) {
        let errors = surface.errors(map, |vertex| vertex);
        if let Some(mirror) = symmetry {
            let mirrored = surface.errors(map, |vertex| mirror[vertex as usize]);
            self.either.push(mean(&errors).min(mean(&mirrored)));
        }
        self.of_pairs.push(errors);
    }

    fn write(&self, rows: &mut String, set: &str, method: &str) -> std::fmt::Result {
        let means: Vec<f64> = self.of_pairs.iter().map(|e| mean(e)).collect();
        let either =
            if self.either.is_empty() { "-".to_owned() } else { format!("{:.4}", mean(&self.either)) };
        let worst = means.iter().copied().fold(0.0, f64::max);
        let below = |limit: f64| {
            let share = |e: &Vec<f64>| e.iter().filter(|x| **x < limit).count() as f64 / e.len() as f64;
            self.of_pairs.iter().map(share).sum::<f64>() / self.of_pairs.len() as f64
        };
        writeln!(
            rows,
            "| {set} | {} | {method} | {:.4} | {worst:.4} | {:.3} | {:.3} | {either} |",
            means.len(),
            mean(&means),
            below(0.05),
            below(0.1)
        )
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn page(voxels: usize, pyfm: Option<&str>, rows: &str) -> String {
    let pyfm = match pyfm {
        Some(version) => format!(
            "* *pyFM* ({version}): a functional map between the surfaces, from wave kernel signatures and 30\n  \
             eigenfunctions, and ZoomOut to 100. It knows neither regions nor sides.\n"
        ),
        None => "* pyFM was not there; `cargo xtask maps --install` adds it.\n".to_owned(),
    };
    format!(
        "# Maps from vertex to vertex

Made by `cargo xtask maps` on {voxels} voxels. The regions of the first shape of each set and of every other one are matched as
`mser3d match` does it, and each vertex is mapped to a vertex of the other shape, both ways. The error is how far that is from the true
vertex, along the edges of the mesh (which are longer than the shortest way on the surface) and over the root of its area, of about
{MEASURED} vertices of each pair. A vertex without a map counts as 1. *Worst pair* is the largest of the pairs' means.
*Either side*: the mean error where left and right may be exchanged, of each whole pair, where the symmetry is known.

* *{}*: the nearest in the cosines between the heat of a vertex and that of the regions.
* *{}*: the same, made finer by eigenfunctions (`descriptors::dense_map`).
{pyfm}
| set | pairs | method | mean error | worst pair | below 0.05 | below 0.1 | either side |
|---|---|---|---|---|---|---|---|
{rows}",
        METHODS[0], METHODS[1]
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_ways_along_edges_over_the_root_of_the_area() {
        // A square of area 4, and a triangle apart from it that has no area.
        let mut vertices = vec![[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.]];
        vertices.push([9., 9., 9.]);
        let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let surface = Surface::new(&mesh);
        let map = [Some(0), Some(3), None, Some(4), Some(4)];
        let errors = surface.errors(&map, |vertex| vertex);
        // From 1 to 3 it is twice an edge of 2, which is more than 1 over the root of 4; so is what cannot be reached.
        assert_eq!(errors, [0.0, 1.0, 1.0, 1.0, 0.0]);
        assert_eq!(surface.way(1, 3), Some(4.0));
        assert_eq!(surface.way(1, 2), Some(2.0));
        assert_eq!(surface.way(3, 4), None);
    }
}
