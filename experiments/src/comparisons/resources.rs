//! What a process has used so far, and what it runs on; from /proc, so on Linux only.

use std::error::Error;
use std::fs;
use std::process::Command;
use std::time::Instant;

/// Clock ticks of `/proc/self/stat` in a second, on every Linux there is.
const TICKS: f64 = 100.0;

/// Measures a stretch of work within this process.
pub struct Stopwatch {
    start: Instant,
    cpu: f64,
}

/// What a stretch of work took.
pub struct Usage {
    /// User and system time of all threads, seconds; NaN where the system doesn't say.
    pub cpu: f64,
    /// Seconds.
    pub wall: f64,
    /// Highest resident memory, bytes; NaN where the system doesn't say.
    pub peak: f64,
}

impl Stopwatch {
    /// Starts. Memory that was used and given back before doesn't count.
    pub fn start() -> Self {
        // 5 resets the high-water mark; where that isn't allowed, the peak is the whole process's.
        let _ = fs::write("/proc/self/clear_refs", "5");
        Self { start: Instant::now(), cpu: cpu_seconds() }
    }

    pub fn stop(self) -> Usage {
        let wall = self.start.elapsed().as_secs_f64();
        Usage { cpu: cpu_seconds() - self.cpu, wall, peak: status_bytes("VmHWM:") }
    }
}

/// Runs a program to its end, with nothing else running for this process meanwhile. Its peak is not known.
///
/// # Errors
/// Why it did not start, or the last line that it said when it failed.
pub fn of_process(command: &mut Command) -> Result<Usage, Box<dyn Error>> {
    let (start, before) = (Instant::now(), cpu_ticks(13));
    let output = command.output()?;
    let (wall, cpu) = (start.elapsed().as_secs_f64(), cpu_ticks(13) - before);
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(text.lines().next_back().unwrap_or("no message").into());
    }
    Ok(Usage { cpu: cpu / TICKS, wall, peak: f64::NAN })
}

/// Seconds that all cores together have had nothing to do since the system started; NaN where it doesn't say.
pub fn idle_seconds() -> f64 {
    let stat = fs::read_to_string("/proc/stat").unwrap_or_default();
    let ticks = stat.split_whitespace().nth(4).and_then(|ticks| ticks.parse::<f64>().ok());
    ticks.map_or(f64::NAN, |ticks| ticks / TICKS)
}

/// Resident memory now, bytes; NaN where the system doesn't say.
pub fn resident() -> f64 {
    status_bytes("VmRSS:")
}

fn cpu_seconds() -> f64 {
    cpu_ticks(11) / TICKS
}

/// User and system time of this process, from 11 on, or of those that it waited for, from 13 on.
fn cpu_ticks(from: usize) -> f64 {
    let stat = fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The second field is the program's name in parentheses; utime and stime are the 14th and 15th, of children the 16th and 17th.
    let after = stat.rsplit(')').next().unwrap_or_default();
    let ticks = |at: usize| after.split_whitespace().nth(at).and_then(|t| t.parse::<f64>().ok());
    ticks(from).zip(ticks(from + 1)).map_or(f64::NAN, |(user, system)| user + system)
}

fn status_bytes(key: &str) -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix(key));
    let kilobytes = line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok());
    kilobytes.map_or(f64::NAN, |kb| kb * 1024.0)
}

/// The processor and the cores that may be used.
pub fn processor() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |key: &str| {
        let line = info.lines().find(|line| line.starts_with(key))?;
        Some(line.split_once(':')?.1.trim().to_string())
    };
    let model = field("model name").unwrap_or_else(|| std::env::consts::ARCH.into());
    let vectors = field("flags").map_or("", |flags| {
        let has = |flag: &str| flags.split_whitespace().any(|f| f == flag);
        if has("avx512f") {
            ", AVX-512"
        } else if has("avx2") {
            ", AVX2"
        } else {
            ""
        }
    });
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{model}{vectors}, {cores} cores, {}", std::env::consts::OS)
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn a_stopwatch_sees_time_and_memory() {
        let watch = Stopwatch::start();
        let start = Instant::now();
        let mut numbers = vec![1u64; 8 << 20];
        while start.elapsed().as_millis() < 80 {
            numbers.iter_mut().for_each(|x| *x = x.wrapping_mul(3));
        }
        let usage = watch.stop();
        assert!(std::hint::black_box(&numbers).len() == 8 << 20);
        // No upper bound: the time is the whole process's, other tests' included.
        assert!(usage.wall >= 0.08 && usage.cpu > 0.0);
        assert!(usage.peak > 6.4e7);
    }
}
