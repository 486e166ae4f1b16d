//! What is damaged is found out and named, and what is whole is never lost.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use mser3d::shape::Affine;
use mser3d_fileio::{NpyArray, NpyValues, read_npz, write_npz};
use mser3d_results::msv::{MsvResults, MsvSearchParameters};
use mser3d_results::{
    Checksums, Extra, Results, ResultsError, ResultsFolder, Sighting, Track, TrackParameters, TrackedFrame,
    TracksRecord, verify,
};
use mser3d_volumeio::Volume;

use crate::folder::VOLUME;

const FILES: [&str; 5] = ["checksums.json", "features.npz", "regions.json", "surface.ply", "volume.vti"];

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    names(folder).into_iter().map(|name| (name.clone(), fs::read(folder.join(&name)).unwrap())).collect()
}

fn error(folder: &Path) -> String {
    Results::load(folder).map(|_| ()).unwrap_err().to_string()
}

/// Another result than [`VOLUME`].
fn fewer_regions() -> Results {
    let mut other = VOLUME.clone();
    other.record.duplicates += 1;
    other
}

#[test]
fn every_changed_byte_is_seen() {
    let folder = tempfile::tempdir().unwrap();
    VOLUME.write(folder.path()).unwrap();
    assert_eq!(names(folder.path()), FILES);
    assert_eq!(verify(folder.path()), []);
    let listed = Checksums::load(folder.path()).unwrap();
    for name in FILES {
        let path = folder.path().join(name);
        let whole = fs::read(&path).unwrap();
        for at in (0..whole.len()).step_by(whole.len() / 40) {
            let mut damaged = whole.clone();
            damaged[at] ^= 1 << (at % 8);
            fs::write(&path, &damaged).unwrap();
            let found = verify(folder.path());
            if name == Checksums::FILE {
                // Line ends may change.
                let same = Checksums::load(folder.path()).is_ok_and(|sums| sums == listed);
                assert!(same || found.iter().any(|found| found.damaged), "{at}");
                continue;
            }
            assert!(found.iter().any(|found| found.damaged && found.text.contains(name)), "{name} {at}");
            // Nobody but other programs reads the voxels.
            assert_eq!(Results::load(folder.path()).is_ok(), name == "volume.vti", "{name} {at}");
        }
        for end in [0, 1, whole.len() - 2] {
            fs::write(&path, &whole[..end]).unwrap();
            assert!(verify(folder.path()).iter().any(|found| found.damaged), "{name} {end}");
        }
        fs::write(&path, &whole).unwrap();
    }
    assert_eq!(verify(folder.path()), []);
}

#[test]
fn what_is_removed_on_purpose_or_of_an_earlier_version_is_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    ResultsFolder::create(path).unwrap().write(&VOLUME, &[Extra::Landmarks]).unwrap();
    fs::remove_file(path.join("volume.vti")).unwrap();
    let found = verify(path);
    assert!(found.len() == 1 && !found[0].damaged && found[0].text.contains("volume.vti"), "{found:?}");
    VOLUME.export(&path.join("regions.nii.gz")).unwrap();
    assert!(verify(path).iter().any(|f| !f.damaged && f.text.contains("regions.nii.gz: has no checksum")));
    // A file that is written anew is told to the checksums.
    VOLUME.export(&path.join("surface.ply")).unwrap();
    fs::write(path.join("landmarks.mrk.json"), "{}").unwrap();
    assert!(verify(path).iter().any(|found| found.damaged));
    Checksums::renew(&path.join("landmarks.mrk.json")).unwrap();
    assert!(verify(path).iter().all(|found| !found.damaged));
    // Without checksums, all that is read is checked all the same.
    fs::remove_file(path.join(Checksums::FILE)).unwrap();
    Results::load(path).unwrap();
    let found = verify(path);
    assert!(found.len() == 1 && found[0].text.contains("no checksums"), "{found:?}");
    fs::write(path.join("features.npz"), "").unwrap();
    assert!(verify(path).iter().any(|found| found.damaged && found.text.contains("features.npz")));
}

/// Writes an array anew, without checksums.
fn spoil(folder: &Path, array: &str, change: impl FnOnce(&mut NpyValues)) {
    let path = folder.join("features.npz");
    let mut arrays = read_npz(&path).unwrap();
    let old = &arrays[array];
    let mut values = old.values().clone();
    change(&mut values);
    let shape = old.shape().to_vec();
    arrays.insert(array.to_owned(), NpyArray::new(&shape, values).unwrap());
    let arrays: Vec<(&str, NpyArray)> = arrays.iter().map(|(name, a)| (name.as_str(), a.clone())).collect();
    write_npz(&path, &arrays).unwrap();
    let _ = fs::remove_file(folder.join(Checksums::FILE));
}

fn number(at: usize, value: f64) -> impl FnOnce(&mut NpyValues) {
    move |values| match values {
        NpyValues::F64(numbers) => numbers.to_mut()[at] = value,
        NpyValues::I32(numbers) => numbers.to_mut()[at] = value as i32,
        NpyValues::I64(numbers) => numbers.to_mut()[at] = value as i64,
        NpyValues::U32(numbers) => numbers.to_mut()[at] = value as u32,
        _ => panic!("of another type"),
    }
}

#[test]
fn arrays_that_nobody_could_have_written_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let nodes = VOLUME.trees[0].parents.len();
    let voxels = VOLUME.region_voxels.concat();
    for (array, at, value, said) in [
        // A node that is its own parent, a circle of two, and a parent that is not there.
        ("tree0_parent", 3, 3.0, "node 3 has the parent 3"),
        ("tree0_parent", nodes - 1, 0.0, "which does not come after it"),
        ("tree0_parent", 0, nodes as f64, "names node"),
        ("tree0_parent", 0, -2.0, "names node -2"),
        ("tree0_entry", 0, nodes as f64, "names node"),
        ("tree0_entry", 0, -7.0, "names node -7"),
        ("tree0_altitude", 0, f64::NAN, "altitude is not a number"),
        ("tree0_volume", 0, f64::INFINITY, "volume is negative or not finite"),
        ("tree0_volume", 0, -1.0, "volume is negative or not finite"),
        ("eigenvalues", 5, f64::NAN, "eigenvalues holds a value that is not finite"),
        ("eigenvalues", 5, 1e9, "eigenvalues is negative or does not ascend"),
        ("eigenvalues", 0, -1.0, "eigenvalues is negative or does not ascend"),
        ("region_descriptor", 2, f64::NAN, "region_descriptor holds a value that is not finite"),
        ("region_cosine", 1, f64::NEG_INFINITY, "region_cosine holds a value that is not finite"),
        ("region_twin", 0, 77.0, "region_twin is not that of regions.json"),
        ("region_side", 0, 0.25, "region_side is not that of regions.json"),
        ("region_voxels", 1, f64::from(voxels[0]), "does not ascend within a region"),
        ("region_voxels", 1, 1e9, "names something beyond"),
        ("region_voxels_start", 0, 1.0, "does not cut all"),
        ("voxel_region", 0, 1e6, "voxel_region names something beyond"),
        ("vertex_region", 0, 1e6, "vertex_region names something beyond"),
        ("vertex_voxel", 0, 1e9, "vertex_voxel names something beyond"),
        ("voxel_index", 0, 1e6, "voxel_index names voxel"),
    ] {
        VOLUME.write(folder.path()).unwrap();
        spoil(folder.path(), array, number(at, value));
        let text = error(folder.path());
        assert!(text.contains("features.npz") && text.contains(said), "{array}: {text}");
    }
    // Labels that other programs read and the lists say the same.
    VOLUME.write(folder.path()).unwrap();
    let label = VOLUME.voxel_region()[0];
    spoil(folder.path(), "voxel_region", number(0, f64::from(if label < 0 { 0 } else { -1 })));
    assert!(error(folder.path()).contains("voxel_region does not fit"));
}

#[test]
fn a_grid_that_no_memory_holds_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    // One voxel far away: a small file that stands for a box of 2^39 voxels, 256 GiB.
    let mut results = VOLUME.clone();
    results.record.grid.as_mut().unwrap().dims = [1 << 13; 3];
    results.record.grid.as_mut().unwrap().affine = Affine::default();
    results.write(folder.path()).unwrap();
    let text = error(folder.path());
    assert!(text.contains("features.npz") && text.contains("bytes of memory"), "{text}");
    // A label map has bytes where the grid has bits.
    let mut map = VOLUME.clone();
    map.record.grid.as_mut().unwrap().dims = [1 << 13; 3];
    let refused = map.export(&folder.path().join("a.nii.gz")).unwrap_err();
    assert!(matches!(refused, ResultsError::TooLarge { .. }), "{refused}");
    for dims in [[usize::MAX; 3], [1 << 40, 1 << 40, 2], [0, 5, 5]] {
        results.record.grid.as_mut().unwrap().dims = dims;
        results.write(folder.path()).unwrap();
        assert!(error(folder.path()).contains("features.npz"));
    }
}

#[test]
fn records_that_nobody_could_have_written_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let refuses = |said: &str, change: &dyn Fn(&mut Results)| {
        let mut results = VOLUME.clone();
        change(&mut results);
        results.write(folder.path()).unwrap();
        let text = error(folder.path());
        assert!(text.contains("regions.json") && text.contains(said), "{said}: {text}");
    };
    refuses("parent, tree, body or twin", &|r| r.record.regions[1].parent = Some(1));
    refuses("parent, tree, body or twin", &|r| r.record.regions[0].parent = Some(1));
    refuses("parent, tree, body or twin", &|r| r.record.regions[1].body = 3);
    refuses("out of its range", &|r| r.record.regions[1].reliability = Some(7.0));
    refuses("out of its range", &|r| r.record.regions[1].volume = -1.0);
    refuses("tree 0 is of a body", &|r| r.record.trees[0].body = 1);
    refuses("no body", &|r| r.record.bodies.clear());
    refuses("body 0 has no measure", &|r| r.record.bodies[0].measure = 0.0);
    refuses("parameters are none", &|r| r.record.parameters.time_scales.clear());
}

#[test]
fn a_result_is_whole_at_every_moment_of_being_replaced() {
    let (root, new) = (tempfile::tempdir().unwrap(), fewer_regions());
    let written = root.path().join("new");
    new.write(&written).unwrap();
    let new_files = contents(&written);
    // What goes and comes, the record first and last. Before each step, the process is killed.
    let steps = [
        "-regions.json",
        "-landmarks.mrk.json",
        "features.npz",
        "surface.ply",
        "volume.vti",
        "checksums.json",
        "regions.json",
    ];
    for step in 0..=steps.len() {
        let folder = root.path().join(step.to_string());
        // What goes with the old result, and what is not part of it.
        ResultsFolder::create(&folder).unwrap().write(&VOLUME, &[Extra::Landmarks]).unwrap();
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        let complete = folder.join(".new");
        fs::create_dir(&complete).unwrap();
        new_files.iter().for_each(|(name, bytes)| fs::write(complete.join(name), bytes).unwrap());
        for name in &steps[..step] {
            match name.strip_prefix('-') {
                Some(gone) => fs::remove_file(folder.join(gone)).unwrap(),
                None => fs::rename(complete.join(name), folder.join(name)).unwrap(),
            }
        }
        let read = Results::load(&folder).unwrap();
        let expected = if step == 0 { &*VOLUME } else { &new };
        assert!(read.record == expected.record, "{step}");
        if step > 0 && step < steps.len() {
            let mut all = contents(&folder);
            assert_eq!(all.remove("notes.txt").unwrap(), b"mine");
            assert!(all == new_files, "{step}: {:?}", all.keys());
        }
        // The next that writes finishes or takes away what is left.
        VOLUME.write(&folder).unwrap();
        assert!(Results::load(&folder).unwrap().record == VOLUME.record);
        assert_eq!(names(&folder), [&FILES[..2], &["notes.txt"], &FILES[2..]].concat());
        assert_eq!(verify(&folder), []);
    }
}

#[test]
fn a_write_that_fails_leaves_the_old_result_and_nothing_else() {
    let root = tempfile::tempdir().unwrap();
    let folder = root.path().join("out");
    VOLUME.write(&folder).unwrap();
    let before = contents(&folder);
    // Eigenfunctions were not kept, which is found out when the other files are written.
    let new = ResultsFolder::create(&folder).unwrap();
    new.write(&fewer_regions(), &[Extra::Eigenfunctions]).unwrap_err();
    drop(new);
    assert!(contents(&folder) == before);
    let fresh = root.path().join("a/b");
    ResultsFolder::create(&fresh).unwrap().write(&VOLUME, &[Extra::Eigenfunctions]).unwrap_err();
    assert!(!root.path().join("a").exists());
}

#[test]
fn two_runs_do_not_write_to_one_folder() {
    let folder = tempfile::tempdir().unwrap();
    VOLUME.write(folder.path()).unwrap();
    let first = ResultsFolder::create(folder.path()).unwrap();
    for refused in [ResultsFolder::create(folder.path()).map(|_| ()), VOLUME.write(folder.path())] {
        let text = refused.unwrap_err().to_string();
        assert!(text.contains("another run is writing"), "{text}");
    }
    // Who reads is not kept out.
    Results::load(folder.path()).unwrap();
    drop(first);
    VOLUME.write(folder.path()).unwrap();
}

fn spots() -> MsvResults {
    let dims = [20, 20, 5];
    let grey = |v: usize| {
        let (x, y) = (v % 20, v / 20 % 20);
        let inside = |cx: usize, r: usize| x.abs_diff(cx).max(y.abs_diff(10)) <= r;
        if inside(6, 1) {
            200u8
        } else if inside(6, 3) {
            120
        } else if inside(14, 2) {
            90
        } else {
            10
        }
    };
    let values: Vec<u8> = (0..2000).map(grey).collect();
    let volume = Volume::new(dims, 1, Affine::default(), values).unwrap();
    let mut parameters = MsvSearchParameters::default();
    parameters.msv.min_area = 0.001;
    MsvResults::find(&volume, "spots.npy", &parameters).unwrap()
}

#[test]
fn grey_value_results_are_checked_and_replaced_as_a_whole() {
    let folder = tempfile::tempdir().unwrap();
    let found = spots();
    let bright = found.record.searches.iter().position(|s| s.regions.len() > 1).unwrap();
    found.write(folder.path()).unwrap();
    assert_eq!(
        names(folder.path()),
        ["checksums.json", "labels.npy", "labels.vti", "msv.json", "regions.csv"]
    );
    assert!(MsvResults::load(folder.path()).unwrap() == found);
    assert_eq!(verify(folder.path()), []);
    // Two results of two kinds in one folder vouch for their own files.
    VOLUME.write(folder.path()).unwrap();
    assert_eq!(verify(folder.path()), []);
    assert_eq!(Checksums::load(folder.path()).unwrap().files.len(), 8);
    let path = folder.path().join("labels.npy");
    let whole = fs::read(&path).unwrap();
    let mut damaged = whole.clone();
    damaged[whole.len() - 3] ^= 1;
    fs::write(&path, damaged).unwrap();
    assert!(MsvResults::load(folder.path()).unwrap_err().to_string().contains("labels.npy: damaged"));
    let refuses = |change: &dyn Fn(&mut MsvResults)| {
        let mut results = found.clone();
        change(&mut results);
        results.write(folder.path()).unwrap();
        let text = MsvResults::load(folder.path()).unwrap_err().to_string();
        assert!(text.contains("msv.json") || text.contains("labels.npy"), "{text}");
    };
    refuses(&|r| r.record.searches[bright].regions[0].parent = Some(0));
    refuses(&|r| r.record.searches[bright].regions[0].parent = Some(1));
    refuses(&|r| r.record.searches[bright].regions[1].region = 9);
    // A label of one search that only another search has.
    let (most, least) = (bright, 1 - bright);
    assert!(found.record.searches[most].regions.len() > found.record.searches[least].regions.len());
    refuses(&|r| r.labels[least][0] = Some(r.record.searches[least].regions.len() as u32));
}

#[test]
fn tracks_that_lead_nowhere_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let frame = |name: &str| TrackedFrame {
        name: name.into(),
        path: "a.off".into(),
        time: None,
        regions: Some(2),
        identity: None,
    };
    let sighting = |frame: usize, region: u32| Sighting {
        frame,
        region,
        overlap: None,
        likeness: None,
        reliability: None,
        volume: 1.0,
        volume_fraction: 0.1,
        centroid: [0.0; 3],
    };
    let track = Track {
        id: 0,
        colour: [1, 2, 3],
        first_frame: 0,
        last_frame: 1,
        colour_of: 0,
        found: 2,
        mean_overlap: None,
        reliability: None,
        sightings: vec![sighting(0, 1), sighting(1, 0)],
    };
    let good = TracksRecord::new(TrackParameters::default(), vec![frame("a"), frame("b")], vec![track]);
    good.write(folder.path()).unwrap();
    assert_eq!(TracksRecord::load(folder.path()).unwrap(), good);
    let refuses = |change: &dyn Fn(&mut TracksRecord)| {
        let mut record = good.clone();
        change(&mut record);
        record.write(folder.path()).unwrap();
        let text = TracksRecord::load(folder.path()).unwrap_err().to_string();
        assert!(text.contains("tracks.json"), "{text}");
    };
    refuses(&|r| r.frames[1].name = "../../etc".into());
    refuses(&|r| r.frames[1].name = "/etc".into());
    refuses(&|r| r.tracks[0].colour_of = 1);
    refuses(&|r| r.tracks[0].sightings[1] = sighting(2, 0));
    refuses(&|r| r.tracks[0].sightings[1] = sighting(1, 2));
    refuses(&|r| r.tracks[0].sightings.reverse());
    refuses(&|r| r.tracks[0].sightings.clear());
    refuses(&|r| r.tracks[0].found = 3);
    refuses(&|r| r.parameters.points = 0);
}
