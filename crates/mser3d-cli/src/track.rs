//! `mser3d track`: regions followed through a sequence.

use std::path::{Path, PathBuf};

use mser3d::{Detector, Progress, ProgressFn, Stage};
use mser3d_collection::{
    BatchParameters, BatchSummary, CollectionFolder, Event, Sampling, plan_sequence, share_parameters,
    track_glb, track_page, track_pictures, track_results,
};
use mser3d_fileio::file_stem;
use mser3d_meshio::ReadOptions;
use mser3d_results::{RenderOptions, TrackParameters, TracksRecord, Up};

use crate::batch::{run_detector, tell_failures};
use crate::choice::choice;
use crate::error::{CliError, print, print_json};
use crate::interrupt;
use crate::message::{self, tell};
use crate::numbers::{count, fraction, positive};
use crate::options::RegionOptions;
use crate::output::folder;
use crate::progress::BatchMeter;
use crate::run_options::ManyOptions;
use crate::volume_options::VolumeOptions;

/// What `mser3d track` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct TrackArgs {
    /// An animated glTF file; or the frames in their order: files, folders, patterns ("scans/*.ply"), or lists (.txt)
    #[arg(required = true)]
    pub inputs: Vec<PathBuf>,
    /// Folder of the sequence; made if it isn't there
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: PathBuf,
    /// Write a page for the browser too, tracks.html in the folder, on which the sequence plays
    #[arg(long)]
    pub html: bool,
    /// Write the animation with the colours of the tracks too, tracks.glb, for Blender and browsers
    #[arg(long)]
    pub glb: bool,
    /// Draw pictures too: strip.png, frames in a row, and moving.png, an animated PNG
    #[arg(long)]
    pub pictures: bool,
    /// Height of the pictures in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = 360)]
    pub height: usize,
    /// The axis that points up on the page and in the pictures
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
    /// Print the tracks as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub(crate) many: ManyOptions,
    /// glTF animation, by name or number from 0 [default: the file's only one]
    #[arg(long, value_name = "NAME", help_heading = "Input")]
    pub animation: Option<String>,
    /// Frames of the animation, from its start to its end, both included
    #[arg(long, value_name = "N", value_parser = count, conflicts_with = "every", help_heading = "Input")]
    pub frames: Option<usize>,
    /// Seconds between frames of the animation, at most [default: 1/24]
    #[arg(long, value_name = "SECONDS", value_parser = positive, help_heading = "Input")]
    pub every: Option<f64>,
    /// Least overlap at which regions of two frames are the same, where the frames have the same vertices
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = TrackParameters::default().min_overlap,
          help_heading = "Tracks")]
    pub min_overlap: f64,
    /// Least likeness at which they are the same, where the frames have other vertices
    #[arg(long, value_name = "F", value_parser = fraction, default_value_t = TrackParameters::default().min_likeness,
          help_heading = "Tracks")]
    pub min_likeness: f64,
    /// In how many frames in a row a region may be missing and keep its identity
    #[arg(long, value_name = "N", default_value_t = TrackParameters::default().max_gap, help_heading = "Tracks")]
    pub max_gap: usize,
    #[command(flatten)]
    pub(crate) volume: VolumeOptions,
    #[command(flatten)]
    pub(crate) options: RegionOptions,
}

impl TrackArgs {
    /// The number of threads that is asked for.
    ///
    /// # Errors
    /// [`CliError::Usage`] for one out of range.
    pub fn threads(&self) -> Result<Option<usize>, CliError> {
        self.many.run.threads()
    }

    /// Follows the regions and writes the folder of the sequence, with what is asked for besides. `progress` can cancel it,
    /// `heard` hears how far it is, `warn` what is wrong with the cache.
    ///
    /// # Errors
    /// [`CliError::Usage`], [`CliError::Collection`], [`CliError::Results`]. Frames that fail are no error, but part of
    /// the summary.
    pub fn find(
        &self,
        progress: ProgressFn,
        heard: &(dyn Fn(Event) + Sync),
        warn: &(dyn Fn(&str) + Sync),
    ) -> Result<(TracksRecord, BatchSummary), CliError> {
        let deadline = self.options.limits.deadline();
        let progress = &|told| {
            deadline.go_on()?;
            progress(told)
        };
        let in_time = || match self.inputs.first() {
            Some(first) => CliError::in_time(&deadline, first),
            None => Ok(()),
        };
        self.options.refuse_field()?;
        if self.volume.all_labels() {
            return Err(CliError::Usage("--label all: a frame is one shape; choose a label".into()));
        }
        let parameters = self.options.parameters(&self.many.write)?;
        let tracking = TrackParameters {
            min_overlap: self.min_overlap,
            min_likeness: self.min_likeness,
            max_gap: self.max_gap,
            ..TrackParameters::default()
        };
        tracking.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        let drawn = RenderOptions { height: self.height, up: self.up, ..RenderOptions::default() };
        drawn.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        let sampling = match (self.frames, self.every) {
            (Some(frames), _) => Sampling::Count(frames),
            (None, Some(seconds)) => Sampling::Every(seconds),
            (None, None) => Sampling::default(),
        };
        let volumes = self.options.shape(&self.volume, ReadOptions::default())?;
        let mut plan = plan_sequence(&self.inputs, self.animation.as_deref(), sampling, &volumes)?;
        let parameters = share_parameters(
            &mut plan,
            self.options.domain(),
            &parameters,
            self.options.eigenpairs.is_none() && self.options.lambda_max.is_none(),
        )?;
        let batch = BatchParameters {
            workers: self.many.workers(),
            memory: parameters.spectrum.memory_limit.unwrap_or(u64::MAX),
            // The limit is that of the whole run.
            time_limit: None,
            extras: self.many.write.clone(),
            shard: None,
        };
        let detector = Detector::new(parameters).with_progress(progress);
        // To the end: what follows reads and writes the frames.
        let collection = CollectionFolder::open(&self.output, None)?;
        let summary = run_detector(&self.options, &collection, &plan, &detector, &batch, (heard, warn));
        if summary.is_err() {
            in_time()?;
        }
        let summary = summary?;
        // All frames have been searched by now.
        let told = Progress { stage: Stage::Parts, done: 1.0, overall: 1.0 };
        let goes_on = |_| progress(told).is_continue();
        let tracks = track_results(&self.output, &plan, &tracking, &goes_on);
        if tracks.is_err() {
            in_time()?;
        }
        let tracks = tracks?;
        if self.html {
            let html = track_page(&self.output, &title(&self.inputs), self.up)?;
            mser3d_fileio::write_text(&self.output.join("tracks.html"), &html)?;
        }
        if self.glb {
            track_glb(&self.output)?;
        }
        if self.pictures {
            track_pictures(&self.output, &drawn)?;
        }
        Ok((tracks, summary))
    }
}

pub(crate) fn run(args: &TrackArgs) -> Result<(), CliError> {
    args.many.run.use_threads()?;
    let first = args.inputs.first().map_or(Path::new(""), PathBuf::as_path);
    let _watch = args.options.limits.watch_time(first);
    let meter = BatchMeter::new(args.many.run.quiet);
    interrupt::keeps_what_is_done();
    let stop = |_| interrupt::go_on();
    let found = args.find(&stop, &|event| meter.report(&event), &|what| meter.warn(what));
    meter.finish();
    let (tracks, summary) = found?;
    if !args.many.run.quiet {
        let warn = |what: &String| tell(&format!("warning: {}: {what}", args.output.display()));
        tracks.warnings.iter().for_each(warn);
    }
    if args.json {
        print_json(&tracks)?;
    } else if !args.many.run.quiet {
        print(&table(&tracks, &args.output, &summary))?;
    }
    tell_failures(&summary)
}

/// What the sequence is called: the first input's name.
fn title(inputs: &[PathBuf]) -> String {
    inputs.first().map_or_else(String::new, |input| format!("{} in motion", file_stem(input)))
}

/// The tracks, a line each, and where they are.
fn table(tracks: &TracksRecord, folder: &Path, summary: &BatchSummary) -> String {
    let mut text = format!(
        "{:>5} {:>13} {:>6} {:>8} {:>8} {:>11}\n",
        "track", "frames", "found", "overlap", "volume", "reliability"
    );
    let percent = |value: f64| format!("{:.1} %", 100.0 * value);
    let maybe = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.2}"));
    for track in &tracks.tracks {
        let volume =
            track.sightings.iter().map(|s| s.volume_fraction).sum::<f64>() / track.found.max(1) as f64;
        text.push_str(&format!(
            "{:>5} {:>13} {:>6} {:>8} {:>8} {:>11}\n",
            track.id,
            format!("{} to {}", track.first_frame, track.last_frame),
            track.found,
            maybe(track.mean_overlap),
            percent(volume),
            maybe(track.reliability),
        ));
    }
    let BatchSummary { computed, kept, failed, .. } = summary;
    let (frames, folder) = (tracks.frames.len(), message::name(&folder.to_string_lossy()));
    text.push_str(&format!(
        "{} tracks through {frames} frames ({computed} computed, {kept} kept, {} failed) in {folder}: tracks.json, \
         tracks.csv, tracks.parquet\n",
        tracks.tracks.len(),
        failed.len(),
    ));
    text
}
