//! Command-line options that become [`VoxelizeParameters`].

use mser3d::shape::Connectivity;
use mser3d::voxelize::{InsideTest, Morphology, Overlap, Pitch, VoxelizeParameters};

use crate::choice::choice;
use crate::error::CliError;
use crate::limit_options::LimitOptions;
use crate::numbers::{count, positive};

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
    /// Edge of a voxel, in the input's units; of a volume, in place of its file's
    #[arg(long, value_name = "H", value_parser = positive, group = "size")]
    pitch: Option<f64>,
    /// Lengths of a voxel along the axes, in the input's units; of a volume, in place of its file's
    #[arg(long, value_name = "X,Y,Z", value_parser = positive, value_delimiter = ',', group = "size")]
    spacing: Vec<f64>,
    /// First corner of the grid, to share it with another tool [default: that of a grid around the body's middle]; of a
    /// volume, the centre of its first voxel, in place of its file's
    #[arg(long, value_name = "X,Y,Z", value_delimiter = ',', allow_hyphen_values = true)]
    origin: Vec<f64>,
    /// Neighbours of a voxel in the tree (the Laplacian has 6)
    #[arg(long, value_parser = choice::<Connectivity>(), default_value_t = Connectivity::default())]
    connectivity: Connectivity,
    /// How inside is told from outside
    #[arg(long, value_parser = choice::<InsideTest>(), default_value_t = InsideTest::default())]
    inside: InsideTest,
    /// What to do where the solid overlaps itself
    #[arg(long, value_parser = choice::<Overlap>(), default_value_t = Overlap::default())]
    overlap: Overlap,
    /// Link all neighbours, even where the surface runs between them
    #[arg(long)]
    no_cut_links: bool,
    /// Change the solid by a voxel, against artefacts of the mesh [default: none]
    #[arg(long, value_parser = choice::<Morphology>())]
    morphology: Option<Morphology>,
}

impl VoxelOptions {
    /// Distance of a volume's voxels.
    pub fn volume_spacing(&self) -> Result<Option<[f64; 3]>, CliError> {
        Ok(triple("--spacing", &self.spacing)?.or(self.pitch.map(|h| [h; 3])))
    }

    /// Centre of a volume's first voxel.
    pub fn volume_origin(&self) -> Result<Option<[f64; 3]>, CliError> {
        triple("--origin", &self.origin)
    }

    /// Neighbours of a voxel.
    pub fn connectivity(&self) -> Connectivity {
        self.connectivity
    }

    /// The first option that makes voxels of a mesh, which a volume has no use for.
    pub fn first_given(&self) -> Option<&'static str> {
        let options = [
            ("--voxels", self.voxels.is_some()),
            ("--resolution", self.resolution.is_some()),
            ("--inside", self.inside != InsideTest::default()),
            ("--overlap", self.overlap != Overlap::default()),
            ("--no-cut-links", self.no_cut_links),
            ("--morphology", self.morphology.is_some()),
        ];
        options.into_iter().find_map(|(name, given)| given.then_some(name))
    }

    /// The library's parameters.
    pub fn parameters(&self, limits: &LimitOptions) -> Result<VoxelizeParameters, CliError> {
        let defaults = VoxelizeParameters::default();
        let spacing = triple("--spacing", &self.spacing)?;
        let parameters = VoxelizeParameters {
            pitch: match (self.voxels, self.resolution, self.pitch, spacing) {
                (Some(n), ..) => Pitch::Voxels(n),
                (_, Some(n), ..) => Pitch::Resolution(n),
                (_, _, Some(h), _) => Pitch::Size(h),
                (.., Some(lengths)) => Pitch::Spacing(lengths),
                _ => defaults.pitch,
            },
            origin: triple("--origin", &self.origin)?,
            connectivity: self.connectivity,
            inside: self.inside,
            overlap: self.overlap,
            cut_links: !self.no_cut_links,
            morphology: self.morphology,
            max_box_voxels: limits.max_box_voxels,
            ..defaults
        };
        parameters.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(parameters)
    }
}

/// One number for each axis, or none at all.
pub fn triple(option: &str, numbers: &[f64]) -> Result<Option<[f64; 3]>, CliError> {
    match numbers {
        [] => Ok(None),
        &[x, y, z] => Ok(Some([x, y, z])),
        _ => Err(CliError::Usage(format!("{option} takes three numbers, X,Y,Z, not {}", numbers.len()))),
    }
}
