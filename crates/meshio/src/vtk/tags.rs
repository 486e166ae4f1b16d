//! Just enough XML for VTK's files: tags with attributes, and the text between.

use crate::error::Fault;
use crate::text::show;

/// A tag. An empty one (`<a/>`) is opened and closed.
#[derive(Debug, Default)]
pub(super) struct Tag<'a> {
    pub name: &'a str,
    attributes: &'a [u8],
    pub opens: bool,
    pub closes: bool,
}

impl<'a> Tag<'a> {
    /// The value of an attribute, as it stands between its quotes.
    pub(super) fn attribute(&self, name: &str) -> Option<&'a str> {
        let mut rest = self.attributes;
        loop {
            let equals = rest.iter().position(|&b| b == b'=')?;
            let key = rest[..equals].trim_ascii();
            rest = rest[equals + 1..].trim_ascii_start();
            let (&quote, after) = rest.split_first()?;
            let end = after.iter().position(|&b| b == quote)?;
            if key == name.as_bytes() {
                return std::str::from_utf8(&after[..end]).ok();
            }
            rest = &after[end + 1..];
        }
    }

    /// An attribute that is a number of something; 0 where it is missing.
    pub(super) fn count(&self, name: &str) -> Result<u64, Fault> {
        let Some(value) = self.attribute(name) else { return Ok(0) };
        value
            .trim()
            .parse()
            .map_err(|_| Fault::new(format!("{name} is {}, not a whole number >= 0", show(value.as_bytes()))))
    }
}

/// The tags of a file, one after another.
pub(super) struct Tags<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Tags<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// What follows the tag read last.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// A fault where the tag read last ends.
    pub(super) fn fault(&self, reason: impl Into<String>) -> Fault {
        Fault::at(1 + self.bytes[..self.at].iter().filter(|&&b| b == b'\n').count(), reason)
    }

    /// The next tag and the text before it; comments and declarations are skipped.
    pub(super) fn next(&mut self) -> Result<Option<(&'a [u8], Tag<'a>)>, Fault> {
        loop {
            let rest = self.rest();
            let Some(start) = rest.iter().position(|&b| b == b'<') else { return Ok(None) };
            let (text, tag) = rest.split_at(start);
            let (length, skip) = if tag.starts_with(b"<!--") {
                (find(tag, b"-->").map(|at| at + 3), true)
            } else {
                (end_of_tag(tag), tag.starts_with(b"<?") || tag.starts_with(b"<!"))
            };
            let Some(length) = length else {
                return Err(
                    self.fault("a tag of XML does not end; the file is truncated; copy or export it again")
                );
            };
            self.at += start + length;
            if skip {
                continue;
            }
            let inner = &tag[1..length - 1];
            let closes_only = inner.starts_with(b"/");
            let inner = inner.strip_prefix(b"/").unwrap_or(inner);
            let (inner, empty) = match inner.strip_suffix(b"/") {
                Some(inner) => (inner, true),
                None => (inner, false),
            };
            let end = inner.iter().position(u8::is_ascii_whitespace).unwrap_or(inner.len());
            let name =
                std::str::from_utf8(&inner[..end]).map_err(|_| self.fault("a tag's name is not UTF-8"))?;
            let tag =
                Tag { name, attributes: &inner[end..], opens: !closes_only, closes: closes_only || empty };
            return Ok(Some((text, tag)));
        }
    }
}

pub(super) fn find(bytes: &[u8], word: &[u8]) -> Option<usize> {
    bytes.windows(word.len()).position(|w| w == word)
}

/// Where a tag ends: after the first `>` outside of quotes.
fn end_of_tag(tag: &[u8]) -> Option<usize> {
    let mut quote = None;
    for (i, &b) in tag.iter().enumerate() {
        match quote {
            Some(q) if b == q => quote = None,
            None if b == b'"' || b == b'\'' => quote = Some(b),
            None if b == b'>' => return Some(i + 1),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_come_with_their_attributes() {
        let mut tags =
            Tags::new(b"<?xml version=\"1.0\"?>\n<!-- a > <b> -->\n<a x = \"1 > 0\" y='2'>text<b/></a>");
        let (_, a) = tags.next().unwrap().unwrap();
        assert_eq!((a.name, a.opens, a.closes), ("a", true, false));
        assert_eq!((a.attribute("x"), a.attribute("y"), a.attribute("z")), (Some("1 > 0"), Some("2"), None));
        assert_eq!(a.count("y").unwrap(), 2);
        assert!(a.count("x").is_err());
        let (text, b) = tags.next().unwrap().unwrap();
        assert_eq!((text, b.name, b.opens, b.closes), (&b"text"[..], "b", true, true));
        let (_, end) = tags.next().unwrap().unwrap();
        assert_eq!((end.name, end.opens, end.closes), ("a", false, true));
        assert!(tags.next().unwrap().is_none());
        assert!(Tags::new(b"<a x=\">").next().is_err());
    }
}
