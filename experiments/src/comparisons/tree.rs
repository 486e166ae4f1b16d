//! `cargo xtask bench tree`: component trees by us and by others, of the same fields, each in a process of its
//! own, in turns; trees compared.

mod field;
mod ours;
mod report;

pub use field::{FIELDS, Field};
pub use report::Row;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

use super::python::{Python, PythonArguments, answer};
use super::resources::processor;

/// What `cargo xtask bench tree` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Only fields with this in their names; may be given several times
    #[arg(long)]
    case: Vec<String>,
    /// Threads of ours, one row each
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    threads: Vec<usize>,
    /// How often each runs
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    #[command(flatten)]
    python: PythonArguments,
    /// Folder for tree.md and tree.csv [default: docs/results, when all fields ran]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Build one tree of ours and print what came out: weights, file, type, and voxels along x, y and z
    #[arg(long, num_args = 6, hide = true)]
    child: Option<Vec<String>>,
}

/// The peers' names in the table, in `peers/tree.py`, and in what it says is there.
const PEERS: [(&str, &str, &str, &str); 3] = [
    ("vertex", "Higra, implicit graph", "higra-vertex", "higra"),
    ("edge", "Higra, quasi-flat zones", "higra-edge", "higra"),
    ("edge", "SciPy, spanning tree only", "scipy-edge", "scipy"),
];

/// Runs the fields and prints and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if let Some([weights, path, numbers, dims @ ..]) = arguments.child.as_deref() {
        let dims: Vec<usize> = dims.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
        let dims = dims.try_into().map_err(|_| "three numbers of voxels are needed")?;
        return ours::build_and_print(weights, Path::new(path), numbers, dims);
    }
    let peers = Peers::find(&arguments.python)?;
    let mut heading = vec![format!("Machine: {}.", processor())];
    for name in ["higra", "scipy"] {
        heading.push(match peers.version(name) {
            Some(version) => format!("* {version}"),
            None => format!("* no {name} here (to get it: pip install {name})"),
        });
    }
    heading.iter().for_each(|line| println!("{line}"));
    println!("{}", report::TITLES);
    let mut rows = Vec::new();
    let chosen = |field: &&Field| {
        arguments.case.is_empty() || arguments.case.iter().any(|part| field.name.contains(part))
    };
    for field in FIELDS.iter().filter(chosen) {
        rows.extend(run_field(field, field.weights(), &peers, &arguments.threads, arguments.repeat)?);
    }
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    let output = arguments.output.clone().or_else(|| arguments.case.is_empty().then_some(default));
    if let Some(output) = output {
        report::write(&output, &rows, &heading)?;
    }
    match rows.iter().find(|row| row.same == "no") {
        Some(row) => Err(format!("trees differ:\n{}", row.line()).into()),
        None => Ok(()),
    }
}

/// Where the peers are, and which.
pub struct Peers {
    python: Python,
    versions: Value,
}

impl Peers {
    /// Looks for them, and installs them first if asked to.
    pub fn find(arguments: &PythonArguments) -> Result<Self, Box<dyn Error>> {
        let python = Python::find(arguments, &[&["numpy"], &["scipy"], &["higra"]])?;
        let versions = python.probe("tree.py");
        Ok(Self { python, versions })
    }

    /// The version of a library that is here.
    pub fn version(&self, library: &str) -> Option<&str> {
        self.versions[library].as_str()
    }
}

/// Compares the trees of a field by these weights, and prints a row for each library and number of threads of ours.
pub fn run_field(
    field: &Field,
    weights: &[&'static str],
    peers: &Peers,
    threads: &[usize],
    repeat: usize,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let path = peers.python.folder.join(format!("{}.{}", field.name, field.numbers.name()));
    field.write(&path)?;
    let mut rows = Vec::new();
    for &weights in weights {
        let mut libraries: Vec<(String, usize, Command)> = Vec::new();
        for (_, label, method, library) in PEERS.iter().filter(|peer| peer.0 == weights) {
            if peers.version(library).is_some() {
                let mut command = peers.python.script("tree.py");
                command.arg(method).arg(&path);
                libraries.push((label.to_string(), 1, command));
            }
        }
        for &threads in threads {
            let mut command = Command::new(std::env::current_exe()?);
            command.args(["bench", "tree", "--child", weights]).arg(&path);
            command.env("RAYON_NUM_THREADS", threads.to_string());
            libraries.push(("mser3d".into(), threads, command));
        }
        let new = compare(field, weights, libraries, repeat)?;
        new.iter().for_each(|row| println!("{}", row.line()));
        rows.extend(new);
    }
    std::fs::remove_file(path)?;
    Ok(rows)
}

/// Runs all libraries on a field in turns; the first that builds a tree is the oracle.
fn compare(
    field: &Field,
    weights: &'static str,
    mut libraries: Vec<(String, usize, Command)>,
    repeat: usize,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let dims = field.dims.map(|n| n.to_string());
    libraries.iter_mut().for_each(|(.., command)| _ = command.arg(field.numbers.name()).args(&dims));
    let mut rows: Vec<Option<Row>> = vec![None; libraries.len()];
    for _ in 0..repeat.max(1) {
        for ((library, threads, command), row) in libraries.iter_mut().zip(&mut rows) {
            let found = answer(command).map_err(|error| format!("{library} on {}: {error}", field.name))?;
            let number = |key: &str| found[key].as_f64().unwrap_or(f64::NAN);
            let digest = found["digest"].as_str().map(|digest| digest.to_string());
            let new = Row {
                field: field.name,
                vertices: field.len(),
                weights,
                library: library.clone(),
                threads: *threads,
                cpu: number("cpu"),
                wall: number("wall"),
                memory: number("memory"),
                digest: digest.zip(found["nodes"].as_u64()),
                same: "",
                ratios: [f64::NAN; 2],
            };
            if row.as_ref().is_none_or(|old| new.cpu < old.cpu) {
                *row = Some(new);
            }
        }
    }
    let mut rows: Vec<Row> = rows.into_iter().flatten().collect();
    let Some(first) = rows.iter().position(|row| row.digest.is_some()) else { return Ok(rows) };
    let oracle = rows[first].clone();
    for (at, row) in rows.iter_mut().enumerate() {
        if row.digest.is_some() && at != first {
            row.same = if row.digest == oracle.digest { "yes" } else { "no" };
        }
        if oracle.library.starts_with("Higra") {
            row.ratios = [oracle.cpu / row.cpu, oracle.wall / row.wall];
        }
    }
    Ok(rows)
}
