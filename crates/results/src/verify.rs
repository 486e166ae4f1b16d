//! Whether a folder is as it was written.

use std::path::Path;

use mser3d_shape::Choice;

use crate::folder::{MATCHES, is_left_over};
use crate::msv::MsvResults;
use crate::{Checksums, Eigenfunctions, Extra, Results, ResultsError};

/// Something about a file or folder that its user should know.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Finding {
    /// What is wrong, with the name of the file, and what to do; or what could not be checked.
    pub text: String,
    /// Whether something is wrong.
    pub damaged: bool,
}

impl Finding {
    /// Something that is wrong.
    pub fn damage(error: impl ToString) -> Self {
        Self { text: error.to_string(), damaged: true }
    }

    /// Something that is not, but should be known.
    pub fn note(path: &Path, what: &str) -> Self {
        Self { text: format!("{}: {what}", path.display()), damaged: false }
    }
}

/// Checks a result, of [`Results::write`] or [`MsvResults::write`]: the size and SHA-256 of each file that `checksums.json` lists, and
/// that all that is read again can be read.
///
/// A file that is listed and gone is damage only where somebody reads it: the others may have been removed on purpose.
pub fn verify(folder: &Path) -> Vec<Finding> {
    let is_msv = MsvResults::is_in(folder);
    let read: &[&str] = match is_msv {
        true => &["msv.json", "labels.npy"],
        false => &["regions.json", "features.npz", "surface.ply"],
    };
    // First, because it finishes what was interrupted.
    let loaded = match is_msv {
        true => MsvResults::load(folder).map(|_| ()),
        false => Results::load(folder).and_then(|results| {
            match folder.join(Extra::Eigenfunctions.file_name()).is_file() {
                true => Eigenfunctions::load(folder, &results).map(|_| ()),
                false => Ok(()),
            }
        }),
    };
    let sums = match Checksums::load(folder) {
        Ok(sums) => sums,
        Err(error) => return vec![Finding::damage(error)],
    };
    let mut findings = Vec::new();
    if sums.files.is_empty() {
        let what = "has no checksums: it was written by an earlier version, or they were removed; what can be read was checked";
        findings.push(Finding::note(folder, what));
    }
    if is_left_over(folder) {
        let what = "holds .new.partial of a run that was killed, or is under way; the next run takes it away";
        findings.push(Finding::note(folder, what));
    }
    findings.extend(sums.check_all(folder, read));
    // Written with every volume, and read by other programs only.
    let (volume, mate) = if is_msv { ("labels.vti", "msv.json") } else { ("volume.vti", "regions.json") };
    if folder.join(volume).is_file() && !sums.files.contains_key(volume) {
        findings.extend(sums.check_beside(folder, volume, mate).err().map(Finding::damage));
    }
    let unlisted = Extra::ALL.iter().map(|extra| extra.file_name());
    let unlisted = unlisted.filter(|name| !sums.files.is_empty() && !sums.files.contains_key(*name));
    for name in unlisted.filter(|name| folder.join(name).is_file()) {
        findings
            .push(Finding::note(&folder.join(name), "has no checksum: it was not written with the result"));
    }
    if let Err(error) = loaded {
        let finding = Finding::damage(error);
        if !findings.contains(&finding) {
            findings.push(finding);
        }
    }
    findings
}

/// Checks matches of two results, of [`ResultsFolder::write_matches`](crate::ResultsFolder::write_matches): the size and SHA-256 of
/// each file; none where there are no matches.
pub fn verify_matches(folder: &Path) -> Option<Vec<Finding>> {
    let record = [MATCHES.record];
    folder.join(record[0]).is_file().then(|| match Checksums::load(folder) {
        Ok(sums) if sums.files.contains_key(record[0]) => sums.check_all(folder, &record),
        Ok(_) => {
            let what = "its matches have no checksums: an earlier version wrote them, or they were removed";
            vec![Finding::note(folder, what)]
        }
        Err(error) => vec![Finding::damage(error)],
    })
}

/// The first thing of a result of [`Results::write`] that is damaged; faster than [`verify`] where it has checksums, because what is as
/// it was written needs no reading.
pub fn first_damage(folder: &Path) -> Option<Finding> {
    let sums = Checksums::load(folder).unwrap_or_default();
    let needed = ["regions.json", "features.npz"];
    let found = match needed.iter().all(|name| sums.files.contains_key(*name)) {
        true => sums.check_all(folder, &["regions.json", "features.npz", "surface.ply"]),
        false => verify(folder),
    };
    found.into_iter().find(|finding| finding.damaged)
}

impl Checksums {
    /// Checks all files that are listed. Of those that are gone, `needed` ones are damage.
    pub fn check_all(&self, folder: &Path, needed: &[&str]) -> Vec<Finding> {
        let mut findings = Vec::new();
        for name in self.files.keys() {
            let path = folder.join(name);
            match self.check(folder, name) {
                Ok(()) => {}
                Err(ResultsError::Damaged { .. }) if !path.exists() && !needed.contains(&name.as_str()) => {
                    findings.push(Finding::note(&path, "is not there any more; nothing here reads it"));
                }
                Err(error) => findings.push(Finding::damage(error)),
            }
        }
        findings
    }
}
