//! Each value of a choice has one spelling: in code, in JSON, in the help, and in the documentation.

use std::fmt::Debug;
use std::path::Path;

use crate::common::*;
use mser3d::comptree::{AltitudeScale, Contrast, Polarity, StabilityRule};
use mser3d::descriptors::MatchRule;
use mser3d::shape::{Choice, Connectivity};
use mser3d::spectral::{Eigensolver, SolverUsed};
use mser3d::voxelize::{InsideTest, Morphology, Overlap};
use mser3d::{Descriptor, DescriptorKind, Domain, Stage, Weight};
use mser3d_evaluation::Verdict;
use mser3d_results::Up;
use mser3d_viewer::NamedView;
use serde_json::Value;

/// `SizedSiHks` as `sized-si-hks`.
fn kebab(variant: &str) -> String {
    let mut name = String::new();
    for c in variant.chars() {
        if c.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(c.to_ascii_lowercase());
    }
    name
}

fn help(command: &str) -> String {
    text(&mser3d([command, "--help"]).stdout).to_owned()
}

/// The lines of the long help that describe an option: its own and those below.
fn entry<'a>(help: &'a str, option: &str) -> Vec<&'a str> {
    let lines = help.lines().skip_while(|line| !line.trim_start().starts_with(&format!("{option} ")));
    let is_option = |line: &&str| line.trim_start().starts_with("--") || line.trim_start().starts_with('-');
    let first = lines.clone().take(1);
    first
        .chain(lines.skip(1).take_while(|line| !is_option(line) || line.trim_start().starts_with("- ")))
        .collect()
}

fn page(name: &str) -> String {
    std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name)).unwrap()
}

/// Checks all values of a choice in code, JSON and a page of the documentation.
fn check_names<T>(docs: &str)
where
    T: Choice + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned,
{
    let docs = page(docs);
    for &value in T::ALL {
        let name = value.name();
        // In code: the variant is the name, but that a number is spelled out.
        let variant = format!("{value:?}");
        let code = match variant.as_str() {
            "Six" => "6".to_owned(),
            "TwentySix" => "26".to_owned(),
            _ => kebab(&variant),
        };
        assert_eq!(code, name);
        // Read and written.
        assert_eq!(value.to_string(), name);
        assert_eq!(name.parse::<T>().ok(), Some(value));
        assert_eq!(serde_json::to_value(value).unwrap(), Value::from(name));
        assert_eq!(serde_json::from_value::<T>(name.into()).unwrap(), value);
        assert!(docs.contains(&format!("`{name}`")), "{} {name} is not documented", T::WHAT);
    }
    let error = "no-such-name".parse::<T>().err().unwrap().to_string();
    assert!(T::ALL.iter().all(|value| error.contains(value.name())), "{error}");
}

/// As [`check_names`], of a choice that an option takes: its help has every value, with what it means.
fn check<T>(command: &str, option: &str, docs: &str)
where
    T: Choice + Debug + PartialEq + serde::Serialize + serde::de::DeserializeOwned,
{
    check_names::<T>(docs);
    let help = help(command);
    let entry = entry(&help, option);
    for name in T::ALL.iter().map(|value| value.name()) {
        let says = |line: &&str| {
            let line = line.trim_start().strip_prefix("- ").unwrap_or_default();
            line.split_once(':').is_some_and(|(n, about)| n == name && !about.trim().is_empty())
        };
        assert!(entry.iter().any(says), "{option} {name} is not in {entry:#?}");
    }
}

#[test]
fn every_choice_has_one_spelling() {
    check::<Weight>("detect", "--weight", "parameters.md");
    check::<Polarity>("detect", "--polarity", "parameters.md");
    check::<Connectivity>("detect", "--connectivity", "parameters.md");
    check::<InsideTest>("detect", "--inside", "parameters.md");
    check::<Overlap>("detect", "--overlap", "parameters.md");
    check::<Morphology>("detect", "--morphology", "parameters.md");
    check::<Eigensolver>("detect", "--solver", "parameters.md");
    check::<StabilityRule>("detect", "--stability-rule", "parameters.md");
    check::<AltitudeScale>("detect", "--altitude", "parameters.md");
    check::<DescriptorKind>("detect", "--descriptor", "parameters.md");
    check::<MatchRule>("match", "--rule", "formats.md");
    check::<Contrast>("msv", "--regions", "formats.md");
    check::<Up>("render", "--up", "formats.md");
    check::<NamedView>("render", "--views", "formats.md");
    // What is written, but not asked for.
    check_names::<Domain>("formats.md");
    check_names::<SolverUsed>("formats.md");
    check_names::<Stage>("formats.md");
    check_names::<Verdict>("formats.md");
}

#[test]
fn a_descriptor_is_tagged_by_its_kind() {
    for &kind in DescriptorKind::ALL {
        let json = serde_json::to_value(Descriptor::from(kind)).unwrap();
        assert_eq!(json["kind"], kind.name());
        assert_eq!(serde_json::from_value::<Descriptor>(json).unwrap().kind(), kind);
    }
}

#[test]
fn what_is_chosen_stands_in_the_record_as_it_was_spelled() {
    let folder = tempfile::tempdir().unwrap();
    let options = "--weight edge --polarity sublevel --connectivity 26 --inside parity --overlap join --morphology close \
                   --solver shift-invert --stability-rule paper --altitude linear --descriptor si-hks";
    let mesh = fixtures().join("human_rest.off");
    let output = detect(&mesh, folder.path(), &format!("{options} --voxels 1500 --eigenpairs 20 --quiet"));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let parameters = json(&folder.path().join("regions.json"))["parameters"].clone();
    let words: Vec<&str> = options.split_whitespace().collect();
    for pair in words.chunks(2) {
        let (option, value) = (pair[0].trim_start_matches("--"), pair[1]);
        let stands = match option {
            "weight" | "polarity" => &parameters[option],
            "connectivity" | "inside" | "overlap" | "morphology" => &parameters["voxelize"][option],
            "solver" => &parameters["spectrum"]["solver"],
            "stability-rule" => &parameters["stability"]["rule"],
            "altitude" => &parameters["stability"]["altitude"],
            _ => &parameters["descriptor"]["kind"],
        };
        assert_eq!(stands, value, "{option}");
    }
}
