use std::fs;
use std::io::ErrorKind;
use std::path::Path;

use mser3d_fileio::{InputFile, Writing, write_text};
use mser3d_meshio::{VoxelField, VoxelValues, write_vti};
use mser3d_shape::{BitGrid, Choice, Frame, VoxelGrid};
use mser3d_volumeio::{Samples, Volume, read_volume, write_npy};

use super::{MSV_RECORD, MsvResults};
use crate::load::parse;
use crate::{FORMAT, ResultsError};

/// All files of a folder, the record first: it goes first and appears last.
const FILES: [&str; 5] = [MSV_RECORD, "regions.csv", "labels.npy", "labels.vti", "view.html"];

impl MsvResults {
    /// Writes `msv.json`, `regions.csv`, and the numbers of the smallest regions as `labels.npy` (a channel for each
    /// search, -1 for none) and `labels.vti`. While `msv.json` is there, the others belong to it.
    ///
    /// # Errors
    /// [`ResultsError::OutputFolder`], [`ResultsError::Io`], [`ResultsError::File`], [`ResultsError::Mesh`] or
    /// [`ResultsError::Volume`], naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), ResultsError> {
        let _whole = Writing::begin();
        let fail = |error| ResultsError::OutputFolder { path: folder.to_owned(), error };
        fs::create_dir_all(folder).map_err(fail)?;
        for path in FILES.map(|name| folder.join(name)) {
            match fs::remove_file(&path) {
                Err(error) if error.kind() != ErrorKind::NotFound => {
                    return Err(ResultsError::Io { path, error });
                }
                _ => {}
            }
        }
        let number = |label: &Option<u32>| label.map_or(-1, |x| x as i32);
        let numbers: Vec<Vec<i32>> = self.labels.iter().map(|l| l.iter().map(number).collect()).collect();
        let dims = self.record.dims;
        let voxels = dims.iter().product();
        let interleaved: Vec<i32> =
            (0..voxels).flat_map(|v| numbers.iter().map(move |search: &Vec<i32>| search[v])).collect();
        let labels = Volume::new(dims, numbers.len(), self.record.affine, interleaved)?;
        write_npy(&folder.join("labels.npy"), &labels)?;
        let grid = VoxelGrid::solid(labels.frame()?, BitGrid::full(dims)?)?;
        let searches = self.record.searches.iter().zip(&numbers);
        let fields: Vec<VoxelField> = searches
            .map(|(s, numbers)| VoxelField { name: s.contrast.name(), values: VoxelValues::Labels(numbers) })
            .collect();
        write_vti(&folder.join("labels.vti"), &grid, &fields)?;
        write_text(&folder.join("regions.csv"), &self.record.to_csv())?;
        let path = folder.join(MSV_RECORD);
        let json = serde_json::to_string_pretty(&self.record);
        let json = json.map_err(|error| ResultsError::Io { path: path.clone(), error: error.into() })?;
        Ok(write_text(&path, &(json + "\n"))?)
    }

    /// Whether a folder holds such a result.
    pub fn is_in(folder: &Path) -> bool {
        folder.join(MSV_RECORD).is_file()
    }

    /// Reads a folder that [`MsvResults::write`] wrote.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::OtherFormat`], [`ResultsError::Broken`], [`ResultsError::Volume`], naming
    /// the file.
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        let path = folder.join(MSV_RECORD);
        let text =
            InputFile::read_all(&path).map_err(|error| ResultsError::Io { path: path.clone(), error })?;
        let record: super::MsvRecord = parse(&path, &text, FORMAT)?;
        let path = folder.join("labels.npy");
        let volume = read_volume(&path)?.volume;
        let searches = record.searches.len();
        let most = record.searches.iter().map(|s| s.regions.len()).max().unwrap_or(0);
        let Samples::I32(numbers) = volume.samples() else {
            let reason = "its numbers are not int32".to_owned();
            return Err(ResultsError::Broken { path, reason });
        };
        if volume.dims() != record.dims || volume.channels() != searches.max(1) {
            let reason = "its shape is not that of msv.json".to_owned();
            return Err(ResultsError::Broken { path, reason });
        }
        let label = |n: i32| u32::try_from(n).ok();
        if numbers.iter().any(|&n| label(n).is_some_and(|n| n as usize >= most)) {
            let reason = "it names a region that msv.json does not have".to_owned();
            return Err(ResultsError::Broken { path, reason });
        }
        let of = |search| numbers.iter().skip(search).step_by(searches).map(|&n| label(n)).collect();
        let labels = (0..searches).map(of).collect();
        Ok(Self { record, labels })
    }

    /// The grid of the volume.
    pub(crate) fn frame(&self) -> Result<Frame, ResultsError> {
        Ok(Frame::placed(self.record.dims, &self.record.affine)?)
    }
}
