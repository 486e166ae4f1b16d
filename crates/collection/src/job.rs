use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::str::FromStr;

use mser3d::Parameters;
use mser3d_fileio::{ReadLimits, file_stem, read_bytes_within};
use mser3d_meshio::{AnimationInfo, MeshFormat, ReadOptions, list_animations};
use mser3d_results::{Checksums, ResultsError, ShapeFile, ShapeOptions, VolumeFile};
use mser3d_shape::InvalidParameter;
use mser3d_volumeio::{BodyParameters, LabelCount, VolumeFormat};

use crate::CollectionError;
use crate::folder::TABLES;
use crate::track::TRACK_FILES;

/// One shape of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The name of its result in the collection: unique, whatever the file system's case.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// How it is read: the frame of an animation, the label of a label map.
    pub options: ShapeOptions,
    /// Parameters of its own, in place of the detector's. Of most shapes none.
    pub parameters: Option<Box<Parameters>>,
}

impl Job {
    /// Reads the shape.
    ///
    /// # Errors
    /// As [`ShapeFile::read`].
    pub fn read(&self) -> Result<ShapeFile, ResultsError> {
        ShapeFile::read(&self.path, &self.options)
    }
}

/// Which frames of animated files become shapes.
#[derive(Clone, Debug, PartialEq)]
pub struct Frames {
    /// An animation, by name or number from 0.
    pub animation: String,
    /// Frames per second.
    pub rate: f64,
}

/// Parameters of [`plan`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanParameters {
    /// Make a shape of each of these frames of every file. Default: none, every file is a shape.
    pub frames: Option<Frames>,
    /// Make a shape of each label of every volume. Default: no.
    pub all_labels: bool,
    /// Look into the folders in a folder, too. Default: no.
    pub recursive: bool,
    /// How volumes are read. Meshes are read as they are, with the same limits.
    pub volumes: ShapeOptions,
}

/// What a batch is to do.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Plan {
    /// The shapes, in the order of their names.
    pub jobs: Vec<Job>,
    /// Labels that are too small to be searched.
    pub skipped: Vec<SkippedLabel>,
}

/// A label of less than [`LEAST_LABEL_VOXELS`].
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[non_exhaustive]
pub struct SkippedLabel {
    /// The label map.
    pub path: String,
    /// The volume of several that it is in.
    pub volume: usize,
    /// The label.
    pub label: i64,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Its voxels.
    pub voxels: u64,
}

/// Fewer voxels than a cube of 4 have no regions to speak of.
pub const LEAST_LABEL_VOXELS: u64 = 64;

/// The shapes that some inputs name, in the order of their names.
///
/// An input is a file; a folder, for all files of a known format in it, meshes and volumes; a pattern
/// such as `scans/*.ply`; or a list, a `.txt` file with one path a line, relative to its folder, in which the files must lie
/// unless the limits of reading allow others. With
/// `frames`, every file is animated and each frame is a shape; with `all_labels`, each label of a volume.
///
/// A shape is named after its file, without the ending; where that is not unique, with it, and where
/// that is not unique either, with the folders before it.
///
/// # Errors
/// [`CollectionError::Input`] when an input names nothing; [`CollectionError::Mesh`] for an animation
/// that cannot be read. A file of a list that is not there is left to fail on its own.
pub fn plan(inputs: &[PathBuf], parameters: &PlanParameters) -> Result<Plan, CollectionError> {
    let mut paths = Vec::new();
    for input in inputs {
        paths.extend(expand(input, parameters.recursive, parameters.volumes.limits())?);
    }
    let mut seen = HashSet::new();
    paths.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    let mut plan = Plan::default();
    for (path, name) in paths.iter().zip(names(&paths)) {
        let is_volume = parameters.volumes.volume_format(path).is_some();
        let options = if is_volume { parameters.volumes.clone() } else { parameters.volumes.limits_alone() };
        let job = Job { name, path: path.clone(), options, parameters: None };
        match &parameters.frames {
            Some(frames) => plan.jobs.extend(frames_of(&job, frames)?),
            None if is_volume && parameters.all_labels => plan.add_labels(job),
            None => plan.jobs.push(job),
        }
    }
    plan.jobs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(plan)
}

impl Plan {
    /// A job for each label of the volume. A file that cannot be read is left to fail on its own.
    fn add_labels(&mut self, file: Job) {
        let Ok(volume) = VolumeFile::read(&file.path, &file.options) else {
            self.jobs.push(file);
            return;
        };
        let chosen = file.options.body.volume;
        let Ok(labels) = volume.labels(chosen) else {
            self.jobs.push(file);
            return;
        };
        for label in labels {
            let LabelCount { value, volume, voxels, name, .. } = label;
            if voxels < LEAST_LABEL_VOXELS {
                let path = file.path.display().to_string();
                self.skipped.push(SkippedLabel { path, volume, label: value, name, voxels });
                continue;
            }
            let layer = if chosen.is_none() && volume > 0 { format!("-{volume}") } else { String::new() };
            let called = name.map_or(String::new(), |name| format!("-{}", plain(&name)));
            let mut job = file.clone();
            job.name = format!("{}{layer}-{value:03}{called}", file.name);
            job.options.body = BodyParameters { volume: Some(volume), ..BodyParameters::of_label(value) };
            self.jobs.push(job);
        }
    }
}

pub(crate) fn expand(
    path: &Path,
    recursive: bool,
    limits: &ReadLimits,
) -> Result<Vec<PathBuf>, CollectionError> {
    let fail = |problem: String| CollectionError::Input { input: path.display().to_string(), problem };
    let found = if path.is_dir() {
        let files = files_in(path, recursive)?;
        if files.is_empty() {
            let deeper = if recursive { "" } else { "; look into its folders with --recursive" };
            return Err(fail(format!("no meshes and no volumes in this folder{deeper}")));
        }
        files
    } else if path.is_file() && has_extension(path, "txt") {
        let bytes = read_bytes_within(path, limits, 1)?;
        let text = String::from_utf8(bytes).map_err(|_| fail("the list is no text in UTF-8".into()))?;
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
        // A list stands for arguments, so it may name files anywhere.
        let folder = path.parent().unwrap_or(Path::new(""));
        let files: Vec<PathBuf> = lines.map(|line| folder.join(line)).collect();
        if files.is_empty() {
            return Err(fail("the list is empty; write one path a line".into()));
        }
        files
    } else if path.exists() {
        vec![path.to_owned()]
    } else if let Some(pattern) = path.to_str().filter(|text| text.contains(['*', '?', '['])) {
        let matches = glob::glob(pattern).map_err(|e| fail(format!("not a pattern: {e}")))?;
        // A folder that cannot be read holds nothing for us.
        let files: Vec<PathBuf> = matches.flatten().filter(|file| is_shape(file)).collect();
        if files.is_empty() {
            return Err(fail("no shapes match this pattern".into()));
        }
        files
    } else {
        return Err(fail("there is no such file or folder".into()));
    };
    Ok(found)
}

/// The shapes in a folder, by name; those in its folders after it.
fn files_in(folder: &Path, recursive: bool) -> Result<Vec<PathBuf>, CollectionError> {
    let entries = std::fs::read_dir(folder).map_err(CollectionError::io(folder))?;
    let paths = entries.map(|e| Ok(e.map_err(CollectionError::io(folder))?.path()));
    let mut paths = paths.collect::<Result<Vec<_>, CollectionError>>()?;
    paths.sort();
    let mut files: Vec<PathBuf> = paths.iter().filter(|path| is_shape(path)).cloned().collect();
    // Header and data of a pair are one volume.
    files.retain(|file| !has_extension(file, "img") || !file.with_extension("hdr").is_file());
    // Links could lead in circles.
    let is_folder = |path: &&PathBuf| path.is_dir() && !path.is_symlink() && !is_hidden(path);
    for inner in paths.iter().filter(is_folder).filter(|_| recursive) {
        files.extend(files_in(inner, recursive)?);
    }
    Ok(files)
}

fn is_shape(path: &Path) -> bool {
    let known = MeshFormat::from_extension(path).is_some() || VolumeFormat::of(path).is_some();
    path.is_file() && !is_hidden(path) && known
}

fn is_hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn frames_of(file: &Job, frames: &Frames) -> Result<Vec<Job>, CollectionError> {
    let animation = find_animation(&file.path, Some(&frames.animation), file.options.limits())?;
    let times = animation.frame_times(frames.rate)?;
    Ok(jobs_at(file, &frames.animation, animation.index, times))
}

/// A job for each of these times of an animation.
pub(crate) fn jobs_at(file: &Job, named: &str, animation: usize, times: Vec<f64>) -> Vec<Job> {
    let job = |(number, time): (usize, f64)| Job {
        name: format!("{}-{}-{number:04}", file.name, plain(named)),
        options: ShapeOptions {
            pose: ReadOptions {
                animation: Some(animation.to_string()),
                time,
                limits: file.options.limits().clone(),
            },
            ..file.options.clone()
        },
        ..file.clone()
    };
    times.into_iter().enumerate().map(job).collect()
}

/// The animation of a file with this name or number; if none is named, the only one.
pub(crate) fn find_animation(
    path: &Path,
    named: Option<&str>,
    limits: &ReadLimits,
) -> Result<AnimationInfo, CollectionError> {
    let mut animations = list_animations(path, limits)?;
    let is_wanted = |a: &AnimationInfo| match named {
        Some(named) => a.name.as_deref() == Some(named) || a.index.to_string() == named,
        None => true,
    };
    let there = || match animations.len() {
        0 => "it has none".to_owned(),
        _ => format!("it has {}", animations.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")),
    };
    let problem = match named {
        Some(named) => format!("there is no animation {named:?}: {}", there()),
        None if animations.len() > 1 => format!("choose an animation with --animation: {}", there()),
        None => "it has no animation, so it is no sequence; give an animated glTF file, or several files"
            .to_owned(),
    };
    let found = animations.iter().position(is_wanted).filter(|_| named.is_some() || animations.len() == 1);
    match found {
        Some(at) => Ok(animations.swap_remove(at)),
        None => Err(CollectionError::Input { input: path.display().to_string(), problem }),
    }
}

/// A name for each path: as few of its last parts as tell it from the others, and from the files of a collection.
pub(crate) fn names(paths: &[PathBuf]) -> Vec<String> {
    let candidate = |path: &Path, level: usize| {
        let own = if level == 0 {
            file_stem(path)
        } else {
            path.file_name().unwrap_or_default().to_string_lossy().into_owned()
        };
        let mut name = plain(&own);
        for folder in path.ancestors().skip(1).filter_map(Path::file_name).take(level.saturating_sub(1)) {
            name = format!("{}-{name}", plain(&folder.to_string_lossy()));
        }
        name
    };
    let depth = paths.iter().map(|p| p.components().count()).max().unwrap_or(0);
    let files =
        || TABLES.iter().chain(&TRACK_FILES).chain([&Checksums::FILE]).map(|name| name.to_lowercase());
    let mut levels = vec![0; paths.len()];
    let mut names: Vec<String> = paths.iter().map(|p| candidate(p, 0)).collect();
    for _ in 0..=depth {
        let mut uses: HashMap<String, usize> = files().map(|name| (name, 1)).collect();
        names.iter().for_each(|name| *uses.entry(name.to_lowercase()).or_default() += 1);
        for number in 0..paths.len() {
            if uses[&names[number].to_lowercase()] > 1 {
                levels[number] += 1;
                names[number] = candidate(&paths[number], levels[number]);
            }
        }
    }
    // Paths such as a/x.off and ../a/x.off may still share a name.
    let mut taken: HashSet<String> = files().collect();
    for name in &mut names {
        let first = name.clone();
        let mut number = 2;
        while !taken.insert(name.to_lowercase()) {
            *name = format!("{first}-{number}");
            number += 1;
        }
    }
    names
}

/// A part of a path as a folder's name: not hidden, without separators.
pub(crate) fn plain(part: &str) -> String {
    let name: String =
        part.chars().map(|c| if c == '/' || c == '\\' || c.is_control() { '_' } else { c }).collect();
    match name.strip_prefix('.') {
        Some(rest) => format!("_{rest}"),
        None if name.is_empty() => "shape".to_owned(),
        None => name,
    }
}

/// One part of a batch, for job arrays: of the shapes in order, every `count`-th from the
/// `number`-th on.
///
/// ```
/// use mser3d_collection::Shard;
/// let shard: Shard = "2/3".parse()?;
/// assert_eq!(shard.of(vec!["a", "b", "c", "d", "e"]), ["b", "e"]);
/// assert!("4/3".parse::<Shard>().is_err());
/// # Ok::<(), mser3d_shape::InvalidParameter>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    count: usize,
}

impl Shard {
    /// Shard `number` (from 1) of `count`.
    ///
    /// # Errors
    /// [`InvalidParameter`].
    pub fn new(number: usize, count: usize) -> Result<Self, InvalidParameter> {
        let value = format!("{number}/{count}");
        InvalidParameter::unless(number > 0 && number <= count, "shard", value, "I/N with I from 1 to N")?;
        Ok(Self { number, count })
    }

    /// Its part of a list.
    pub fn of<T>(self, all: Vec<T>) -> Vec<T> {
        all.into_iter().skip(self.number - 1).step_by(self.count).collect()
    }
}

impl FromStr for Shard {
    type Err = InvalidParameter;

    fn from_str(text: &str) -> Result<Self, InvalidParameter> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        // 0/0 is out of range and gives the message.
        let (number, count) = parts.unwrap_or((0, 0));
        let message = |_| InvalidParameter::new("shard", text, "I/N with I from 1 to N, such as 1/8");
        Self::new(number, count).map_err(message)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(paths: &[&str]) -> Vec<String> {
        names(&paths.iter().map(PathBuf::from).collect::<Vec<_>>())
    }

    #[test]
    fn names_are_short_unique_and_visible() {
        assert_eq!(named(&["a/x.off", "a/y.off"]), ["x", "y"]);
        assert_eq!(named(&["a/x.off", "a/x.obj", "z.ply"]), ["x.off", "x.obj", "z"]);
        assert_eq!(named(&["p/a/x.off", "p/b/X.off"]), ["a-x.off", "b-X.off"]);
        assert_eq!(named(&["x.off", "../x.off"]), ["x.off", "x.off-2"]);
        assert_eq!(named(&["a/.off", ".."]), ["_off", "shape"]);
        assert_eq!(named(&["a/ct.nii.gz", "b.seg.nrrd"]), ["ct", "b.seg"]);
    }

    #[test]
    fn no_result_takes_the_name_of_a_table() {
        let files = ["regions.parquet.off", "Shapes.PARQUET.obj", "failures.json.off", "tracks.json.off"];
        assert_eq!(named(&files), files);
        for (table, path) in TABLES.iter().chain(&TRACK_FILES).map(|table| (table, format!("a/{table}.off")))
        {
            assert_eq!(named(&[&path]), [format!("{table}.off")]);
        }
        // Whatever the tables are called, a file without an ending may be called so too.
        assert_eq!(named(&["labels.csv"]), ["labels"]);
        assert_eq!(
            named(&["x/labels.csv.off", "y/labels.csv.off"]),
            ["x-labels.csv.off", "y-labels.csv.off"]
        );
    }

    #[test]
    fn folders_patterns_and_lists_name_the_same_shapes_once() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.off", "a.obj", "notes.md", ".hidden.off", "mask.npy"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let list = folder.path().join("list.txt");
        std::fs::write(&list, "b.off\n\nmissing.stl\r\n").unwrap();
        let inputs = [folder.path().to_owned(), folder.path().join("*.o*"), list];
        let jobs = plan(&inputs, &PlanParameters::default()).unwrap().jobs;
        let names: Vec<&str> = jobs.iter().map(|j| j.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "mask", "missing"]);
    }

    #[test]
    fn inputs_that_name_nothing_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        for (input, problem) in [
            (folder.path().to_owned(), "no meshes and no volumes in this folder"),
            (folder.path().join("*.off"), "no shapes match"),
            (folder.path().join("x.off"), "no such file"),
        ] {
            let error = plan(&[input], &PlanParameters::default()).unwrap_err().to_string();
            assert!(error.contains(problem), "{error}");
        }
    }

    #[test]
    fn shards_share_out_everything_once() {
        let all: Vec<usize> = (0..10).collect();
        let mut parts: Vec<usize> = (1..=4).flat_map(|i| Shard::new(i, 4).unwrap().of(all.clone())).collect();
        parts.sort_unstable();
        assert_eq!(parts, all);
        for bad in ["0/4", "5/4", "1", "a/b", "1/0", "-1/2"] {
            assert!(bad.parse::<Shard>().unwrap_err().to_string().contains("1/8"), "{bad}");
        }
    }
}
