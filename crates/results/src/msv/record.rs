use mser3d::comptree::{Contrast, MsvParameters, SelectionReport};
use mser3d_shape::Connectivity;
use mser3d_volumeio::{Affine, Volume};
use serde::{Deserialize, Serialize};

use crate::FORMAT;

/// The name of the record in its folder: what tells such a folder from that of [`Results`](crate::Results).
pub const MSV_RECORD: &str = "msv.json";

/// What `msv.json` says: the volume, the parameters, and the regions of each search.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct MsvRecord {
    /// The version of mser3d that found the regions.
    pub mser3d: String,
    /// The layout of the folder: [`FORMAT`]. Programs refuse others.
    pub format: u32,
    /// The file.
    pub volume: String,
    /// Voxels along x, y and z.
    pub dims: [usize; 3],
    /// Values of a voxel.
    pub channels: usize,
    /// Type of the values, as Rust calls it.
    #[serde(rename = "type")]
    pub value_type: String,
    /// Index to world, 4 x 4: the centre of voxel (i, j, k) is `affine (i, j, k, 1)`.
    pub affine: Affine,
    /// Which regions were kept.
    pub parameters: MsvParameters,
    /// Which voxels were neighbours.
    pub connectivity: Connectivity,
    /// One for each kind of region.
    pub searches: Vec<MsvSearch>,
}

/// The regions of one component tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct MsvSearch {
    /// What the regions have in common.
    pub contrast: Contrast,
    /// How many regions each filter cut.
    pub filters: SelectionReport,
    /// The regions, by descending size.
    pub regions: Vec<MsvRegion>,
}

/// A maximally stable volume.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[non_exhaustive]
pub struct MsvRegion {
    /// Its place in the list: its number in `labels.npy` and `labels.vti`.
    pub region: u32,
    /// The smallest region that contains it.
    pub parent: Option<u32>,
    /// Number of voxels.
    pub voxels: u64,
    /// Volume in the volume's units.
    pub volume: f64,
    /// The grey value at which it is complete.
    pub grey: f64,
    /// By how much of its size it grows within delta.
    pub variation: f64,
    /// Centre of the ellipsoid of like moments, placed as the voxels are.
    pub centre: [f64; 3],
    /// Its semi-axes, the longest first.
    pub semi_axes: [f64; 3],
    /// Their directions.
    pub axes: [[f64; 3]; 3],
}

impl MsvRecord {
    pub(crate) fn new(
        volume: &Volume,
        path: &str,
        parameters: MsvParameters,
        connectivity: Connectivity,
        searches: Vec<MsvSearch>,
    ) -> Self {
        Self {
            mser3d: env!("CARGO_PKG_VERSION").to_owned(),
            format: FORMAT,
            volume: path.to_owned(),
            dims: volume.dims(),
            channels: volume.channels(),
            value_type: volume.samples().type_name().to_owned(),
            affine: *volume.affine(),
            parameters,
            connectivity,
            searches,
        }
    }

    /// The regions as comma-separated values, with a header line.
    pub fn to_csv(&self) -> String {
        let mut csv = String::from(
            "contrast,region,parent,voxels,grey,variation,x,y,z,semi_axis_1,semi_axis_2,semi_axis_3,\
             axis_1_x,axis_1_y,axis_1_z,axis_2_x,axis_2_y,axis_2_z,axis_3_x,axis_3_y,axis_3_z\n",
        );
        for search in &self.searches {
            for r in &search.regions {
                let parent = r.parent.map_or(String::new(), |p| p.to_string());
                let numbers = r.centre.iter().chain(&r.semi_axes).chain(r.axes.as_flattened());
                let numbers: String = numbers.map(|x| format!(",{x}")).collect();
                csv.push_str(&format!(
                    "{},{},{parent},{},{},{}{numbers}\n",
                    search.contrast, r.region, r.voxels, r.grey, r.variation
                ));
            }
        }
        csv
    }
}
