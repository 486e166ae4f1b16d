//! Every command that reads a file, with what is there before it begins: what kills and faults are tried on.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use tempfile::TempDir;

use crate::common::{detect, fixtures, mser3d, text};

/// A command.
pub struct Case {
    pub command: &'static str,
    /// Makes what is in the folder of its outputs: what the same command wrote with other parameters, as a rule.
    pub before: fn(&Path),
    /// Its inputs and its output, as [`words`].
    pub line: &'static str,
    /// Options for a run that takes some time, and for one that is soon over.
    pub long: &'static str,
    pub short: &'static str,
}

impl Case {
    /// All words after the command.
    pub fn words(&self, options: &str, out: &Path) -> Vec<OsString> {
        words(&format!("{} {options}", self.line), out)
    }
}

pub const DETECT: Case = Case {
    command: "detect",
    before: |out| through("detect %human_rest.off -o @r --voxels 2000 --eigenpairs 20 -q", out),
    line: "%human_rest.off -o @r",
    long: "--voxels 30000 --eigenpairs 60",
    short: "--voxels 1500 --eigenpairs 20",
};

/// Into folders that are not there yet.
pub const DETECT_SURFACE: Case = Case {
    command: "detect",
    before: |_| {},
    line: "%human_rest.off -o @new/result --surface",
    long: "--eigenpairs 60",
    short: "--eigenpairs 20",
};

pub const BATCH: Case = Case {
    command: "batch",
    before: |out| batch(out, SMALL),
    line: "%human_rest.off %human_kick.off -o @",
    long: "--voxels 12000 --eigenpairs 40",
    short: "--voxels 1500 --eigenpairs 20",
};

pub const TRACK: Case = Case {
    command: "track",
    before: |out| {
        through("track %human.glb --animation poses --frames 3 -o @ --voxels 2000 --eigenpairs 20 -q", out);
    },
    line: "%human.glb --animation poses --frames 3 -o @",
    long: "--voxels 6000 --eigenpairs 30 --glb",
    short: "--voxels 1500 --eigenpairs 20",
};

pub const VOXELIZE: Case = Case {
    command: "voxelize",
    before: |out| through("voxelize %human_rest.off -o @m.nii.gz --voxels 1000", out),
    line: "%human_rest.off -o @m.nii.gz",
    long: "--voxels 20000000",
    short: "--voxels 100000",
};

pub const MSV: Case = Case {
    command: "msv",
    before: |out| {
        noise(&out.join("noise.npy"));
        through("msv @noise.npy -o @r --max-area 0.4", out);
    },
    line: "@noise.npy -o @r",
    long: "",
    short: "",
};

pub const INSPECT: Case = Case {
    command: "inspect",
    before: |out| noise(&out.join("noise.npy")),
    line: "@noise.npy",
    long: "",
    short: "",
};

pub const RENDER: Case = Case {
    command: "render",
    before: |out| through("render <human_rest -o @r.png --height 100", out),
    line: "<human_rest -o @r.png",
    long: "--height 1000",
    short: "--height 120",
};

pub const VIEW: Case = Case {
    command: "view",
    before: |out| through("view <human_rest -o @v.html --up z", out),
    line: "<human_rest -o @v.html",
    long: "",
    short: "",
};

pub const EXPORT: Case = Case {
    command: "export",
    before: |out| through("export <human_rest -o @r.glb --parts", out),
    line: "<human_rest -o @r.glb",
    long: "",
    short: "",
};

pub const MATCH: Case = Case {
    command: "match",
    before: |out| through("match <human_kick <human_rest -o @m", out),
    line: "<human_rest <human_kick -o @m --html",
    long: "",
    short: "",
};

pub const QUERY: Case = Case {
    command: "query",
    before: |out| through("query <all <human_kick --html @q.html -k 1 --region 1", out),
    line: "<all <human_rest --html @q.html",
    long: "",
    short: "-k 1 --region 0",
};

/// All of them.
pub const ALL: [&Case; 12] = [
    &DETECT,
    &DETECT_SURFACE,
    &BATCH,
    &TRACK,
    &VOXELIZE,
    &MSV,
    &INSPECT,
    &RENDER,
    &VIEW,
    &EXPORT,
    &MATCH,
    &QUERY,
];

const SMALL: &str = "--voxels 2000 --eigenpairs 20 --quiet";

/// Results of two poses, and a collection of them.
pub fn results() -> &'static TempDir {
    static RESULTS: OnceLock<TempDir> = OnceLock::new();
    RESULTS.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        for name in ["human_rest", "human_kick"] {
            let output = detect(&fixtures().join(format!("{name}.off")), &folder.path().join(name), SMALL);
            assert!(output.status.success(), "{}", text(&output.stderr));
        }
        batch(&folder.path().join("all"), SMALL);
        folder
    })
}

fn poses() -> [PathBuf; 2] {
    ["human_rest.off", "human_kick.off"].map(|name| fixtures().join(name))
}

fn batch(out: &Path, options: &str) {
    let words = options.split_whitespace().map(OsString::from);
    let inputs = poses().map(OsString::from);
    let all = ["batch".into()].into_iter().chain(inputs).chain(["-o".into(), out.into()]).chain(words);
    let output = mser3d(all);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

/// Words, in which `@` is the folder, and what comes in angle brackets is in the folder of results.
pub fn words(line: &str, out: &Path) -> Vec<OsString> {
    let word = |word: &str| match word.strip_prefix('<') {
        Some(name) => results().path().join(name).into(),
        None if word.starts_with('@') => out.join(word[1..].trim_start_matches('/')).into(),
        None if word.starts_with('%') => fixtures().join(&word[1..]).into(),
        None => OsString::from(word),
    };
    line.split_whitespace().map(word).collect()
}

/// A command that succeeds.
fn through(line: &str, out: &Path) {
    let output = mser3d(words(line, out));
    assert!(output.status.success(), "{line}: {}", text(&output.stderr));
}

/// A grey-value volume of noise.
fn noise(out: &Path) {
    let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (64, 64, 64), }";
    let mut bytes = b"\x93NUMPY\x01\0\x76\0".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    let mut state = 7u32;
    bytes.extend((0..64 * 64 * 64).map(|_| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    }));
    fs::write(out, bytes).unwrap();
}

/// How each file of a folder looks, by its path in it.
pub type Snapshot = BTreeMap<String, Vec<u8>>;

pub fn snapshot(folder: &Path) -> Snapshot {
    fn add(root: &Path, folder: &Path, files: &mut Snapshot) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(root).unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                files.insert(format!("{name}/"), Vec::new());
                add(root, &path, files);
            } else if !path.file_name().unwrap().to_string_lossy().starts_with(".lock") {
                files.insert(name, fs::read(&path).unwrap());
            }
        }
    }
    let mut files = Snapshot::new();
    add(folder, folder, &mut files);
    files
}

/// Files that differ from run to run, by the times in them; those of a frame are coloured when all are there.
fn varies(name: &str) -> bool {
    let (folder, last) = name.rsplit_once('/').unwrap_or(("", name));
    ["regions.json", "msv.json", "checksums.json"].contains(&last)
        || folder.starts_with("human-poses") && last == "surface.ply"
}

/// Made of all results of a collection: they go before the first result changes.
fn is_table(name: &str) -> bool {
    name.ends_with(".parquet")
        || ["failures.json", "tracks.json", "tracks.csv", "checksums.json"].contains(&name)
}

/// What is wrong with what a killed run left, if anything.
pub fn fault(before: &Snapshot, complete: &Snapshot, after: &Snapshot, hard: bool) -> Option<String> {
    let hidden = |name: &String| name.split('/').any(|part| part.starts_with('.'));
    if let Some(left) = after.keys().find(|name| !hard && hidden(name)) {
        return Some(format!("left behind: {left}"));
    }
    let folder = |name: &str| name.rsplit_once('/').map_or("", |(folder, _)| folder).to_owned();
    let mut folders: Vec<String> =
        after.keys().chain(before.keys()).filter(|n| !hidden(n)).map(|n| folder(n)).collect();
    folders.sort();
    folders.dedup();
    for of in folders {
        let files = |all: &Snapshot| -> Snapshot {
            let own = all.iter().filter(|(name, _)| folder(name) == of && !hidden(name));
            let own = own
                .map(|(name, bytes)| (name.clone(), if varies(name) { Vec::new() } else { bytes.clone() }));
            own.filter(|(name, _)| !name.ends_with('/') && !is_table(name)).collect()
        };
        let (old, new, found) = (files(before), files(complete), files(after));
        let record =
            |all: &Snapshot| all.keys().any(|n| n.ends_with("regions.json") || n.ends_with("msv.json"));
        // A record says that the other files belong to it. Whoever is killed without a word may have taken it away.
        let unsaid = hard && record(&old) && !record(&found);
        if found != old && found != new && !unsaid {
            let names = |all: &Snapshot| all.keys().cloned().collect::<Vec<_>>();
            return Some(format!("{of:?}: neither old nor new: {:?} of {:?}", names(&found), names(&new)));
        }
    }
    let broken = after.iter().find(|(name, bytes)| {
        let json = name.ends_with(".json") && serde_json::from_slice::<serde_json::Value>(bytes).is_err();
        let table = name.ends_with(".parquet") && !(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));
        !hidden(name) && (json || table)
    });
    broken.map(|(name, _)| format!("half a file: {name}"))
}

pub fn copy(from: &Path, to: &Path) {
    fs::create_dir(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}
