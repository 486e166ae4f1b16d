use std::fs;
use std::path::{Path, PathBuf};

use mser3d::Features;
use mser3d_meshio::{
    VertexAttributes, VoxelField, VoxelValues, write_atomically, write_npz, write_ply, write_vti,
};
use mser3d_viewer::region_colours;

use super::arrays;
use super::report::Report;
use crate::error::CliError;
use crate::input::Input;

/// A folder that either holds a whole result or none.
///
/// `regions.json` is the last file to appear and the first to go: while it is there, the others
/// belong to it.
pub struct OutputFolder {
    path: PathBuf,
    /// Whether we made the folder, and take it away again if nothing gets written.
    made: bool,
    done: std::cell::Cell<bool>,
}

impl OutputFolder {
    /// Makes the folder, and finds out early whether it can be written to.
    pub fn create(path: &Path) -> Result<Self, CliError> {
        let fail = |source| CliError::OutputFolder { path: path.to_path_buf(), source };
        let made = !path.exists();
        fs::create_dir_all(path).map_err(fail)?;
        let folder = Self { path: path.to_path_buf(), made, done: false.into() };
        tempfile::tempfile_in(path).map_err(fail)?;
        Ok(folder)
    }

    pub fn write(&self, input: &Input, features: &Features, report: &Report) -> Result<(), CliError> {
        let file = |name: &str| self.path.join(name);
        for stale in ["regions.json", "features.npz", "surface.ply", "volume.vti"] {
            match fs::remove_file(file(stale)) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(CliError::OutputFolder { path: file(stale), source });
                }
                _ => {}
            }
        }
        write_npz(&file("features.npz"), &arrays::features(input, features))?;
        let voxel_labels = arrays::labels(&features.region_of_element());
        if let Some(mesh) = input.mesh() {
            let labels = arrays::labels(&features.region_of_vertex());
            let nested: Vec<[u32; 2]> = (0u32..)
                .zip(&features.regions)
                .filter_map(|(id, region)| region.parent.map(|parent| [parent as u32, id]))
                .collect();
            let palette = region_colours(features.regions.len(), &labels, &mesh.edge_graph(), &nested);
            let colour = |&label: &i32| match usize::try_from(label) {
                Ok(region) => palette[region].0,
                Err(_) => mser3d_viewer::NO_REGION.0,
            };
            let colours: Vec<[u8; 3]> = labels.iter().map(colour).collect();
            let attributes =
                VertexAttributes { colors: Some(&colours), regions: Some(&labels), normals: None };
            write_ply(&file("surface.ply"), mesh, &attributes)?;
        }
        if let Some(grid) = features.body.grid() {
            let fields = [VoxelField { name: "region", values: VoxelValues::Labels(&voxel_labels) }];
            write_vti(&file("volume.vti"), grid, &fields)?;
        }
        let json = report.to_json();
        write_atomically(&file("regions.json"), |out| {
            use std::io::Write;
            out.write_all(json.as_bytes())
        })?;
        self.done.set(true);
        Ok(())
    }
}

impl Drop for OutputFolder {
    fn drop(&mut self) {
        if self.made && !self.done.get() {
            // Only if it is still empty.
            let _ = fs::remove_dir(&self.path);
        }
    }
}
