//! Names of labels from a table beside the label map.
use crate::error::Fault;
use crate::{LoadedVolume, Segment, VolumeIoError};
use mser3d_fileio::{ReadLimits, read_bytes_within};
use std::path::Path;

/// A label and its name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelName {
    /// The label.
    pub value: i64,
    /// What it stands for.
    pub name: String,
}

impl LoadedVolume {
    /// The same volume with these names of labels, in all layers, in place of the file's own.
    #[must_use]
    pub fn with_label_names(mut self, names: &[LabelName]) -> Self {
        if !names.is_empty() {
            let layers = 0..self.volume.channels();
            let in_layer =
                |layer| names.iter().map(move |n| Segment { value: n.value, layer, name: n.name.clone() });
            self.segments = layers.flat_map(in_layer).collect();
        }
        self
    }
}

/// Reads a table of labels: a line each, with the label's number and its name.
///
/// Fields are parted by commas, semicolons or tabs, or by spaces; the first that is a whole number is the label, the
/// first that is no number its name. So CSV files with or without a header are read, and the tables of FreeSurfer, 3D
/// Slicer (`.ctbl`) and ITK-SNAP. Lines that begin with `#` are remarks.
///
/// # Errors
/// [`VolumeIoError::File`]; [`VolumeIoError::Invalid`] for a line without a label or name, for a label that is there
/// twice, and for no label at all.
pub fn read_label_names(path: &Path, limits: &ReadLimits) -> Result<Vec<LabelName>, VolumeIoError> {
    let bytes = read_bytes_within(path, limits, 8)?;
    parse(&String::from_utf8_lossy(&bytes)).map_err(|fault| fault.in_file(path))
}

fn parse(text: &str) -> Result<Vec<LabelName>, Fault> {
    let mut names: Vec<LabelName> = Vec::new();
    let lines = text.trim_start_matches('\u{feff}').lines().map(str::trim);
    let lines = (1..).zip(lines).filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
    for (place, (number, line)) in lines.enumerate() {
        let fields = fields(line);
        let value = fields.iter().find_map(|field| field.parse::<i64>().ok());
        let name = fields.iter().find(|field| !field.is_empty() && field.parse::<f64>().is_err());
        match (value, name) {
            (Some(value), Some(name)) => {
                if names.iter().any(|n| n.value == value) {
                    return Err(Fault::invalid(format!("line {number}: label {value} is there twice")));
                }
                names.push(LabelName { value, name: name.clone() });
            }
            // A header.
            (None, Some(_)) if place == 0 => {}
            _ => {
                return Err(Fault::invalid(format!(
                    "line {number}: a label's number and its name are expected, not {line:?}"
                )));
            }
        }
    }
    if names.is_empty() {
        return Err(Fault::invalid("there is no label; write one a line, as in: 3,liver"));
    }
    Ok(names)
}

/// The fields of a line, without their quotes.
fn fields(line: &str) -> Vec<String> {
    // Every second part lies between quotes.
    let bare: String = line.split('"').step_by(2).collect();
    let separator = [',', ';', '\t'].into_iter().find(|&c| bare.contains(c));
    let mut fields = vec![String::new()];
    let mut quoted = false;
    for c in line.chars() {
        let parts = !quoted && separator.map_or(c.is_whitespace(), |s| c == s);
        match fields.last_mut() {
            _ if parts => fields.push(String::new()),
            _ if c == '"' => quoted = !quoted,
            Some(field) => field.push(c),
            None => {}
        }
    }
    fields.iter().map(|field| field.trim().to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_many_programs_are_read() {
        let expected = [(3, "liver"), (17, "left kidney, upper")];
        for text in [
            "3,liver\n17,\"left kidney, upper\"\n",
            "\u{feff}name;label\r\nliver;3\r\n\"left kidney, upper\";17\r\n",
            "# FreeSurfer\n\n3 liver 221 130 101 0\n17   \"left kidney, upper\"  0 0 0 0",
            // ITK-SNAP: number, colour, visibility, name.
            "3 221 130 101 1 1 1 \"liver\"\n17 0 0 0 1 1 1 \"left kidney, upper\"",
        ] {
            let names = parse(text).unwrap();
            let read: Vec<(i64, &str)> = names.iter().map(|n| (n.value, n.name.as_str())).collect();
            assert_eq!(read, expected, "{text}");
        }
    }

    #[test]
    fn what_is_no_table_says_where() {
        for (text, says) in [
            ("3,liver\n3,spleen", "line 2: label 3 is there twice"),
            ("3,liver\n4,5", "line 2"),
            ("label,name\n", "no label"),
        ] {
            let Fault::Invalid(error) = parse(text).unwrap_err() else { panic!() };
            assert!(error.contains(says), "{error}");
        }
    }
}
