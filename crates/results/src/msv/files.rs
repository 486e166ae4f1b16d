use std::path::Path;

use mser3d_fileio::{InputFile, write_text};
use mser3d_meshio::{VoxelField, VoxelValues, write_vti};
use mser3d_shape::{BitGrid, Choice, Frame, VoxelGrid};
use mser3d_volumeio::{Samples, Volume, read_volume, write_npy};

use super::{MSV_RECORD, MsvResults};
use crate::folder::{Kind, recover};
use crate::load::parse;
use crate::{Checksums, FORMAT, ResultsError, ResultsFolder};

impl MsvResults {
    /// The files of a folder.
    pub(crate) const FILES: Kind =
        Kind { record: MSV_RECORD, others: &["regions.csv", "labels.npy", "labels.vti", "view.html"] };

    /// Writes `msv.json`, `regions.csv`, and the numbers of the smallest regions as `labels.npy` (a channel for each
    /// search, -1 for none) and `labels.vti`, with `checksums.json` of them. While `msv.json` is there, the others belong to it.
    /// What is promised stands at [`ResultsFolder`], which also finds out early whether a folder can be written to.
    ///
    /// # Errors
    /// [`ResultsError::OutputFolder`], [`ResultsError::Busy`], [`ResultsError::Io`], [`ResultsError::File`],
    /// [`ResultsError::Mesh`] or [`ResultsError::Volume`], naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), ResultsError> {
        ResultsFolder::create(folder)?.write_msv(self)
    }

    /// Writes all files into an empty folder.
    pub(crate) fn write_files(&self, folder: &Path) -> Result<(), ResultsError> {
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

    /// Reads a folder that [`MsvResults::write`] wrote, and checks it as [`Results::load`](crate::Results::load) does.
    ///
    /// # Errors
    /// [`ResultsError::Io`], [`ResultsError::OtherFormat`], [`ResultsError::Damaged`], [`ResultsError::Broken`],
    /// [`ResultsError::Volume`], naming the file.
    pub fn load(folder: &Path) -> Result<Self, ResultsError> {
        recover(folder, MSV_RECORD)?;
        let sums = Checksums::load(folder)?;
        sums.check_beside(folder, MSV_RECORD, "labels.npy")?;
        sums.check_beside(folder, "labels.npy", MSV_RECORD)?;
        let path = folder.join(MSV_RECORD);
        let text =
            InputFile::read_all(&path).map_err(|error| ResultsError::Io { path: path.clone(), error })?;
        let record: super::MsvRecord = parse(&path, &text, FORMAT)?;
        record.check().map_err(|reason| ResultsError::Broken { path, reason })?;
        let path = folder.join("labels.npy");
        let volume = read_volume(&path, &Default::default())?.volume;
        let searches = record.searches.len();
        let broken = |reason: &str| ResultsError::Broken { path: path.clone(), reason: reason.to_owned() };
        let Samples::I32(numbers) = volume.samples() else {
            return Err(broken("its numbers are not int32"));
        };
        if volume.dims() != record.dims || volume.channels() != searches.max(1) {
            return Err(broken("its shape is not that of msv.json"));
        }
        let label = |n: i32| u32::try_from(n).ok();
        for (search, of) in record.searches.iter().enumerate() {
            let mut named = numbers.iter().skip(search).step_by(searches).filter_map(|&n| label(n));
            if named.any(|n| n as usize >= of.regions.len()) {
                return Err(broken("it names a region that msv.json does not have"));
            }
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
