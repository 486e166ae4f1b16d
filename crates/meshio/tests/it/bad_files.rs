//! Every file of the corpus of bad files is refused with the message written beside it.

use mser3d_meshio::{ReadOptions, read_mesh};
use std::collections::BTreeMap;
use std::path::Path;

/// `fixtures/bad/MESSAGES` holds a line `file: message` or `file:line: message` for each file; where
/// the message ends in words of the operating system, `...` stands for them.
#[test]
fn each_bad_file_is_refused_with_its_message() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/bad"));
    let listed = std::fs::read_to_string(folder.join("MESSAGES")).unwrap();
    let mut expected: BTreeMap<&str, &str> = BTreeMap::new();
    for line in listed.lines() {
        expected.insert(line.split(':').next().unwrap(), line);
    }
    let mut wrong = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name == "MESSAGES" {
            continue;
        }
        let path = folder.join(&name);
        let Err(error) = read_mesh(&path, &ReadOptions::default()) else {
            wrong.push(format!("{name} was read"));
            continue;
        };
        let message = error.to_string().replace(&format!("{}/", folder.display()), "");
        let says = expected.remove(name.as_str()).unwrap_or("(nothing is listed for it)");
        let agrees = match says.split_once("...") {
            Some((start, end)) => message.starts_with(start) && message.ends_with(end),
            None => message == says,
        };
        if !agrees {
            wrong.push(format!("{message}\n    should be: {says}"));
        }
    }
    wrong.extend(expected.values().map(|line| format!("no such file: {line}")));
    wrong.sort();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let missing = read_mesh(Path::new("no/such/file.obj"), &ReadOptions::default()).unwrap_err();
    assert!(missing.to_string().starts_with("no/such/file.obj: cannot be read: "), "{missing}");
    assert!(read_mesh(Path::new(env!("CARGO_MANIFEST_DIR")), &ReadOptions::default()).is_err());
}
