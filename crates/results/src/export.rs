use std::path::Path;

use mser3d_meshio::{
    MeshIoError, VertexAttributes, VoxelField, VoxelValues, write_glb, write_ply, write_vti, write_vtp,
};
use mser3d_viewer::label_colour;

use crate::label_map::LabelMap;
use crate::landmarks::write_landmarks;
use crate::{Results, ResultsError};

/// How the names of files that [`Results::export`] writes end.
pub const EXPORT_ENDINGS: [&str; 7] = [".glb", ".ply", ".vtp", ".vti", ".nii.gz", ".nii", ".mrk.json"];

impl Results {
    /// Writes one file for other programs; its name's ending says which kind:
    ///
    /// | ending | opens in | holds |
    /// |---|---|---|
    /// | `.glb` | Blender, browsers | the mesh; `COLOR_0` and `_REGION` per vertex |
    /// | `.ply` | MeshLab, Blender | the mesh; colour and `region` per vertex |
    /// | `.vtp` | ParaView | the mesh; `color` and `region` per point |
    /// | `.vti` | ParaView | the voxels; `region`, `inside` and, if there are parts, `part` per cell |
    /// | `.nii`, `.nii.gz` | Slicer, ITK-SNAP, nibabel | the voxels on the grid of the input; 1 + the number of the region, 0 for none |
    /// | `.mrk.json` | Slicer | the regions' centres and tips |
    ///
    /// Returns what its user should know of the file, such as places that its numbers could not keep apart.
    ///
    /// Of a solid given as voxels, the mesh is the outer faces of its voxels. `region` is the innermost
    /// region, -1 for none.
    ///
    /// # Errors
    /// [`ResultsError::Export`] for another ending, or for `.vti` when there are no voxels;
    /// [`ResultsError::File`], naming the file.
    pub fn export(&self, path: &Path) -> Result<Vec<String>, ResultsError> {
        let none = Vec::new();
        let refuse = |reason| ResultsError::Export { path: path.to_owned(), reason };
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        if name.ends_with(".mrk.json") {
            write_landmarks(path, &[(String::new(), &self.record)])?;
            return Ok(none);
        }
        if name.ends_with(".nii") || name.ends_with(".nii.gz") {
            let no_grid = "the regions were found on a surface, there are no voxels; write .ply";
            self.grid.as_ref().ok_or_else(|| refuse(no_grid))?;
            LabelMap::new(&[(self, 0)])?.write(path)?;
            return Ok(none);
        }
        let ending = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match ending.as_deref() {
            Some("glb") => return Ok(self.with_attributes(|a| write_glb(path, &self.mesh, a))?),
            Some("ply") => self.with_attributes(|a| write_ply(path, &self.mesh, a))?,
            Some("vtp") => self.with_attributes(|a| write_vtp(path, &self.mesh, a))?,
            Some("vti") => {
                let no_grid = "the regions were found on a surface, there are no voxels; write .vtp";
                let grid = self.grid.as_ref().ok_or_else(|| refuse(no_grid))?;
                let regions = self.voxel_region();
                let mut fields = vec![VoxelField { name: "region", values: VoxelValues::Labels(&regions) }];
                if self.record.parts.is_some() {
                    fields.push(VoxelField { name: "part", values: VoxelValues::Labels(&self.voxel_part) });
                }
                write_vti(path, grid, &fields)?;
            }
            _ => {
                return Err(refuse(
                    "no such format; end the name in .glb, .ply, .vtp, .vti, .nii.gz, .nii or .mrk.json",
                ));
            }
        }
        Ok(none)
    }

    /// Calls a writer of meshes with the colour and region of each vertex.
    fn with_attributes<T>(
        &self,
        write: impl FnOnce(&VertexAttributes<'_>) -> Result<T, MeshIoError>,
    ) -> Result<T, MeshIoError> {
        self.with_labels(&self.vertex_region(), write)
    }

    /// The same for vertices with these labels.
    pub(crate) fn with_labels<T>(
        &self,
        regions: &[i32],
        write: impl FnOnce(&VertexAttributes<'_>) -> Result<T, MeshIoError>,
    ) -> Result<T, MeshIoError> {
        let colours = self.colours();
        let colors: Vec<[u8; 3]> = regions.iter().map(|&label| label_colour(&colours, label).0).collect();
        write(&VertexAttributes { colors: Some(&colors), regions: Some(regions), normals: None })
    }
}
