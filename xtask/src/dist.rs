//! `cargo xtask dist`: the archive of a release, `target/dist/mser3d-VERSION-TARGET.tar.gz`.
//!
//! In it are the program, manual pages, completions for four shells, the README, the changelog and the licences. The
//! same program gives the same archive, byte for byte: entries are sorted, have one fixed date, and no owners.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use flate2::{Compression, GzBuilder};

use crate::command::{MINUTE, output};

/// Optimizing the whole program takes minutes.
const BUILD: Duration = Duration::from_secs(3600);
/// The dates of all entries: 1980-01-01, the first that ZIP tools and old tars know too.
const DATE: u64 = 315_532_800;
/// Texts of the workspace that go with the program.
const TEXTS: [&str; 5] = ["CHANGELOG.md", "LICENSE-APACHE", "LICENSE-DEJAVU", "LICENSE-MIT", "README.md"];
/// Shells, and the file that each looks for.
const COMPLETIONS: [(&str, &str); 4] =
    [("bash", "mser3d.bash"), ("zsh", "_mser3d"), ("fish", "mser3d.fish"), ("powershell", "mser3d.ps1")];

/// What `cargo xtask dist` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Pack this program instead of building one
    #[arg(long, value_name = "PROGRAM")]
    binary: Option<PathBuf>,
    /// Folder for the archive [default: target/dist of the workspace]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Builds the program, if none is given, and packs it.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let target = target_folder();
    let binary = match &arguments.binary {
        Some(binary) => binary.clone(),
        None => build(&target)?,
    };
    let folder = arguments.output.clone().unwrap_or_else(|| target.join("dist"));
    let archive = archive(&binary, &folder, Compression::best())?;
    println!("{:.1} MB  {}", fs::metadata(&archive)?.len() as f64 / 1e6, archive.display());
    Ok(())
}

/// Packs a program that runs on this machine. Returns the archive's path.
fn archive(binary: &Path, folder: &Path, compression: Compression) -> Result<PathBuf, Box<dyn Error>> {
    let name = format!("mser3d-{}-{}", env!("CARGO_PKG_VERSION"), target_triple()?);
    let bytes = tar_gz(&name, &entries(binary)?, compression)?;
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let path = folder.join(format!("{name}.tar.gz"));
    fs::write(&path, bytes).map_err(|e| format!("{}: {e}", path.display()))?;
    Ok(path)
}

/// A file in the archive.
struct Entry {
    bytes: Vec<u8>,
    executable: bool,
}

/// Every file, by its path within the archive's one folder.
fn entries(binary: &Path) -> Result<BTreeMap<String, Entry>, Box<dyn Error>> {
    let mut entries = BTreeMap::new();
    let mut add = |path: String, bytes: Vec<u8>, executable: bool| {
        entries.insert(path, Entry { bytes, executable });
    };
    add(format!("mser3d{}", std::env::consts::EXE_SUFFIX), read(binary)?, true);
    for text in TEXTS {
        add(text.into(), read(&root().join(text))?, false);
    }
    for (shell, file) in COMPLETIONS {
        let script = output(Command::new(binary).args(["completions", shell]), MINUTE)?;
        add(format!("completions/{file}"), script.into_bytes(), false);
    }
    let pages = tempfile::tempdir()?;
    output(Command::new(binary).args(["man", "-o"]).arg(pages.path()), MINUTE)?;
    for page in fs::read_dir(pages.path())? {
        let page = page?;
        add(format!("man/{}", page.file_name().to_string_lossy()), read(&page.path())?, false);
    }
    Ok(entries)
}

fn tar_gz(
    name: &str,
    entries: &BTreeMap<String, Entry>,
    compression: Compression,
) -> Result<Vec<u8>, Box<dyn Error>> {
    // The builder writes no date and no system's name into the head of the file.
    let mut archive = tar::Builder::new(GzBuilder::new().write(Vec::new(), compression));
    for (path, entry) in entries {
        let mut header = tar::Header::new_gnu();
        header.set_size(entry.bytes.len() as u64);
        header.set_mode(if entry.executable { 0o755 } else { 0o644 });
        header.set_mtime(DATE);
        archive.append_data(&mut header, format!("{name}/{path}"), entry.bytes.as_slice())?;
    }
    Ok(archive.into_inner()?.finish()?)
}

fn build(target: &Path) -> Result<PathBuf, Box<dyn Error>> {
    println!("building with all optimizations, which takes minutes");
    let mut cargo = Command::new(cargo());
    cargo.args(["build", "--locked", "--quiet", "--profile", "dist", "--package", "mser3d-cli"]);
    cargo.arg("--manifest-path").arg(root().join("Cargo.toml")).arg("--target-dir").arg(target);
    output(&mut cargo, BUILD)?;
    Ok(target.join("dist").join(format!("mser3d{}", std::env::consts::EXE_SUFFIX)))
}

/// What the compiler calls this machine, such as `x86_64-unknown-linux-gnu`.
fn target_triple() -> Result<String, Box<dyn Error>> {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let version = output(Command::new(rustc).arg("-vV"), MINUTE)?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    Ok(host.ok_or("rustc does not say what it builds for")?.to_owned())
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|e| format!("{}: {e}", path.display()))
}

fn cargo() -> std::ffi::OsString {
    std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into())
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn target_folder() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

#[cfg(test)]
mod tests;
