use mser3d::Features;
use mser3d::comptree::Polarity;
use mser3d::descriptors::TimeScale;
use mser3d_shape::Domain;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value, json};

/// The layout of the folder that this version writes and reads.
pub const FORMAT: u64 = 1;

/// What `regions.json` says, as far as it is needed to draw and compare results. The command line
/// writes more: it is kept in [`more`](Record::more).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// The version of mser3d that found the regions.
    pub mser3d: String,
    /// [`FORMAT`].
    pub format: u64,
    /// What heat flowed on.
    #[serde(with = "DomainName")]
    pub domain: Domain,
    /// The component trees, one per time scale.
    pub trees: Vec<TreeRecord>,
    /// The regions, by descending volume.
    pub regions: Vec<RegionRecord>,
    /// Everything else: input, parameters, warnings, times.
    #[serde(flatten)]
    pub more: Map<String, Value>,
}

/// A component tree in `regions.json`; its nodes are in `features.npz`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TreeRecord {
    /// Its time scale; none for the commute time.
    #[serde(with = "time_scale")]
    pub time_scale: Option<TimeScale>,
    /// The time in length^2; none for the commute time.
    pub time: Option<f64>,
    /// Everything else: how many regions each filter cut.
    #[serde(flatten)]
    pub more: Map<String, Value>,
}

/// A region in `regions.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RegionRecord {
    /// Its place in the list.
    pub id: u32,
    /// The smallest region that contains it.
    pub parent: Option<u32>,
    /// The tree it was found in.
    pub tree: u32,
    /// The weight at which it is complete.
    pub altitude: f64,
    /// Volume over its change with log altitude (eq. 5). In JSON `"Infinity"` where nothing changes,
    /// null where none was measured (NaN).
    #[serde(with = "stability")]
    pub stability: f64,
    /// How long it lasts before the real merge that ends it, in log altitude; none where no merge does.
    #[serde(default)]
    pub lifetime: Option<f64>,
    /// Volume in length^3, or area in length^2.
    pub volume: f64,
    /// Volume over that of the whole body.
    pub volume_fraction: f64,
    /// Number of voxels; none for a surface.
    pub voxels: Option<usize>,
    /// Number of the mesh's vertices.
    pub vertices: usize,
    /// Centre of mass.
    pub centroid: [f64; 3],
}

impl Record {
    /// The record of some features; `path` is their input.
    pub fn new(features: &Features, path: &str) -> Self {
        let superlevel = features.trees.iter().any(|t| t.tree.polarity() == Polarity::Superlevel);
        let polarity = if superlevel { "superlevel" } else { "sublevel" };
        let more = [("input", json!({ "path": path })), ("parameters", json!({ "polarity": polarity }))];
        let volume = features.body.domain() == Domain::Volume;
        let regions = features.regions.iter().enumerate().map(|(id, r)| RegionRecord {
            id: id as u32,
            parent: r.parent.map(|p| p as u32),
            tree: r.tree as u32,
            altitude: r.altitude,
            stability: r.stability,
            lifetime: r.merge.map(|merge| merge.lifetime),
            volume: r.volume,
            volume_fraction: r.volume_fraction,
            voxels: volume.then_some(r.elements.len()),
            vertices: r.vertices.len(),
            centroid: r.centroid,
        });
        let tree = |t: &mser3d::Tree| TreeRecord { time_scale: t.time_scale, time: t.time, more: Map::new() };
        Self {
            mser3d: env!("CARGO_PKG_VERSION").to_owned(),
            format: FORMAT,
            domain: features.body.domain(),
            trees: features.trees.iter().map(tree).collect(),
            regions: regions.collect(),
            more: more.map(|(key, value)| (key.to_owned(), value)).into_iter().collect(),
        }
    }

    /// Whether the trees are of superlevel sets.
    pub fn superlevel(&self) -> bool {
        self.more.get("parameters").is_none_or(|p| p["polarity"] != "sublevel")
    }

    /// The input's path.
    pub fn path(&self) -> Option<&str> {
        self.more.get("input").and_then(|input| input["path"].as_str())
    }
}

#[derive(Serialize, Deserialize)]
#[serde(remote = "Domain", rename_all = "lowercase")]
enum DomainName {
    Volume,
    Surface,
}

/// `{"relative": 0.5}`, `{"absolute": 2048}` or null.
mod time_scale {
    use super::*;

    #[derive(Serialize, Deserialize)]
    #[serde(rename_all = "lowercase")]
    enum Named {
        Relative(f64),
        Absolute(f64),
    }

    pub fn serialize<S: Serializer>(value: &Option<TimeScale>, to: S) -> Result<S::Ok, S::Error> {
        let named = value.map(|scale| match scale {
            TimeScale::Relative(t) => Named::Relative(t),
            TimeScale::Absolute(t) => Named::Absolute(t),
        });
        named.serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Option<TimeScale>, D::Error> {
        let named = Option::<Named>::deserialize(from)?;
        Ok(named.map(|scale| match scale {
            Named::Relative(t) => TimeScale::Relative(t),
            Named::Absolute(t) => TimeScale::Absolute(t),
        }))
    }
}

/// JSON has neither infinity nor NaN.
mod stability {
    use super::*;

    #[derive(Serialize, Deserialize)]
    #[serde(untagged)]
    enum Stability {
        Number(f64),
        Word(String),
        Unknown,
    }

    pub fn serialize<S: Serializer>(value: &f64, to: S) -> Result<S::Ok, S::Error> {
        match value {
            v if v.is_finite() => Stability::Number(*v),
            v if v.is_nan() => Stability::Unknown,
            _ => Stability::Word("Infinity".to_owned()),
        }
        .serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
        match Stability::deserialize(from)? {
            Stability::Number(v) => Ok(v),
            Stability::Word(word) if word == "Infinity" => Ok(f64::INFINITY),
            Stability::Word(_) => Err(serde::de::Error::custom("a stability is a number or \"Infinity\"")),
            Stability::Unknown => Ok(f64::NAN),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stability_and_time_scale_survive_json() {
        let region = RegionRecord {
            id: 3,
            parent: None,
            tree: 0,
            altitude: 0.5,
            stability: 2.5,
            lifetime: Some(0.5),
            volume: 1.0,
            volume_fraction: 0.1,
            voxels: None,
            vertices: 4,
            centroid: [0.1, 0.2, 0.3],
        };
        for stability in [2.5, f64::INFINITY, f64::NAN] {
            let text = serde_json::to_string(&RegionRecord { stability, ..region.clone() }).unwrap();
            let back: RegionRecord = serde_json::from_str(&text).unwrap();
            assert_eq!(back.stability.to_bits(), stability.to_bits(), "{text}");
        }
        for time_scale in [None, Some(TimeScale::Relative(0.5)), Some(TimeScale::Absolute(9.0))] {
            let tree = TreeRecord { time_scale, time: None, more: Map::new() };
            let text = serde_json::to_string(&tree).unwrap();
            assert_eq!(serde_json::from_str::<TreeRecord>(&text).unwrap(), tree, "{text}");
        }
    }
}
