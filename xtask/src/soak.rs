//! `cargo xtask soak`: many bodies that no one has seen through `mser3d batch`, once in peace and once with kills at random, and
//! other people's meshes through `mser3d inspect` and `mser3d detect`.
//!
//! * Every figure has a result, and memory does not grow: the first hundred are run again at the end, and their peak is the same.
//! * A batch that is killed and run again ends with the bytes of one that was left in peace, and leaves nothing behind.
//! * Every mesh is answered, or refused in one message.

mod corpora;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::{Read, Seek};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use crate::command::{program, runs};
use crate::fixtures::{off, random_figure};

/// What `cargo xtask soak` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Random figures
    #[arg(long, default_value_t = 1000, value_name = "N")]
    shapes: usize,
    /// The figures and the moments of the kills follow from it
    #[arg(long, default_value_t = 1, value_name = "S")]
    seed: u64,
    /// Voxels of each figure
    #[arg(long, default_value_t = 3000, value_name = "N")]
    voxels: usize,
    /// Times that the second batch is killed
    #[arg(long, default_value_t = 40, value_name = "N")]
    kills: usize,
    /// Get the meshes that Debian's libcgal-demo and PyPI's pyvista bring
    #[arg(long)]
    install: bool,
}

/// Figures whose memory is compared, at the start and at the end.
const COMPARED: usize = 100;

/// The peak may differ by so much: pages that the allocator has kept.
const FLAT: f64 = 0.02;

/// A run on one mesh takes at most so long.
const ONE: Duration = Duration::from_secs(120);

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = std::path::absolute("target/soak")?;
    let program = program()?;
    let mut faults = Vec::new();
    let shapes = folder.join("shapes");
    let count = figures(&shapes, arguments)?;
    let peaceful = folder.join("peaceful");
    faults.extend(in_peace(&program, (&shapes, count), &peaceful, arguments)?);
    faults.extend(with_kills(&program, (&shapes, count), &folder.join("killed"), &peaceful, arguments)?);
    faults.extend(corpora::run(&program, &folder.join("corpora"), arguments.install)?);
    if faults.is_empty() {
        return Ok(());
    }
    faults.iter().for_each(|fault| println!("fault: {fault}"));
    Err(format!("{} faults", faults.len()).into())
}

/// Writes the figures, and the first hundred once more at the end, by names in this order; how many files.
fn figures(folder: &Path, arguments: &Arguments) -> Result<usize, Box<dyn Error>> {
    afresh(folder)?;
    let start = Instant::now();
    let again = arguments.shapes.min(COMPARED);
    let write = |number: usize| -> Result<(), String> {
        let seed = arguments.seed.wrapping_mul(1_000_003).wrapping_add(number as u64);
        let (vertices, triangles) = random_figure(seed);
        let bytes = off(&vertices, &triangles);
        let names = [format!("figure_{number:05}.off"), format!("zz_again_{number:05}.off")];
        for name in &names[..if number < again { 2 } else { 1 }] {
            let path = folder.join(name);
            std::fs::write(&path, &bytes).map_err(|e| format!("{}: {e}", path.display()))?;
        }
        Ok(())
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    let work = |first: usize| (first..arguments.shapes).step_by(workers).try_for_each(write);
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..workers).map(|first| scope.spawn(move || work(first))).collect();
        running.into_iter().try_for_each(|worker| worker.join().map_err(|_| "a thread ended".to_owned())?)
    })?;
    println!(
        "{} figures, {again} of them twice, in {:.0} s",
        arguments.shapes,
        start.elapsed().as_secs_f64()
    );
    Ok(arguments.shapes + again)
}

/// An empty folder.
fn afresh(folder: &Path) -> Result<(), String> {
    let fail = |e: std::io::Error| format!("{}: {e}", folder.display());
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(fail)?;
    }
    std::fs::create_dir_all(folder).map_err(fail)
}

/// The batch of these shapes, one at a time: memory is then that of one shape.
fn batch(program: &Path, shapes: &Path, folder: &Path, arguments: &Arguments) -> Command {
    let mut command = Command::new(program);
    command.arg("batch").arg(shapes).arg("-o").arg(folder).args(["--quiet", "--workers", "1"]);
    command.args(["--voxels", &arguments.voxels.to_string()]).stdin(Stdio::null());
    command
}

fn in_peace(
    program: &Path,
    (shapes, count): (&Path, usize),
    folder: &Path,
    arguments: &Arguments,
) -> Result<Vec<String>, Box<dyn Error>> {
    afresh(folder)?;
    let mut faults = Vec::new();
    let start = Instant::now();
    let log = folder.with_extension("log");
    let mut child = batch(program, shapes, folder, arguments)
        .stdout(Stdio::null())
        .stderr(std::fs::File::create(&log)?)
        .spawn()?;
    let again = arguments.shapes.min(COMPARED);
    let mut peaks: [Option<u64>; 2] = [None; 2];
    let mut before = 0;
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        let through = finished(folder);
        let peak = peak_memory(child.id());
        if through < again {
            peaks[0] = peak.or(peaks[0]);
        } else if through >= arguments.shapes {
            if peaks[1].is_none() {
                // From here on, the peak of the last hundred alone.
                let _ = std::fs::write(format!("/proc/{}/clear_refs", child.id()), "5");
                peaks[1] = Some(0);
            } else if through > before {
                // Tables, which come after the last shape, take memory for all shapes.
                peaks[1] = peak.or(peaks[1]);
            }
        }
        before = through;
        std::thread::sleep(Duration::from_millis(50));
    };
    let seconds = start.elapsed().as_secs_f64();
    let found = finished(folder);
    println!("in peace: {found} of {} shapes in {seconds:.0} s, {status}", count);
    if !status.success() || found != count {
        let text = std::fs::read_to_string(&log).unwrap_or_default();
        faults.push(format!("the batch in peace: {status}, {found} results: {}", text.trim()));
    }
    match peaks {
        [Some(first), Some(last)] if first > 0 && last > 0 => {
            let growth = last as f64 / first as f64 - 1.0;
            println!(
                "peak memory: {} kB of the first {again}, {} kB of the same at the end, {:+.2} %",
                first / 1024,
                last / 1024,
                100.0 * growth
            );
            if growth > FLAT {
                faults.push(format!("memory grows by {:.1} %", 100.0 * growth));
            }
        }
        _ => println!("skipped: memory, which this system does not tell or which was too quick to see"),
    }
    Ok(faults)
}

/// Results that are there.
fn finished(folder: &Path) -> usize {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter(|entry| !hidden(&entry.path()) && entry.path().join("regions.json").is_file()).count()
}

fn hidden(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"."))
}

/// The most memory that a process had, in bytes, where the system tells.
fn peak_memory(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kib| kib * 1024)
}

/// Kills a batch at random and runs it again, until it ends by itself.
fn with_kills(
    program: &Path,
    (shapes, count): (&Path, usize),
    folder: &Path,
    peaceful: &Path,
    arguments: &Arguments,
) -> Result<Vec<String>, Box<dyn Error>> {
    afresh(folder)?;
    let start = Instant::now();
    let mut faults = Vec::new();
    let mut state = arguments.seed;
    let mut random = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64
    };
    let mut kills = [0usize; 2];
    loop {
        let mut child =
            batch(program, shapes, folder, arguments).stdout(Stdio::null()).stderr(Stdio::null()).spawn()?;
        if kills[0] + kills[1] == arguments.kills {
            let status = child.wait()?;
            if !status.success() {
                faults.push(format!("the last run of the killed batch: {status}"));
            }
            break;
        }
        // Each run does some more of the work; most of the time it is computing, at times starting, writing or merging.
        let wait = Duration::from_millis((random() * random() * 6000.0) as u64);
        let gently = cfg!(unix) && random() < 0.5;
        let ended = wait_for(&mut child, wait)?;
        if ended {
            break;
        }
        if gently {
            runs("kill", &["-TERM", &child.id().to_string()]);
            let asked = Instant::now();
            if !wait_for(&mut child, Duration::from_secs(10))? {
                faults.push("a batch does not end 10 s after SIGTERM".to_owned());
                child.kill()?;
            }
            let _ = (child.wait()?, asked.elapsed());
        } else {
            child.kill()?;
            child.wait()?;
        }
        kills[usize::from(gently)] += 1;
    }
    let [killed, ended] = kills;
    println!(
        "with kills: {} of {} shapes in {:.0} s, {killed} by SIGKILL, {ended} by SIGTERM",
        finished(folder),
        count,
        start.elapsed().as_secs_f64()
    );
    let [expected, found] = [contents(peaceful)?, contents(folder)?];
    for (name, bytes) in &expected {
        match found.get(name) {
            None => faults.push(format!("{name} is missing after kills")),
            Some(other) if other != bytes => faults.push(format!("{name} has other bytes after kills")),
            Some(_) => {}
        }
    }
    faults.extend(
        found
            .keys()
            .filter(|name| !expected.contains_key(*name))
            .map(|name| format!("{name} is left behind")),
    );
    Ok(faults)
}

/// Whether a process has ended within this time.
fn wait_for(child: &mut Child, time: Duration) -> Result<bool, std::io::Error> {
    let start = Instant::now();
    loop {
        if child.try_wait()?.is_some() {
            return Ok(true);
        }
        if start.elapsed() > time {
            return Ok(false);
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// All files below a folder with their bytes; of records without what changes from run to run.
fn contents(folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Box<dyn Error>> {
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(path) = folders.pop() {
        for entry in std::fs::read_dir(&path)? {
            let path = entry?.path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            // Times are in the records, and so in their checksums.
            if path.ends_with("checksums.json") {
                continue;
            }
            let mut bytes = std::fs::read(&path)?;
            if path.extension().is_some_and(|ending| ending == "json")
                && let Ok(mut record) = serde_json::from_slice::<serde_json::Value>(&bytes)
            {
                if let Some(fields) = record.as_object_mut() {
                    fields.remove("run");
                }
                bytes = record.to_string().into_bytes();
            }
            files.insert(path.strip_prefix(folder)?.display().to_string(), bytes);
        }
    }
    Ok(files)
}

/// How a command ended, and what it said on stderr; none where it did not end in time.
fn said(command: &mut Command, limit: Duration) -> Result<Option<(ExitStatus, String)>, Box<dyn Error>> {
    let mut log = tempfile::tempfile()?;
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(log.try_clone()?).spawn()?;
    if !wait_for(&mut child, limit)? {
        child.kill()?;
        child.wait()?;
        return Ok(None);
    }
    let mut bytes = Vec::new();
    log.rewind()?;
    log.read_to_end(&mut bytes)?;
    Ok(Some((child.wait()?, String::from_utf8_lossy(&bytes).into_owned())))
}
