//! Whether results, collections and sequences are as they were written.

use std::collections::BTreeMap;
use std::path::Path;

use mser3d_fileio::InputFile;
use mser3d_results::msv::MsvResults;
use mser3d_results::{Checksums, Finding, Record, ResultsError, TracksRecord, verify, verify_matches};

use crate::failure::FAILURE;
use crate::folder::result_names;
use crate::parquet_table::Table;
use crate::tables::{REGIONS_TABLE, SHAPES_TABLE};
use crate::{CollectionError, Failure, Index};

/// What was checked, and what was found.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Verification {
    /// Results that were checked.
    pub results: usize,
    /// Tables that were checked.
    pub tables: usize,
    /// What is wrong or should be known, each in one line, in the order of the names.
    pub findings: Vec<Finding>,
}

impl Verification {
    /// How many findings are damage.
    pub fn damaged(&self) -> usize {
        self.findings.iter().filter(|finding| finding.damaged).count()
    }
}

/// Checks a folder: a result of `detect`, `msv` or `match`, or a collection of `batch` or `track` with all its results and tables.
///
/// Each file is compared with the size and the SHA-256 that were written with it ([`Checksums`]), all that is read again is read, and
/// tables are compared with the results that they are made of. Nothing is changed, but that a result which a killed process had
/// nearly put in its place is put there.
///
/// # Errors
/// [`CollectionError::NotACollection`] for a folder in which there is nothing to check; [`CollectionError::Io`].
pub fn verify_folder(folder: &Path) -> Result<Verification, CollectionError> {
    let mut found = Verification::default();
    let single =
        MsvResults::is_in(folder) || !matches!(Record::load(folder), Err(ResultsError::NotAResult { .. }));
    if single {
        found.results = 1;
        found.findings = verify(folder);
    }
    // Where they are in a result's folder, its checksums are theirs.
    if !single && let Some(findings) = verify_matches(folder) {
        found.results = 1;
        found.findings = findings;
    }
    if !folder.is_dir() {
        let problem = "there is no such folder".to_owned();
        return Err(CollectionError::NotACollection { folder: folder.to_owned(), problem });
    }
    let (mut records, mut failures) = (BTreeMap::new(), 0);
    for name in result_names(folder)? {
        let result = folder.join(&name);
        let failure = result.join(FAILURE);
        if let Ok(text) = InputFile::read_all(&failure) {
            failures += 1;
            match serde_json::from_slice::<Failure>(&text) {
                Ok(Failure { error, .. }) => {
                    found.findings.push(Finding::note(&result, &format!("its last run failed: {error}")));
                }
                Err(error) => found.findings.push(Finding::damage(format!("{}: {error}", failure.display()))),
            }
        }
        match Record::load(&result) {
            Err(ResultsError::NotAResult { .. }) if !MsvResults::is_in(&result) => continue,
            Ok(record) => drop(records.insert(name, record.regions.len())),
            // What is wrong is found below.
            Err(_) => {}
        }
        found.results += 1;
        found.findings.extend(verify(&result));
    }
    let is_collection =
        failures > 0 || folder.join(".lock").is_file() || folder.join(REGIONS_TABLE).is_file();
    if is_collection {
        verify_tables(folder, &records, &mut found);
    }
    if found.results + found.tables == 0 && !is_collection {
        let problem = "there is nothing to verify: neither a result nor a collection of results".to_owned();
        return Err(CollectionError::NotACollection { folder: folder.to_owned(), problem });
    }
    Ok(found)
}

fn verify_tables(folder: &Path, records: &BTreeMap<String, usize>, found: &mut Verification) {
    let sums = match Checksums::load(folder) {
        Ok(sums) => sums,
        Err(error) => return found.findings.push(Finding::damage(error)),
    };
    let tables = [SHAPES_TABLE, REGIONS_TABLE];
    if tables.iter().all(|name| !folder.join(name).is_file()) {
        let what =
            "has no tables: a batch is under way, or was stopped; run it again, or `mser3d batch --merge`";
        return found.findings.push(Finding::note(folder, what));
    }
    if !sums.files.contains_key(REGIONS_TABLE) {
        let what = "its tables have no checksums: they were written by an earlier version; `mser3d batch --merge` makes them again";
        found.findings.push(Finding::note(folder, what));
    }
    found.tables = sums.files.len().max(tables.len());
    found.findings.extend(sums.check_all(folder, &tables));
    let said: Vec<String> = found.findings.iter().map(|finding| finding.text.clone()).collect();
    let mut push = |error: CollectionError| {
        let finding = Finding::damage(error);
        if !said.contains(&finding.text) {
            found.findings.push(finding);
        }
    };
    match regions_by_shape(folder) {
        Ok(listed) => {
            if let Some(what) = difference(&listed, records) {
                let path = folder.join(REGIONS_TABLE);
                let reason = format!("{what}; make the tables again with `mser3d batch --merge`");
                push(CollectionError::Table { path, reason });
            }
        }
        Err(error) => push(error),
    }
    if listed_regions(folder) {
        // Reads the numbers too.
        if let Err(error) = Index::load(folder) {
            push(error);
        }
    }
    if folder.join(TracksRecord::FILE).is_file()
        && let Err(error) = TracksRecord::load(folder)
    {
        push(error.into());
    }
}

/// Whether there is a region in the table.
fn listed_regions(folder: &Path) -> bool {
    Table::open(&folder.join(REGIONS_TABLE)).is_ok_and(|table| table.rows() > 0)
}

/// How many regions each shape has in the tables.
fn regions_by_shape(folder: &Path) -> Result<BTreeMap<String, usize>, CollectionError> {
    let shapes = Table::open(&folder.join(SHAPES_TABLE))?;
    let counts = shapes.column::<i32>("regions")?.into_iter().map(|n| usize::try_from(n).unwrap_or(0));
    let stated: BTreeMap<String, usize> = shapes.column::<String>("shape")?.into_iter().zip(counts).collect();
    let mut counted: BTreeMap<String, usize> = stated.keys().map(|name| (name.clone(), 0)).collect();
    for shape in Table::open(&folder.join(REGIONS_TABLE))?.column::<String>("shape")? {
        *counted.entry(shape).or_default() += 1;
    }
    match difference(&counted, &stated) {
        None => Ok(counted),
        Some(what) => {
            let reason =
                format!("{what}, by {SHAPES_TABLE}; make the tables again with `mser3d batch --merge`");
            Err(CollectionError::Table { path: folder.join(REGIONS_TABLE), reason })
        }
    }
}

/// The first shape of the tables that is not as the results have it. A result that the tables leave out may be of an earlier run.
fn difference(listed: &BTreeMap<String, usize>, records: &BTreeMap<String, usize>) -> Option<String> {
    let wrong = |(name, count): (&String, &usize)| match records.get(name) {
        Some(own) if own == count => None,
        Some(own) => Some(format!("it lists {count} regions of {name}, which has {own}")),
        None => Some(format!("it lists {name}, of which there is no whole result")),
    };
    listed.iter().find_map(wrong)
}
