//! `mser3d match`: which regions of two shapes are the same.

use std::fmt::Write as _;
use std::path::PathBuf;

use mser3d::descriptors::{DenseMapParameters, MatchParameters, MatchRule};
use mser3d_collection::{
    CollectionError, DescribedResult, MatchRecord, Matching, MatchingParameters, RegionMatch, judge_matching,
    map_vertices, match_results,
};
use mser3d_evaluation::{Verdict, read_symmetry};
use mser3d_fileio::{NpyArray, write_atomically, write_npy, write_text};
use mser3d_results::{RegionPair, RenderOptions, Results, ResultsError, ResultsFolder, Up};

use crate::choice::choice;
use crate::error::{CliError, print};
use crate::message::tell;
use crate::output::folder;

/// What can be written to the folder of matches besides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum MatchExtra {
    /// For each vertex of the second shape one of the first, map.npy; both results need detect --write eigenfunctions
    Map,
}

/// What `mser3d match` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct MatchArgs {
    /// Results of the first shape: a folder written by `mser3d detect`
    pub first: PathBuf,
    /// Results of the second shape, whose regions each get a partner on the first
    pub second: PathBuf,
    /// Folder for matches.json, matches.csv and matches.png, a picture with matched regions in one
    /// colour; made if it isn't there
    #[arg(short, long, value_name = "DIR", value_parser = folder())]
    pub output: Option<PathBuf>,
    /// Write a page for the browser too, matches.html in the folder: both shapes side by side
    #[arg(long, requires = "output")]
    pub html: bool,
    /// Write this too, into the folder
    #[arg(long, value_name = "WHAT", value_enum, value_delimiter = ',', requires = "output")]
    pub write: Vec<MatchExtra>,
    /// Axis that points up, in the picture and on the page
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
    /// How partners are chosen
    #[arg(long, value_parser = choice::<MatchRule>(), default_value_t = MatchParameters::default().rule)]
    pub rule: MatchRule,
    /// Ratio test: drop matches at least this times as far as the next best (off by default; on a
    /// symmetric shape it drops one of many pairs)
    #[arg(long, value_name = "R")]
    pub max_ratio: Option<f64>,
    /// Drop matches of a greater distance
    #[arg(long, value_name = "D")]
    pub max_distance: Option<f64>,
    /// Call a match ambiguous from this ratio to the next best on
    #[arg(long, value_name = "R", default_value_t = MatchParameters::default().ambiguity)]
    pub ambiguity: f64,
    /// How much matches count that hold together: near each other on both shapes. 0: each region alone, as in the paper
    #[arg(long, value_name = "W", default_value_t = MatchParameters::default().consistency)]
    pub consistency: f64,
    /// Let the whole second shape be matched as a mirror image, left to right, where that fits better
    #[arg(long)]
    pub allow_mirror: bool,
    /// Print JSON instead of a table
    #[arg(long)]
    pub json: bool,

    /// Vertex i of one mesh is vertex i of the other: say which matches are right
    #[arg(long, help_heading = "Ground truth")]
    pub same_vertices: bool,
    /// Left-right symmetry of the first mesh: entry i is the vertex that mirrors vertex i (.txt, .mat).
    /// Matches with the mirror image are then told apart from wrong ones
    #[arg(long, value_name = "FILE", requires = "same_vertices", help_heading = "Ground truth")]
    pub symmetry: Option<PathBuf>,
    /// Overlap from which a match is right
    #[arg(long, value_name = "F", default_value_t = 0.8, help_heading = "Ground truth")]
    pub min_overlap: f64,
}

impl MatchArgs {
    /// How regions are matched.
    ///
    /// # Errors
    /// [`CliError::Usage`] for values out of range.
    pub fn parameters(&self) -> Result<MatchingParameters, CliError> {
        let regions = MatchParameters {
            rule: self.rule,
            max_ratio: self.max_ratio,
            max_distance: self.max_distance,
            ambiguity: self.ambiguity,
            consistency: self.consistency,
        };
        regions.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
        Ok(MatchingParameters { regions, allow_mirror: self.allow_mirror })
    }

    /// Matches each region of the second shape to one of the first, and compares with the truth where it is known.
    ///
    /// # Errors
    /// [`CliError::Usage`], [`CliError::Collection`].
    pub fn find(&self, first: &DescribedResult, second: &DescribedResult) -> Result<Matching, CliError> {
        let mut matching = match_results(first, second, &self.parameters()?)?;
        if self.same_vertices {
            let vertices = first.results.mesh.vertices().len();
            let mirror = self.symmetry.as_ref().map(|path| read_symmetry(path, vertices)).transpose();
            let mirror = mirror.map_err(CollectionError::from)?;
            judge_matching(&mut matching, first, second, mirror, self.min_overlap)?;
        }
        Ok(matching)
    }
}

pub(crate) fn run(args: &MatchArgs) -> Result<(), CliError> {
    let parameters = args.parameters()?;
    let folder = args.output.as_deref().map(ResultsFolder::create).transpose()?;
    let (first, second) = (DescribedResult::load(&args.first)?, DescribedResult::load(&args.second)?);
    let matching = args.find(&first, &second)?;
    let map = match args.write.contains(&MatchExtra::Map) {
        true => Some(map_vertices(&first, &second, &matching, &DenseMapParameters::default())?),
        false => None,
    };
    let record = MatchRecord::new(&first, &second, &parameters, &matching);
    let json = serde_json::to_string_pretty(&record).map_err(|e| CliError::Stdout(e.into()))? + "\n";
    if let Some(folder) = &folder {
        // In numpy -1 is handier for none.
        let map = map.map(|map| map.into_iter().map(|v| v.map_or(-1, |v| v as i32)).collect());
        write(folder, &first.results, &second.results, &matching, (&json, map), args)?;
    }
    for warning in &matching.warnings {
        tell(&format!("warning: {warning}"));
    }
    print(&if args.json { json } else { table(&matching) })
}

/// Writes the folder: all of it or nothing.
fn write(
    folder: &ResultsFolder,
    first: &Results,
    second: &Results,
    matching: &Matching,
    (json, map): (&str, Option<Vec<i32>>),
    args: &MatchArgs,
) -> Result<(), CliError> {
    let pairs = matching.matches.iter();
    let pair = |m: &RegionMatch| {
        let mistake = m.truth.is_some_and(|truth| truth.verdict != Verdict::Right);
        RegionPair { first: m.partner, second: m.region, distance: m.distance, mistake }
    };
    let pairs: Vec<RegionPair> = pairs.map(pair).collect();
    let options = RenderOptions { height: 560, up: args.up, ..RenderOptions::default() };
    let mut picture = Vec::new();
    first.match_sheet(second, &pairs, &options)?.write_png(&mut picture).map_err(ResultsError::from)?;
    let page = match args.html {
        true => {
            let parts = first.record.parts.is_some() && second.record.parts.is_some();
            let what = if parts { "Parts and regions" } else { "Regions" };
            let title = format!("{what} of {} matched to {}", second.name(), first.name());
            Some(first.match_page(second, &pairs, &title, args.up)?)
        }
        false => None,
    };
    folder.write_matches(|staged| {
        write_text(&staged.join("matches.csv"), &matching.to_csv())?;
        write_atomically(&staged.join("matches.png"), |out| std::io::Write::write_all(out, &picture))?;
        if let Some(page) = &page {
            write_text(&staged.join("matches.html"), page)?;
        }
        if let Some(map) = map {
            write_npy(&staged.join("map.npy"), &NpyArray::flat(map))?;
        }
        Ok(write_text(&staged.join("matches.json"), json)?)
    })?;
    Ok(())
}

fn table(matching: &Matching) -> String {
    let judged = matching.precision.is_some();
    let mut text = String::from("region  partner   distance  next best  ratio");
    text.push_str(if judged { "  overlap  mirrored  verdict     note\n" } else { "  note\n" });
    for m in &matching.matches {
        let optional = |value: Option<f64>, digits| value.map_or("-".to_owned(), |v| format!("{v:.digits$}"));
        let ratio = m.rival_distance.map(|r| if r > 0.0 { m.distance / r } else { 1.0 });
        let _ = write!(
            text,
            "{:>6}  {:>7}  {:>9.5}  {:>9}  {:>5}",
            m.region,
            m.partner,
            m.distance,
            m.rival.map_or("-".to_owned(), |r| r.to_string()),
            optional(ratio, 2),
        );
        if let Some(truth) = m.truth {
            let mirrored = optional(truth.mirrored_overlap, 2);
            let _ = write!(text, "  {:>7.2}  {mirrored:>8}  {:<10}", truth.overlap, truth.verdict);
        }
        let note = match (m.symmetric_partner, m.rival) {
            (Some(twin), _) => format!("or {twin}: left and right look alike"),
            (None, Some(rival)) if m.ambiguous => format!("or {rival}: about as near"),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {note}");
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    let regions = matching.matches.len() + matching.unmatched.len();
    let symmetric = matching.matches.iter().filter(|m| m.symmetric_partner.is_some()).count();
    let ambiguous = matching.matches.iter().filter(|m| m.ambiguous && m.symmetric_partner.is_none()).count();
    let _ = writeln!(
        text,
        "{} of {regions} regions matched; {symmetric} could as well be their mirror image, {ambiguous} are \
         ambiguous otherwise",
        matching.matches.len(),
    );
    if matching.mirrored {
        text.push_str("the second shape is matched as a mirror image: that fits better\n");
    }
    if let Some(p) = &matching.precision {
        let _ = writeln!(
            text,
            "at overlap {}: {} right, {} on the other side, {} wrong: precision {:.1} % up to symmetry \
             ({:.1} % of all regions)",
            p.threshold,
            p.right,
            p.other_side,
            p.wrong,
            100.0 * p.precision,
            100.0 * p.recall,
        );
    }
    text
}
