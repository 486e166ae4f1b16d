use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d_shape::TriangleMesh;

use super::{ShapeName, Transformed, corr};
use crate::{EvaluationError, NullShape};
use mser3d_fileio::write_text;

/// Writes a benchmark in the layout that [`Benchmark`](super::Benchmark) reads.
///
/// The ground truth is written last for each shape: where it is there, the shape is whole.
#[derive(Clone, Debug)]
pub struct BenchmarkWriter {
    folder: PathBuf,
}

impl BenchmarkWriter {
    /// Into a folder, which is made if need be.
    ///
    /// # Errors
    /// [`EvaluationError::Write`].
    pub fn create(folder: &Path) -> Result<Self, EvaluationError> {
        let corr = folder.join("corr");
        fs::create_dir_all(&corr).map_err(|source| EvaluationError::Write { path: corr, source })?;
        Ok(Self { folder: folder.into() })
    }

    /// A null shape and, if it has one, its symmetry (`NNNN.null.0.sym.txt`, counted from 1).
    ///
    /// # Errors
    /// [`EvaluationError::Write`].
    pub fn null_shape(&self, number: u32, shape: &NullShape) -> Result<(), EvaluationError> {
        let name = ShapeName::null(number);
        write_text(&name.mesh_path(&self.folder), &off(shape.mesh()))?;
        if let Some(mirror) = shape.mirror() {
            let list: String = mirror.iter().map(|m| format!("{}\n", m + 1)).collect();
            write_text(&self.folder.join(format!("{name}.sym.txt")), &list)?;
        }
        Ok(())
    }

    /// A transformed shape and its ground truth.
    ///
    /// # Errors
    /// [`EvaluationError::Write`].
    pub fn transformed(&self, name: &ShapeName, shape: &Transformed) -> Result<(), EvaluationError> {
        write_text(&name.mesh_path(&self.folder), &off(&shape.mesh))?;
        Ok(write_text(&name.corr_path(&self.folder), &corr::format(shape))?)
    }
}

/// As OFF, with all digits: what is read again is the same mesh.
fn off(mesh: &TriangleMesh) -> String {
    let mut text = format!("OFF\n{} {} 0\n", mesh.vertices().len(), mesh.triangles().len());
    // Writing to a String cannot fail.
    for [x, y, z] in mesh.vertices() {
        let _ = writeln!(text, "{x} {y} {z}");
    }
    for [a, b, c] in mesh.triangles() {
        let _ = writeln!(text, "3 {a} {b} {c}");
    }
    text
}
