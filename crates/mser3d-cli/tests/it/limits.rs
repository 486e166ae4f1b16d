//! What a run may take: memory, also in a control group and below `ulimit -v`, time, and files outside of a folder.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use flate2::Compression;
use flate2::write::GzEncoder;

use crate::common::*;

/// Runs the program with words separated by spaces, of which `@` begins a path in the folder. Also the most memory that it
/// held, in bytes, as far as Linux tells.
fn run_in(folder: &Path, words: &str) -> (Output, u64) {
    let words = words.split_whitespace().map(|word| match word.strip_prefix('@') {
        Some(name) => folder.join(name).into_os_string(),
        None => OsStr::new(word).to_owned(),
    });
    let mut command = Command::new(env!("CARGO_BIN_EXE_mser3d"));
    let mut child = command.args(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    while child.try_wait().unwrap().is_none() {
        let text = fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let held = line.and_then(|line| line.trim().strip_suffix(" kB")?.parse::<u64>().ok());
        peak = peak.max(1024 * held.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(1));
    }
    (child.wait_with_output().unwrap(), peak)
}

/// Writes a file that begins with these bytes and goes on with zeros, which take no place on the disk.
fn sparse(path: PathBuf, start: &[u8], length: u64) {
    fs::write(&path, start).unwrap();
    File::options().write(true).open(&path).unwrap().set_len(length).unwrap();
}

fn npy_header(shape: &str) -> Vec<u8> {
    let header = format!("{{'descr': '|u1', 'fortran_order': False, 'shape': ({shape}), }}\n");
    [&b"\x93NUMPY\x01\0"[..], &(header.len() as u16).to_le_bytes(), header.as_bytes()].concat()
}

/// These bytes so many times over, packed by gzip: a member for each.
fn gzip(bytes: &[u8], times: usize) -> Vec<u8> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::fast());
    packer.write_all(bytes).unwrap();
    packer.finish().unwrap().repeat(times)
}

#[test]
fn memory_stays_below_its_limit() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::copy(fixtures().join("human_rest.off"), path("human.off")).unwrap();
    fs::copy(fixtures().join("human.glb"), path("human.glb")).unwrap();
    // Volumes that are there, and would take more than is allowed.
    sparse(path("large.npy"), &npy_header("1000, 1000, 1000"), 1_000_000_200);
    sparse(path("grey.npy"), &npy_header("160, 160, 160"), 4_100_000);
    let nrrd = |encoding: &str| {
        format!("NRRD0004\ntype: uchar\ndimension: 3\nsizes: 900 900 900\nencoding: {encoding}\n\n")
            .into_bytes()
    };
    sparse(path("raw.nrrd"), &nrrd("raw"), 729_000_200);
    sparse(path("ascii.nrrd"), &nrrd("ascii"), 900_000_000);
    sparse(path("hex.nrrd"), &nrrd("hex"), 1_500_000_000);
    sparse(
        path("data.mha"),
        b"NDims = 3\nDimSize = 900 900 900\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n",
        729_000_200,
    );
    let mut mgh = vec![0u8; 284];
    for (i, field) in [1, 900, 900, 900, 1].into_iter().enumerate() {
        mgh[4 * i..4 * i + 4].copy_from_slice(&i32::to_be_bytes(field));
    }
    sparse(path("data.mgh"), &mgh, 729_000_500);
    let mut nifti = vec![0u8; 352];
    let mut put = |at: usize, field: &[u8]| nifti[at..at + field.len()].copy_from_slice(field);
    put(0, &348i32.to_le_bytes());
    for (i, size) in [3i16, 900, 900, 900].into_iter().enumerate() {
        put(40 + 2 * i, &size.to_le_bytes());
    }
    put(70, &2i16.to_le_bytes());
    put(76, &[0, 0, 128, 63].repeat(4));
    put(108, &352f32.to_le_bytes());
    put(344, b"n+1");
    sparse(path("data.nii"), &nifti, 729_000_500);
    fs::write(path("packed.nii.gz"), [gzip(&nifti, 1), gzip(&vec![0; 1_000_000], 729)].concat()).unwrap();
    // Meshes that declare or hold too much.
    let header = "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
                  property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n";
    fs::write(path("declared.ply"), header).unwrap();
    sparse(path("there.ply"), header.as_bytes(), 2_000_000_000);
    let mut stl = vec![b' '; 80];
    stl.extend(40_000_000u32.to_le_bytes());
    sparse(path("there.stl"), &stl, 84 + 50 * 40_000_000);
    fs::write(path("packed.obj.gz"), gzip(&b"v 0 0 0\n".repeat(125_000), 1000)).unwrap();
    fs::write(path("text.off"), "OFF 999999999 999999999 0\n".to_owned() + &"0 0 0\n".repeat(3_000_000))
        .unwrap();
    sparse(path("field.npy"), &npy_header("2000000000"), 2_000_000_100);
    sparse(path("labels.csv"), b"1,liver\n", 2_000_000_000);
    sparse(path("affine.txt"), b"1 0 0 0\n", 2_000_000_000);
    let tall = "--resolution 3000 -o @mask.nii.gz --memory-limit 100";
    let runs = [
        ("detect @large.npy -o @o", 100, false),
        ("inspect @raw.nrrd", 100, false),
        ("detect @ascii.nrrd -o @o", 100, false),
        ("detect @hex.nrrd -o @o", 100, false),
        ("inspect @data.mha", 100, false),
        ("msv @data.mgh -o @o", 100, false),
        ("msv @grey.npy -o @o", 100, false),
        ("detect @data.nii -o @o", 100, false),
        ("detect @packed.nii.gz -o @o", 100, false),
        ("detect @declared.ply -o @o", 100, false),
        ("detect @there.ply -o @o", 100, false),
        ("inspect @there.stl", 100, false),
        ("detect @packed.obj.gz -o @o", 100, false),
        ("voxelize @text.off -o @mask.nii.gz", 100, false),
        ("detect @human.off -o @o --weight @field.npy", 100, false),
        ("detect @data.nii -o @o --label liver --labels @labels.csv", 100, false),
        ("detect @data.nii -o @o --affine @affine.txt", 100, false),
        ("detect @human.off -o @o", 60, false),
        ("detect @human.off -o @o --voxels 400000 --eigenpairs 10", 120, false),
        ("detect @human.glb -o @o --eigenpairs 400", 150, false),
        ("track @human.glb -o @t --frames 2 --workers 1 --voxels 200000", 100, false),
        (&format!("voxelize @human.off {tall}"), 100, false),
        // What has room is done.
        ("detect @human.off -o @small -q --voxels 5000 --eigenpairs 30 --reliability 1", 60, true),
        ("detect @human.off -o @all -q", 160, true),
        ("voxelize @human.off --resolution 400 -o @done.nii.gz", 80, true),
    ];
    let mut report = String::new();
    for (words, limit, is_done) in runs {
        let given =
            if words.contains("--memory-limit") { String::new() } else { format!(" --memory-limit {limit}") };
        let (output, peak) = run_in(folder.path(), &format!("{words}{given}"));
        let stderr = text(&output.stderr);
        report.push_str(&format!("{:>4} of {limit:>3} MB: {words}\n", peak / 1_000_000));
        assert!(peak <= limit * 1_100_000, "{words}: {} MB of {limit}\n{stderr}", peak / 1_000_000);
        if is_done {
            assert!(output.status.success(), "{words}: {stderr}");
            continue;
        }
        assert_eq!(output.status.code(), Some(1), "{words}: {stderr}");
        if words.contains("declared.ply") || words.contains("track") {
            // The file ends before; a batch says it of each frame.
            assert!(
                stderr.contains("truncated") || stderr.contains("more than the limit of 100 MB"),
                "{stderr}"
            );
            continue;
        }
        let says = format!("more than the limit of {limit} MB");
        assert!(stderr.contains(&says) && stderr.contains("--memory-limit"), "{words}: {stderr}");
        assert_eq!(stderr.lines().count(), 1, "{stderr}");
        assert!(!path("o").exists() && !path("mask.nii.gz").exists(), "{words}");
    }
    println!("{report}");
}

#[test]
fn a_box_of_a_file_is_bounded_as_that_of_a_mesh() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("a.nrrd"),
        "NRRD0004\ntype: short\ndimension: 3\nsizes: 2000 2000 2000\nendian: little\nencoding: gzip\n\n",
    )
    .unwrap();
    for command in ["detect @a.nrrd -o @o", "inspect @a.nrrd", "msv @a.nrrd -o @o"] {
        let (output, _) = run_in(folder.path(), &format!("{command} --max-box-voxels 1000"));
        let says = "it declares 2000 x 2000 x 2000 voxels, more than the limit of 1000 voxels; if that is meant, raise \
                    --max-box-voxels";
        assert_fails(&output, 1, &["a.nrrd: ", says]);
    }
    assert!(!folder.path().join("o").exists());
}

/// A control group with a limit of memory, as far as this machine lets us make one.
#[cfg(target_os = "linux")]
struct ControlGroup(PathBuf);

#[cfg(target_os = "linux")]
impl ControlGroup {
    fn new(bytes: u64) -> Option<Self> {
        let name = format!("mser3d-test-{}", std::process::id());
        [("memory", "memory.limit_in_bytes"), ("", "memory.max")].into_iter().find_map(
            |(hierarchy, limit)| {
                let group = Path::new("/sys/fs/cgroup").join(hierarchy).join(&name);
                fs::create_dir(&group).ok()?;
                let group = Self(group);
                fs::write(group.0.join(limit), bytes.to_string()).ok()?;
                let found = fs::read_to_string(group.0.join(limit)).ok()?;
                (found.trim().parse::<u64>().ok()? <= bytes).then_some(group)
            },
        )
    }
}

#[cfg(target_os = "linux")]
impl Drop for ControlGroup {
    fn drop(&mut self) {
        let _ = fs::remove_dir(&self.0);
    }
}

/// Runs a script of the shell with the program as `$0` and the input as `$1`.
#[cfg(target_os = "linux")]
fn shell(script: &str, input: &Path, folder: &Path) -> Output {
    let mut command = Command::new("sh");
    command.args(["-c", script, env!("CARGO_BIN_EXE_mser3d")]).arg(input).current_dir(folder);
    command.output().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn in_a_control_group_a_run_is_refused_and_not_killed() {
    let Some(group) = ControlGroup::new(90_000_000) else {
        eprintln!("skipped: no control group can be made here");
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let enter = format!("echo $$ > {}/cgroup.procs && exec \"$0\" ", group.0.display());
    let human = fixtures().join("human_rest.off");
    let output = shell(&format!("{enter} detect \"$1\" -o out"), &human, folder.path());
    assert_fails(&output, 1, &["MB of memory", "more than the limit of", "--memory-limit"]);
    assert!(!folder.path().join("out").exists());
    let large = folder.path().join("large.npy");
    sparse(large.clone(), &npy_header("500, 500, 500"), 125_000_200);
    let output = shell(&format!("{enter} detect \"$1\" -o out"), &large, folder.path());
    assert_fails(&output, 1, &["500 x 500 x 500", "more than the limit of", "--memory-limit"]);
    // What has room is done.
    let small = "--voxels 5000 --eigenpairs 30 --reliability 0 --threads 2 -q";
    let output = shell(&format!("{enter} detect \"$1\" -o out {small}"), &human, folder.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[cfg(target_os = "linux")]
#[test]
fn below_a_limit_of_addresses_a_run_is_refused_and_does_not_abort() {
    let folder = tempfile::tempdir().unwrap();
    let limited = "ulimit -v 400000; exec \"$0\" ";
    let human = fixtures().join("human_rest.off");
    let output =
        shell(&format!("{limited} detect \"$1\" -o out --voxels 300000 --threads 2"), &human, folder.path());
    assert_fails(&output, 1, &["more than the limit of", "--memory-limit"]);
    let small = "--voxels 5000 --eigenpairs 30 --reliability 0 --threads 2 -q";
    let output = shell(&format!("{limited} detect \"$1\" -o out {small}"), &human, folder.path());
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn work_that_takes_too_long_ends_with_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::copy(fixtures().join("human_rest.off"), path("human.off")).unwrap();
    fs::copy(fixtures().join("human.glb"), path("human.glb")).unwrap();
    let noise =
        |x: usize, y: usize, z: usize| ((x * 7919) ^ (y * 104_729) ^ (z * 1_299_709)).is_multiple_of(5);
    fs::write(path("grey.npy"), npy([200, 200, 200], noise)).unwrap();
    for words in [
        "detect @human.off -o @o --voxels 400000 --memory-limit 100000",
        "voxelize @human.off -o @mask.nii.gz --resolution 1500",
        "msv @grey.npy -o @o",
        "track @human.glb -o @t --frames 4 --voxels 200000 --memory-limit 100000",
    ] {
        let start = Instant::now();
        let (output, _) = run_in(folder.path(), &format!("{words} --time-limit 0.3"));
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{words}: {stderr}");
        assert!(stderr.contains("not done within the time limit of 0.3 s"), "{words}: {stderr}");
        assert!(stderr.contains("--time-limit"), "{stderr}");
        // Machines that do other things besides are slow.
        assert!(start.elapsed() < Duration::from_secs(10), "{words}: {:?}", start.elapsed());
        assert!(!path("o").exists() && !path("mask.nii.gz").exists(), "{words}");
        let left = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
        assert!(left.into_iter().all(|name| !name.to_string_lossy().ends_with(".partial")), "{words}");
    }
    for wrong in ["0", "-1", "nan", "x"] {
        let (output, _) = run_in(folder.path(), &format!("detect @human.off -o @o --time-limit={wrong}"));
        assert_eq!(output.status.code(), Some(2), "{wrong}");
    }
    let (output, _) =
        run_in(folder.path(), "detect @human.off -o @o -q --voxels 2000 --reliability 0 --time-limit 1e300");
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn in_a_batch_a_shape_that_takes_too_long_is_a_failure() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    fs::create_dir(path("in")).unwrap();
    fs::copy(fixtures().join("human_rest.off"), path("in/slow.off")).unwrap();
    fs::write(path("in/quick.npy"), npy([9, 4, 4], |_, _, _| true)).unwrap();
    let words = "batch @in -o @all --voxels 300000 --eigenpairs 60 --memory-limit 100000 --workers 1 --time-limit 2 \
                 --stability-rule baseline";
    let (output, _) = run_in(folder.path(), &words.replace("--eigenpairs 60", ""));
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(stderr.contains("1 of 2 shapes failed"), "{stderr}");
    let failure = json(&path("all/slow/failure.json"));
    let why = failure["error"].as_str().unwrap();
    assert!(why.contains("not done within the time limit of 2 s"), "{why}");
    assert!(path("all/quick/regions.json").is_file());
    assert!(!path("all/slow/regions.json").exists());
}

#[test]
fn files_that_a_file_names_lie_in_its_folder() {
    let root = tempfile::tempdir().unwrap();
    let path = |name: &str| root.path().join(name);
    fs::create_dir(path("in")).unwrap();
    fs::write(path("out.raw"), vec![1; 216]).unwrap();
    fs::write(path("box.off"), box_off([0.0; 3], [3.0, 1.0, 1.0])).unwrap();
    let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 6 6 6\nencoding: raw\ndata file: ../out.raw\n";
    fs::write(path("in/a.nhdr"), header).unwrap();
    for words in [
        "detect @in/a.nhdr -o @a --eigenpairs 20 --reliability 0 --stability-rule baseline",
        "inspect @in/a.nhdr",
    ] {
        let (output, _) = run_in(root.path(), words);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{words}: {stderr}");
        assert!(stderr.contains("outside of its folder") && stderr.contains("--allow-outside"), "{stderr}");
        assert!(!path("a").exists());
        let (output, _) = run_in(root.path(), &format!("{words} --allow-outside"));
        assert!(output.status.success(), "{words}: {}", text(&output.stderr));
        let _ = fs::remove_dir_all(path("a"));
    }
    // A list stands for arguments.
    fs::write(path("in/list.txt"), "\n../box.off\n").unwrap();
    let small = "--voxels 300 --eigenpairs 20 --reliability 0 --stability-rule baseline";
    let (output, _) = run_in(root.path(), &format!("batch @in/list.txt -o @b {small}"));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(path("b/box/regions.json").is_file());
}
