//! Segmentation by the shape diameter function (Shapira, Shamir, Cohen-Or 2008), as CGAL has it.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use mser3d::shape::{IndexSet, TriangleMesh};

use super::tomato::read_labels;
use super::{COUNTS, Parts, is_part};
use crate::comparisons::refine::refined;

/// How to get it.
pub const ADVICE: &str = "apt-get install g++ libcgal-dev";

/// Segmentations are made with 2 clusters of diameters up to this many. More give no more segments.
const CLUSTERS: usize = 12;

/// Coarser meshes are refined until they have so many vertices: diameters are of triangles, and on a few hundred CGAL finds
/// one segment.
const VERTICES: usize = 10_000;

/// The one of CGAL.
pub struct ShapeDiameter {
    pub version: String,
    program: PathBuf,
}

impl ShapeDiameter {
    /// Compiles the program that calls CGAL.
    pub fn find(folder: &Path) -> Option<Self> {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("peers/shape_diameter.cpp");
        let program = folder.join("shape_diameter");
        let mut compiler = Command::new("g++");
        compiler.args(["-O3", "-std=c++17"]).arg(source).arg("-o").arg(&program).args(["-lmpfr", "-lgmp"]);
        compiler.output().ok().filter(|output| output.status.success())?;
        let version = Command::new(&program).output().ok().filter(|output| output.status.success())?;
        Some(Self { version: String::from_utf8_lossy(&version.stdout).trim().to_owned(), program })
    }

    /// The parts that 2, 3, ... clusters give.
    pub fn segmentations(
        &self,
        own: &TriangleMesh,
        file: &Path,
    ) -> Result<Vec<Vec<IndexSet>>, Box<dyn Error>> {
        let mesh = refined(own, VERTICES)?;
        let (vertices, triangles) = (mesh.vertices(), mesh.triangles());
        let mut problem: Vec<u8> =
            [vertices.len(), triangles.len()].iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
        problem.extend(vertices.iter().flatten().flat_map(|x| x.to_le_bytes()));
        problem.extend(triangles.iter().flatten().flat_map(|v| v.to_le_bytes()));
        std::fs::write(file, problem)?;
        let out = file.with_extension("labels");
        let mut command = Command::new(&self.program);
        let ran = command.args([file, &out]).arg(CLUSTERS.to_string()).output()?;
        std::fs::remove_file(file)?;
        if !ran.status.success() {
            let text = String::from_utf8_lossy(&ran.stderr);
            return Err(format!("CGAL: {}", text.trim().replace('\n', "; ")).into());
        }
        let labels = read_labels(&out, CLUSTERS - 1, triangles.len())?;
        std::fs::remove_file(&out)?;
        Ok(labels.iter().map(|labels| segments(&mesh, labels, own.vertices().len())).collect())
    }
}

/// For each number of parts, the segmentations into as many clusters as give, on average over the shapes, a number of parts
/// nearest to it; if two do, into fewer clusters. From shape to shape the number of clusters is the same: with another,
/// borders are elsewhere. No part is left out, even where there are more than are asked for.
pub fn nearest(shapes: Vec<Vec<Vec<IndexSet>>>) -> Vec<Parts> {
    let solved = shapes.iter().filter(|shape| !shape.is_empty()).count().max(1) as f64;
    let mean = |place: usize| {
        shapes.iter().filter_map(|s| s.get(place)).map(Vec::len).sum::<usize>() as f64 / solved
    };
    let chosen = COUNTS.map(|count| {
        let off = |place: &usize| (mean(*place) - count as f64).abs();
        (0..CLUSTERS - 1).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or_default()
    });
    let of_shape =
        |shape: &Vec<Vec<IndexSet>>| chosen.map(|place| shape.get(place).cloned().unwrap_or_default());
    shapes.iter().map(of_shape).collect()
}

/// The segments of labelled triangles that are parts, as sets of the first vertices. A vertex belongs to the segment that has
/// most of the area around it.
fn segments(mesh: &TriangleMesh, labels: &[i32], vertices: usize) -> Vec<IndexSet> {
    let mut around: Vec<Vec<(i32, f64)>> = vec![Vec::new(); mesh.vertices().len()];
    let mut areas: Vec<f64> = Vec::new();
    for (triangle, &label) in labels.iter().enumerate() {
        let Ok(segment) = usize::try_from(label) else { continue };
        let area = mesh.triangle_area(triangle);
        areas.resize(areas.len().max(segment + 1), 0.0);
        areas[segment] += area;
        for &v in &mesh.triangles()[triangle] {
            let segments = &mut around[v as usize];
            match segments.iter_mut().find(|(other, _)| *other == label) {
                Some((_, sum)) => *sum += area,
                None => segments.push((label, area)),
            }
        }
    }
    let most = |segments: &Vec<(i32, f64)>| {
        segments.iter().max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))).map(|segment| segment.0)
    };
    let of_vertex: Vec<Option<i32>> = around.iter().take(vertices).map(most).collect();
    let all: f64 = areas.iter().sum();
    let parts = (0i32..).zip(&areas).filter(|(_, area)| is_part(**area / all));
    parts.map(|(label, _)| IndexSet::from_fn(vertices, |v| of_vertex[v] == Some(label))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_shapes_of_a_set_have_the_clusters_that_come_nearest_on_average() {
        let parts = |count: usize| vec![IndexSet::from_fn(1, |_| true); count];
        let of = |counts: &[usize]| counts.iter().map(|&count| parts(count)).collect::<Vec<_>>();
        // Means: 3, 5, 8, 12. The shape that failed is no matter.
        let chosen = nearest(vec![of(&[4, 2, 9, 12]), of(&[2, 8, 7, 12]), Vec::new()]);
        let counts: Vec<Vec<usize>> =
            chosen.iter().map(|parts| parts.iter().map(Vec::len).collect()).collect();
        assert_eq!(counts, [vec![4, 2, 9, 12, 12], vec![2, 8, 7, 12, 12], vec![0; 5]]);
    }

    #[test]
    fn vertices_take_the_segment_of_most_area_around_them() {
        // Triangles of areas 1/2, 1/2, 2 and 0.002 in a row.
        let places = [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [5., 1.], [1., 1.001]];
        let vertices = places.map(|[x, y]| [x, y, 0.0]).to_vec();
        let mesh = TriangleMesh::new(vertices, vec![[0, 1, 2], [1, 3, 2], [1, 4, 3], [3, 4, 5]]).unwrap();
        let members = |labels: &[i32], mesh: &TriangleMesh| -> Vec<Vec<usize>> {
            segments(mesh, labels, 6).iter().map(|part| part.members().collect()).collect()
        };
        // The last triangle is too small to be a part, but it has vertex 5. At vertex 2 areas are equal.
        assert_eq!(members(&[0, 1, 2, 3], &mesh), [vec![0, 2], vec![], vec![1, 3, 4]]);
        assert_eq!(members(&[1, 1, 0, 0], &mesh), [vec![1, 3, 4, 5], vec![0, 2]]);
        // Nearly all of it is no part.
        assert_eq!(members(&[0, 0, 0, 1], &mesh), Vec::<Vec<usize>>::new());

        // Vertices after the first are counted for area alone.
        let first: Vec<usize> = segments(&mesh, &[1, 1, 0, 0], 4).iter().map(IndexSet::len).collect();
        assert_eq!(first, [2, 2]);
    }
}
