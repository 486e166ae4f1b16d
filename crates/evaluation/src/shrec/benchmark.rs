use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_shape::TriangleMesh;

use super::{ShapeName, Transformed, corr};
use crate::{EvaluationError, NullShape, read_symmetry};

const SHREC11: [&str; 11] = [
    "affine",
    "holes",
    "isometry",
    "microholes",
    "noise",
    "partial",
    "rasterize",
    "sampling",
    "scaling",
    "shotnoise",
    "view",
];
const SHREC10: [&str; 9] =
    ["holes", "isometry", "localscale", "microholes", "noise", "sampling", "scale", "shotnoise", "topology"];

/// A folder in the layout of SHREC'10 or SHREC'11. Shapes are read one by one, so that one that is
/// missing or wrong does not stop the others.
#[derive(Clone, Debug)]
pub struct Benchmark {
    folder: PathBuf,
    names: BTreeSet<ShapeName>,
}

impl Benchmark {
    /// Lists a folder.
    ///
    /// # Errors
    /// [`EvaluationError::Read`] when the folder cannot be listed, [`EvaluationError::NoShapes`] when it holds
    /// no `NNNN.<class>.<strength>.off`.
    pub fn open(folder: &Path) -> Result<Self, EvaluationError> {
        let read = |source| EvaluationError::Read { path: folder.into(), source };
        let mut names = BTreeSet::new();
        for entry in std::fs::read_dir(folder).map_err(read)? {
            let file = entry.map_err(read)?.file_name();
            let name = file.to_str().and_then(|f| f.strip_suffix(".off")).and_then(|n| n.parse().ok());
            names.extend(name);
        }
        if names.is_empty() {
            return Err(EvaluationError::NoShapes { folder: folder.into() });
        }
        Ok(Self { folder: folder.into(), names })
    }

    /// All shapes in the folder, null shapes too: by null shape, class and strength.
    pub fn names(&self) -> impl Iterator<Item = &ShapeName> {
        self.names.iter()
    }

    /// The numbers of the null shapes that shapes of the folder refer to.
    pub fn null_numbers(&self) -> BTreeSet<u32> {
        self.names.iter().map(|n| n.null).collect()
    }

    /// The classes in the folder.
    pub fn classes(&self) -> BTreeSet<&str> {
        self.names.iter().filter(|n| !n.is_null()).map(|n| n.class.as_str()).collect()
    }

    /// What a whole benchmark would have and this folder has not, a line each: files of the meshes
    /// and of the ground truth, and classes of the edition (SHREC'10 or '11) that it resembles more.
    pub fn missing(&self) -> Vec<String> {
        let mut missing = Vec::new();
        let classes = self.classes();
        let share = |edition: &[&str]| {
            edition.iter().filter(|c| classes.contains(*c)).count() as f64 / edition.len() as f64
        };
        let edition = if share(&SHREC10) > share(&SHREC11) { &SHREC10[..] } else { &SHREC11[..] };
        for class in edition.iter().filter(|c| !classes.contains(*c)) {
            missing.push(format!("class {class}: no shapes"));
        }
        for null in self.null_numbers() {
            let wanted = classes.iter().flat_map(|class| {
                (1..=5).map(move |strength| ShapeName { null, class: (*class).into(), strength })
            });
            for name in std::iter::once(ShapeName::null(null)).chain(wanted) {
                let (mesh, corr) = (name.mesh_path(&self.folder), name.corr_path(&self.folder));
                if !self.names.contains(&name) {
                    missing.push(format!("{}: not there", mesh.display()));
                } else if !name.is_null() && !corr.exists() {
                    missing.push(format!("{}: not there", corr.display()));
                }
            }
        }
        missing
    }

    /// A null shape, with its symmetry if the folder has one: `NNNN.null.0.sym.mat` (variable
    /// `isym`) or `NNNN.null.0.sym.txt` (a list, counted from 0 or 1).
    ///
    /// # Errors
    /// [`EvaluationError::Mesh`], [`EvaluationError::BadFile`] or [`EvaluationError::BadLine`], with the file.
    pub fn null_shape(&self, number: u32) -> Result<NullShape, EvaluationError> {
        let name = ShapeName::null(number);
        let mesh = self.mesh(&name)?;
        for extension in ["mat", "txt"] {
            let path = self.folder.join(format!("{name}.sym.{extension}"));
            if path.exists() {
                let mirror = read_symmetry(&path, mesh.vertices().len())?;
                return NullShape::new(mesh).with_symmetry(mirror);
            }
        }
        Ok(NullShape::new(mesh))
    }

    /// A transformed shape with its ground truth.
    ///
    /// # Errors
    /// [`EvaluationError::Mesh`], [`EvaluationError::Read`] or [`EvaluationError::BadLine`], with the file.
    pub fn transformed(&self, name: &ShapeName, null: &NullShape) -> Result<Transformed, EvaluationError> {
        let mesh = self.mesh(name)?;
        let path = name.corr_path(&self.folder);
        let text = std::fs::read_to_string(&path)
            .map_err(|source| EvaluationError::Read { path: path.clone(), source })?;
        let points = corr::parse(&text, &path, null.mesh(), &mesh)?;
        Ok(Transformed { mesh, points })
    }

    fn mesh(&self, name: &ShapeName) -> Result<TriangleMesh, EvaluationError> {
        let path = name.mesh_path(&self.folder);
        let loaded = read_mesh(&path, &ReadOptions::default())?;
        if loaded.polygons > 0 || !loaded.notes.is_empty() {
            // Ground truth numbers the file's triangles.
            let problem = "faces that are not triangles; the benchmark's meshes have only triangles".into();
            return Err(EvaluationError::BadFile { path, problem });
        }
        Ok(loaded.mesh)
    }
}
