//! The lines `Key = value` of a header.
use crate::error::Fault;
use std::collections::HashMap;
use std::io::{BufRead, Read};
use std::str::FromStr;

pub(super) struct Header {
    fields: HashMap<String, String>,
    /// The value of `ElementDataFile`, with which the header ends.
    pub data_file: String,
}

const LONGEST: u64 = 1 << 20;

impl Header {
    /// Reads up to the first byte after `ElementDataFile`.
    pub fn read(source: &mut impl BufRead) -> Result<Self, Fault> {
        let mut source = source.take(LONGEST);
        let mut fields = HashMap::new();
        loop {
            let mut bytes = Vec::new();
            source.read_until(b'\n', &mut bytes)?;
            if bytes.is_empty() {
                return Err(Fault::invalid(
                    "not a whole MetaImage: its header does not end with ElementDataFile",
                ));
            }
            let line = String::from_utf8_lossy(&bytes);
            let Some((key, value)) = line.split_once('=') else {
                if line.trim().is_empty() {
                    continue;
                }
                let shown: String = line.trim().chars().take(40).collect();
                return Err(Fault::invalid(format!("not a MetaImage: {shown:?} is no line of a header")));
            };
            let (key, value) = (key.trim().to_owned(), value.trim().to_owned());
            if key == "ElementDataFile" {
                return Ok(Self { fields, data_file: value });
            }
            fields.insert(key, value);
        }
    }

    /// The first of these fields that is there; formats before ITK's had other names for the same.
    pub fn text(&self, names: &[&str]) -> Option<&str> {
        names.iter().find_map(|&name| self.fields.get(name)).map(String::as_str)
    }

    pub fn is_true(&self, names: &[&str]) -> bool {
        self.text(names).is_some_and(|value| value.starts_with(['T', 't', '1', 'Y', 'y']))
    }

    /// `count` numbers of a field, if it is there.
    pub fn numbers<T: FromStr>(&self, names: &[&str], count: usize) -> Result<Option<Vec<T>>, Fault> {
        let Some(text) = self.text(names) else { return Ok(None) };
        let all = text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<T>>>();
        match all.filter(|all| all.len() == count) {
            Some(all) => Ok(Some(all)),
            None => {
                let name = names[0];
                Err(Fault::invalid(format!("{name} is {text:?}, where {count} numbers are expected")))
            }
        }
    }
}
