//! `mser3d msv`: maximally stable volumes of a grey-value volume or image (Donoser and Bischof 2006).

use std::path::{Path, PathBuf};

use mser3d::comptree::{Contrast, MsvParameters};
use mser3d::shape::Connectivity;
use mser3d_fileio::STDIN;
use mser3d_meshio::ReadOptions;
use mser3d_results::msv::{MSV_RECORD, MsvResults, MsvSearchParameters};
use mser3d_results::{ResultsError, ResultsFolder, ShapeOptions, VolumeFile};
use mser3d_volumeio::{PlacementParameters, VolumeFormat, read_affine};

use crate::choice::choice;
use crate::error::{CliError, print};
use crate::input::{FormatOption, folder_beside, take_input};
use crate::interrupt;
use crate::limit_options::LimitOptions;
use crate::message::tell;
use crate::numbers::positive;
use crate::output::folder;
use crate::voxel_options::triple;

/// Bytes that a search takes for each voxel, as measured on noise, the worst.
const VOXEL: f64 = 110.0;

/// What `mser3d msv` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct MsvArgs {
    /// Grey values: .npy ([x, y], [x, y, z] or [x, y, z, channel]), .nii, .nii.gz, .nrrd, .tif or .tiff; - is standard
    /// input
    #[arg(value_name = "VOLUME")]
    pub input: PathBuf,
    #[command(flatten)]
    pub(crate) format: FormatOption,
    /// Folder for msv.json, regions.csv, and labels.vti and labels.npy (a channel for each kind of region; the
    /// number of the smallest region, -1 for none); made if it isn't there [default: the volume's name]
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: Option<PathBuf>,
    /// Which regions are searched [default: dark,bright; of colours alike]
    #[arg(long, value_parser = choice::<Contrast>(), value_delimiter = ',', value_name = "KIND,...")]
    pub regions: Vec<Contrast>,
    /// Over how many grey values a region is compared with what it grows into [default: 5 for integers, 2 %
    /// of the range for others, where it is also the step that 1 is for integers]
    #[arg(long, value_name = "GREY")]
    pub delta: Option<f64>,
    /// Smallest region, as a fraction of all voxels
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().min_area)]
    pub min_area: f64,
    /// Largest region, as a fraction of all voxels
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().max_area)]
    pub max_area: f64,
    /// Drop regions that grow by this share of their size or more within delta
    #[arg(long, value_name = "V", default_value_t = MsvParameters::default().max_variation)]
    pub max_variation: f64,
    /// How much smaller than the next larger region a nested one must be, as a fraction
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().min_diversity)]
    pub min_diversity: f64,
    /// Which voxels are neighbours; VLFeat's are 26
    #[arg(long, value_parser = choice::<Connectivity>(),
          default_value_t = MsvSearchParameters::default().connectivity)]
    pub connectivity: Connectivity,
    /// Which volume of a file that holds several (times, frames, components), from 0
    #[arg(long, value_name = "N")]
    pub volume: Option<usize>,
    /// Distances of the voxels along the axes, in place of the file's
    #[arg(long, value_name = "X,Y,Z", value_parser = positive, value_delimiter = ',')]
    pub spacing: Vec<f64>,
    /// Centre of the first voxel, in place of the file's
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true)]
    pub origin: Vec<f64>,
    /// Voxel-to-world map in place of the file's: a text or .npy file of 4 x 4 numbers
    #[arg(long, value_name = "FILE", conflicts_with_all = ["spacing", "origin"])]
    pub affine: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) limits: LimitOptions,
    /// No table on stdout
    #[arg(short, long)]
    pub quiet: bool,
}

impl MsvArgs {
    /// What the volume is read with.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range, [`CliError::Volume`] for the file of an affine.
    pub fn shape_options(&self) -> Result<ShapeOptions, CliError> {
        let limits = self.limits.reading();
        let placement = PlacementParameters {
            spacing: triple("--spacing", &self.spacing)?,
            origin: triple("--origin", &self.origin)?,
            affine: self.affine.as_deref().map(|path| read_affine(path, &limits)).transpose()?,
        };
        let pose = ReadOptions { limits, ..Default::default() };
        Ok(ShapeOptions { pose, placement, format: self.format.format, ..Default::default() })
    }

    /// Finds the regions of a volume.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range, [`CliError::Results`], [`CliError::Shape`],
    /// [`CliError::MemoryLimit`], [`CliError::TimeLimit`].
    pub fn find(&self, file: VolumeFile) -> Result<MsvResults, CliError> {
        let deadline = self.limits.deadline();
        let path = file.path;
        let body = |error| ResultsError::Body { path: path.clone(), error };
        let volume = file.loaded.grey(self.volume).map_err(body)?;
        volume.frame().map_err(|error| ResultsError::Placement { path: path.clone(), error })?;
        let [nx, ny, nz] = volume.dims();
        let searches = if self.regions.is_empty() { 2 } else { self.regions.len() };
        let bytes = VOXEL * searches as f64 * (nx as f64 * ny as f64 * nz as f64);
        self.limits.check_memory(&path, bytes, || format!("a search of {nx} x {ny} x {nz} voxels"))?;
        let parameters = MsvSearchParameters {
            contrasts: self.regions.clone(),
            delta: self.delta,
            msv: MsvParameters {
                min_area: self.min_area,
                max_area: self.max_area,
                max_variation: self.max_variation,
                min_diversity: self.min_diversity,
                ..MsvParameters::default()
            },
            connectivity: self.connectivity,
        };
        let found = MsvResults::find(&volume, &path.to_string_lossy(), &parameters);
        CliError::in_time(&deadline, &path)?;
        found.map_err(|error| match error {
            ResultsError::Tree(mser3d::comptree::TreeError::InvalidParameter(error)) => {
                CliError::Usage(format!("wrong parameter: {error}"))
            }
            ResultsError::Tree(error) => CliError::detection(&path, error.into()),
            error => error.into(),
        })
    }
}

pub(crate) fn run(args: &MsvArgs) -> Result<(), CliError> {
    let options = args.shape_options()?;
    let is_stdin = args.input == Path::new("-") || args.input == Path::new(STDIN);
    if options.volume_format(&args.input).is_none() {
        let name = args.input.display();
        let how = if is_stdin || options.format.is_some() { "; say which with --format" } else { "" };
        return Err(CliError::Usage(format!("{name}: a volume is one of {}{how}", VolumeFormat::LIST)));
    }
    let _watch = args.limits.watch(&args.input);
    let input = take_input(&args.input)?;
    let file = VolumeFile::read(&input, &options)?;
    let notes = file.loaded.notes.clone();
    let output = match &args.output {
        Some(folder) => folder.clone(),
        None => folder_beside(&input, &[MSV_RECORD])?,
    };
    let folder = ResultsFolder::create(&output)?;
    interrupt::take_away(folder.made());
    let found = args.find(file)?;
    folder.write_msv(&found)?;
    if args.quiet {
        return Ok(());
    }
    notes.iter().for_each(|note| tell(&format!("note: {}: {note}", args.input.display())));
    let line = |search: &mser3d_results::msv::MsvSearch| {
        format!("{} regions: {}\n", search.contrast, search.regions.len())
    };
    print(&found.record.searches.iter().map(line).collect::<String>())
}
