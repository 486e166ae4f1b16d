//! Commands that the package `mser3d-experiments` has: built and run when they are asked for, so that the other tasks
//! need not wait for what these depend on.

use std::error::Error;
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, ExitCode};

/// Everything after the command's name, `--help` too.
#[derive(clap::Args)]
#[command(disable_help_flag = true)]
pub struct Arguments {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    rest: Vec<OsString>,
}

/// Runs a command of the experiments with its arguments; its exit code is ours.
pub fn run(command: &str, arguments: &Arguments) -> Result<ExitCode, Box<dyn Error>> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../Cargo.toml");
    let status = Command::new(&cargo)
        .args(["run", "--release", "--quiet", "--package", "mser3d-experiments", "--manifest-path"])
        .arg(manifest)
        .args(["--", command])
        .args(&arguments.rest)
        .status()
        .map_err(|e| format!("{}: {e}", cargo.display()))?;
    // No code: ended by a signal.
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    #[derive(Parser)]
    struct Command {
        #[command(flatten)]
        arguments: super::Arguments,
    }

    #[test]
    fn everything_is_handed_on() {
        let given = ["--help", "-o", "out", "--", "x"];
        let command = Command::try_parse_from(["figures"].iter().chain(&given)).unwrap();
        assert_eq!(command.arguments.rest, given);
    }
}
