//! `cargo xtask interop`: what mser3d writes, opened by each format's own library; and volumes, masks and label maps
//! that those libraries write, read by mser3d.
//!
//! The libraries come from PyPI and npm, in the versions of `xtask/interop`, into `target/interop`; the
//! checks are in `check.py`, `volumes.py`, `label_maps.py` and `validate.cjs` there. A library that cannot be had is skipped, and said
//! so.

mod libraries;

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use crate::command::{example, mser3d, output, program};
use libraries::{Libraries, TOOLS};

/// Frames of the sequence.
const FRAMES: &str = "9";

/// A library that takes longer for a few megabytes hangs.
const CHECK: Duration = Duration::from_secs(300);

#[derive(clap::Args)]
pub struct Arguments {
    /// Fail when a library is missing, instead of skipping it
    #[arg(long)]
    require: bool,
    /// Voxels of the figures
    #[arg(long, default_value_t = 20_000)]
    voxels: usize,
}

/// A library, and the formats that are opened with it.
struct Check {
    library: &'static str,
    formats: &'static str,
    /// What it needs from PyPI; the glTF validator is from npm.
    packages: &'static [&'static str],
}

const PYTHON: [Check; 7] = [
    Check { library: "csv", formats: "CSV", packages: &[] },
    Check { library: "numpy", formats: "NPZ", packages: &["numpy"] },
    Check { library: "plyfile", formats: "PLY", packages: &["numpy", "plyfile"] },
    Check { library: "trimesh", formats: "PLY, GLB", packages: &["numpy", "trimesh"] },
    Check { library: "vtk", formats: "VTP, VTI, PLY", packages: &["numpy", "vtk"] },
    Check { library: "pyarrow", formats: "Parquet", packages: &["numpy", "pyarrow"] },
    Check { library: "pillow", formats: "animated PNG", packages: &["pillow"] },
];

/// What writes random volumes and reads them again, with what that needs.
const VOLUMES: [&str; 9] = [
    "numpy",
    "nibabel",
    "pynrrd",
    "tifffile",
    "imagecodecs",
    "SimpleITK",
    "packaging",
    "importlib_resources",
    "typing_extensions",
];

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::path::absolute("target/interop")?;
    let files = folder.join("files");
    write_files(&files, arguments.voxels)?;
    let libraries = Libraries::set_up(&folder)?;
    let mut counts = Counts::default();
    for check in &PYTHON {
        let outcome = match libraries.python(check.packages) {
            Err(missing) => Outcome::Skipped(missing),
            Ok(python) => {
                let mut command = Command::new(python);
                command.arg(tools("check.py")).arg(check.library).arg(figure("rest")).arg(&files);
                Outcome::of(output(&mut command, CHECK))
            }
        };
        counts.add(check.library, check.formats, outcome);
    }
    let outcome = match libraries.python(&VOLUMES) {
        Err(missing) => Outcome::Skipped(missing),
        Ok(python) => Outcome::of(volumes(python, &folder.join("volumes"))),
    };
    counts.add("nibabel, pynrrd, tifffile, SimpleITK", "volumes", outcome);
    let outcome = match libraries.python(&["numpy", "nibabel", "vtk", "packaging", "typing_extensions"]) {
        Err(missing) => Outcome::Skipped(missing),
        Ok(python) => Outcome::of(label_maps(python, &folder.join("label_maps"))),
    };
    counts.add("nibabel, VTK", "masks and label maps", outcome);
    let outcome = match libraries.node() {
        Err(missing) => Outcome::Skipped(missing),
        Ok(mut node) => Outcome::of(validate(&mut node, &files)),
    };
    counts.add("gltf-validator", "GLB", outcome);
    println!("interop: {} passed, {} failed, {} skipped", counts.passed, counts.failed, counts.skipped);
    if counts.failed > 0 {
        return Err("what was written is not what the format's own library reads".into());
    }
    if arguments.require && counts.skipped > 0 {
        return Err("a library is missing, and --require asks for all".into());
    }
    Ok(())
}

/// Every format that mser3d writes, of two poses of a figure, and of one in motion.
fn write_files(files: &Path, voxels: usize) -> Result<(), String> {
    if files.exists() {
        std::fs::remove_dir_all(files).map_err(|e| format!("{}: {e}", files.display()))?;
    }
    let at = |name: &str| files.join(name).display().to_string();
    let (rest, kick) = (figure("rest").display().to_string(), figure("kick").display().to_string());
    let voxels = voxels.to_string();
    mser3d(&["detect", &rest, "-o", &at("rest"), "--voxels", &voxels, "--quiet"])?;
    mser3d(&["detect", &kick, "-o", &at("kick"), "--voxels", &voxels, "--quiet"])?;
    mser3d(&["export", &at("rest"), "-o", &at("rest.glb")])?;
    mser3d(&["export", &at("rest"), "-o", &at("rest.vtp")])?;
    mser3d(&["match", &at("rest"), &at("kick"), "-o", &at("match"), "--same-vertices"])?;
    mser3d(&["batch", &rest, &kick, "-o", &at("all"), "--voxels", &voxels, "--quiet"])?;
    let moving = Path::new("fixtures/human.glb").display().to_string();
    let what = ["--frames", FRAMES, "--glb", "--pictures", "--quiet"];
    mser3d(&[&["track", &moving, "-o", &at("track"), "--voxels", &voxels], &what[..]].concat())
}

/// A thousand random volumes through each library, mser3d and back.
fn volumes(python: &Path, folder: &Path) -> Result<String, String> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let convert = example("mser3d-volumeio", "convert")?;
    let mut command = Command::new(python);
    command.args(["-W", "ignore"]).arg(tools("volumes.py")).arg(convert).arg(folder);
    output(&mut command, CHECK)
}

/// Masks in all orientations and label maps, through the program; a real one where the shared data are.
fn label_maps(python: &Path, folder: &Path) -> Result<String, String> {
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    }
    let mut command = Command::new(python);
    command.args(["-W", "ignore"]).arg(tools("label_maps.py")).arg(program()?).arg(folder);
    let real = Path::new("../shared/data/segmentation/example_seg.nii.gz");
    output(if real.exists() { command.arg(real) } else { &mut command }, CHECK)
}

fn validate(node: &mut Command, files: &Path) -> Result<String, String> {
    let off = std::fs::read_to_string(figure("rest")).map_err(|e| e.to_string())?;
    let mut counts = off.split_whitespace().skip(1);
    let (vertices, triangles) = (counts.next().unwrap_or_default(), counts.next().unwrap_or_default());
    node.arg(tools("validate.cjs")).args([vertices, triangles]);
    output(node.arg(files.join("rest.glb")).arg(files.join("track/tracks.glb")), CHECK)
}

fn figure(pose: &str) -> PathBuf {
    Path::new("fixtures").join(format!("human_{pose}.off"))
}

fn tools(name: &str) -> PathBuf {
    Path::new(TOOLS).join(name)
}

enum Outcome {
    Passed(String),
    Failed(String),
    Skipped(String),
}

impl Outcome {
    fn of(result: Result<String, String>) -> Self {
        match result {
            Ok(text) => Self::Passed(text.trim().to_owned()),
            Err(error) => Self::Failed(error),
        }
    }
}

#[derive(Default)]
struct Counts {
    passed: usize,
    failed: usize,
    skipped: usize,
}

impl Counts {
    fn add(&mut self, library: &str, formats: &str, outcome: Outcome) {
        let (count, word, text) = match outcome {
            Outcome::Passed(text) => (&mut self.passed, "ok", text),
            Outcome::Failed(text) => (&mut self.failed, "FAILED", text),
            Outcome::Skipped(text) => (&mut self.skipped, "skipped", text),
        };
        *count += 1;
        println!("{word}: {formats} by {library}: {text}");
    }
}
