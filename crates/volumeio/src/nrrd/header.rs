//! The lines of the header.
use crate::error::Fault;
use std::collections::HashMap;
use std::io::{BufRead, Read};
use std::str::FromStr;

/// What the header says.
pub(super) struct Header {
    /// Fields by their names, in lower case and without spaces.
    fields: HashMap<String, String>,
    /// `key:=value`: remarks of the program that wrote the file.
    pub remarks: Vec<(String, String)>,
    /// The lines after `data file: LIST`: names of files.
    pub listed: Vec<String>,
}

/// A header has a dozen lines; who sends more without an end gets an error.
const LONGEST: u64 = 16 << 20;

impl Header {
    /// Reads up to the first byte of the data.
    pub fn read(source: &mut impl BufRead) -> Result<Self, Fault> {
        let mut source = source.take(LONGEST);
        let mut line = || -> Result<Option<String>, Fault> {
            let mut bytes = Vec::new();
            source.read_until(b'\n', &mut bytes)?;
            let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).trim_end().to_owned();
            Ok(if bytes.is_empty() { None } else { Some(text(&bytes)) })
        };
        if !line()?.is_some_and(|first| first.starts_with("NRRD000")) {
            return Err(Fault::invalid("not an NRRD file: it does not begin with NRRD000"));
        }
        let mut header = Self { fields: HashMap::new(), remarks: Vec::new(), listed: Vec::new() };
        loop {
            let Some(text) = line()? else {
                // The header of detached data may end with its file.
                if header.data_file().is_some() {
                    return Ok(header);
                }
                return Err(Fault::invalid("the file ends within its header; copy or export it again"));
            };
            if text.is_empty() {
                return Ok(header);
            }
            if text.starts_with('#') {
                continue;
            }
            let (field, remark) = (text.find(": "), text.find(":="));
            match (field, remark) {
                (at, Some(remark)) if at.is_none_or(|at| remark < at) => {
                    let value = text[remark + 2..].replace("\\n", "\n").replace("\\\\", "\\");
                    header.remarks.push((text[..remark].to_owned(), value));
                }
                (Some(at), _) => {
                    let name = compact(&text[..at]);
                    let value = text[at + 2..].trim().to_owned();
                    let is_list = name == "datafile" && value.split_whitespace().next() == Some("LIST");
                    header.fields.insert(name, value);
                    if is_list {
                        while let Some(name) = line()?.filter(|name| !name.is_empty()) {
                            header.listed.push(name);
                        }
                        return Ok(header);
                    }
                }
                // A field without a value, such as `content:`, says nothing.
                _ => {}
            }
        }
    }

    /// A field, by its name in the format's specification; `None` if it is not there.
    pub fn text(&self, name: &str) -> Option<&str> {
        let other = match name {
            "centerings" => "centers",
            "labels" => "axislabels",
            _ => name,
        };
        self.fields.get(&compact(name)).or_else(|| self.fields.get(&compact(other))).map(String::as_str)
    }

    pub fn data_file(&self) -> Option<&str> {
        self.text("data file")
    }

    pub fn required(&self, name: &str) -> Result<&str, Fault> {
        self.text(name).ok_or_else(|| Fault::invalid(format!("the header has no field {name:?}")))
    }

    /// The numbers of a field.
    pub fn numbers<T: FromStr>(&self, name: &str) -> Result<Vec<T>, Fault> {
        let text = self.required(name)?;
        let all = text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<T>>>();
        all.ok_or_else(|| Fault::invalid(format!("field {name:?} is {text:?}; numbers are expected")))
    }

    /// One number for each axis; none if the field is not there.
    pub fn per_axis(&self, name: &str, axes: usize) -> Result<Option<Vec<f64>>, Fault> {
        if self.text(name).is_none() {
            return Ok(None);
        }
        let numbers: Vec<f64> = self.numbers(name)?;
        if numbers.len() != axes {
            let found = numbers.len();
            return Err(Fault::invalid(format!("field {name:?} has {found} numbers for {axes} axes")));
        }
        Ok(Some(numbers))
    }

    /// The words of a field, of which each may stand in quotes.
    pub fn words(&self, name: &str) -> Vec<String> {
        let mut words = Vec::new();
        let mut rest = self.text(name).unwrap_or_default().trim();
        while !rest.is_empty() {
            let (word, after) = match rest.strip_prefix('"') {
                Some(quoted) => quoted.split_once('"').unwrap_or((quoted, "")),
                None => rest.split_once(char::is_whitespace).unwrap_or((rest, "")),
            };
            words.push(word.to_owned());
            rest = after.trim_start();
        }
        words
    }
}

/// Names are compared without case and spaces: `byteskip` is an old spelling of `byte skip`.
fn compact(name: &str) -> String {
    name.chars().filter(|c| !c.is_whitespace()).collect::<String>().to_ascii_lowercase()
}
