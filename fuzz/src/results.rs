//! Folders of results, damaged in all ways, and whoever reads them.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use arbitrary::Unstructured;
use mser3d::spectral::EigenpairRange;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters};
use mser3d_collection::{
    DescribedResult, MatchingParameters, map_vertices, match_results, track_glb, track_page,
};
use mser3d_fileio::{NpyArray, read_npz, write_npz};
use mser3d_results::msv::{MsvResults, MsvSearchParameters};
use mser3d_results::{
    Eigenfunctions, Extra, Identity, Results, ResultsError, ResultsFolder, Sighting, Track, TrackParameters,
    TrackedFrame, TracksRecord,
};
use mser3d_shape::{Affine, BitGrid, Frame, TriangleMesh, VoxelGrid};
use mser3d_viewer::{RenderOptions, Up, voxel_surface};
use mser3d_volumeio::Volume;
use serde_json::Value;

use crate::patches::{patch_arrays, patch_json};
use crate::scratch::{check_message, folder};

/// A result as it is written: its files, with the arrays taken apart.
struct Template {
    name: &'static str,
    files: Vec<(String, Vec<u8>)>,
    record: Value,
    features: Vec<(String, NpyArray<'static>)>,
    eigenfunctions: Vec<(String, NpyArray<'static>)>,
}

/// A cross of four thick arms, one of them longer.
pub fn cross() -> VoxelGrid {
    let dims = [13, 11, 3];
    let mut inside = BitGrid::empty(dims).unwrap_or_else(|error| panic!("{error}"));
    for (i, j, k) in (0..13).flat_map(|i| (0..11).flat_map(move |j| (0..3).map(move |k| (i, j, k)))) {
        if (4..7).contains(&j) || (3..6).contains(&i) {
            inside.set([i, j, k], true);
        }
    }
    let frame = Frame::new(dims, [0.0; 3], [0.5; 3]).unwrap_or_else(|error| panic!("{error}"));
    VoxelGrid::solid(frame, inside).unwrap_or_else(|error| panic!("{error}"))
}

pub fn parameters() -> Parameters {
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Size(0.5);
    parameters.spectrum.eigenpairs = EigenpairRange::Count(12);
    parameters.reliability.deformations = Some(0);
    parameters
}

/// What is found on the cross as voxels, on the solid inside its surface, and on the surface itself.
fn found() -> Vec<(&'static str, Results)> {
    let grid = cross();
    let surface: TriangleMesh = voxel_surface(&grid).unwrap_or_else(|error| panic!("{error}"));
    let detector = Detector::new(parameters());
    let extras = [Extra::Eigenfunctions];
    let of = |name, input, mesh| {
        let features = detector.detect(input).unwrap_or_else(|error| panic!("{error}"));
        let results = Results::new(&features, mesh, "cross.off").unwrap_or_else(|error| panic!("{error}"));
        (name, results.with_extras(&features, &extras))
    };
    vec![
        of("solid", Input::Solid(&grid), None),
        of("volume", Input::Volume(&surface), Some(&surface)),
        of("surface", Input::Surface(&surface), Some(&surface)),
    ]
}

pub fn write_folder(results: &Results, path: &Path) {
    let folder = ResultsFolder::create(path).unwrap_or_else(|error| panic!("{error}"));
    let extras: &[Extra] = if results.eigenfunctions.is_some() { &[Extra::Eigenfunctions] } else { &[] };
    folder.write(results, extras).unwrap_or_else(|error| panic!("{error}"));
}

fn templates() -> &'static [Template] {
    static TEMPLATES: OnceLock<Vec<Template>> = OnceLock::new();
    TEMPLATES.get_or_init(|| {
        let of = |(name, results): (&'static str, Results)| {
            let path = folder().join("template");
            let _ = std::fs::remove_dir_all(&path);
            write_folder(&results, &path);
            // Damage is to reach the readers: a checksum would stop it.
            let mut files = files_of(&path);
            files.retain(|(name, _)| name != "checksums.json");
            let text = std::fs::read(path.join("regions.json")).unwrap_or_default();
            let record = serde_json::from_slice(&text).unwrap_or_else(|error| panic!("{error}"));
            let arrays = |name: &str| -> Vec<(String, NpyArray<'static>)> {
                let arrays = read_npz(&path.join(name)).unwrap_or_else(|error| panic!("{error}"));
                arrays.into_iter().collect()
            };
            let (features, eigenfunctions) = (arrays("features.npz"), arrays("eigenfunctions.npz"));
            let template = Template { name, files, record, features, eigenfunctions };
            assert!(!results.record.regions.is_empty() || name == "surface", "{name} has regions");
            template
        };
        found().into_iter().map(of).collect()
    })
}

/// The files of a folder, by name.
pub fn files_of(path: &Path) -> Vec<(String, Vec<u8>)> {
    let entries = std::fs::read_dir(path).into_iter().flatten().flatten();
    let mut files: Vec<(String, Vec<u8>)> = entries
        .filter(|entry| entry.path().is_file())
        .map(|entry| {
            let bytes = std::fs::read(entry.path()).unwrap_or_default();
            (entry.file_name().to_string_lossy().into_owned(), bytes)
        })
        .collect();
    files.sort();
    files
}

/// Files that loaders read, and so can be replaced as a whole.
const FILES: [&str; 4] = ["regions.json", "features.npz", "surface.ply", "eigenfunctions.npz"];

/// Bytes: which result, which damage, which reader; then the damage.
pub fn run(input: &[u8]) {
    let &[which, damage, reader, ref rest @ ..] = input else { return };
    let template = &templates()[usize::from(which) % templates().len()];
    let path = folder().join("result");
    let _ = std::fs::create_dir_all(&path);
    for (name, bytes) in &template.files {
        std::fs::write(path.join(name), bytes).unwrap_or_else(|error| panic!("{error}"));
    }
    let damaged = damage_folder(template, &path, damage, rest);
    if damaged.is_err() {
        return;
    }
    match Results::load(&path) {
        Ok(results) => read_all(&results, &path, reader),
        Err(error) => check_error(&error),
    }
}

fn damage_folder(template: &Template, path: &Path, damage: u8, rest: &[u8]) -> arbitrary::Result<()> {
    let mut input = Unstructured::new(rest);
    let arrays = |arrays: &[(String, NpyArray<'static>)], name: &str, input: &mut Unstructured| {
        let mut arrays = arrays.to_vec();
        patch_arrays(&mut arrays, input)?;
        let named: Vec<(&str, NpyArray)> =
            arrays.iter().map(|(name, array)| (&name[..], array.clone())).collect();
        write_npz(&path.join(name), &named).map_err(|_| arbitrary::Error::IncorrectFormat)
    };
    match damage % 8 {
        0..=3 => {
            let _ = std::fs::write(path.join(FILES[usize::from(damage % 4)]), rest);
        }
        4 => arrays(&template.eigenfunctions, "eigenfunctions.npz", &mut input)?,
        5 => arrays(&template.features, "features.npz", &mut input)?,
        kind => {
            let mut record = template.record.clone();
            patch_json(&mut record, &mut input)?;
            let _ = std::fs::write(path.join("regions.json"), record.to_string());
            if kind == 7 {
                arrays(&template.features, "features.npz", &mut input)?;
            }
        }
    }
    Ok(())
}

fn check_error(error: &ResultsError) {
    check_message(&error.to_string(), "");
}

/// What commands do with a result that was read. What it says may be wrong; nothing may break on it.
fn read_all(results: &Results, path: &Path, reader: u8) {
    let said = |error: ResultsError| check_error(&error);
    let out = |name: &str| -> PathBuf { folder().join(name) };
    match reader % 8 {
        0 => drop(results.page("title", Up::Y).map_err(said)),
        1 => {
            let options = RenderOptions { height: 40, supersampling: 1, ..RenderOptions::default() };
            drop(results.sheet(&options).map_err(said));
        }
        2 => {
            for name in ["out.glb", "out.vtp", "out.ply", "out.vti", "out.nii.gz", "out.mrk.json"] {
                drop(results.export(&out(name)).map_err(said));
            }
        }
        3 => drop(Eigenfunctions::load(path, results).map_err(said)),
        4 => {
            let parts = results.with_parts_as_regions().map_err(said);
            if let Ok(parts) = parts {
                drop(parts.page("parts", Up::Z).map_err(said));
            }
        }
        5 => {
            let _ = (results.vertex_region(), results.voxel_region(), results.colours(), results.name());
            for region in 0..results.record.regions.len() {
                let _ = (results.node(region), results.descriptor(region).len());
            }
            if let Some(cut) = results.cut(None, None, Up::Y, 0.0) {
                drop(results.voxel_model(Some(&cut)).map_err(said));
            }
            let text = results.record.to_json().unwrap_or_else(|error| panic!("{error}"));
            assert!(!text.is_empty());
        }
        6 => drop(results.fine_surface(path).map_err(said)),
        _ => {
            let text = |error: mser3d_collection::CollectionError| check_message(&error.to_string(), "");
            let Ok(first) = DescribedResult::load(path).map_err(text) else { return };
            let parameters = MatchingParameters { allow_mirror: true, ..MatchingParameters::default() };
            let Ok(matching) = match_results(&first, &first, &parameters).map_err(text) else { return };
            drop(map_vertices(&first, &first, &matching, &Default::default()).map_err(text));
        }
    }
}

pub fn seeds() -> Vec<Vec<u8>> {
    let mut seeds = Vec::new();
    for (which, template) in templates().iter().enumerate() {
        for reader in 0..8 {
            for damage in 4..8u8 {
                seeds.push(vec![which as u8, damage, reader]);
                seeds.push([&[which as u8, damage, reader][..], &[reader.wrapping_mul(37); 24]].concat());
            }
        }
        for (damage, name) in FILES.iter().enumerate() {
            let Some((_, bytes)) = template.files.iter().find(|(of, _)| of == name) else { continue };
            if bytes.len() < 40_000 {
                seeds.push([&[which as u8, damage as u8, damage as u8][..], bytes].concat());
            }
        }
        assert!(!template.name.is_empty());
    }
    seeds
}

/// A grey-value result: `msv.json` or `labels.npy`.
pub fn run_msv(input: &[u8]) {
    let &[damage, reader, ref rest @ ..] = input else { return };
    let template = msv_template();
    let path = folder().join("msv");
    let _ = std::fs::create_dir_all(&path);
    for (name, bytes) in template {
        std::fs::write(path.join(name), bytes).unwrap_or_else(|error| panic!("{error}"));
    }
    match damage % 3 {
        0 => drop(std::fs::write(path.join("msv.json"), rest)),
        1 => drop(std::fs::write(path.join("labels.npy"), rest)),
        _ => {
            let text =
                template.iter().find(|(name, _)| name == "msv.json").map_or(&[][..], |(_, bytes)| bytes);
            let mut record = serde_json::from_slice(text).unwrap_or_else(|error| panic!("{error}"));
            if patch_json(&mut record, &mut Unstructured::new(rest)).is_err() {
                return;
            }
            drop(std::fs::write(path.join("msv.json"), record.to_string()));
        }
    }
    let said = |error: ResultsError| check_error(&error);
    let Ok(results) = MsvResults::load(&path).map_err(said) else { return };
    match reader % 3 {
        0 => drop(results.page("title", Up::Z, None).map_err(said)),
        1 => {
            let options = RenderOptions { height: 40, supersampling: 1, ..RenderOptions::default() };
            drop(results.sheet(&options).map_err(said));
        }
        _ => assert!(!results.record.to_csv().is_empty()),
    }
}

fn msv_template() -> &'static [(String, Vec<u8>)] {
    static FILES: OnceLock<Vec<(String, Vec<u8>)>> = OnceLock::new();
    FILES.get_or_init(|| {
        let dims = [7usize, 6, 5];
        let grey = (0..210).map(|v| {
            let [i, j, k] = [v % 7, v / 7 % 6, v / 42];
            if (1..4).contains(&i) && (1..4).contains(&j) && (1..4).contains(&k) {
                200u8
            } else {
                20 + (v % 3) as u8
            }
        });
        let volume = Volume::new(dims, 1, Affine::default(), grey.collect::<Vec<u8>>());
        let volume = volume.unwrap_or_else(|error| panic!("{error}"));
        let parameters = MsvSearchParameters::default();
        let found =
            MsvResults::find(&volume, "volume.nii", &parameters).unwrap_or_else(|error| panic!("{error}"));
        let path = folder().join("msv-template");
        found.write(&path).unwrap_or_else(|error| panic!("{error}"));
        assert!(found.record.searches.iter().any(|search| !search.regions.is_empty()));
        let mut files = files_of(&path);
        files.retain(|(name, _)| name != "checksums.json");
        files
    })
}

pub fn msv_seeds() -> Vec<Vec<u8>> {
    let mut seeds: Vec<Vec<u8>> =
        (0..3).flat_map(|reader| [vec![2, reader], vec![2, reader, 9, 9, 9, 9, 9, 9, 9]]).collect();
    for (damage, name) in ["msv.json", "labels.npy"].iter().enumerate() {
        let bytes = msv_template().iter().find(|(of, _)| of == name).map_or(&[][..], |(_, bytes)| bytes);
        seeds.push([&[damage as u8, 0][..], bytes].concat());
    }
    seeds
}

/// A tracked sequence of two frames, with `tracks.json` damaged.
pub fn run_tracks(input: &[u8]) {
    let &[damage, reader, ref rest @ ..] = input else { return };
    let path = folder().join("tracked");
    static RECORD: OnceLock<Value> = OnceLock::new();
    let record = RECORD.get_or_init(|| tracked(&path));
    if damage % 4 == 0 {
        drop(std::fs::write(path.join(TracksRecord::FILE), rest));
    } else {
        let mut record = record.clone();
        if patch_json(&mut record, &mut Unstructured::new(rest)).is_err() {
            return;
        }
        drop(std::fs::write(path.join(TracksRecord::FILE), record.to_string()));
    }
    let text = |error: mser3d_collection::CollectionError| check_message(&error.to_string(), "");
    if reader % 2 == 0 {
        drop(track_page(&path, "title", Up::Y).map_err(text));
    } else {
        let _ = track_glb(&path).map_err(text);
    }
}

/// Writes a sequence of two frames that are alike, each of whose regions is a track, and gives its `tracks.json`.
fn tracked(path: &Path) -> Value {
    let (_, mut results) = found().remove(1);
    let mut tracks = Vec::new();
    for region in &mut results.record.regions {
        let colour = [10, 200, region.id as u8];
        (region.track, region.colour) = (Some(region.id), Some(colour));
        let sighting = |frame: usize| Sighting {
            frame,
            region: region.id,
            overlap: (frame > 0).then_some(1.0),
            likeness: None,
            reliability: None,
            volume: region.volume,
            volume_fraction: region.volume_fraction,
            centroid: region.centroid,
        };
        tracks.push(Track {
            id: region.id,
            colour,
            first_frame: 0,
            last_frame: 1,
            colour_of: region.id,
            found: 2,
            mean_overlap: Some(1.0),
            reliability: None,
            sightings: vec![sighting(0), sighting(1)],
        });
    }
    let frames = [("a", 0.0), ("b", 0.5)].map(|(name, time)| {
        write_folder(&results, &path.join(name));
        TrackedFrame {
            name: name.to_owned(),
            path: "cross.glb".to_owned(),
            time: Some(time),
            regions: Some(results.record.regions.len()),
            identity: (time > 0.0).then_some(Identity::Vertices),
        }
    });
    let record = TracksRecord::new(TrackParameters::default(), frames.to_vec(), tracks);
    serde_json::to_value(record).unwrap_or_else(|error| panic!("{error}"))
}

pub fn track_seeds() -> Vec<Vec<u8>> {
    vec![vec![1, 0], vec![1, 1]]
}
