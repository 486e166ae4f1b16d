use mser3d_shape::{IndexSet, TriangleMesh};

use crate::EvaluationError;

/// The shape that all others of a benchmark are transforms of: there overlaps are measured. (SHREC's word for it.)
#[derive(Clone, Debug)]
pub struct NullShape {
    mesh: TriangleMesh,
    vertex_areas: Vec<f64>,
    mirror: Option<Vec<u32>>,
}

impl NullShape {
    /// A null shape without a symmetry.
    pub fn new(mesh: TriangleMesh) -> Self {
        Self { vertex_areas: mesh.vertex_areas(), mesh, mirror: None }
    }

    /// The same shape with its left-right symmetry: `mirror[v]` is the vertex that mirrors vertex v.
    ///
    /// An intrinsic detector cannot tell left from right. With a symmetry, the better of the direct
    /// and the mirrored overlap counts.
    ///
    /// # Errors
    /// [`EvaluationError::SizeMismatch`] or [`EvaluationError::OutOfRange`].
    pub fn with_symmetry(mut self, mirror: Vec<u32>) -> Result<Self, EvaluationError> {
        let count = self.vertex_areas.len();
        if mirror.len() != count {
            let (found, expected) = (mirror.len(), count);
            return Err(EvaluationError::SizeMismatch {
                what: "entries of the symmetry map",
                found,
                expected,
            });
        }
        if let Some(number) = mirror.iter().position(|&m| m as usize >= count) {
            let (what, index) = ("entry of the symmetry map", mirror[number].into());
            return Err(EvaluationError::OutOfRange { what, number, index, count });
        }
        self.mirror = Some(mirror);
        Ok(self)
    }

    /// The surface.
    pub fn mesh(&self) -> &TriangleMesh {
        &self.mesh
    }

    /// The area that each vertex stands for: a third of that of its triangles.
    pub fn vertex_areas(&self) -> &[f64] {
        &self.vertex_areas
    }

    /// The symmetry map, if there is one.
    pub fn mirror(&self) -> Option<&[u32]> {
        self.mirror.as_deref()
    }

    /// The mirror image of a region, if the symmetry is known.
    pub(crate) fn mirror_image(&self, region: &IndexSet) -> Option<IndexSet> {
        let mirror = self.mirror.as_ref()?;
        Some(IndexSet::from_fn(mirror.len(), |v| region.contains(mirror[v] as usize)))
    }
}
