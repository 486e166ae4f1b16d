//! Every command is stopped by signals at moments all over its run: it ends within a second, with the right code, and what was there
//! before is there still, or the new in its place; nothing else.
//!
//! `MSER3D_KILLS=20` has each command killed twenty times, by SIGKILL too, and prints what came of it:
//! `MSER3D_KILLS=20 cargo test --release -p mser3d-cli --test it kills -- --nocapture`.

use std::fs;
use std::io::{Read, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use crate::common::{fixtures, ignores};
use crate::every_command::*;

fn send(signal: &str, child: &Child) {
    assert!(Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap().success());
}

/// Seconds in which a process ended that was told to, and its code; killed and reported if it takes too long.
fn end(mut child: Child) -> (f64, Option<i32>, String) {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            let seconds = start.elapsed().as_secs_f64();
            let mut said = String::new();
            child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
            // As shells report it.
            let code = status.code().or(status.signal().map(|signal| 128 + signal));
            return (seconds, code, said);
        }
        if start.elapsed() > Duration::from_secs(120) {
            child.kill().unwrap();
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Kills a command again and again.
fn survives(case: &Case) {
    let Case { command, before, long, .. } = case;
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    fs::create_dir(path("before")).unwrap();
    before(&path("before"));
    let start = |out: &Path| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_mser3d"));
        program
            .arg(command)
            .args(case.words(long, out))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    };
    copy(&path("before"), &path("complete"));
    let began = Instant::now();
    let (_, code, said) = end(start(&path("complete")));
    let seconds = began.elapsed().as_secs_f64();
    assert_eq!(code, Some(0), "{command}: {said}");
    let (old, new) = (snapshot(&path("before")), snapshot(&path("complete")));
    let wanted = std::env::var("MSER3D_KILLS").ok().map(|text| text.parse::<usize>().unwrap());
    let signals: &[(&str, i32)] = match wanted {
        None => &[("-INT", 130), ("-TERM", 143)],
        Some(_) => &[("-INT", 130), ("-TERM", 143), ("-KILL", 0)],
    };
    let signals: Vec<_> = signals.iter().filter(|(name, _)| *name != "-INT" || !ignores(2)).collect();
    if ignores(2) {
        eprintln!("skipped: SIGINT is ignored where the tests run");
    }
    let kills = wanted.unwrap_or(10);
    let words =
        |said: &str| said.lines().last().is_some_and(|line| line.starts_with("mser3d: interrupted; "));
    let (mut slowest, mut late, mut interrupted, mut faults) = (0.0f64, 0, 0, Vec::new());
    for kill in 0..kills {
        let out = path(&format!("kill{kill}"));
        copy(&path("before"), &out);
        let (signal, expected) = signals[kill % signals.len()];
        // All over the run, in another order than the signals.
        let moment = (kill as f64 * 0.618_034 + 0.1).fract() * seconds;
        let child = start(&out);
        std::thread::sleep(Duration::from_secs_f64(moment));
        send(signal, &child);
        let (took, code, said) = end(child);
        let hard = *signal == "-KILL";
        let when = format!("{command}, {signal} after {moment:.3} s of {seconds:.3}");
        if !hard {
            slowest = slowest.max(took);
            late += usize::from(took > 1.0);
            match code {
                Some(0) => {}
                code if code == Some(*expected) && words(&said) => interrupted += 1,
                // Before it had begun to listen.
                code if code == Some(*expected) && said.is_empty() && moment < 0.2 => {}
                code => faults.push(format!("{when}: ends with {code:?}: {said}")),
            }
        }
        faults.extend(fault(&old, &new, &snapshot(&out), hard).map(|fault| format!("{when}: {fault}")));
        fs::remove_dir_all(out).unwrap();
    }
    println!(
        "{command}: {kills} kills, {interrupted} interrupted, slowest {slowest:.2} s, {} faults",
        faults.len()
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    // Machines on which much else runs are late now and then.
    assert!(
        late <= kills / 5 && slowest < 5.0,
        "{command}: {late} of {kills} took more than a second, one {slowest} s"
    );
}

#[test]
fn detect_survives_kills() {
    [&DETECT, &DETECT_SURFACE].into_iter().for_each(survives);
}

#[test]
fn batch_survives_kills() {
    survives(&BATCH);
}

#[test]
fn track_survives_kills() {
    survives(&TRACK);
}

#[test]
fn voxelize_survives_kills() {
    survives(&VOXELIZE);
}

#[test]
fn msv_and_inspect_survive_kills() {
    [&MSV, &INSPECT].into_iter().for_each(survives);
}

#[test]
fn pictures_and_pages_survive_kills() {
    [&RENDER, &VIEW].into_iter().for_each(survives);
}

#[test]
fn export_match_and_query_survive_kills() {
    [&EXPORT, &MATCH, &QUERY].into_iter().for_each(survives);
}

/// A command that waits for standard input, which does not come.
fn waiting() -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    let pipes =
        program.args(["inspect", "-"]).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let child = pipes.spawn().unwrap();
    // Long enough to be listening.
    std::thread::sleep(Duration::from_millis(300));
    child
}

#[test]
fn a_command_that_waits_for_ever_ends_within_a_second() {
    let child = waiting();
    send("-TERM", &child);
    let (took, code, said) = end(child);
    assert!(took < 2.0 && code == Some(143) && said.contains("interrupted"), "{took} {code:?} {said}");
}

#[test]
fn a_second_signal_ends_it_at_once() {
    let mut quickest = f64::INFINITY;
    for _ in 0..3 {
        let child = waiting();
        send("-TERM", &child);
        std::thread::sleep(Duration::from_millis(60));
        send("-TERM", &child);
        let (took, code, _) = end(child);
        assert_eq!(code, Some(143));
        quickest = quickest.min(took);
    }
    assert!(quickest < 0.3, "{quickest}");
}

#[test]
fn under_nohup_a_closed_terminal_is_ignored() {
    let mut program = Command::new("sh");
    program.args(["-c", "trap '' HUP; exec \"$0\" inspect -", env!("CARGO_BIN_EXE_mser3d")]);
    let pipes = program.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    let mut child = pipes.spawn().unwrap();
    std::thread::sleep(Duration::from_millis(400));
    send("-HUP", &child);
    std::thread::sleep(Duration::from_millis(900));
    assert!(child.try_wait().unwrap().is_none());
    let mesh = fs::read(fixtures().join("human_rest.off")).unwrap();
    child.stdin.take().unwrap().write_all(&mesh).unwrap();
    assert_eq!(end(child).1, Some(0));
    if ignores(1) {
        return eprintln!("skipped: SIGHUP is ignored where the tests run");
    }
    let child = waiting();
    send("-HUP", &child);
    let (_, code, said) = end(child);
    assert!(code == Some(129) && said.contains("interrupted"), "{code:?} {said}");
}
