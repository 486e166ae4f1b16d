//! What was found, on disk, and by what it is known to be still right.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use mser3d::shape::TriangleMesh;
use mser3d_evaluation::DetectedRegions;
use mser3d_evaluation::shrec::ShapeName;
use sha2::{Digest as _, Sha256};

use super::detectors::Detector;

/// A folder of detections: in it one for each detector and descriptor, with `.regions` and
/// `.descriptors`, and `.key` for what our own were made from.
pub struct Store {
    folder: PathBuf,
}

impl Store {
    pub fn new(output: &Path) -> Self {
        Self { folder: output.join("detections") }
    }

    /// The folder of a detector and descriptor, which is made if need be.
    pub fn folder(&self, entry: &str) -> Result<PathBuf, Box<dyn Error>> {
        let folder = self.folder.join(entry);
        fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
        Ok(folder)
    }

    /// Whether what a detector found on a shape is there and was made from the same.
    pub fn has(&self, detector: &Detector, name: &ShapeName, key: &Digest) -> bool {
        fs::read_to_string(self.key_path(detector, name)).is_ok_and(|before| before == key.hex())
    }

    /// Says what all files of a detector and a shape were made from, once they are there.
    pub fn seal(&self, detector: &Detector, name: &ShapeName, key: &Digest) -> Result<(), Box<dyn Error>> {
        let path = self.key_path(detector, name);
        Ok(fs::write(&path, key.hex()).map_err(|e| format!("{}: {e}", path.display()))?)
    }

    /// To be called before files are replaced.
    pub fn unseal(&self, detector: &Detector, name: &ShapeName) -> Result<(), Box<dyn Error>> {
        let path = self.key_path(detector, name);
        match fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(format!("{}: {e}", path.display()).into())
            }
            _ => Ok(()),
        }
    }

    /// The best overlap of each region in voxels, a line each.
    pub fn write_voxel_overlaps(
        &self,
        detector: &Detector,
        name: &ShapeName,
        overlaps: &[f64],
    ) -> Result<(), Box<dyn Error>> {
        let path = self.folder(detector.name)?.join(format!("{name}.voxels"));
        let lines: String = overlaps.iter().map(|x| format!("{x}\n")).collect();
        Ok(fs::write(&path, lines).map_err(|e| format!("{}: {e}", path.display()))?)
    }

    /// Those of a detector or of another folder, if there are any.
    pub fn voxel_overlaps(folder: &Path, name: &ShapeName) -> Vec<f64> {
        let text = fs::read_to_string(folder.join(format!("{name}.voxels"))).unwrap_or_default();
        text.lines().filter_map(|line| line.parse().ok()).collect()
    }

    fn key_path(&self, detector: &Detector, name: &ShapeName) -> PathBuf {
        self.folder.join(detector.name).join(format!("{name}.key"))
    }
}

/// SHA-256 of everything that a detection depends on.
#[derive(Clone, Default)]
pub struct Digest(Sha256);

impl Digest {
    pub fn text(&mut self, text: &str) {
        self.numbers([text.len() as u64]);
        self.0.update(text);
    }

    pub fn mesh(&mut self, mesh: &TriangleMesh) {
        self.numbers([mesh.vertices().len() as u64, mesh.triangles().len() as u64]);
        self.numbers(mesh.vertices().iter().flatten().map(|x| x.to_bits()));
        self.numbers(mesh.triangles().iter().flatten().map(|v| u64::from(*v)));
    }

    pub fn detection(&mut self, detection: &DetectedRegions) {
        for region in &detection.regions {
            self.numbers([region.len() as u64]);
            self.numbers(region.members().map(|v| v as u64));
        }
        self.numbers(detection.descriptors.iter().flatten().map(|x| x.to_bits()));
    }

    fn numbers(&mut self, numbers: impl IntoIterator<Item = u64>) {
        numbers.into_iter().for_each(|x| self.0.update(x.to_le_bytes()));
    }

    fn hex(&self) -> String {
        self.0.clone().finalize().iter().map(|b| format!("{b:02x}")).collect()
    }
}
