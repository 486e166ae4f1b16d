//! What an evaluation is of.

use std::path::PathBuf;

/// What `cargo xtask shrec11` can be told.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("source").required(true).args(["data", "synthesize"]))]
pub struct Arguments {
    /// Folder of the benchmark: NNNN.CLASS.STRENGTH.off and corr/
    #[arg(long, value_name = "DIR")]
    pub(super) data: Option<PathBuf>,
    /// Make a benchmark from this closed mesh instead
    #[arg(long, value_name = "MESH")]
    pub(super) synthesize: Option<PathBuf>,
    /// Poses of the mesh for the isometry class, up to five, from the weakest
    #[arg(long, value_name = "MESH", num_args = 1.., requires = "synthesize")]
    pub(super) poses: Vec<PathBuf>,
    /// Left-right symmetry of the mesh: line i holds the number of vertex i's mirror vertex
    #[arg(long, value_name = "FILE", requires = "synthesize")]
    pub(super) symmetry: Option<PathBuf>,
    /// Seed of the random transforms
    #[arg(long, default_value_t = 1, requires = "synthesize")]
    pub(super) seed: u64,
    /// Only these classes
    #[arg(long, value_name = "CLASS", num_args = 1..)]
    pub(super) classes: Vec<String>,
    /// Only these strengths, 1 to 5
    #[arg(long, value_name = "STRENGTH", num_args = 1.., value_parser = clap::value_parser!(u32).range(1..=5))]
    pub(super) strengths: Vec<u32>,
    /// Only these of our detectors
    #[arg(long, value_name = "NAME", num_args = 1..)]
    pub(super) detectors: Vec<String>,
    /// Voxels of a null shape; its transforms get the same pitch
    #[arg(long, default_value_t = 45_000)]
    pub(super) voxels: usize,
    /// Eigenpairs of each solid and surface
    #[arg(long, default_value_t = 100)]
    pub(super) eigenpairs: usize,
    /// Folders of .regions files by other detectors, which are scored too
    #[arg(long, value_name = "DIR", num_args = 1..)]
    pub(super) detections: Vec<PathBuf>,
    /// Folder for the results. What an interrupted run left there is used
    #[arg(short, long, value_name = "DIR")]
    pub(super) output: PathBuf,
}

impl Arguments {
    /// Whether transforms of a class and strength are asked for.
    pub(super) fn wants(&self, class: &str, strength: u32) -> bool {
        (self.classes.is_empty() || self.classes.iter().any(|c| c == class))
            && (self.strengths.is_empty() || self.strengths.contains(&strength))
    }
}
