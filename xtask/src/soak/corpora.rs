//! Meshes by other people, good and bad, from packages that bring them.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

use flate2::read::GzDecoder;
use mser3d_meshio::MeshFormat;

use super::{ONE, said};
use crate::command::output;

const DOWNLOAD: Duration = Duration::from_secs(600);

/// Runs every mesh of the corpora that are there; gets them first if that is asked for.
pub fn run(program: &Path, folder: &Path, install: bool) -> Result<Vec<String>, Box<dyn Error>> {
    if install {
        std::fs::create_dir_all(folder)?;
        for (name, get) in [
            ("cgal", debian as fn(&Path) -> Result<(), String>),
            ("pyvista", |folder| pypi(folder, "pyvista")),
        ] {
            let path = folder.join(name);
            if !path.exists() {
                std::fs::create_dir_all(&path)?;
                if let Err(why) = get(&path).and_then(|()| unpack(&path)) {
                    std::fs::remove_dir_all(&path)?;
                    println!("skipped: the meshes of {name}: {}", why.lines().last().unwrap_or_default());
                }
            }
        }
    }
    if !folder.is_dir() {
        println!("skipped: other people's meshes; --install gets them");
        return Ok(Vec::new());
    }
    let known = |path: &PathBuf| MeshFormat::from_extension(path).is_some();
    let meshes: Vec<PathBuf> = files(folder, "").into_iter().filter(known).collect();
    let (mut answered, mut refused, mut faults) = (0, 0, Vec::new());
    let out = folder.with_file_name("corpora-result");
    for mesh in &meshes {
        let _ = std::fs::remove_dir_all(&out);
        let mut inspect = Command::new(program);
        inspect.arg("inspect").arg(mesh);
        let mut detect = Command::new(program);
        detect.arg("detect").arg(mesh).arg("-o").arg(&out).args(["--voxels", "3000", "--quiet"]);
        for command in [&mut inspect, &mut detect] {
            let about =
                format!("{} {}", command.get_args().next().unwrap_or_default().display(), mesh.display());
            let Some((status, text)) = said(command, ONE)? else {
                faults.push(format!("{about}: not through in {} s", ONE.as_secs()));
                continue;
            };
            if status.success() {
                answered += 1;
            } else if let Some(why) = wrong(status.code(), &text) {
                faults.push(format!("{about}: {why}: {status}: {}", text.trim()));
            } else if out.exists() {
                faults.push(format!("{about}: refused, and {} is left", out.display()));
            } else {
                refused += 1;
            }
        }
    }
    println!("other people's meshes: {} files, {answered} answers, {refused} refusals", meshes.len());
    Ok(faults)
}

/// What is wrong with how a file was refused, if anything is: it is one message by the program itself.
fn wrong(code: Option<i32>, said: &str) -> Option<&'static str> {
    let words = ["mser3d: note: ", "mser3d: warning: "];
    let messages = said.lines().filter(|line| line.starts_with("mser3d: "));
    let messages = messages.filter(|line| !words.iter().any(|word| line.starts_with(word))).count();
    match (code, messages) {
        (None, _) => Some("ended by a signal"),
        (Some(1), 1) => None,
        (Some(1), _) => Some("not one message"),
        _ => Some("another exit code"),
    }
}

/// The package with the data of CGAL's demos.
fn debian(folder: &Path) -> Result<(), String> {
    output(Command::new("apt-get").args(["download", "libcgal-demo"]).current_dir(folder), DOWNLOAD)?;
    for package in files(folder, ".deb") {
        output(Command::new("dpkg-deb").arg("-x").arg(package).arg(folder), DOWNLOAD)?;
    }
    Ok(())
}

/// A package of PyPI as it lies there.
fn pypi(folder: &Path, package: &str) -> Result<(), String> {
    let mut command = Command::new("python3");
    command.args(["-m", "pip", "download", "--quiet", "--no-deps", "--dest"]).arg(folder).arg(package);
    output(&mut command, DOWNLOAD)?;
    for wheel in files(folder, ".whl") {
        let mut unpack = Command::new("python3");
        output(unpack.args(["-m", "zipfile", "-e"]).arg(wheel).arg(folder), DOWNLOAD)?;
    }
    Ok(())
}

/// Unpacks all archives below a folder.
fn unpack(folder: &Path) -> Result<(), String> {
    for archive in files(folder, ".tar.gz") {
        let fail = |e: std::io::Error| format!("{}: {e}", archive.display());
        let file = std::fs::File::open(&archive).map_err(fail)?;
        let into = archive.with_extension("").with_extension("");
        tar::Archive::new(GzDecoder::new(file)).unpack(into).map_err(fail)?;
    }
    Ok(())
}

/// The files below a folder whose names end so.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(path) = folders.pop() {
        for path in std::fs::read_dir(path).into_iter().flatten().flatten().map(|entry| entry.path()) {
            if path.is_dir() && !path.is_symlink() {
                folders.push(path);
            } else if path.to_string_lossy().ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

#[cfg(test)]
mod tests {
    use super::wrong;

    #[test]
    fn a_refusal_is_one_message_of_the_program() {
        assert_eq!(wrong(Some(1), "mser3d: note: 3 faces\nmser3d: a.off:3: no number\n"), None);
        assert_eq!(wrong(Some(1), ""), Some("not one message"));
        assert_eq!(wrong(Some(101), "thread 'main' panicked at a.rs"), Some("another exit code"));
        assert_eq!(wrong(None, "mser3d: a.off: too long"), Some("ended by a signal"));
    }
}
