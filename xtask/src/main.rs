//! The project's own tasks, one file per command: `cargo xtask COMMAND`.

mod fixtures;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's own tasks.
#[derive(Parser)]
#[command(name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Make the shapes in fixtures/ again, byte for byte
    Fixtures(fixtures::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Fixtures(arguments) => fixtures::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
