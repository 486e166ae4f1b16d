//! How a command that computes runs: what it says meanwhile, and with how many threads.

use crate::error::CliError;

/// More threads than any machine that this runs on has cores.
const MOST_THREADS: usize = 1024;

#[derive(clap::Args)]
pub struct RunOptions {
    /// No progress and no warnings on stderr, no table on stdout
    #[arg(short, long)]
    pub quiet: bool,
    /// Threads to use; the result is the same for any number [default: all cores]
    #[arg(long, value_name = "N")]
    threads: Option<usize>,
}

impl RunOptions {
    /// Sets the number of threads for everything that follows.
    pub fn use_threads(&self) -> Result<(), CliError> {
        match self.threads {
            None => Ok(()),
            Some(n) if !(1..=MOST_THREADS).contains(&n) => {
                Err(CliError::Usage(format!("--threads {n}: must be between 1 and {MOST_THREADS}")))
            }
            Some(n) => rayon::ThreadPoolBuilder::new()
                .num_threads(n)
                .build_global()
                .map_err(|e| CliError::Usage(format!("--threads {n}: {e}"))),
        }
    }
}
