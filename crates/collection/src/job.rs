use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use mser3d_meshio::{AnimationInfo, MeshFormat, ReadOptions, list_animations};
use mser3d_results::{ResultsError, ShapeFile};
use mser3d_shape::InvalidParameter;

use crate::CollectionError;

/// One shape of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    /// The name of its result in the collection: unique, whatever the file system's case.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// The glTF animation that poses it.
    pub animation: Option<String>,
    /// When in the animation, in seconds.
    pub time: f64,
}

impl Job {
    /// Reads the shape.
    ///
    /// # Errors
    /// As [`ShapeFile::read`].
    pub fn read(&self) -> Result<ShapeFile, ResultsError> {
        let pose = ReadOptions { animation: self.animation.clone(), time: self.time };
        ShapeFile::read(&self.path, &pose)
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

/// The shapes that some inputs name, in the order of their names.
///
/// An input is a file; a folder, for all files of a known format in it (`.npy` masks too); a pattern
/// such as `scans/*.ply`; or a list, a `.txt` file with one path a line, relative to its folder. With
/// `frames`, every file is animated and each frame is a shape.
///
/// A shape is named after its file, without the ending; where that is not unique, with it, and where
/// that is not unique either, with the folders before it.
///
/// # Errors
/// [`CollectionError::Input`] when an input names nothing; [`CollectionError::Mesh`] for an animation
/// that cannot be read. A file of a list that is not there is left to fail on its own.
pub fn plan(inputs: &[PathBuf], frames: Option<&Frames>) -> Result<Vec<Job>, CollectionError> {
    let mut paths = Vec::new();
    for input in inputs {
        paths.extend(expand(input)?);
    }
    let mut seen = std::collections::HashSet::new();
    paths.retain(|path| seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())));
    let mut jobs = Vec::new();
    for (path, name) in paths.iter().zip(names(&paths)) {
        match frames {
            None => jobs.push(Job { name, path: path.clone(), animation: None, time: 0.0 }),
            Some(frames) => jobs.extend(frames_of(path, &name, frames)?),
        }
    }
    jobs.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(jobs)
}

fn expand(path: &Path) -> Result<Vec<PathBuf>, CollectionError> {
    let fail = |problem: String| CollectionError::Input { input: path.display().to_string(), problem };
    let found = if path.is_dir() {
        let entries = std::fs::read_dir(path).map_err(CollectionError::io(path))?;
        let files = entries.map(|e| Ok(e.map_err(CollectionError::io(path))?.path()));
        let mut files = files.collect::<Result<Vec<_>, CollectionError>>()?;
        files.retain(|file| is_shape(file));
        files.sort();
        if files.is_empty() {
            return Err(fail("no shapes in this folder (.obj .gltf .glb .off .ply .stl .npy)".into()));
        }
        files
    } else if path.is_file() && has_extension(path, "txt") {
        let text = std::fs::read_to_string(path).map_err(CollectionError::io(path))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
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

fn is_shape(path: &Path) -> bool {
    let hidden = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    path.is_file() && !hidden && (MeshFormat::from_extension(path).is_some() || has_extension(path, "npy"))
}

fn has_extension(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension))
}

fn frames_of(path: &Path, name: &str, frames: &Frames) -> Result<Vec<Job>, CollectionError> {
    let animations = list_animations(path)?;
    let is_wanted = |a: &&AnimationInfo| {
        a.name.as_ref() == Some(&frames.animation) || a.index.to_string() == frames.animation
    };
    let Some(animation) = animations.iter().find(is_wanted) else {
        let there = match animations.len() {
            0 => "it has none".to_owned(),
            _ => format!(
                "it has {}",
                animations.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
            ),
        };
        let problem = format!("there is no animation {:?}: {there}", frames.animation);
        return Err(CollectionError::Input { input: path.display().to_string(), problem });
    };
    let times = animation.frame_times(frames.rate)?;
    let job = |(number, time): (usize, f64)| Job {
        name: format!("{name}-{}-{number:04}", plain(&frames.animation)),
        path: path.to_owned(),
        animation: Some(animation.index.to_string()),
        time,
    };
    Ok(times.into_iter().enumerate().map(job).collect())
}

/// A name for each path: as few of its last parts as tell it from the others.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let candidate = |path: &Path, level: usize| {
        let stem = if level == 0 { path.file_stem() } else { path.file_name() };
        let mut name = plain(&stem.unwrap_or_default().to_string_lossy());
        for folder in path.ancestors().skip(1).filter_map(Path::file_name).take(level.saturating_sub(1)) {
            name = format!("{}-{name}", plain(&folder.to_string_lossy()));
        }
        name
    };
    let depth = paths.iter().map(|p| p.components().count()).max().unwrap_or(0);
    let mut levels = vec![0; paths.len()];
    let mut names: Vec<String> = paths.iter().map(|p| candidate(p, 0)).collect();
    for _ in 0..=depth {
        let mut uses: HashMap<String, usize> = HashMap::new();
        names.iter().for_each(|name| *uses.entry(name.to_lowercase()).or_default() += 1);
        for number in 0..paths.len() {
            if uses[&names[number].to_lowercase()] > 1 {
                levels[number] += 1;
                names[number] = candidate(&paths[number], levels[number]);
            }
        }
    }
    // Paths such as a/x.off and ../a/x.off may still share a name.
    let mut taken = std::collections::HashSet::new();
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
fn plain(part: &str) -> String {
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
        let jobs = plan(&inputs, None).unwrap();
        let names: Vec<&str> = jobs.iter().map(|j| j.name.as_str()).collect();
        assert_eq!(names, ["a", "b", "mask", "missing"]);
    }

    #[test]
    fn inputs_that_name_nothing_are_errors() {
        let folder = tempfile::tempdir().unwrap();
        for (input, problem) in [
            (folder.path().to_owned(), "no shapes in this folder"),
            (folder.path().join("*.off"), "no shapes match"),
            (folder.path().join("x.off"), "no such file"),
        ] {
            let error = plan(&[input], None).unwrap_err().to_string();
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
