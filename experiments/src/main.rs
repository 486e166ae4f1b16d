//! The project's measurements, one file per command: `cargo xtask COMMAND` runs them.
//!
//! `experiments/` measures our own detectors, `comparisons/` our stages beside other people's libraries.

mod comparisons;
mod drawing;
mod experiments;
mod pose_sets;
mod repeats;
mod solved;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use comparisons::peers;
use experiments::{figures, maps, poses, reliability, selection, shrec11, sides, tolerance, tracks};

/// The project's measurements.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Compare with other people's libraries
    Bench(comparisons::Arguments),
    /// Make the paper's figures in docs/results again
    Figures(figures::Arguments),
    /// Measure maps from vertex to vertex that matched regions give
    Maps(maps::Arguments),
    /// Compare parts with those of other people's methods, at equal numbers
    Peers(peers::Arguments),
    /// Score the detector on sets of poses and of persons, in a minute
    Poses(poses::Arguments),
    /// Compare choices of weights, time scales and filters on poses
    Selection(selection::Arguments),
    /// Compare what reliability says with what is found on other poses
    Reliability(reliability::Arguments),
    /// Score detectors on SHREC'10, SHREC'11 or a synthetic benchmark
    Shrec11(shrec11::Arguments),
    /// Compare matches with the right side of the body
    Sides(sides::Arguments),
    /// Compare the regions of exact and of less exact eigenpairs
    Tolerance(tolerance::Arguments),
    /// Follow regions through animations, and compare with the truth
    Tracks(tracks::Arguments),
}

fn main() -> ExitCode {
    let result = match Arguments::parse().command {
        Command::Bench(arguments) => comparisons::run(&arguments),
        Command::Figures(arguments) => figures::run(&arguments),
        Command::Maps(arguments) => maps::run(&arguments),
        Command::Peers(arguments) => peers::run(&arguments),
        Command::Poses(arguments) => poses::run(&arguments),
        Command::Selection(arguments) => selection::run(&arguments),
        Command::Reliability(arguments) => reliability::run(&arguments),
        Command::Shrec11(arguments) => shrec11::run(&arguments),
        Command::Sides(arguments) => sides::run(&arguments),
        Command::Tolerance(arguments) => tolerance::run(&arguments),
        Command::Tracks(arguments) => tracks::run(&arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
