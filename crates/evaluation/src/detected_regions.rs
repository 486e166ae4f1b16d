use std::fmt::{Display, Write};
use std::fs;
use std::path::{Path, PathBuf};

use mser3d_shape::IndexSet;

use crate::EvaluationError;
use mser3d_fileio::write_text;

/// The regions that a detector found on one shape, whichever detector it was, and their descriptors.
///
/// In a folder it is two texts a shape. `NAME.regions` has one line per region: the numbers of its vertices, from 0,
/// separated by spaces. `NAME.descriptors`, which may be missing, has one line of numbers for each of these lines.
/// Lines that begin with `#` are comments; an empty line is an empty region. In SHREC's benchmarks `NAME` is a
/// [`ShapeName`](crate::shrec::ShapeName).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DetectedRegions {
    /// The regions.
    pub regions: Vec<IndexSet>,
    /// A descriptor of each region; empty if there are none.
    pub descriptors: Vec<Vec<f64>>,
}

impl DetectedRegions {
    /// Reads what was found on a shape with so many vertices.
    ///
    /// # Errors
    /// [`EvaluationError::Read`], [`EvaluationError::BadLine`] or [`EvaluationError::BadFile`], with the file.
    pub fn read(folder: &Path, name: impl Display, vertices: usize) -> Result<Self, EvaluationError> {
        let path = regions_path(folder, &name);
        let mut regions = Vec::new();
        for (line, members) in rows::<u32>(&path)? {
            let set = IndexSet::from_members(vertices, members);
            regions.push(set.map_err(|e| EvaluationError::BadLine {
                path: path.clone(),
                line,
                problem: e.to_string(),
            })?);
        }
        let path = descriptors_path(folder, name);
        if !path.exists() {
            return Ok(Self { regions, descriptors: Vec::new() });
        }
        let descriptors: Vec<Vec<f64>> = rows(&path)?.into_iter().map(|(_, row)| row).collect();
        if descriptors.len() != regions.len() {
            let problem = format!("{} descriptors for {} regions", descriptors.len(), regions.len());
            return Err(EvaluationError::BadFile { path, problem });
        }
        Ok(Self { regions, descriptors })
    }

    /// Whether a folder has what was found on a shape.
    pub fn is_in(folder: &Path, name: impl Display) -> bool {
        regions_path(folder, name).exists()
    }

    /// Writes it into a folder, the regions last.
    ///
    /// # Errors
    /// [`EvaluationError::Write`].
    pub fn write(&self, folder: &Path, name: impl Display) -> Result<(), EvaluationError> {
        let mut regions = String::new();
        for region in &self.regions {
            let members: Vec<String> = region.members().map(|v| v.to_string()).collect();
            // Writing to a String cannot fail.
            let _ = writeln!(regions, "{}", members.join(" "));
        }
        let mut descriptors = String::new();
        for row in &self.descriptors {
            let numbers: Vec<String> = row.iter().map(f64::to_string).collect();
            let _ = writeln!(descriptors, "{}", numbers.join(" "));
        }
        let path = descriptors_path(folder, &name);
        if !descriptors.is_empty() {
            write_text(&path, &descriptors)?;
        } else if path.exists() {
            // Of an earlier detection.
            fs::remove_file(&path).map_err(|source| EvaluationError::Write { path, source })?;
        }
        Ok(write_text(&regions_path(folder, name), &regions)?)
    }
}

fn regions_path(folder: &Path, name: impl Display) -> PathBuf {
    folder.join(format!("{name}.regions"))
}

fn descriptors_path(folder: &Path, name: impl Display) -> PathBuf {
    folder.join(format!("{name}.descriptors"))
}

/// The numbers of each line that is no comment, with the line's number.
fn rows<T: std::str::FromStr>(path: &Path) -> Result<Vec<(usize, Vec<T>)>, EvaluationError> {
    let text =
        fs::read_to_string(path).map_err(|source| EvaluationError::Read { path: path.into(), source })?;
    let mut rows = Vec::new();
    for (line, words) in text.lines().enumerate().filter(|(_, words)| !words.starts_with('#')) {
        let number = |word: &str| {
            let problem = format!("{word:?} is not a number that is wanted here");
            word.parse().map_err(|_| EvaluationError::BadLine { path: path.into(), line: line + 1, problem })
        };
        rows.push((line + 1, words.split_ascii_whitespace().map(number).collect::<Result<_, _>>()?));
    }
    Ok(rows)
}
