//! `cargo xtask bench tree`: component trees by us and by others, of the same fields, each in a process of its
//! own, in turns; trees compared.

mod field;
mod ours;
mod report;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;

use field::{FIELDS, Field};
use report::Row;

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
    /// Build one tree of ours and print what came out: weights, file, and voxels along x, y and z
    #[arg(long, num_args = 5, hide = true)]
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
    if let Some([weights, path, dims @ ..]) = arguments.child.as_deref() {
        let dims: Vec<usize> = dims.iter().map(|n| n.parse()).collect::<Result<_, _>>()?;
        let dims = dims.try_into().map_err(|_| "three numbers of voxels are needed")?;
        return ours::build_and_print(weights, Path::new(path), dims);
    }
    let packages: &[&[&str]] = &[&["numpy"], &["scipy"], &["higra"]];
    let python = Python::find(&arguments.python, packages)?;
    let versions = python.probe("tree.py");
    let mut heading = vec![format!("Machine: {}.", processor())];
    for name in ["higra", "scipy"] {
        heading.push(match versions[name].as_str() {
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
        let path = python.folder.join(format!("{}.f64", field.name));
        field.write(&path)?;
        for weights in ["vertex", "edge"] {
            let mut libraries: Vec<(String, usize, Command)> = Vec::new();
            for (_, label, method, _) in
                PEERS.iter().filter(|peer| peer.0 == weights && versions[peer.3].is_string())
            {
                let mut command = python.script("tree.py");
                command.arg(method).arg(&path);
                libraries.push((label.to_string(), 1, command));
            }
            for &threads in &arguments.threads {
                let mut command = Command::new(std::env::current_exe()?);
                command.args(["bench", "tree", "--child", weights]).arg(&path);
                command.env("RAYON_NUM_THREADS", threads.to_string());
                libraries.push(("mser3d".into(), threads, command));
            }
            let new = compare(field, weights, libraries, arguments.repeat)?;
            new.iter().for_each(|row| println!("{}", row.line()));
            rows.extend(new);
        }
        std::fs::remove_file(path)?;
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

/// Runs all libraries on a field in turns; the first that builds a tree is the oracle.
fn compare(
    field: &Field,
    weights: &'static str,
    mut libraries: Vec<(String, usize, Command)>,
    repeat: usize,
) -> Result<Vec<Row>, Box<dyn Error>> {
    let dims = field.dims.map(|n| n.to_string());
    libraries.iter_mut().for_each(|(.., command)| _ = command.args(&dims));
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
