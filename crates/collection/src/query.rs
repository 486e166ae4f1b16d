use std::path::{Path, PathBuf};

use mser3d::descriptors::Descriptors;
use mser3d_results::Checksums;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::parquet_table::Table;
use crate::tables::{REGIONS_TABLE, SETTINGS};
use crate::{CollectionError, DescribedResult, DescriptorSettings};

/// All regions of a collection, to be searched by descriptor.
#[derive(Clone, Debug)]
pub struct Index {
    folder: PathBuf,
    settings: DescriptorSettings,
    shapes: Vec<String>,
    regions: Vec<u32>,
    fractions: Vec<f64>,
    twins: Vec<Option<u32>>,
    sides: Vec<Option<f64>>,
    descriptors: Descriptors,
}

/// A region of a collection that is like another.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Hit {
    /// Name of its shape.
    pub shape: String,
    /// Its number there.
    pub region: u32,
    /// Its volume over that of the shape.
    pub volume_fraction: f64,
    /// Its mirror image on its shape.
    pub twin: Option<u32>,
    /// On which side of its body it is, from -1 to 1; none where the body has no sides.
    pub side: Option<f64>,
    /// Euclidean distance of the descriptors.
    pub distance: f64,
}

/// The regions of a collection nearest to one region of a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegionHits {
    /// The region of the shape.
    pub region: u32,
    /// What is nearest to it, nearest first.
    pub closest: Vec<Hit>,
}

/// What a query found, as `mser3d query --json` says it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct QueryRecord {
    /// The version of mser3d that searched.
    pub mser3d: String,
    /// The collection's folder.
    pub collection: String,
    /// Regions that were searched.
    pub searched: usize,
    /// Folder of the shape.
    pub shape: String,
    /// Its regions, with what is nearest to each.
    pub regions: Vec<RegionHits>,
}

impl Index {
    /// Reads `regions.parquet` of a collection.
    ///
    /// # Errors
    /// [`CollectionError::NotACollection`] for a folder that is none, is not finished, or has no regions;
    /// [`CollectionError::Table`] for a table that is broken.
    pub fn load(folder: &Path) -> Result<Self, CollectionError> {
        let none = |problem: &str| CollectionError::NotACollection {
            folder: folder.to_owned(),
            problem: problem.to_owned(),
        };
        let path = folder.join(REGIONS_TABLE);
        if !path.exists() {
            return Err(none(if folder.join("regions.json").is_file() {
                "this is the result of one shape, no collection; make one with `mser3d batch`, or compare two \
                 results with `mser3d match`"
            } else if folder.join(".lock").is_file() {
                "this collection is not finished (there is no regions.parquet): a batch is still running or was \
                 stopped; run it again, or `mser3d batch --merge` after all shards"
            } else {
                "there is no regions.parquet, so this is no collection; make one with `mser3d batch`"
            }));
        }
        Checksums::load(folder)?.check(folder, REGIONS_TABLE)?;
        let table = Table::open(&path)?;
        if table.rows() == 0 {
            return Err(none("no shape of this collection has regions; nothing can be found"));
        }
        let broken = |reason: String| CollectionError::Table { path: path.clone(), reason };
        let settings = table.note(SETTINGS).and_then(|text| serde_json::from_str(text).ok());
        let settings = settings.ok_or_else(|| {
            broken("not written by this version of mser3d; run `mser3d batch` again".into())
        })?;
        let (shapes, regions) = (table.column::<String>("shape")?, table.column::<i32>("region")?);
        let (width, values) = table.lists("descriptor")?;
        let fractions: Vec<f64> = table.column("volume_fraction")?;
        let (twins, sides) = (table.optional::<i32>("twin")?, table.optional::<f64>("side")?);
        let rows = table.rows();
        let good = |row: usize| {
            let descriptor = &values[row * width..][..width];
            let numbers = descriptor.iter().all(|x| x.is_finite()) || descriptor.iter().all(|x| x.is_nan());
            let share = fractions[row].is_finite() && sides[row].is_none_or(|side: f64| side.is_finite());
            numbers && share && regions[row] >= 0 && twins[row].is_none_or(|twin| twin >= 0)
        };
        if let Some(row) = (0..rows).find(|&row| width == 0 || !good(row)) {
            return Err(broken(format!(
                "row {row} is no region: a number is out of its range; run `mser3d batch --merge`"
            )));
        }
        // Rows of NaN are of shapes that cannot be compared.
        let kept: Vec<usize> = (0..rows).filter(|&row| !values[row * width].is_nan()).collect();
        let values = kept.iter().flat_map(|&row| values[row * width..][..width].iter().copied()).collect();
        let shapes = kept.iter().map(|&row| shapes[row].clone()).collect();
        let regions = kept.iter().map(|&row| regions[row] as u32).collect();
        let fractions = kept.iter().map(|&row| fractions[row]).collect();
        let twins = kept.iter().map(|&row| twins[row].map(|twin| twin as u32)).collect();
        let sides = kept.iter().map(|&row| sides[row]).collect();
        let descriptors = Descriptors::new(width, values)?;
        Ok(Self {
            folder: folder.to_owned(),
            settings,
            shapes,
            regions,
            fractions,
            twins,
            sides,
            descriptors,
        })
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Regions in the collection.
    pub fn len(&self) -> usize {
        self.regions.len()
    }

    /// The shapes that have regions which can be compared, by name.
    pub fn shapes(&self) -> Vec<&str> {
        let mut shapes: Vec<&str> = self.shapes.iter().map(String::as_str).collect();
        shapes.dedup();
        shapes
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty()
    }

    /// The `count` regions nearest to each region of a shape by descriptor, nearest first; of equally near
    /// ones, the first by name of shape and number. Regions of the shape `but` are left out.
    ///
    /// Exact: all distances are computed.
    ///
    /// # Errors
    /// [`CollectionError::DifferentDescriptors`].
    pub fn nearest(
        &self,
        shape: &DescribedResult,
        count: usize,
        but: Option<&str>,
    ) -> Result<Vec<RegionHits>, CollectionError> {
        let difference = self.settings.difference(&shape.settings);
        let widths = [self.descriptors.width(), shape.descriptors.width()];
        let difference = difference.or_else(|| {
            (widths[0] != widths[1]).then(|| format!("length {} against {}", widths[0], widths[1]))
        });
        if let Some(what) = difference {
            let (first, second) = (self.folder.clone(), shape.folder.clone());
            return Err(CollectionError::DifferentDescriptors { first, second, what });
        }
        let queries: Vec<(u32, &[f64])> = (0..).zip(shape.descriptors.rows()).collect();
        let search = |(region, query)| RegionHits { region, closest: self.nearest_to(query, count, but) };
        Ok(queries.into_par_iter().map(search).collect())
    }

    /// The record of a query.
    pub fn record(&self, shape: &DescribedResult, regions: Vec<RegionHits>) -> QueryRecord {
        QueryRecord {
            mser3d: env!("CARGO_PKG_VERSION").to_owned(),
            collection: self.folder.to_string_lossy().into_owned(),
            searched: self.len(),
            shape: shape.folder.to_string_lossy().into_owned(),
            regions,
        }
    }

    fn nearest_to(&self, query: &[f64], count: usize, but: Option<&str>) -> Vec<Hit> {
        // The nearest so far, in order; short, so sorting in is cheap.
        let mut best: Vec<(f64, usize)> = Vec::with_capacity(count.min(self.len()) + 1);
        for (number, row) in self.descriptors.rows().enumerate() {
            let distance: f64 = row.iter().zip(query).map(|(a, b)| (a - b) * (a - b)).sum();
            let full = best.len() == count;
            if full && best.last().is_none_or(|&(worst, _)| distance >= worst) {
                continue;
            }
            if but.is_some_and(|but| self.shapes[number] == but) {
                continue;
            }
            let place = best.partition_point(|&(d, _)| d <= distance);
            best.insert(place, (distance, number));
            best.truncate(count);
        }
        let hit = |(distance, number): (f64, usize)| Hit {
            shape: self.shapes[number].clone(),
            region: self.regions[number],
            volume_fraction: self.fractions[number],
            twin: self.twins[number],
            side: self.sides[number],
            distance: distance.sqrt(),
        };
        best.into_iter().map(hit).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn index(rows: usize) -> Index {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64
        };
        let settings = DescriptorSettings {
            domain: Default::default(),
            eigenpairs: 100.into(),
            descriptor: Default::default(),
            measure: 1.0,
            own_measure: true,
        };
        Index {
            folder: PathBuf::new(),
            settings,
            shapes: (0..rows).map(|i| format!("shape{:05}", i / 20)).collect(),
            regions: (0..rows).map(|i| i as u32 % 20).collect(),
            fractions: vec![0.1; rows],
            twins: vec![None; rows],
            sides: vec![None; rows],
            descriptors: Descriptors::new(6, (0..6 * rows).map(|_| random()).collect()).unwrap(),
        }
    }

    #[test]
    fn the_nearest_are_those_of_a_full_sort() {
        let index = index(1000);
        let query = index.descriptors.row(123);
        let mut all: Vec<(f64, usize)> = (0..1000)
            .filter(|i| i / 20 != 6)
            .map(|i| {
                let row = index.descriptors.row(i);
                (row.iter().zip(query).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt(), i)
            })
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        let hits = index.nearest_to(query, 7, Some("shape00006"));
        let found: Vec<(f64, usize)> = hits
            .iter()
            .map(|h| (h.distance, h.shape[5..].parse::<usize>().unwrap() * 20 + h.region as usize))
            .collect();
        assert_eq!(found, all[..7]);
        assert_eq!((index.shapes().len(), index.shapes()[6]), (50, "shape00006"));
        // Without leaving its own shape out, a region is nearest to itself.
        assert_eq!(index.nearest_to(query, 1, None)[0].region, 3);
        assert_eq!(index.nearest_to(query, 5000, None).len(), 1000);
        assert!(index.nearest_to(query, 0, None).is_empty());
    }
}
