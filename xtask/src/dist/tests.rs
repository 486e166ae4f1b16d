use super::*;

/// The program as it was built last: packing needs no fast one, and building takes its time.
fn program() -> Option<PathBuf> {
    let name = format!("mser3d{}", std::env::consts::EXE_SUFFIX);
    ["debug", "release"]
        .map(|profile| target_folder().join(profile).join(&name))
        .into_iter()
        .find(|p| p.exists())
}

#[test]
fn the_archive_is_the_same_again_and_its_program_runs() {
    let Some(program) = program() else {
        eprintln!("skipped: there is no program in target; `cargo build --package mser3d-cli` makes it");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let [first, second] =
        ["a", "b"].map(|name| archive(&program, &folder.path().join(name), Compression::fast()).unwrap());
    assert!(fs::read(&first).unwrap() == fs::read(&second).unwrap(), "two archives differ");
    let name = first.file_name().unwrap().to_str().unwrap().strip_suffix(".tar.gz").unwrap();
    assert!(name.starts_with(concat!("mser3d-", env!("CARGO_PKG_VERSION"), "-")), "{name}");

    let unpacked = folder.path().join("unpacked");
    let gz = flate2::read::GzDecoder::new(fs::File::open(&first).unwrap());
    tar::Archive::new(gz).unpack(&unpacked).unwrap();
    let at = |path: &str| unpacked.join(name).join(path);
    for (file, says) in [
        ("README.md", "mser3d"),
        ("CHANGELOG.md", "0."),
        ("LICENSE-MIT", "Permission is hereby granted"),
        ("LICENSE-APACHE", "Apache License"),
        ("LICENSE-DEJAVU", "Bitstream Vera"),
        ("man/mser3d.1", "mser3d"),
        ("man/mser3d-detect.1", "detect"),
        ("completions/mser3d.bash", "detect"),
        ("completions/_mser3d", "#compdef mser3d"),
        ("completions/mser3d.fish", "complete"),
        ("completions/mser3d.ps1", "Register-ArgumentCompleter"),
    ] {
        let text = fs::read_to_string(at(file)).unwrap_or_else(|e| panic!("{file}: {e}"));
        assert!(text.contains(says), "{file} does not say {says}");
    }
    let program = at(&format!("mser3d{}", std::env::consts::EXE_SUFFIX));
    let version = output(Command::new(program).arg("--version"), MINUTE).unwrap();
    assert!(version.starts_with(concat!("mser3d ", env!("CARGO_PKG_VERSION"))), "{version}");
}

#[test]
fn a_program_that_is_not_there_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let error =
        archive(&folder.path().join("nothing"), folder.path(), Compression::fast()).unwrap_err().to_string();
    assert!(error.contains("nothing"), "{error}");
}
