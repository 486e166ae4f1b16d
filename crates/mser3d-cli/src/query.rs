//! `mser3d query`: what in a collection is like the regions of a shape.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use mser3d_collection::{Hit, Index, Shape};
use mser3d_meshio::write_atomically;
use serde_json::json;

use crate::error::CliError;
use crate::options::count;
use crate::render::UpAxis;

#[derive(clap::Args)]
pub struct QueryArgs {
    /// Folder that `mser3d batch` wrote
    pub collection: PathBuf,
    /// Results of the shape: a folder written by `mser3d detect`, or the name of a shape of the collection
    pub shape: PathBuf,
    /// How many of the closest regions to list
    #[arg(short, value_name = "N", value_parser = count, default_value_t = 5)]
    pub k: usize,
    /// Only for this region of the shape
    #[arg(long, value_name = "ID")]
    pub region: Option<usize>,
    /// List regions of the shape itself too, when it is in the collection
    #[arg(long)]
    pub include_itself: bool,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// Write a page with pictures of the regions and those closest to them, in one file
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Axis that points up, in the pictures
    #[arg(long, value_enum, default_value_t = UpAxis::Y)]
    pub up: UpAxis,
}

pub fn run(args: &QueryArgs) -> Result<(), CliError> {
    let index = Index::load(&args.collection)?;
    let member = args.collection.join(&args.shape);
    let folder = if !args.shape.is_dir() && member.is_dir() { member } else { args.shape.clone() };
    let shape = Shape::load(&folder)?;
    let itself = name_in(&args.collection, &folder).filter(|_| !args.include_itself);
    let all = index.nearest(&shape, args.k, itself.as_deref())?;
    let regions = shape.results.record.regions.len();
    if let Some(region) = args.region.filter(|&region| region >= regions) {
        return Err(CliError::Usage(format!(
            "--region {region}: {} has {regions} regions, numbered from 0",
            folder.display()
        )));
    }
    let wanted = (0..).zip(all).filter(|(id, _)| args.region.is_none_or(|only| only == *id as usize));
    let closest: Vec<(u32, Vec<Hit>)> = wanted.collect();
    if let Some(path) = &args.html {
        let page = index.page(&shape, &closest, args.up.into())?;
        write_atomically(path, |out| out.write_all(page.as_bytes()))?;
    }
    let text = if args.json {
        let regions: Vec<_> =
            closest.iter().map(|(id, hits)| json!({"region": id, "closest": hits})).collect();
        let json = json!({
            "mser3d": env!("CARGO_PKG_VERSION"),
            "collection": args.collection.to_string_lossy(),
            "searched": index.len(),
            "shape": folder.to_string_lossy(),
            "regions": regions,
        });
        format!("{json:#}\n")
    } else {
        table(&closest, &shape, index.len())
    };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

/// The name that a result has in a collection, if it is part of it.
fn name_in(collection: &Path, folder: &Path) -> Option<String> {
    let (collection, folder) = (collection.canonicalize().ok()?, folder.canonicalize().ok()?);
    let inside = folder.parent() == Some(&collection);
    folder.file_name().filter(|_| inside).map(|name| name.to_string_lossy().into_owned())
}

fn table(closest: &[(u32, Vec<Hit>)], shape: &Shape, searched: usize) -> String {
    let mut text = String::from("region  measure %  rank   distance  measure %  region  shape\n");
    for (id, hits) in closest {
        let own = 100.0 * shape.results.record.regions[*id as usize].volume_fraction;
        for (rank, hit) in hits.iter().enumerate() {
            let query = if rank == 0 { format!("{id:>6}  {own:>9.2}") } else { " ".repeat(17) };
            let _ = writeln!(
                text,
                "{query}  {:>4}  {:>9.5}  {:>9.2}  {:>6}  {}",
                rank + 1,
                hit.distance,
                100.0 * hit.volume_fraction,
                hit.region,
                hit.shape,
            );
        }
    }
    let _ = writeln!(text, "{searched} regions searched");
    text
}
