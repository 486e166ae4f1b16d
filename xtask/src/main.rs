//! The project's own tasks, one file per command: `cargo xtask COMMAND`.

mod bench;
mod browser;
mod browser_test;
mod command;
mod drawing;
mod evaluate;
mod figures;
mod fixtures;
mod interop;
mod pictures;
mod poses;
mod selection;
mod shrec11;

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
    /// Compare with other people's libraries
    Bench(bench::Arguments),
    /// Try the page that `mser3d view` writes in a real browser
    BrowserTest(browser_test::Arguments),
    /// Make the paper's figures in docs/results again
    Figures(figures::Arguments),
    /// Make the shapes in fixtures/ again, byte for byte
    Fixtures(fixtures::Arguments),
    /// Open what mser3d writes with each format's own library
    Interop(interop::Arguments),
    /// Make the pictures in docs/images again
    Pictures(pictures::Arguments),
    /// Score the detector on poses of one figure
    Poses(poses::Arguments),
    /// Compare choices of weights, time scales and filters on poses
    Selection(selection::Arguments),
    /// Score detectors on SHREC'10, SHREC'11 or a synthetic benchmark
    Shrec11(shrec11::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Bench(arguments) => bench::run(&arguments),
        Command::BrowserTest(arguments) => browser_test::run(&arguments),
        Command::Figures(arguments) => figures::run(&arguments),
        Command::Fixtures(arguments) => fixtures::run(&arguments),
        Command::Interop(arguments) => interop::run(&arguments),
        Command::Pictures(arguments) => pictures::run(&arguments),
        Command::Poses(arguments) => poses::run(&arguments),
        Command::Selection(arguments) => selection::run(&arguments),
        Command::Shrec11(arguments) => shrec11::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
