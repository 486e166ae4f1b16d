//! Command-line options that become [`VoxelizeParameters`].

use mser3d::shape::Connectivity;
use mser3d::voxelize::{Method, Morphology, Overlap, Pitch, VoxelizeParameters};

use crate::error::CliError;
use crate::options::{ConnectivityArg, MethodArg, OverlapArg, count, positive};

/// How a mesh becomes voxels.
#[derive(clap::Args, Clone, Debug)]
#[command(next_help_heading = "Voxels")]
pub struct VoxelOptions {
    /// Voxels in the solid, about [default: 45000]
    #[arg(long, value_name = "N", value_parser = count, group = "size")]
    voxels: Option<usize>,
    /// Voxels on the longest axis
    #[arg(long, value_name = "N", value_parser = count, group = "size")]
    resolution: Option<usize>,
    /// Edge of a voxel, in the input's units (of a .npy mask: 1 by default)
    #[arg(long, value_name = "H", value_parser = positive, group = "size")]
    pitch: Option<f64>,
    /// Lengths of a voxel along the axes, in the input's units
    #[arg(long, value_name = "X,Y,Z", value_parser = positive, value_delimiter = ',', group = "size")]
    spacing: Vec<f64>,
    /// First corner of the grid, to share it with another tool [default: a voxel below the lowest coordinates]
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true)]
    origin: Vec<f64>,
    /// Neighbours of a voxel in the tree (the Laplacian has 6)
    #[arg(long, value_enum, default_value_t = ConnectivityArg::Six)]
    connectivity: ConnectivityArg,
    /// How inside is told from outside
    #[arg(long, value_enum, default_value_t = MethodArg::Auto)]
    inside: MethodArg,
    /// What to do where the solid overlaps itself
    #[arg(long, value_enum, default_value_t = OverlapArg::Auto)]
    overlap: OverlapArg,
    /// Link all neighbours, even where the surface runs between them
    #[arg(long)]
    no_cut_links: bool,
    /// Drop what is thinner than three voxels: erode by a voxel, then dilate
    #[arg(long, conflicts_with = "close")]
    open: bool,
    /// Fill slits and pits a voxel wide: dilate by a voxel, then erode
    #[arg(long)]
    close: bool,
    /// Refuse boxes of more voxels than this; a grid takes half a byte for each
    #[arg(long, value_name = "N", default_value_t = VoxelizeParameters::default().max_box_voxels)]
    max_box_voxels: u64,
}

impl VoxelOptions {
    /// Edge of a voxel, if it was given.
    pub fn pitch(&self) -> Option<f64> {
        self.pitch
    }

    /// The first option that makes voxels of a mesh, which a mask or a surface has no use for.
    pub fn first_given(&self) -> Option<&'static str> {
        let options = [
            ("--voxels", self.voxels.is_some()),
            ("--resolution", self.resolution.is_some()),
            ("--spacing", !self.spacing.is_empty()),
            ("--origin", !self.origin.is_empty()),
            ("--inside", self.inside != MethodArg::Auto),
            ("--overlap", self.overlap != OverlapArg::Auto),
            ("--no-cut-links", self.no_cut_links),
            ("--open", self.open),
            ("--close", self.close),
        ];
        options.into_iter().find_map(|(name, given)| given.then_some(name))
    }

    /// The library's parameters.
    pub fn parameters(&self) -> Result<VoxelizeParameters, CliError> {
        let mut p = VoxelizeParameters::default();
        let spacing = triple("--spacing", &self.spacing)?;
        p.pitch = match (self.voxels, self.resolution, self.pitch, spacing) {
            (Some(n), ..) => Pitch::Voxels(n),
            (_, Some(n), ..) => Pitch::Resolution(n),
            (_, _, Some(h), _) => Pitch::Size(h),
            (.., Some(lengths)) => Pitch::Spacing(lengths),
            _ => p.pitch,
        };
        p.origin = triple("--origin", &self.origin)?;
        p.connectivity = match self.connectivity {
            ConnectivityArg::Six => Connectivity::Six,
            ConnectivityArg::TwentySix => Connectivity::TwentySix,
        };
        p.method = match self.inside {
            MethodArg::Auto => Method::Auto,
            MethodArg::Parity => Method::Parity,
            MethodArg::Vote => Method::Vote,
            MethodArg::Winding => Method::Winding,
        };
        p.overlap = match self.overlap {
            OverlapArg::Auto => Overlap::Auto,
            OverlapArg::Part => Overlap::Part,
            OverlapArg::Join => Overlap::Join,
        };
        p.cut_links = !self.no_cut_links;
        p.morphology = match (self.open, self.close) {
            (true, _) => Some(Morphology::Open),
            (_, true) => Some(Morphology::Close),
            _ => None,
        };
        p.max_box_voxels = self.max_box_voxels;
        p.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(p)
    }
}

/// One number for each axis, or none at all.
fn triple(option: &str, numbers: &[f64]) -> Result<Option<[f64; 3]>, CliError> {
    match numbers {
        [] => Ok(None),
        &[x, y, z] => Ok(Some([x, y, z])),
        _ => Err(CliError::Usage(format!("{option} takes three numbers, X,Y,Z, not {}", numbers.len()))),
    }
}
