//! `mser3d msv`: maximally stable volumes of a grey-value volume or image (Donoser and Bischof 2006).

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mser3d::comptree::{
    ComponentTree, Ellipsoid, Moments, MsvParameters, Polarity, SelectionReport, StableRegion, Stencil,
    maximally_stable_volumes,
};
use mser3d::shape::{BitGrid, VoxelGrid};
use mser3d_meshio::{VoxelField, VoxelValues, write_atomically, write_vti};
use mser3d_volumeio::{Placement, Values, Volume, VolumeFormat, read_volume, write_npy};
use serde_json::{Value, json};

use crate::error::CliError;

#[derive(clap::Args)]
pub struct MsvArgs {
    /// Grey values: .npy ([x, y], [x, y, z] or [x, y, z, channel]), .nii, .nii.gz, .nrrd, .tif or .tiff
    pub volume: PathBuf,
    /// Folder for regions.json, regions.csv, and labels.vti and labels.npy (a channel for each polarity; the
    /// number of the smallest region, -1 for none); made if it isn't there
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Which regions are searched
    #[arg(long, value_enum, default_value_t = Search::Both)]
    pub regions: Search,
    /// Over how many grey values a region is compared with what it grows into [default: 5 for integers, 2 %
    /// of the range for others, where it is also the step that 1 is for integers]
    #[arg(long, value_name = "GREY")]
    pub delta: Option<f64>,
    /// Smallest region, as a fraction of all voxels
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().min_area)]
    pub min_area: f64,
    /// Largest region, as a fraction of all voxels
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().max_area)]
    pub max_area: f64,
    /// Regions go that grow by this share of their size or more within delta
    #[arg(long, value_name = "V", default_value_t = MsvParameters::default().max_variation)]
    pub max_variation: f64,
    /// Regions go whose next larger one is not bigger by this share of it
    #[arg(long, value_name = "F", default_value_t = MsvParameters::default().min_diversity)]
    pub min_diversity: f64,
    /// Which voxels are neighbours: those that share a face, or a corner too (as VLFeat)
    #[arg(long, value_enum, default_value_t = Neighbours::Corners)]
    pub neighbours: Neighbours,
    /// No table on stdout
    #[arg(short, long)]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Search {
    /// Dark and bright ones
    Both,
    /// Dark regions on brighter ground (MSER+)
    Dark,
    /// Bright regions on darker ground (MSER-)
    Bright,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Neighbours {
    /// 6 neighbours, 4 in an image
    Faces,
    /// 26 neighbours, 8 in an image
    Corners,
}

/// The regions of one tree.
struct Layer {
    name: &'static str,
    regions: Vec<Found>,
    report: SelectionReport,
    /// Of each voxel the place of its smallest region in `regions`.
    labels: Vec<Option<u32>>,
}

struct Found {
    region: StableRegion,
    ellipsoid: Ellipsoid,
}

pub fn run(args: &MsvArgs) -> Result<(), CliError> {
    if VolumeFormat::of(&args.volume).is_none() {
        let name = args.volume.display();
        return Err(CliError::Usage(format!("{name}: a volume is one of {}", VolumeFormat::LIST)));
    }
    let volume = read_volume(&args.volume)?;
    let vectors = volume.channels() > 1;
    if vectors && args.regions != Search::Both {
        return Err(CliError::Usage("--regions needs one grey value a voxel; colours have no order".into()));
    }
    let parameters = parameters(args, &volume)?;
    let layers = if vectors {
        vec![layer(args, &volume, &parameters, "alike", Polarity::Sublevel)?]
    } else {
        let wanted =
            [("dark", Search::Dark, Polarity::Sublevel), ("bright", Search::Bright, Polarity::Superlevel)];
        let wanted = wanted.into_iter().filter(|w| [Search::Both, w.1].contains(&args.regions));
        wanted.map(|w| layer(args, &volume, &parameters, w.0, w.2)).collect::<Result<_, _>>()?
    };
    write(args, &volume, &parameters, &layers)?;
    if args.quiet {
        return Ok(());
    }
    let mut text = String::new();
    for layer in &layers {
        let _ = writeln!(text, "{} regions: {}", layer.name, layer.regions.len());
    }
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

/// VLFeat's defaults are for grey values from 0 to 255; other numbers have no unit step.
fn parameters(args: &MsvArgs, volume: &Volume) -> Result<MsvParameters, CliError> {
    let integers = volume.channels() == 1 && !matches!(volume.values(), Values::F32(_) | Values::F64(_));
    let delta = args.delta.unwrap_or_else(|| if integers { 5.0 } else { 0.02 * range(volume) });
    let parameters = MsvParameters {
        delta,
        min_area: args.min_area,
        max_area: args.max_area,
        max_variation: args.max_variation,
        min_diversity: args.min_diversity,
        step: if integers { 1.0 } else { delta },
    };
    parameters.validate().map_err(|e| CliError::Usage(e.to_string()))?;
    Ok(parameters)
}

/// The largest difference between two finite values; 1 where there is none.
fn range(volume: &Volume) -> f64 {
    let values = volume.values().to_f64();
    let finite = values.iter().filter(|x| x.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
    if high > low { high - low } else { 1.0 }
}

fn layer(
    args: &MsvArgs,
    volume: &Volume,
    parameters: &MsvParameters,
    name: &'static str,
    polarity: Polarity,
) -> Result<Layer, CliError> {
    let failed = |e| CliError::Shape { path: args.volume.clone(), source: mser3d::Error::from(e) };
    let tree = tree(args.neighbours, volume, polarity).map_err(failed)?;
    let selection = maximally_stable_volumes(&tree, parameters).map_err(failed)?;
    let nodes: Vec<u32> = selection.regions.iter().map(|r| r.node).collect();
    let ([nx, ny, nz], placement) = (volume.dims(), *volume.placement());
    let position = |v: u32| {
        let v = v as usize;
        placement.position([v % nx, v / nx % ny, v / (nx * ny)].map(|i| i as f64))
    };
    let dimensions = if nz == 1 { 2 } else { 3 };
    let found = |region: StableRegion| {
        let moments = Moments::of(tree.vertices(region.node), position, 1.0);
        Found { region, ellipsoid: Ellipsoid::fit(&moments, dimensions) }
    };
    let labels = tree.labels(&nodes);
    let regions = selection.regions.into_iter().map(found).collect();
    Ok(Layer { name, regions, report: selection.report, labels })
}

fn tree(
    neighbours: Neighbours,
    volume: &Volume,
    polarity: Polarity,
) -> Result<ComponentTree, mser3d::comptree::TreeError> {
    let dims = volume.dims();
    let stencil = match (neighbours, dims[2] == 1) {
        (Neighbours::Faces, true) => Stencil::Four,
        (Neighbours::Faces, false) => Stencil::Six,
        (Neighbours::Corners, true) => Stencil::Eight,
        (Neighbours::Corners, false) => Stencil::TwentySix,
    };
    if volume.channels() > 1 {
        // Vectors have no order, but distances: neighbours join the sooner the more alike they are.
        let (values, channels) = (volume.values().to_f64(), volume.channels());
        let of = |v: u32| &values[v as usize * channels..][..channels];
        let distance =
            |u: u32, v: u32| of(u).iter().zip(of(v)).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
        return ComponentTree::from_grid_edges(dims, stencil, distance, 1.0, polarity);
    }
    macro_rules! each {
        ($($variant:ident)*) => {
            match volume.values() {
                $(Values::$variant(v) => ComponentTree::from_grid(dims, stencil, v, 1.0, polarity),)*
            }
        };
    }
    each!(U8 I8 U16 I16 U32 I32 F32 F64)
}

fn write(
    args: &MsvArgs,
    volume: &Volume,
    parameters: &MsvParameters,
    layers: &[Layer],
) -> Result<(), CliError> {
    let folder = &args.output;
    std::fs::create_dir_all(folder)
        .map_err(|source| CliError::OutputFolder { path: folder.clone(), source })?;
    // The last file says that the result is whole.
    let last = folder.join("regions.json");
    if last.exists() {
        std::fs::remove_file(&last)
            .map_err(|source| CliError::OutputFolder { path: folder.clone(), source })?;
    }
    write_labels(folder, volume, layers)?;
    let table = csv(layers);
    write_atomically(&folder.join("regions.csv"), |out| out.write_all(table.as_bytes()))?;
    let json = json(args, volume, parameters, layers);
    write_atomically(&last, |out| writeln!(out, "{json:#}"))?;
    Ok(())
}

fn write_labels(folder: &Path, volume: &Volume, layers: &[Layer]) -> Result<(), CliError> {
    let numbers: Vec<Vec<i32>> =
        layers.iter().map(|l| l.labels.iter().map(|x| x.map_or(-1, |x| x as i32)).collect()).collect();
    let voxels = volume.values().len() / volume.channels();
    let interleaved: Vec<i32> = (0..voxels).flat_map(|v| numbers.iter().map(move |layer| layer[v])).collect();
    let labels = Volume::new(volume.dims(), layers.len(), *volume.placement(), interleaved)?;
    write_npy(&folder.join("labels.npy"), &labels)?;
    let mut whole = BitGrid::empty(volume.dims()).map_err(no_grid)?;
    let [nx, ny, nz] = volume.dims().map(|n| n as u32);
    for k in 0..nz {
        (0..ny).for_each(|j| (0..nx).for_each(|i| whole.set([i, j, k], true)));
    }
    let grid = VoxelGrid::solid(volume.frame()?, whole).map_err(no_grid)?;
    let fields: Vec<VoxelField> = layers
        .iter()
        .zip(&numbers)
        .map(|(layer, numbers)| VoxelField { name: layer.name, values: VoxelValues::Labels(numbers) })
        .collect();
    Ok(write_vti(&folder.join("labels.vti"), &grid, &fields)?)
}

fn no_grid(error: mser3d::shape::ShapeError) -> CliError {
    CliError::Usage(format!("labels cannot be written: {error}"))
}

fn csv(layers: &[Layer]) -> String {
    let mut text = String::from(
        "polarity,region,parent,voxels,grey,variation,x,y,z,semi_axis_1,semi_axis_2,semi_axis_3,\
         axis_1_x,axis_1_y,axis_1_z,axis_2_x,axis_2_y,axis_2_z,axis_3_x,axis_3_y,axis_3_z\n",
    );
    for layer in layers {
        for (number, Found { region, ellipsoid }) in layer.regions.iter().enumerate() {
            let parent = region.parent.map_or(String::new(), |p| p.to_string());
            let _ = write!(
                text,
                "{},{number},{parent},{},{},{}",
                layer.name,
                region.volume,
                region.altitude,
                1.0 / region.stability
            );
            let numbers = ellipsoid.centre.iter().chain(&ellipsoid.semi_axes);
            for x in numbers.chain(ellipsoid.axes.as_flattened()) {
                let _ = write!(text, ",{x}");
            }
            text.push('\n');
        }
    }
    text
}

fn json(args: &MsvArgs, volume: &Volume, parameters: &MsvParameters, layers: &[Layer]) -> Value {
    let Placement { origin, spacing, directions } = *volume.placement();
    let voxel: f64 = spacing.iter().product();
    let layer = |layer: &Layer| {
        let region = |(number, found): (usize, &Found)| {
            let Found { region, ellipsoid } = found;
            json!({
                "region": number,
                "parent": region.parent,
                "voxels": region.volume,
                "volume": region.volume * voxel,
                "grey": region.altitude,
                "variation": 1.0 / region.stability,
                "centre": ellipsoid.centre,
                "semi_axes": ellipsoid.semi_axes,
                "axes": ellipsoid.axes,
            })
        };
        let report = &layer.report;
        json!({
            "polarity": layer.name,
            "filters": {
                "components": report.nodes,
                "maximally_stable": report.candidates,
                "max_variation": report.unstable,
                "max_area": report.too_large,
                "min_area": report.too_small,
                "min_diversity": report.overlapping,
                "kept": report.kept,
            },
            "regions": layer.regions.iter().enumerate().map(region).collect::<Vec<_>>(),
        })
    };
    json!({
        "program": "mser3d msv",
        "version": env!("CARGO_PKG_VERSION"),
        "volume": args.volume.display().to_string(),
        "dims": volume.dims(),
        "channels": volume.channels(),
        "type": volume.values().type_name(),
        "origin": origin,
        "spacing": spacing,
        "directions": directions,
        "parameters": {
            "delta": parameters.delta,
            "min_area": parameters.min_area,
            "max_area": parameters.max_area,
            "max_variation": parameters.max_variation,
            "min_diversity": parameters.min_diversity,
            "step": Some(parameters.step).filter(|x| x.is_finite()),
            "neighbours": if args.neighbours == Neighbours::Faces { "faces" } else { "corners" },
        },
        "searches": layers.iter().map(layer).collect::<Vec<_>>(),
    })
}
