//! Maximally stable volumes of grey-value volumes and images (Donoser & Bischof 2006): from a volume to a folder.

mod draw;
mod files;
mod grey;
mod record;

pub use record::{MSV_RECORD, MsvRecord, MsvRegion, MsvSearch};

use mser3d::comptree::{
    ComponentTree, Contrast, Ellipsoid, Moments, MsvParameters, StableRegion, TreeError,
    maximally_stable_volumes,
};
use mser3d_shape::Connectivity;
use mser3d_volumeio::{Samples, Volume};

use crate::ResultsError;

/// Parameters of [`MsvResults::find`].
#[derive(Clone, Debug, PartialEq)]
pub struct MsvSearchParameters {
    /// Which regions are searched. Default: none given, dark and bright ones of grey values, alike ones of colours.
    pub contrasts: Vec<Contrast>,
    /// Over how many grey values a region is compared with what it grows into. Default: none, 5 for integers (as in
    /// VLFeat, for grey values from 0 to 255), 2 % of the range for other numbers, which have no unit step.
    pub delta: Option<f64>,
    /// Which regions are kept; `delta` and `step` are set by the above. Default: VLFeat's.
    pub msv: MsvParameters,
    /// Which voxels are neighbours. Default: [`Connectivity::TwentySix`], as in VLFeat.
    pub connectivity: Connectivity,
}

impl Default for MsvSearchParameters {
    fn default() -> Self {
        Self {
            contrasts: Vec::new(),
            delta: None,
            msv: MsvParameters::default(),
            connectivity: Connectivity::TwentySix,
        }
    }
}

impl MsvSearchParameters {
    fn contrasts(&self, volume: &Volume) -> Vec<Contrast> {
        match (self.contrasts.is_empty(), volume.channels()) {
            (true, 1) => vec![Contrast::Dark, Contrast::Bright],
            (true, _) => vec![Contrast::Alike],
            (false, _) => self.contrasts.clone(),
        }
    }

    fn msv(&self, volume: &Volume) -> MsvParameters {
        let integers =
            volume.channels() == 1 && !matches!(volume.samples(), Samples::F32(_) | Samples::F64(_));
        let delta = self.delta.unwrap_or_else(|| if integers { 5.0 } else { 0.02 * range(volume) });
        MsvParameters { delta, step: if integers { 1.0 } else { delta }, ..self.msv }
    }
}

/// The largest difference between two finite values; 1 where there is none.
fn range(volume: &Volume) -> f64 {
    let values = volume.samples().to_f64();
    let finite = values.iter().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
    if high > low { high - low } else { 1.0 }
}

/// The maximally stable volumes of a grey-value volume or image.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MsvResults {
    /// What `msv.json` says.
    pub record: MsvRecord,
    /// For each search, the smallest region of each voxel, x fastest.
    pub labels: Vec<Vec<Option<u32>>>,
}

impl MsvResults {
    /// Searches a volume; `path` names it.
    ///
    /// # Errors
    /// [`ResultsError::Tree`] for parameters out of range, and for grey contrasts of a volume of several channels.
    pub fn find(volume: &Volume, path: &str, parameters: &MsvSearchParameters) -> Result<Self, ResultsError> {
        let msv = parameters.msv(volume);
        msv.validate()?;
        let contrasts = parameters.contrasts(volume);
        if volume.channels() > 1 && contrasts.iter().any(|&c| c != Contrast::Alike) {
            return Err(ResultsError::NoOrder { path: path.into() });
        }
        let mut searches = Vec::with_capacity(contrasts.len());
        let mut labels = Vec::with_capacity(contrasts.len());
        for contrast in contrasts {
            let tree = tree(volume, parameters.connectivity, contrast)?;
            let selection = maximally_stable_volumes(&tree, &msv)?;
            let nodes: Vec<u32> = selection.regions.iter().map(|r| r.node).collect();
            labels.push(tree.labels(&nodes));
            let regions = (0..).zip(&selection.regions);
            let regions = regions.map(|(number, region)| msv_region(volume, &tree, number, region)).collect();
            searches.push(MsvSearch { contrast, filters: selection.report, regions });
        }
        let record = MsvRecord::new(volume, path, msv, parameters.connectivity, searches);
        Ok(Self { record, labels })
    }
}

fn tree(volume: &Volume, connectivity: Connectivity, contrast: Contrast) -> Result<ComponentTree, TreeError> {
    let (dims, polarity) = (volume.dims(), contrast.polarity());
    if contrast == Contrast::Alike {
        // Neighbours join the sooner the more alike they are.
        let (values, channels) = (volume.samples().to_f64(), volume.channels());
        let of = |v: u32| &values[v as usize * channels..][..channels];
        let distance =
            |u: u32, v: u32| of(u).iter().zip(of(v)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        return ComponentTree::from_grid_edges(dims, connectivity, distance, 1.0, polarity);
    }
    macro_rules! each {
        ($($variant:ident)*) => {
            match volume.samples() {
                $(Samples::$variant(v) => ComponentTree::from_grid(dims, connectivity, v, 1.0, polarity),)*
                // Exact up to 2^53.
                Samples::U64(_) | Samples::I64(_) => {
                    ComponentTree::from_grid(dims, connectivity, &volume.samples().to_f64(), 1.0, polarity)
                }
            }
        };
    }
    each!(U8 I8 U16 I16 U32 I32 F32 F64)
}

fn msv_region(volume: &Volume, tree: &ComponentTree, number: u32, region: &StableRegion) -> MsvRegion {
    let ([nx, ny, nz], affine) = (volume.dims(), *volume.affine());
    let position = |v: u32| {
        let v = v as usize;
        affine.position([v % nx, v / nx % ny, v / (nx * ny)].map(|i| i as f64))
    };
    let moments = Moments::of(tree.vertices(region.node), position, 1.0);
    let ellipsoid = Ellipsoid::fit(&moments, if nz == 1 { 2 } else { 3 });
    MsvRegion {
        region: number,
        parent: region.parent.map(|p| p as u32),
        voxels: region.volume as u64,
        volume: region.volume * affine.determinant().abs(),
        grey: region.altitude,
        variation: 1.0 / region.stability,
        centre: ellipsoid.centre,
        semi_axes: ellipsoid.semi_axes,
        axes: ellipsoid.axes,
    }
}
