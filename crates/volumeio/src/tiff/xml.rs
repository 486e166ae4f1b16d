//! As much of XML as OME's descriptions need: elements with their attributes.
use std::collections::HashMap;

/// An element's beginning.
pub(super) struct Element {
    /// Its name without a namespace.
    pub name: String,
    attributes: HashMap<String, String>,
    /// The text up to the next element.
    pub text: String,
}

impl Element {
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.get(name).map(String::as_str)
    }
}

/// All elements in the order of the text. What is not XML ends the list.
pub(super) fn elements(text: &str) -> Vec<Element> {
    let mut all: Vec<Element> = Vec::new();
    let mut rest = text;
    while let Some(at) = rest.find('<') {
        if let Some(last) = all.last_mut() {
            last.text.push_str(&decoded(&rest[..at]));
        }
        rest = &rest[at..];
        let end = match rest {
            _ if rest.starts_with("<!--") => rest.find("-->").map(|at| at + 3),
            _ if rest.starts_with("<![CDATA[") => rest.find("]]>").map(|at| at + 3),
            _ => tag_end(rest),
        };
        let Some(end) = end else { break };
        let tag = &rest[1..end - 1];
        rest = &rest[end..];
        if !tag.starts_with(['!', '?', '/']) {
            all.push(element(tag.trim_end_matches('/')));
        }
    }
    all
}

/// The end of a tag; a `>` in quotes is none.
fn tag_end(text: &str) -> Option<usize> {
    let mut quote = None;
    for (at, c) in text.char_indices() {
        match (quote, c) {
            (None, '>') => return Some(at + 1),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            _ => {}
        }
    }
    None
}

fn element(tag: &str) -> Element {
    let (name, mut rest) = tag.split_once(char::is_whitespace).unwrap_or((tag, ""));
    let mut attributes = HashMap::new();
    while let Some((key, after)) = rest.split_once('=') {
        let after = after.trim_start();
        let Some(quote) = after.chars().next().filter(|c| matches!(c, '"' | '\'')) else { break };
        let Some((value, after)) = after[1..].split_once(quote) else { break };
        attributes.insert(key.trim().to_owned(), decoded(value));
        rest = after;
    }
    let name = name.rsplit(':').next().unwrap_or_default().to_owned();
    Element { name, attributes, text: String::new() }
}

fn decoded(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('&') {
        out.push_str(before);
        let Some((name, next)) = after.split_once(';') else {
            rest = after;
            break;
        };
        let number = |text: &str, base| u32::from_str_radix(text, base).ok().and_then(char::from_u32);
        let c = match name {
            "amp" => Some('&'),
            "lt" => Some('<'),
            "gt" => Some('>'),
            "quot" => Some('"'),
            "apos" => Some('\''),
            _ => name.strip_prefix("#x").map_or_else(
                || name.strip_prefix('#').and_then(|digits| number(digits, 10)),
                |digits| number(digits, 16),
            ),
        };
        out.extend(c);
        rest = next;
    }
    out.push_str(rest);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_attributes_and_entities() {
        let text = "<?xml version='1.0'?><!-- <a b='c'> --><o:OME x='1 > 0' y=\"&#xB5;m &amp; &#181;m\"><b/>t&lt;</o:OME>";
        let all = elements(text);
        assert_eq!(all.iter().map(|e| &e.name[..]).collect::<Vec<_>>(), ["OME", "b"]);
        assert_eq!((all[0].attribute("x"), all[0].attribute("y")), (Some("1 > 0"), Some("µm & µm")));
        assert_eq!(all[1].text, "t<");
        for bad in ["<", "<a", "<a b", "<a b=", "<a b='", "<a b='c", "&", "<!--", "<a b=c>", "<é ü='ß'"] {
            elements(bad);
            decoded(bad);
        }
    }
}
