//! `mser3d verify`: whether results and collections are as they were written.

use std::path::PathBuf;

use mser3d_collection::verify_folder;

use crate::error::{CliError, print};
use crate::message::tell;

#[derive(clap::Args)]
pub struct VerifyArgs {
    /// Folders that `mser3d detect`, `msv`, `match`, `batch` or `track` wrote
    #[arg(required = true)]
    pub folders: Vec<PathBuf>,
    /// Say only what is wrong
    #[arg(short, long)]
    pub quiet: bool,
}

pub fn run(args: &VerifyArgs) -> Result<(), CliError> {
    let (mut results, mut tables, mut damaged) = (0, 0, 0);
    for folder in &args.folders {
        let found = match verify_folder(folder) {
            Ok(found) => found,
            Err(error) => {
                tell(&error.to_string());
                damaged += 1;
                continue;
            }
        };
        (results, tables) = (results + found.results, tables + found.tables);
        damaged += found.damaged();
        for finding in &found.findings {
            if finding.damaged {
                tell(&finding.text);
            } else if !args.quiet {
                tell(&format!("note: {}", finding.text));
            }
        }
    }
    let count = |n: usize, what: &str| format!("{n} {what}{}", if n == 1 { "" } else { "s" });
    let checked = format!("{} and {} checked", count(results, "result"), count(tables, "table"));
    if damaged > 0 {
        return Err(CliError::Incomplete(format!(
            "{checked}: {damaged} are damaged or missing, as said above"
        )));
    }
    if args.quiet { Ok(()) } else { print(&format!("{checked}: nothing is wrong\n")) }
}
