//! The project's own tasks, one file per command: `cargo xtask COMMAND`.

mod browser;
mod browser_test;
mod command;
mod delegate;
mod dist;
mod fixtures;
mod fuzz;
mod interop;
mod package;
mod pictures;
mod python;
mod schema;
mod soak;

use std::error::Error;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's own tasks.
#[derive(Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Try the page that `mser3d view` writes in a real browser
    BrowserTest(browser_test::Arguments),
    /// Make the archive of a release: the program, its manual and completions
    Dist(dist::Arguments),
    /// Make the shapes in fixtures/ again, byte for byte
    Fixtures(fixtures::Arguments),
    /// Feed readers, loaders and algorithms with what libFuzzer makes up
    Fuzz(fuzz::Arguments),
    /// Open what mser3d writes with each format's own library
    Interop(interop::Arguments),
    /// Package the crates as for crates.io, and use one of them in a fresh project
    Package(package::Arguments),
    /// Make the pictures in docs/images again
    Pictures(pictures::Arguments),
    /// Install the Python package into a fresh environment, test it, and check its wheel
    Python(python::Arguments),
    /// Write the JSON Schemas of regions.json and msv.json to docs/
    Schema(schema::Arguments),
    /// Run random figures and other people's meshes through the program, with kills
    Soak(soak::Arguments),
    /// Experiments: compare with other people's libraries
    Bench(delegate::Arguments),
    /// Experiments: make the paper's figures in docs/results again
    Figures(delegate::Arguments),
    /// Experiments: measure maps from vertex to vertex that matched regions give
    Maps(delegate::Arguments),
    /// Experiments: compare parts with those of other people's methods, at equal numbers
    Peers(delegate::Arguments),
    /// Experiments: score the detector on sets of poses and of persons, in a minute
    Poses(delegate::Arguments),
    /// Experiments: compare what reliability says with what is found on other poses
    Reliability(delegate::Arguments),
    /// Experiments: compare choices of weights, time scales and filters on poses
    Selection(delegate::Arguments),
    /// Experiments: score detectors on SHREC'10, SHREC'11 or a synthetic benchmark
    Shrec11(delegate::Arguments),
    /// Experiments: compare matches with the right side of the body
    Sides(delegate::Arguments),
    /// Experiments: compare the regions of exact and of less exact eigenpairs: docs/results/tolerance.md
    Tolerance(delegate::Arguments),
    /// Follow regions through animations, and compare with the truth: docs/results/tracks.md
    Tracks(delegate::Arguments),
}

fn main() -> ExitCode {
    run(Arguments::parse().command).unwrap_or_else(|error| {
        eprintln!("error: {error}");
        ExitCode::FAILURE
    })
}

fn run(command: Command) -> Result<ExitCode, Box<dyn Error>> {
    match command {
        Command::BrowserTest(arguments) => browser_test::run(&arguments)?,
        Command::Dist(arguments) => dist::run(&arguments)?,
        Command::Fixtures(arguments) => fixtures::run(&arguments)?,
        Command::Fuzz(arguments) => fuzz::run(&arguments)?,
        Command::Interop(arguments) => interop::run(&arguments)?,
        Command::Package(arguments) => package::run(&arguments)?,
        Command::Pictures(arguments) => pictures::run(&arguments)?,
        Command::Python(arguments) => python::run(&arguments)?,
        Command::Schema(arguments) => schema::run(&arguments)?,
        Command::Soak(arguments) => soak::run(&arguments)?,
        Command::Bench(arguments) => return delegate::run("bench", &arguments),
        Command::Figures(arguments) => return delegate::run("figures", &arguments),
        Command::Maps(arguments) => return delegate::run("maps", &arguments),
        Command::Peers(arguments) => return delegate::run("peers", &arguments),
        Command::Poses(arguments) => return delegate::run("poses", &arguments),
        Command::Reliability(arguments) => return delegate::run("reliability", &arguments),
        Command::Selection(arguments) => return delegate::run("selection", &arguments),
        Command::Shrec11(arguments) => return delegate::run("shrec11", &arguments),
        Command::Sides(arguments) => return delegate::run("sides", &arguments),
        Command::Tolerance(arguments) => return delegate::run("tolerance", &arguments),
        Command::Tracks(arguments) => return delegate::run("tracks", &arguments),
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use std::path::{Path, PathBuf};

    use clap::CommandFactory;

    /// The Markdown files in a folder, and in those below it.
    fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let hidden =
                path.file_name().is_some_and(|name| name == "target" || name.as_encoded_bytes()[0] == b'.');
            if path.is_dir() && !hidden {
                pages(&path, found);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                found.push(path);
            }
        }
    }

    #[test]
    fn every_task_that_a_page_names_is_there() {
        let command = super::Arguments::command();
        let (mut found, mut named) = (Vec::new(), 0);
        pages(&Path::new(env!("CARGO_MANIFEST_DIR")).join(".."), &mut found);
        for page in found {
            let text = std::fs::read_to_string(&page).unwrap();
            for after in text.split("cargo xtask ").skip(1) {
                let name: String =
                    after.chars().take_while(|c| c.is_ascii_alphanumeric() || *c == '-').collect();
                // Some pages speak of tasks in general.
                if !name.is_empty() && !name.starts_with(char::is_uppercase) {
                    assert!(
                        command.find_subcommand(&name).is_some(),
                        "{}: cargo xtask {name}",
                        page.display()
                    );
                    named += 1;
                }
            }
        }
        assert!(named > 20, "{named}");
    }
}
