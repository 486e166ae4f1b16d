//! `cargo xtask fuzz`: readers and loaders on damaged input, and algorithms beside exact oracles, by libFuzzer.
//!
//! The targets are in `fuzz/`, a workspace of its own: its program is built with the compiler's coverage instrumentation, which
//! needs no nightly toolchain and no cargo-fuzz, only a C++ compiler for libFuzzer itself. What was learned stays in
//! `target/fuzz/corpus`; an input that breaks a promise is kept in `target/fuzz/findings`.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

use crate::command::{MINUTE, output, runs};

/// Optimizing all crates takes minutes on a small machine.
const BUILD: Duration = Duration::from_secs(3600);

/// An input that takes longer hangs.
const HANG_SECONDS: u32 = 5;

/// What a process may take besides the 1 GB that an input may: the inputs that it has kept, and libFuzzer's own tables.
const PROCESS_MB: u32 = 2048;

/// Coverage as libFuzzer reads it: counters of edges, and what is compared with what.
const INSTRUMENTATION: &str = "-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4 \
    -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table \
    -Cllvm-args=-sanitizer-coverage-trace-compares";

/// What `cargo xtask fuzz` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// What to feed; default: all that `fuzz/src/targets.rs` lists
    targets: Vec<String>,
    /// How long, all targets together
    #[arg(long, default_value_t = 30.0, value_name = "N")]
    minutes: f64,
    /// Targets at the same time
    #[arg(long, default_value_t = 1, value_name = "N")]
    jobs: usize,
    /// Begin libFuzzer's random numbers here; 0: anywhere
    #[arg(long, default_value_t = 0, value_name = "S")]
    seed: u32,
    /// See also what `unsafe` code of dependencies does wrong: about three times slower, on Linux and macOS
    #[arg(long)]
    address_sanitizer: bool,
}

/// What came of a target.
struct Outcome {
    executions: u64,
    minutes: f64,
    /// The input that broke a promise, and what was said of it.
    finding: Option<(PathBuf, String)>,
}

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    if !cfg!(any(target_os = "linux", target_os = "macos")) {
        println!("skipped: libFuzzer is for Linux and macOS");
        return Ok(());
    }
    let compiler = std::env::var("CXX").unwrap_or_else(|_| "c++".to_owned());
    if !runs(&compiler, &["--version"]) {
        println!("skipped: {compiler}, a C++ compiler, is not there; libFuzzer needs it");
        return Ok(());
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").canonicalize()?;
    let program = build(&root, arguments.address_sanitizer)?;
    let known = output(Command::new(&program).env("MSER3D_FUZZ_TARGET", "list"), MINUTE)?;
    let known: Vec<&str> = known.split_whitespace().collect();
    if let Some(strange) = arguments.targets.iter().find(|target| !known.contains(&target.as_str())) {
        return Err(format!("there is no target {strange}; there are {}", known.join(", ")).into());
    }
    let chosen: Vec<&str> = match &arguments.targets[..] {
        [] => known,
        chosen => chosen.iter().map(String::as_str).collect(),
    };
    // Files that are read by their names, in memory where there is such a place.
    let memory = Path::new("/dev/shm");
    let scratch = if memory.is_dir() { tempfile::tempdir_in(memory) } else { tempfile::tempdir() }?;
    let jobs = arguments.jobs.clamp(1, chosen.len());
    let seconds = (arguments.minutes * 60.0 * jobs as f64 / chosen.len() as f64).max(1.0) as u64;
    let queue = Mutex::new(chosen.iter());
    let findings = Mutex::new(Vec::new());
    let totals = Mutex::new((0u64, 0.0));
    println!("{:<16}{:>12}{:>9}  finding", "target", "executions", "minutes");
    let work = || -> Result<(), String> {
        loop {
            let Some(target) = queue.lock().map_err(|e| e.to_string())?.next() else { return Ok(()) };
            let outcome = feed(&root, &program, target, seconds, arguments.seed, scratch.path())?;
            let Outcome { executions, minutes, finding } = outcome;
            let said = finding.as_ref().map_or("none", |(_, said)| said);
            println!("{target:<16}{executions:>12}{minutes:>9.1}  {said}");
            let mut totals = totals.lock().map_err(|e| e.to_string())?;
            (totals.0, totals.1) = (totals.0 + executions, totals.1 + minutes);
            if let Some((path, _)) = finding {
                findings.lock().map_err(|e| e.to_string())?.push((*target, path));
            }
        }
    };
    std::thread::scope(|scope| {
        let workers: Vec<_> = (0..jobs).map(|_| scope.spawn(work)).collect();
        workers.into_iter().try_for_each(|worker| worker.join().map_err(|_| "a thread ended".to_owned())?)
    })?;
    let (executions, minutes) = totals.into_inner().map_err(|e| e.to_string())?;
    let findings = findings.into_inner().map_err(|e| e.to_string())?;
    println!(
        "fuzz: {} targets, {executions} executions, {minutes:.1} minutes, {} findings",
        chosen.len(),
        findings.len()
    );
    for (target, path) in &findings {
        println!("again: MSER3D_FUZZ_TARGET={target} {} {}", program.display(), path.display());
    }
    if findings.is_empty() { Ok(()) } else { Err("an input breaks a promise".into()) }
}

/// Builds the program with instrumentation; where it is.
fn build(root: &Path, address_sanitizer: bool) -> Result<PathBuf, Box<dyn Error>> {
    let about = output(Command::new("rustc").arg("-vV"), MINUTE)?;
    let host = about.lines().find_map(|line| line.strip_prefix("host: ")).ok_or("rustc -vV names no host")?;
    let folder = root.join(if address_sanitizer { "target/fuzz-asan" } else { "target/fuzz" });
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = root.join("fuzz/Cargo.toml");
    output(Command::new(&cargo).args(["fmt", "--check", "--manifest-path"]).arg(&manifest), MINUTE)?;
    let mut command = Command::new(cargo);
    command.args(["build", "--quiet", "--release", "--locked", "--target", host, "--manifest-path"]);
    command.arg(manifest).arg("--target-dir").arg(&folder);
    let mut flags = INSTRUMENTATION.to_owned();
    if address_sanitizer {
        // The stable compiler has it, and its runtime, behind the door for unstable options.
        flags.push_str(" -Zsanitizer=address");
        command.env("RUSTC_BOOTSTRAP", "1");
    }
    // Named by the target, the flags are not those of build scripts and macros.
    command.env("RUSTFLAGS", flags).env("CARGO_INCREMENTAL", "0");
    let start = Instant::now();
    output(&mut command, BUILD)?;
    println!("built in {:.0} s", start.elapsed().as_secs_f64());
    Ok(folder.join(host).join("release/mser3d-fuzz"))
}

/// Feeds a target for so many seconds.
fn feed(
    root: &Path,
    program: &Path,
    target: &str,
    seconds: u64,
    seed: u32,
    scratch: &Path,
) -> Result<Outcome, String> {
    let folder = |name: &str| -> Result<PathBuf, String> {
        let path = root.join("target/fuzz").join(name).join(target);
        std::fs::create_dir_all(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        Ok(path)
    };
    let (corpus, findings) = (folder("corpus")?, folder("findings")?);
    let seeds = scratch.join(format!("seeds-{target}"));
    std::fs::create_dir_all(&seeds).map_err(|e| format!("{}: {e}", seeds.display()))?;
    let log = findings.join("log");
    let file = |path: &Path| std::fs::File::create(path).map_err(|e| format!("{}: {e}", path.display()));
    let mut command = Command::new(program);
    command.args([&corpus, &seeds]);
    command.arg(format!("-dict={}", root.join("fuzz/dictionary.txt").display()));
    command.arg(format!("-artifact_prefix={}/", findings.display()));
    command.arg(format!("-max_total_time={seconds}")).arg(format!("-timeout={HANG_SECONDS}"));
    command.arg(format!("-rss_limit_mb={PROCESS_MB}")).arg(format!("-seed={seed}"));
    command.args(["-print_final_stats=1", "-print_funcs=0", "-report_slow_units=60"]);
    command.env("MSER3D_FUZZ_TARGET", target).env("MSER3D_FUZZ_SEEDS", &seeds);
    command.env("MSER3D_FUZZ_SCRATCH", scratch).env("RAYON_NUM_THREADS", "1");
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(file(&log)?);
    let start = Instant::now();
    let status = command.status().map_err(|e| format!("{}: {e}", program.display()))?;
    let minutes = start.elapsed().as_secs_f64() / 60.0;
    let text = std::fs::read(&log).map_err(|e| format!("{}: {e}", log.display()))?;
    let text = String::from_utf8_lossy(&text);
    let executions = text.lines().find_map(|line| line.strip_prefix("stat::number_of_executed_units:"));
    // After a crash there are no statistics but those of the last line that told them.
    let told = || text.lines().rev().find_map(|line| line.strip_prefix('#')?.split_whitespace().next());
    let executions = executions.or_else(told).and_then(|word| word.trim().parse().ok()).unwrap_or(0);
    let kept =
        text.lines().find_map(|line| line.split_once("Test unit written to ").map(|(_, path)| path.trim()));
    let finding = match (status.success(), kept) {
        (true, _) => None,
        (false, Some(path)) => Some((PathBuf::from(path), reason(&text))),
        (false, None) => return Err(format!("{target}: {status}: see {}", log.display())),
    };
    Ok(Outcome { executions, minutes, finding })
}

/// What the process said when it ended, in a line.
fn reason(text: &str) -> String {
    let lines: Vec<&str> = text.lines().collect();
    // The last but that of the wrapper around a target. Earlier ones were caught.
    let unwinds = |at: &usize| !lines.get(at + 1).is_some_and(|next| next.contains("cannot unwind"));
    let mut panics = (0..lines.len()).rev().filter(|&at| lines[at].contains("panicked at"));
    let panic = panics.find(unwinds);
    let said = panic.map(|at| lines[at..].iter().take(2).copied().collect::<Vec<_>>().join(" "));
    let other = || {
        let known = ["memory allocation of", "ERROR: libFuzzer:", "has overflowed its stack"];
        lines
            .iter()
            .find(|line| known.iter().any(|words| line.contains(words)))
            .map(|line| (*line).to_owned())
    };
    said.or_else(other).unwrap_or_else(|| "it ended".to_owned()).chars().take(300).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_is_told_in_a_line() {
        let text = "#2 INITED cov: 5\nthread '<unnamed>' panicked at crates/a.rs:3:4:\nindex out of bounds\nthread 'x' panicked at \
                    b.rs:5:5:\npanic in a function that cannot unwind\n==1== ERROR: libFuzzer: \
                    deadly signal\nTest unit written to /x/crash-1\n";
        assert_eq!(reason(text), "thread '<unnamed>' panicked at crates/a.rs:3:4: index out of bounds");
        assert!(reason("==7== ERROR: libFuzzer: timeout after 5 seconds\n").contains("timeout"));
        assert_eq!(reason("memory allocation of 9 bytes failed\n"), "memory allocation of 9 bytes failed");
    }

    #[test]
    fn the_instrumented_workspace_locks_what_ours_locks() {
        // What is fuzzed is what is released: the same versions of what both use.
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let versions = |path: &str| -> Vec<(String, String)> {
            let text = std::fs::read_to_string(root.join(path)).unwrap();
            let field = |package: &str, name: &str| {
                let line = package.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(" = "));
                line.map(|value| value.trim_matches('"').to_owned())
            };
            text.split("[[package]]")
                .filter_map(|p| Some((field(p, "name")?, field(p, "version")?)))
                .collect()
        };
        let ours = versions("Cargo.lock");
        let fuzzed = versions("fuzz/Cargo.lock");
        assert!(fuzzed.len() > 100, "{}", fuzzed.len());
        let known = |name: &str| ours.iter().any(|(own, _)| own == name);
        let strange: Vec<_> = fuzzed.iter().filter(|p| known(&p.0) && !ours.contains(p)).collect();
        assert!(strange.is_empty(), "copy Cargo.lock to fuzz/ and build it again: {strange:?}");
    }
}
