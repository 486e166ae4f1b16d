//! What collections keep: spectra in a cache, and tables.

use std::path::PathBuf;
use std::sync::OnceLock;

use arbitrary::Unstructured;
use mser3d::spectral::{Spectrum, SpectrumParameters};
use mser3d::{Detector, DiscreteShape, Input, NO_PROGRESS};
use mser3d_collection::{CacheUse, DescribedResult, Index, SpectrumCache, build_tables};
use mser3d_fileio::{NpyArray, read_npz, write_npz};
use mser3d_results::Results;
use mser3d_shape::{BitGrid, Connectivity, Frame, VoxelGrid};

use crate::patches::patch_arrays;
use crate::results::{cross, parameters, write_folder};
use crate::scratch::{check_message, folder};

struct Cached {
    cache: SpectrumCache,
    shape: DiscreteShape,
    parameters: SpectrumParameters,
    path: PathBuf,
    bytes: Vec<u8>,
    arrays: Vec<(String, NpyArray<'static>)>,
    spectrum: Spectrum,
}

fn cached() -> &'static Cached {
    static CACHED: OnceLock<Cached> = OnceLock::new();
    CACHED.get_or_init(|| {
        let dims = [3, 2, 4];
        let frame = Frame::new(dims, [0.0; 3], [0.5; 3]).unwrap_or_else(|error| panic!("{error}"));
        let full = BitGrid::full(dims).unwrap_or_else(|error| panic!("{error}"));
        let grid = VoxelGrid::solid(frame, full).unwrap_or_else(|error| panic!("{error}"));
        let shape = DiscreteShape::solid(grid, Connectivity::Six);
        let parameters = SpectrumParameters { eigenpairs: 5.into(), ..SpectrumParameters::default() };
        let folder = folder().join("cache");
        let cache = SpectrumCache::open(&folder).unwrap_or_else(|error| panic!("{error}"));
        let (spectrum, _) =
            cache.spectrum(&shape, &parameters, NO_PROGRESS).unwrap_or_else(|error| panic!("{error}"));
        let entries = std::fs::read_dir(&folder).into_iter().flatten().flatten();
        let path =
            entries.map(|entry| entry.path()).find(|path| path.extension().is_some_and(|e| e == "npz"));
        let path = path.unwrap_or_else(|| panic!("an entry of the cache"));
        let bytes = std::fs::read(&path).unwrap_or_default();
        let arrays = read_npz(&path).unwrap_or_else(|error| panic!("{error}")).into_iter().collect();
        Cached { cache, shape, parameters, path, bytes, arrays, spectrum }
    })
}

/// An entry of the cache, its bytes or its arrays damaged. What the cache gives is the spectrum all the same: eigenvalues as
/// computed, eigenfunctions of length 1.
pub fn cache(input: &[u8]) {
    let Some((&damage, rest)) = input.split_first() else { return };
    let cached = cached();
    if damage % 2 == 0 {
        let _ = std::fs::write(&cached.path, rest);
    } else {
        let mut arrays = cached.arrays.clone();
        if patch_arrays(&mut arrays, &mut Unstructured::new(rest)).is_err() {
            return;
        }
        let named: Vec<(&str, NpyArray)> =
            arrays.iter().map(|(name, array)| (&name[..], array.clone())).collect();
        if write_npz(&cached.path, &named).is_err() {
            return;
        }
    }
    let given = cached.cache.spectrum(&cached.shape, &cached.parameters, NO_PROGRESS);
    let (spectrum, used) = given.unwrap_or_else(|error| panic!("{error}"));
    if let CacheUse::Trouble(text) = &used {
        check_message(text, "cache");
    }
    let (basis, truth) = (&spectrum.basis, &cached.spectrum.basis);
    assert_eq!(basis.eigenvalues().len(), truth.eigenvalues().len(), "{used:?}");
    for (found, wanted) in basis.eigenvalues().iter().zip(truth.eigenvalues()) {
        assert!((found - wanted).abs() <= 1e-6 * (1.0 + wanted), "{used:?}: {found} for {wanted}");
    }
    let (count, functions) = (basis.eigenvalues().len(), basis.functions().to_f64());
    for column in 0..count {
        let rows = basis.mass().iter().enumerate();
        let norm: f64 = rows.map(|(row, mass)| mass * functions[row * count + column].powi(2)).sum();
        assert!((norm - 1.0).abs() < 1e-6, "{used:?}: length {norm} of eigenfunction {column}");
    }
}

pub fn cache_seeds() -> Vec<Vec<u8>> {
    let mut seeds = vec![[&[0][..], &cached().bytes].concat(), vec![1]];
    seeds.extend((0..12u8).map(|place| [&[1][..], &[place.wrapping_mul(53); 20]].concat()));
    seeds
}

struct Collection {
    path: PathBuf,
    table: Vec<u8>,
    shape: DescribedResult,
}

fn collection() -> &'static Collection {
    static COLLECTION: OnceLock<Collection> = OnceLock::new();
    COLLECTION.get_or_init(|| {
        let path = folder().join("collection");
        let grid = cross();
        let features =
            Detector::new(parameters()).detect(Input::Solid(&grid)).unwrap_or_else(|error| panic!("{error}"));
        let results = Results::new(&features, None, "cross.npy").unwrap_or_else(|error| panic!("{error}"));
        for name in ["a", "b"] {
            write_folder(&results, &path.join(name));
        }
        build_tables(&path).unwrap_or_else(|error| panic!("{error}"));
        let table = std::fs::read(path.join("regions.parquet")).unwrap_or_default();
        let shape = DescribedResult::load(&path.join("a")).unwrap_or_else(|error| panic!("{error}"));
        Collection { path, table, shape }
    })
}

/// The table that queries read.
pub fn parquet(bytes: &[u8]) {
    let collection = collection();
    let _ = std::fs::write(collection.path.join("regions.parquet"), bytes);
    let text = |error: mser3d_collection::CollectionError| check_message(&error.to_string(), "");
    let Ok(index) = Index::load(&collection.path).map_err(text) else { return };
    let Ok(hits) = index.nearest(&collection.shape, 3, Some("a")).map_err(text) else { return };
    for region in &hits {
        assert!(region.closest.len() <= 3);
    }
    let _ = (index.shapes().len(), index.record(&collection.shape, hits));
}

pub fn parquet_seeds() -> Vec<Vec<u8>> {
    vec![collection().table.clone()]
}
