//! `cargo xtask bench spectrum`: the smallest eigenpairs by our solvers and by others, on the same
//! matrices, each in a process of its own, in turns; answers compared.

mod cases;
mod exchange;
mod growth;
mod ours;
mod report;
mod solvers;

pub use cases::{Case, cases};
pub use report::Row;
pub use solvers::{Peers, Solver};

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::laplace::Operator;
use serde_json::Value;

use cases::series;
use exchange::{difference, read_solution, residual_and_orthogonality, write_problem};

use super::python::{PythonArguments, answer};
use super::resources::processor;

/// What `cargo xtask bench spectrum` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Only cases with this in their names; may be given several times
    #[arg(long)]
    case: Vec<String>,
    /// Only solvers with this in their names, and write nothing; may be given several times
    #[arg(long)]
    solver: Vec<String>,
    /// Threads of our solvers, one row each; peers get the first
    #[arg(long, value_delimiter = ',', default_value = "1,2")]
    threads: Vec<usize>,
    /// How often each solver runs on cases up to 500,000 rows; once on larger ones
    #[arg(long, default_value_t = 3)]
    repeat: usize,
    /// One repetition, no case above 100,000 rows
    #[arg(long)]
    quick: bool,
    /// The cases of one and ten million voxels too: minutes, and up to 16 GB
    #[arg(long)]
    large: bool,
    /// Instead: how the cost of our solvers grows with the size and the number of eigenpairs
    #[arg(long)]
    growth: bool,
    #[command(flatten)]
    python: PythonArguments,
    /// Folder for spectrum.md and spectrum.csv, or spectrum_growth.md [default: docs/results]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Solve one case by one solver of ours and print what came out
    #[arg(long, num_args = 2, hide = true)]
    child: Option<Vec<String>>,
}

/// Differences between eigenvalues beyond this are different answers.
pub const SAME: f64 = 1e-6;

/// Who solves a case, and how often.
pub struct Plan {
    /// Those that are not here are left out.
    pub solvers: Vec<Solver>,
    /// Threads of our solvers, one row each; peers get the first.
    pub threads: Vec<usize>,
    /// The run with the fewest CPU seconds counts.
    pub repeat: usize,
}

/// Runs the cases and prints and writes the tables.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let all = cases();
    if let Some([case, solver]) = arguments.child.as_deref() {
        let series: Vec<Case> = series().into_iter().flat_map(|s| s.cases).map(|(_, case)| case).collect();
        let mut known = all.iter().chain(&series);
        let case = known.find(|c| c.name == *case).ok_or_else(|| format!("no case {case}"))?;
        return ours::solve_and_print(case, solver.parse()?);
    }
    let default = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/results");
    let output = arguments.output.clone().unwrap_or(default);
    if arguments.growth {
        return growth::run(&output, arguments.repeat);
    }
    let peers = Peers::find(&arguments.python)?;
    let mut heading = vec![format!("Machine: {}.", processor())];
    heading.extend(peers.versions().into_iter().map(|v| format!("* {v}")));
    heading.iter().chain(&peers.missing()).for_each(|line| println!("{line}"));

    let chosen = all.iter().filter(|case| {
        let limit = match (arguments.quick, arguments.large) {
            (true, _) => 100_000,
            (false, false) => 500_000,
            (false, true) => usize::MAX,
        };
        case.size() <= limit
            && (arguments.case.is_empty() || arguments.case.iter().any(|part| case.name.contains(part)))
    });
    let asked = |solver: Solver| {
        let label = solver.label().to_lowercase();
        arguments.solver.is_empty() || arguments.solver.iter().any(|p| label.contains(&p.to_lowercase()))
    };
    let order: Vec<String> = all.iter().map(|case| case.name.clone()).collect();
    let mut wrong = Vec::new();
    for case in chosen {
        let once = arguments.quick || case.is_for_completeness() || case.size() > 500_000;
        let plan = Plan {
            solvers: Solver::of(case).into_iter().filter(|solver| asked(*solver)).collect(),
            threads: arguments.threads.clone(),
            repeat: if once { 1 } else { arguments.repeat },
        };
        let (rows, failed) = run_case(case, &peers, &plan)?;
        wrong.extend(failed.into_iter().map(|message| format!("{}: {message}", case.name)));
        for row in &rows {
            if row.is_wrong() {
                wrong.push(format!("{}: {}", case.name, report::line(row)));
            }
        }
        // Written case by case: the later ones take long. Some solvers alone are no comparison.
        if arguments.solver.is_empty() {
            report::write(&output, &rows, &order, &heading)?;
        }
    }
    if wrong.is_empty() { Ok(()) } else { Err(format!("wrong answers:\n{}", wrong.join("\n")).into()) }
}

/// What one run of one solver came to.
struct Outcome {
    row: Row,
    values: Vec<f64>,
    digest: Option<String>,
}

/// Runs all solvers on a case, in turns, and prints its table. The second list says what failed.
pub fn run_case(case: &Case, peers: &Peers, plan: &Plan) -> Result<(Vec<Row>, Vec<String>), Box<dyn Error>> {
    let problem = case.problem()?;
    let operator = problem.operator()?;
    let folder = peers.folder().join(&case.name);
    println!(
        "\n{}: {} rows, k = {}, residual {:.0e}\n{}",
        case.name,
        operator.len(),
        case.eigenpairs,
        case.tolerance,
        report::TITLES
    );
    let mut runs: Vec<(Solver, usize)> = Vec::new();
    for &solver in plan.solvers.iter().filter(|&&solver| peers.has(solver)) {
        let ours = matches!(solver, Solver::Ours(_));
        let threads = if ours { &plan.threads[..] } else { &plan.threads[..1] };
        runs.extend(threads.iter().map(|&threads| (solver, threads)));
    }
    if runs.iter().any(|(solver, _)| !matches!(solver, Solver::Ours(_))) {
        write_problem(&folder, &problem, &operator)?;
    }
    drop(problem);
    let mut best: Vec<Option<Outcome>> = runs.iter().map(|_| None).collect();
    let mut failed = Vec::new();
    for _ in 0..plan.repeat {
        for (&(solver, threads), best) in runs.iter().zip(&mut best) {
            match run_solver(case, &operator, peers, solver, threads, &folder) {
                Ok(new) => {
                    if best.as_ref().is_none_or(|old| new.row.cpu < old.row.cpu) {
                        *best = Some(new);
                    }
                }
                Err(error) => {
                    let message = format!("{:20} {threads:7} failed: {error}", solver.label());
                    println!("{message}");
                    if matches!(solver, Solver::Ours(_)) {
                        failed.push(message);
                    }
                }
            }
        }
    }
    if folder.exists() {
        std::fs::remove_dir_all(&folder)?;
    }
    let ours = best.first().and_then(Option::as_ref).map(|first| first.row.cpu);
    let rows = judged(best.into_iter().flatten().collect(), ours);
    rows.iter().for_each(|row| println!("{}", report::line(row)));
    Ok((rows, failed))
}

/// Compares the outcomes with the oracle's, with our CPU seconds, and with those for other numbers of threads.
fn judged(mut outcomes: Vec<Outcome>, ours: Option<f64>) -> Vec<Row> {
    let oracles = [Solver::ScipyCholmod, Solver::ScipySuperLu, Solver::Spectra].map(Solver::label);
    let mut peers =
        oracles.iter().filter_map(|&label| outcomes.iter().find(|o| o.row.solver == label)).peekable();
    let least = peers.peek().map(|_| least(&outcomes));
    let complete =
        peers.find(|peer| least.as_ref().is_some_and(|least| difference(&peer.values, least) <= SAME));
    let expected = complete.map(|peer| peer.values.clone()).or(least);
    let digests: Vec<_> = outcomes.iter().map(|o| (o.row.solver.clone(), o.digest.clone())).collect();
    for outcome in &mut outcomes {
        let row = &mut outcome.row;
        row.difference = expected.as_ref().map_or(f64::NAN, |expected| difference(&outcome.values, expected));
        row.ratio = ours.map_or(f64::NAN, |ours| row.cpu / ours);
        let mut siblings = digests.iter().filter(|(solver, _)| *solver == row.solver);
        if outcome.digest.is_some() && siblings.clone().count() > 1 {
            let same = siblings.all(|(_, digest)| *digest == outcome.digest);
            row.same_bits = if same { "yes" } else { "no" }.into();
        }
    }
    outcomes.into_iter().map(|outcome| outcome.row).collect()
}

/// The least eigenvalue that was found in each place, by solvers whose functions are orthonormal: those never give less than
/// the true ones, so who has more missed one before.
fn least(outcomes: &[Outcome]) -> Vec<f64> {
    let sound = outcomes.iter().filter(|outcome| outcome.row.orthogonality < SAME);
    let both = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| a.min(*b)).collect();
    sound.map(|outcome| outcome.values.clone()).reduce(both).unwrap_or_default()
}

/// Runs one solver in a process of its own.
fn run_solver(
    case: &Case,
    operator: &Operator,
    peers: &Peers,
    solver: Solver,
    threads: usize,
    folder: &Path,
) -> Result<Outcome, Box<dyn Error>> {
    let solution = folder.join("solution.bin");
    let mut command = peers.command(solver, case, folder, &solution)?;
    for variable in ["RAYON_NUM_THREADS", "OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"] {
        command.env(variable, threads.to_string());
    }
    let answer = answer(&mut command)?;
    let number = |key: &str| answer[key].as_f64().unwrap_or(f64::NAN);
    let (values, residual, orthogonality) = match answer["values"].as_array() {
        Some(values) => {
            let values = values.iter().filter_map(Value::as_f64).collect();
            (values, number("residual"), number("orthogonality"))
        }
        None => {
            let found = read_solution(&solution, operator.len(), case.eigenpairs)?;
            let (residual, orthogonality) =
                residual_and_orthogonality(operator, &found.values, &found.functions);
            (found.values, residual, orthogonality)
        }
    };
    let row = Row {
        case: case.name.clone(),
        rows: operator.len(),
        eigenpairs: case.eigenpairs,
        tolerance: case.tolerance,
        solver: solver.label().into(),
        threads,
        cpu: number("cpu"),
        wall: number("wall"),
        peak: number("peak"),
        residual,
        orthogonality,
        difference: f64::NAN,
        ratio: f64::NAN,
        same_bits: String::new(),
        used: answer["solver"].as_str().unwrap_or_default().into(),
    };
    Ok(Outcome { row, values, digest: answer["digest"].as_str().map(Into::into) })
}
