//! Every command meets what goes wrong around it: disks that are full or read-only, inputs that vanish or are damaged. It fails in one
//! error, and what was there before is there still; or it succeeds, and the new is in its place.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use tempfile::TempDir;

use crate::common::*;
use crate::every_command::*;

/// Bytes that are left on a disk.
const LEFT: [u64; 3] = [0, 20_000, 120_000];
/// The same in blocks of 512 bytes that a file may have, where no disk can be mounted.
const BLOCKS: [u64; 3] = [0, 8, 40];

/// A command, what was there before it, and what is there after a run that nothing disturbs.
struct Trial {
    case: &'static Case,
    root: TempDir,
    old: Snapshot,
    new: Snapshot,
}

impl Trial {
    fn new(case: &'static Case) -> Self {
        let root = tempfile::tempdir().unwrap();
        let [before, complete] = ["before", "complete"].map(|name| root.path().join(name));
        fs::create_dir(&before).unwrap();
        (case.before)(&before);
        copy(&before, &complete);
        let mut trial = Self { case, root, old: snapshot(&before), new: Snapshot::new() };
        let output = trial.run(trial.inputs(&complete).0);
        assert!(output.status.success(), "{}: {}", case.command, text(&output.stderr));
        trial.new = snapshot(&complete);
        trial
    }

    fn start(&self, words: Vec<OsString>) -> Child {
        let mut program = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        program.arg(self.case.command).args(words).stdin(Stdio::null());
        program.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn run(&self, words: Vec<OsString>) -> Output {
        self.start(words).wait_with_output().unwrap()
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    /// A folder as it was before.
    fn out(&self, at: PathBuf) -> PathBuf {
        let _ = fs::remove_dir_all(&at);
        copy(&self.path("before"), &at);
        at
    }

    /// Whether the command writes: `inspect` only prints.
    fn writes(&self) -> bool {
        self.case.command != "inspect"
    }

    /// The words for this output, and the inputs among them, which are copies that may be harmed.
    fn inputs(&self, out: &Path) -> (Vec<OsString>, Vec<PathBuf>) {
        let inputs = self.path("inputs");
        let _ = fs::remove_dir_all(&inputs);
        fs::create_dir(&inputs).unwrap();
        let mut copies = Vec::new();
        let words = self.case.words(self.case.short, out).into_iter().map(|word| {
            let path = PathBuf::from(&word);
            let known = [fixtures(), results().path().to_owned()].iter().any(|of| path.starts_with(of));
            if !known && !path.ends_with("noise.npy") {
                return word;
            }
            let own = inputs.join(path.file_name().unwrap());
            if path.is_dir() {
                copy(&path, &own);
            } else {
                fs::copy(&path, &own).unwrap();
            }
            copies.push(own.clone());
            own.into_os_string()
        });
        (words.collect(), copies)
    }

    /// Checks how a run ended and what it left.
    fn check(&self, out: &Path, output: &Output, what: &str, must_fail: &[&str]) {
        let (command, stderr) = (self.case.command, text(&output.stderr));
        let what = format!("{command}, {what}: {:?}: {stderr}", output.status);
        assert!(!stderr.contains("panicked"), "{what}");
        // What a batch says of a shape that failed, beside its earlier result, is no part of the result.
        let mut after = snapshot(out);
        after.retain(|name, _| !name.ends_with("/failure.json"));
        if output.status.success() {
            assert!(must_fail.is_empty(), "{what}");
            assert!(fault(&self.new, &self.new, &after, false).is_none(), "{what}: {:?}", after.keys());
            return;
        }
        assert_eq!(output.status.code(), Some(1), "{what}");
        let said = stderr.lines().filter(|line| line.starts_with("mser3d: ")).count();
        assert!(said == 1, "{said} errors, not 1: {what}");
        must_fail.iter().for_each(|word| assert!(stderr.contains(word), "{word:?} is not said: {what}"));
        let filled = |folder: &String| after.keys().any(|name| name.starts_with(folder) && name != folder);
        let empty =
            after.keys().find(|name| name.ends_with('/') && !self.old.contains_key(*name) && !filled(name));
        assert_eq!(empty, None, "an empty folder is left: {what}");
        if let Some(fault) = fault(&self.old, &self.new, &after, false) {
            panic!("{what}: {fault}");
        }
    }
}

/// A small disk; none where the tests may not mount one.
struct Disk(PathBuf);

impl Disk {
    fn new(at: PathBuf) -> Option<Self> {
        fs::create_dir(&at).unwrap();
        let mut mount = Command::new("mount");
        mount.args(["-t", "tmpfs", "-o", "size=32m", "tmpfs"]).arg(&at);
        let mounted = mount.output().is_ok_and(|output| output.status.success());
        mounted.then_some(Self(at))
    }

    /// Fills it until so many bytes are left.
    fn leave(&self, bytes: u64) {
        let path = self.0.join("filler");
        let mut filler = File::create(&path).unwrap();
        assert!(std::io::copy(&mut std::io::repeat(1), &mut filler).is_err());
        filler.flush().unwrap();
        let size = filler.metadata().unwrap().len();
        filler.set_len(size.saturating_sub(bytes)).unwrap();
    }

    fn empty(&self) {
        let _ = fs::remove_file(self.0.join("filler"));
    }

    fn writable(&self, yes: bool) {
        let how = if yes { "remount,rw" } else { "remount,ro" };
        assert!(Command::new("mount").args(["-o", how]).arg(&self.0).status().unwrap().success());
    }
}

impl Drop for Disk {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("-l").arg(&self.0).status();
    }
}

/// Tries all commands, and tells all that fail.
fn each(count: usize, attempt: impl Fn(&Trial)) {
    let mut wrong = Vec::new();
    for case in ALL {
        let trial = Trial::new(case);
        if let Err(panic) = catch_unwind(AssertUnwindSafe(|| attempt(&trial))) {
            wrong.push(panic);
        }
    }
    println!("{} faults, {} commands with a wrong answer", count * ALL.len(), wrong.len());
    if let Some(panic) = wrong.pop() {
        resume_unwind(panic);
    }
}

#[test]
fn a_full_disk_takes_nothing_good() {
    each(LEFT.len(), |trial| {
        let disk = Disk::new(trial.path("disk"));
        for (left, blocks) in LEFT.into_iter().zip(BLOCKS) {
            let (output, out, said) = match &disk {
                Some(disk) => {
                    disk.empty();
                    let out = trial.out(disk.0.join("out"));
                    let (words, _) = trial.inputs(&out);
                    disk.leave(left);
                    (trial.run(words), out, "No space left")
                }
                None => {
                    let out = trial.out(trial.path("out"));
                    // The signal is ignored, so that writing is an error, as it is on a full disk.
                    let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
                    let mut shell = Command::new("sh");
                    shell.args(["-c", &script, env!("CARGO_BIN_EXE_mser3d"), trial.case.command]);
                    (
                        shell.args(trial.inputs(&out).0).stdin(Stdio::null()).output().unwrap(),
                        out,
                        "cannot be ",
                    )
                }
            };
            let must_fail = if trial.writes() && left == 0 { &[said][..] } else { &[] };
            trial.check(&out, &output, &format!("{left} bytes left"), must_fail);
        }
    });
}

#[test]
fn a_disk_that_cannot_be_written_is_left_as_it_is() {
    each(1, |trial| {
        let Some(disk) = Disk::new(trial.path("disk")) else {
            return eprintln!("skipped: no file system can be mounted here");
        };
        let out = trial.out(disk.0.join("out"));
        disk.writable(false);
        let (words, _) = trial.inputs(&out);
        let output = trial.run(words);
        let must_fail: &[&str] = if trial.writes() { &["Read-only file system"] } else { &[] };
        trial.check(&out, &output, "read-only", must_fail);
        disk.writable(true);
    });
}

#[test]
fn inputs_that_vanish_take_nothing_with_them() {
    let moments = [0, 15, 80];
    each(moments.len(), |trial| {
        for moment in moments {
            let out = trial.out(trial.path("out"));
            let (words, inputs) = trial.inputs(&out);
            let vanish = || match inputs[0].is_dir() {
                true => drop(fs::remove_dir_all(&inputs[0])),
                false => fs::remove_file(&inputs[0]).unwrap(),
            };
            if moment == 0 {
                vanish();
                let output = trial.run(words);
                let name = inputs[0].file_name().unwrap().to_str().unwrap();
                trial.check(&out, &output, "no input", &[name]);
            } else {
                let child = trial.start(words);
                std::thread::sleep(Duration::from_millis(moment));
                vanish();
                let output = child.wait_with_output().unwrap();
                trial.check(&out, &output, &format!("no input after {moment} ms"), &[]);
            }
        }
    });
}

#[test]
fn damaged_inputs_are_named_and_take_nothing_good() {
    each(2, |trial| {
        for cut in [true, false] {
            let out = trial.out(trial.path("out"));
            let (words, inputs) = trial.inputs(&out);
            let file = ["regions.parquet", "regions.json"].map(|name| inputs[0].join(name));
            let file = file.into_iter().find(|path| path.is_file()).unwrap_or(inputs[0].clone());
            let mut bytes = fs::read(&file).unwrap();
            if cut {
                bytes.truncate(bytes.len() / 2);
            } else {
                // Where the file says what it is, or where it is text, a number is no number any more.
                bytes[3] ^= 0x41;
            }
            fs::write(&file, bytes).unwrap();
            let output = trial.run(words);
            let name = file.file_name().unwrap().to_str().unwrap();
            trial.check(&out, &output, &format!("{name} is damaged, cut: {cut}"), &[name]);
        }
    });
}
