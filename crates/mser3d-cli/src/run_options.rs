//! How a command that computes runs: what it says meanwhile, and with how many threads.

use mser3d_results::Extra;

use crate::choice::choice;
use crate::error::CliError;
use crate::numbers::count;

/// More threads than any machine that this runs on has cores.
const MOST_THREADS: usize = 1024;

#[derive(clap::Args, Clone, Debug)]
pub struct RunOptions {
    /// No progress and no warnings on stderr, no table on stdout
    #[arg(short, long)]
    pub quiet: bool,
    /// Threads to use; the result is the same for any number [default: all cores]
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
    /// The number of threads that is asked for.
    pub fn threads(&self) -> Result<Option<usize>, CliError> {
        match self.threads {
            Some(n) if !(1..=MOST_THREADS).contains(&n) => {
                Err(CliError::Usage(format!("--threads {n}: must be between 1 and {MOST_THREADS}")))
            }
            threads => Ok(threads),
        }
    }

    /// Sets the number of threads for everything that follows.
    pub fn use_threads(&self) -> Result<(), CliError> {
        match self.threads()? {
            None => Ok(()),
            Some(n) => rayon::ThreadPoolBuilder::new()
                .num_threads(n)
                .build_global()
                .map_err(|e| CliError::Usage(format!("--threads {n}: {e}"))),
        }
    }
}
