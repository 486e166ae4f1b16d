//! How a command that computes runs: what it says meanwhile, and with how many threads.

use mser3d_results::Extra;

use crate::choice::choice;
use crate::error::CliError;
use crate::message::tell;
use crate::numbers::count;

/// The most threads, where the machine has no more cores: so many cost little even on one core; a thousand take minutes to get
/// out of each other's way.
const MOST_THREADS: usize = 32;

#[derive(clap::Args, Clone, Debug)]
pub struct RunOptions {
    /// No progress and no warnings on stderr, no table on stdout
    #[arg(short, long)]
    pub quiet: bool,
    /// Threads to use, 32 or the number of cores at most; the result is the same for any number [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

/// How a command runs that computes many shapes, or frames.
#[derive(clap::Args, Clone, Debug)]
pub struct ManyOptions {
    /// Write this too, for each shape
    #[arg(long, value_name = "WHAT,...", value_parser = choice::<Extra>(), value_delimiter = ',')]
    pub write: Vec<Extra>,
    /// Shapes in parallel, as far as memory allows [default: one a thread]
    #[arg(long, value_name = "N", value_parser = count)]
    workers: Option<usize>,
    #[command(flatten)]
    pub run: RunOptions,
}

impl ManyOptions {
    /// Shapes in parallel.
    pub fn workers(&self) -> usize {
        self.workers.unwrap_or_else(rayon::current_num_threads)
    }
}

impl RunOptions {
    /// The number of threads that is asked for, as far as they are of use.
    pub fn threads(&self) -> Result<Option<usize>, CliError> {
        match self.threads {
            Some(0) => Err(CliError::Usage("--threads 0: must be at least 1".into())),
            threads => Ok(threads.map(|n| n.min(most_threads()))),
        }
    }

    /// Sets the number of threads for everything that follows.
    pub fn use_threads(&self) -> Result<(), CliError> {
        let asked = match self.threads {
            Some(n) => Some(("--threads ", n)),
            None => {
                let variable = std::env::var("RAYON_NUM_THREADS").ok().and_then(|n| n.parse().ok());
                variable.map(|n| ("RAYON_NUM_THREADS=", n)).filter(|(_, n)| *n > most_threads())
            }
        };
        let Some((option, n)) = asked else { return Ok(()) };
        let used = self.threads()?.unwrap_or(most_threads());
        if used < n && !self.quiet {
            let cores = cores();
            tell(&format!(
                "warning: {option}{n}: {used} threads are used; more only cost time on {cores} cores"
            ));
        }
        rayon::ThreadPoolBuilder::new()
            .num_threads(used)
            .build_global()
            .map_err(|e| CliError::Usage(format!("{option}{n}: {e}")))
    }
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, Into::into)
}

fn most_threads() -> usize {
    cores().max(MOST_THREADS)
}
