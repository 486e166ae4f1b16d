//! `mser3d query`: what in a collection is like the regions of a shape.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use mser3d_collection::{DescribedResult, Index, RegionHits};
use mser3d_fileio::write_text;
use mser3d_results::{Up, side_text};

use crate::choice::choice;
use crate::error::{CliError, print, print_json};
use crate::message::name;
use crate::numbers::count;
use crate::output::{PAGE, file};

/// What `mser3d query` is told.
#[derive(clap::Args, Clone, Debug)]
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
    #[arg(long, value_name = "FILE", value_parser = file(PAGE))]
    pub html: Option<PathBuf>,
    /// Axis that points up, in the pictures
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
}

impl QueryArgs {
    /// The regions of a collection that are most like those of a shape. `itself` is the shape's name in the collection,
    /// whose regions are left out.
    ///
    /// # Errors
    /// [`CliError::Usage`] for a region that is not there, [`CliError::Collection`].
    pub fn find(
        &self,
        index: &Index,
        shape: &DescribedResult,
        itself: Option<&str>,
    ) -> Result<Vec<RegionHits>, CliError> {
        let all = index.nearest(shape, self.k, itself.filter(|_| !self.include_itself))?;
        let regions = shape.results.record.regions.len();
        if let Some(region) = self.region.filter(|&region| region >= regions) {
            return Err(CliError::Usage(format!(
                "--region {region}: {} has {regions} regions, numbered from 0",
                shape.folder.display()
            )));
        }
        let wanted =
            all.into_iter().filter(|hits| self.region.is_none_or(|only| only == hits.region as usize));
        Ok(wanted.collect())
    }
}

pub(crate) fn run(args: &QueryArgs) -> Result<(), CliError> {
    let index = Index::load(&args.collection)?;
    let member = args.collection.join(&args.shape);
    let folder = if !args.shape.is_dir() && member.is_dir() { member } else { args.shape.clone() };
    let shape = DescribedResult::load(&folder)?;
    let found = args.find(&index, &shape, name_in(&args.collection, &folder).as_deref())?;
    if let Some(path) = &args.html {
        write_text(path, &index.page(&shape, &found, args.up)?)?;
    }
    if args.json {
        print_json(&index.record(&shape, found))
    } else {
        print(&table(&found, &shape, index.len()))
    }
}

/// The name that a result has in a collection, if it is part of it.
fn name_in(collection: &Path, folder: &Path) -> Option<String> {
    let (collection, folder) = (collection.canonicalize().ok()?, folder.canonicalize().ok()?);
    let inside = folder.parent() == Some(&collection);
    folder.file_name().filter(|_| inside).map(|name| name.to_string_lossy().into_owned())
}

fn table(found: &[RegionHits], shape: &DescribedResult, searched: usize) -> String {
    let regions = &shape.results.record.regions;
    let of_shape = regions.iter().map(|region| region.side);
    let of_hits = found.iter().flat_map(|hits| hits.closest.iter().map(|hit| hit.side));
    // A column that would have nothing to say is left out.
    let sides = of_shape.chain(of_hits).any(|side| side.is_some());
    let column = |side: String| if sides { format!("  {side:>5}") } else { String::new() };
    let side = |side: Option<f64>| column(side.map_or("-".into(), side_text));
    let head = column("side".into());
    let mut text = format!("region  measure %{head}  rank   distance  measure %  region{head}  shape\n");
    for RegionHits { region: id, closest } in found {
        let own = &regions[*id as usize];
        for (rank, hit) in closest.iter().enumerate() {
            let query = match rank {
                0 => format!("{id:>6}  {:>9.2}{}", 100.0 * own.volume_fraction, side(own.side)),
                _ => " ".repeat(17) + &column(String::new()),
            };
            let _ = writeln!(
                text,
                "{query}  {:>4}  {:>9.5}  {:>9.2}  {:>6}{}  {}",
                rank + 1,
                hit.distance,
                100.0 * hit.volume_fraction,
                hit.region,
                side(hit.side),
                name(&hit.shape),
            );
        }
    }
    let _ = writeln!(text, "{searched} regions searched");
    text
}
