//! `cargo xtask bench all`: every stage, and the whole program, beside the fastest of the others; one table.

mod programs;
mod report;

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::spectral::Eigensolver;

use programs::cores;
use report::Line;

use super::program::{Program, body};
use super::python::{Python, PythonArguments};
use super::resources::{Usage, processor};
use super::spectrum::{self, Case, Solver};
use super::{scale, tree, voxelize};

/// What `cargo xtask bench all` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Ten minutes at most on two cores: few repetitions, and large cases left out or made smaller
    #[arg(long)]
    quick: bool,
    #[command(flatten)]
    python: PythonArguments,
    /// Folder for speed.md and speed.csv [default: docs/results]
    #[arg(short, long)]
    output: Option<PathBuf>,
}

/// The bodies of the spectrum's cases.
const BODIES: [&str; 2] = ["human", "makehuman"];
/// What is written of cases that take too long.
const LEFT_OUT: &str = "left out by --quick";

/// Measures all of it, and prints and writes the table.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let spectra = spectrum::Peers::find(&arguments.python)?;
    let trees = tree::Peers::find(&arguments.python)?;
    let python = Python::find(&arguments.python, &[&["numpy"], &["libigl"]])?;
    let load = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    let load = load.split_whitespace().next().unwrap_or("unknown");
    let mut heading = vec![format!("Machine: {}. Load when this began: {load}.", processor())];
    heading.extend(spectra.versions().into_iter().map(|version| format!("* {version}")));
    heading.extend(trees.version("higra").map(|version| format!("* {version}")));
    heading.iter().for_each(|line| println!("{line}"));

    let mut all = All { lines: Vec::new(), wrong: Vec::new(), quick: arguments.quick };
    all.spectra(&spectra)?;
    all.large_spectra(&spectra)?;
    all.completeness(&spectra)?;
    all.winding_numbers(&python)?;
    all.trees(&trees)?;
    all.programs()?;

    let All { mut lines, wrong, quick } = all;
    report::compare(&mut lines);
    println!("\n{}", report::TITLES);
    lines.iter().for_each(|line| println!("{}", line.text()));
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    report::write(arguments.output.as_deref().unwrap_or(&default), &lines, &heading, quick)?;
    if wrong.is_empty() { Ok(()) } else { Err(format!("wrong answers:\n{}", wrong.join("\n")).into()) }
}

/// The table while it grows.
struct All {
    lines: Vec<Line>,
    wrong: Vec<String>,
    quick: bool,
}

impl All {
    /// Runs solvers on a case of `bench spectrum`, and adds its rows as lines if there is a stage for them.
    fn solve(
        &mut self,
        stage: Option<&str>,
        name: &str,
        peers: &spectrum::Peers,
        plan: &spectrum::Plan,
    ) -> Result<Vec<spectrum::Row>, Box<dyn Error>> {
        let cases = spectrum::cases();
        let Some(case) = cases.iter().find(|case| case.name == name) else {
            let note = "its mesh is not here".to_string();
            self.lines.push(Line::without(&[stage.unwrap_or("spectrum").into(), name.into()], "", note));
            return Ok(Vec::new());
        };
        let (rows, failed) = spectrum::run_case(case, peers, plan)?;
        let failed = failed.into_iter().map(|message| format!("{name}: {message}"));
        self.wrong.extend(failed);
        let wrong = rows.iter().filter(|row| row.is_wrong());
        self.wrong.extend(wrong.map(|row| format!("{name}: {}, {} threads", row.solver, row.threads)));
        let Some(stage) = stage else { return Ok(rows) };
        let case = [stage.into(), description(case)];
        for row in &rows {
            let usage = Usage { cpu: row.cpu, wall: row.wall, peak: row.peak };
            let replaced = if row.solver.ends_with("multigrid") && row.used != "multigrid" {
                format!("; {} in its place", row.used)
            } else {
                String::new()
            };
            let note = format!("residual {:.0e}, {:.0} MB{replaced}", row.residual, row.peak / 1e6);
            self.lines.push(Line::new(&case, &row.solver, Some(row.threads), &usage).with(note));
        }
        for solver in plan.solvers.iter().filter(|solver| !peers.has(**solver)) {
            let note = format!("not here (to get it: {})", solver.advice());
            self.lines.push(Line::without(&case, solver.label(), note));
        }
        Ok(rows)
    }

    fn spectra(&mut self, peers: &spectrum::Peers) -> Result<(), Box<dyn Error>> {
        let solvers = vec![Solver::Ours(Eigensolver::Auto), Solver::ScipyCholmod, Solver::Spectra];
        let plan = spectrum::Plan { solvers, threads: vec![1, 2], repeat: if self.quick { 1 } else { 3 } };
        for body in BODIES {
            self.solve(Some("spectrum"), &format!("{body}-45K-k100"), peers, &plan)?;
        }
        Ok(())
    }

    fn large_spectra(&mut self, peers: &spectrum::Peers) -> Result<(), Box<dyn Error>> {
        let [filter, multigrid] = [Eigensolver::Filter, Eigensolver::Multigrid].map(Solver::Ours);
        let mut plan = spectrum::Plan { solvers: vec![filter], threads: vec![2], repeat: 1 };
        for body in if self.quick { &BODIES[..1] } else { &BODIES } {
            self.solve(Some("spectrum"), &format!("{body}-1M-k100"), peers, &plan)?;
        }
        let name = format!("{}-10M-k50", BODIES[0]);
        if self.quick {
            let (case, by) = (["spectrum".into(), name], "mser3d filter, multigrid");
            self.lines.push(Line::without(&case, by, LEFT_OUT.into()));
            return Ok(());
        }
        plan.solvers.push(multigrid);
        self.solve(Some("spectrum"), &name, peers, &plan).map(drop)
    }

    /// Whether eigenvalues were missed, over solids that make that easy, and bodies.
    fn completeness(&mut self, peers: &spectrum::Peers) -> Result<(), Box<dyn Error>> {
        let [chosen, multigrid] = [Eigensolver::Auto, Eigensolver::Multigrid].map(Solver::Ours);
        let solvers = vec![chosen, multigrid, Solver::ScipyCholmod];
        let plan = spectrum::Plan { solvers, threads: vec![1], repeat: 1 };
        let hard = spectrum::cases().into_iter().filter(Case::is_for_completeness);
        let mut names: Vec<String> = hard.map(|case| case.name).collect();
        for (number, body) in BODIES.iter().enumerate() {
            names.push(format!("{body}-45K-k100"));
            if number == 0 || !self.quick {
                names.push(format!("{body}-350K-k100"));
            }
        }
        let mut rows = Vec::new();
        for name in &names {
            rows.extend(self.solve(None, name, peers, &plan)?);
        }
        let case = ["completeness".into(), format!("{} cases, 26K to 350K rows", names.len())];
        for solver in plan.solvers {
            let own: Vec<_> = rows.iter().filter(|row| row.solver == solver.label()).collect();
            if own.is_empty() {
                let note = format!("not here, so nothing is compared (to get it: {})", solver.advice());
                self.lines.push(Line::without(&case, solver.label(), note));
                continue;
            }
            let sum = |of: fn(&spectrum::Row) -> f64| own.iter().map(|&row| of(row)).sum::<f64>();
            let usage = Usage { cpu: sum(|row| row.cpu), wall: sum(|row| row.wall), peak: f64::NAN };
            let compared = own.iter().filter(|row| !row.difference.is_nan());
            let most = compared.clone().map(|row| row.difference).fold(0.0, f64::max);
            let missed = compared.clone().filter(|row| row.difference > spectrum::SAME).count();
            let replaced =
                own.iter().filter(|row| row.solver.ends_with("multigrid") && row.used != "multigrid");
            let others = match replaced.count() {
                0 => String::new(),
                some => format!("; in {some} the filter took over"),
            };
            let note = format!(
                "eigenvalues missed in {missed} of {} cases, largest difference {most:.0e}{others}",
                compared.count()
            );
            self.lines.push(Line::new(&case, solver.label(), Some(own[0].threads), &usage).with(note));
        }
        Ok(())
    }

    /// The inside of an open mesh.
    fn winding_numbers(&mut self, python: &Python) -> Result<(), Box<dyn Error>> {
        let mesh = voxelize::meshes::with_holes(&voxelize::meshes::figure()?)?;
        let tasks = [voxelize::TASKS[1], voxelize::TREE_CODE];
        let runs = if self.quick { 3 } else { 5 };
        let plan = voxelize::Plan { tasks: &tasks, threads: &[1], runs, peers: &["libigl"] };
        let resolution = if self.quick { 256 } else { 512 };
        let rows = voxelize::compare("open figure", &mesh, resolution, python, &plan)?;
        let size = if self.quick { ", 512 along a side left out by --quick" } else { "" };
        let case = ["open mesh".into(), rows.first().map_or(String::new(), |row| row.case.clone() + size)];
        for row in &rows {
            let usage = Usage { cpu: row.cpu, wall: row.wall, peak: row.memory };
            let by = if row.library == tasks[0].1 { "mser3d, crossings and holes" } else { &row.library };
            let note = row.differing.map_or(String::new(), |n| format!("{n} voxels differ"));
            self.lines.push(Line::new(&case, by, row.threads, &usage).with(note));
        }
        if !rows.iter().any(|row| row.library.starts_with("libigl")) {
            let note = "not here (to get it: pip install libigl)".to_string();
            self.lines.push(Line::without(&case, "libigl fast winding number", note));
        }
        Ok(())
    }

    fn trees(&mut self, peers: &tree::Peers) -> Result<(), Box<dyn Error>> {
        for name in ["smooth-10M", "smooth-10M-u16", "smooth-10M-u8", "noise-1M"] {
            let Some(field) = tree::FIELDS.iter().find(|field| field.name == name) else { continue };
            let mut rows = tree::run_field(field, &["vertex"], peers, &[1], if self.quick { 2 } else { 5 })?;
            let case = ["vertex tree".into(), name.into()];
            let wrong = rows.iter().filter(|row| row.same == "no");
            self.wrong.extend(wrong.map(|row| format!("{name}: {}: another tree", row.library)));
            // Ours first: the others' ratios are to it.
            rows.reverse();
            for row in &rows {
                let usage = Usage { cpu: row.cpu, wall: row.wall, peak: row.memory };
                let bytes = row.memory / row.vertices as f64;
                let same = if row.same == "yes" { "; the same tree" } else { "" };
                let note = format!(
                    "{:.0} ns and {bytes:.0} bytes a voxel{same}",
                    1e9 * row.cpu / row.vertices as f64
                );
                self.lines.push(Line::new(&case, &row.library, Some(row.threads), &usage).with(note));
            }
            if peers.version("higra").is_none() {
                let note = "not here (to get it: pip install higra)".to_string();
                self.lines.push(Line::without(&case, "Higra", note));
            }
        }
        Ok(())
    }

    /// The released program.
    fn programs(&mut self) -> Result<(), Box<dyn Error>> {
        let program = Program::build()?;
        for name in BODIES {
            let case = ["detect".into(), format!("{name}, 45K voxels, k = 100")];
            self.lines.push(match body(name) {
                Some(mesh) => programs::detect(&program, &mesh, &case, if self.quick { 3 } else { 7 })?,
                None => Line::without(&case, "mser3d detect", "its mesh is not here".into()),
            });
        }
        self.lines.push(programs::batch(&program, if self.quick { 40 } else { 200 })?);
        for name in if self.quick { &BODIES[..1] } else { &BODIES } {
            let case = ["scale".into(), format!("{name}, 1M and 10M voxels, k = 30, residual 1e-4")];
            let Some(mesh) = body(name) else {
                self.lines.push(Line::without(&case, "mser3d detect", "its mesh is not here".into()));
                continue;
            };
            let runs = scale::Run::measure_all(&program, &mesh, &[1_000_000, 10_000_000], None)?;
            for (run, size) in runs.iter().zip(["1M", "10M"]) {
                let mut note = format!("{size} by {}, {:.0} MB", run.solver, run.usage.peak / 1e6);
                if !run.overlaps.is_empty() {
                    note += &format!(", {}", run.found());
                }
                self.lines.push(Line::new(&case, "mser3d detect", Some(cores()), &run.usage).with(note));
            }
        }
        Ok(())
    }
}

/// A case in words.
fn description(case: &Case) -> String {
    format!("{}, residual {:.0e}", case.name, case.tolerance)
}
