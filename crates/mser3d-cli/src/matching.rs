//! `mser3d match`: which regions of two shapes are the same.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use mser3d::descriptors::{MatchParameters, MatchRule};
use mser3d_collection::{CollectionError, Matching, Shape, Verdict, judge, match_shapes};
use mser3d_meshio::write_atomically;
use mser3d_results::{Match, RenderOptions, Results};
use serde_json::json;

use crate::error::CliError;
use crate::render::UpAxis;

#[derive(clap::Args)]
pub struct MatchArgs {
    /// Results of the first shape: a folder written by `mser3d detect`
    pub first: PathBuf,
    /// Results of the second shape, whose regions each get a partner on the first
    pub second: PathBuf,
    /// Folder for matches.json, matches.csv and matches.png, a picture with matched regions in one
    /// colour; made if it isn't there
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write a page for the browser too, matches.html in the folder: both shapes side by side
    #[arg(long, requires = "output")]
    pub html: bool,
    /// Axis that points up, in the picture and on the page
    #[arg(long, value_enum, default_value_t = UpAxis::Y)]
    pub up: UpAxis,
    /// How partners are chosen
    #[arg(long, value_enum, default_value_t = RuleArg::Nearest)]
    pub rule: RuleArg,
    /// Ratio test: drop matches at least this times as far as the next best (off by default; on a
    /// symmetric shape it drops one of many pairs)
    #[arg(long, value_name = "R")]
    pub max_ratio: Option<f64>,
    /// Drop matches of a greater distance
    #[arg(long, value_name = "D")]
    pub max_distance: Option<f64>,
    /// Call a match ambiguous from this ratio to the next best on
    #[arg(long, value_name = "R", default_value_t = 0.8)]
    pub ambiguity: f64,
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
    pub overlap: f64,
}

#[derive(Clone, Copy, Debug, ValueEnum, PartialEq, Eq)]
pub enum RuleArg {
    /// The nearest region; several regions, such as both arms, may get the same one
    Nearest,
    /// Only pairs that are nearest to each other
    Mutual,
    /// No partner twice, and the sum of distances as small as can be
    OneToOne,
}

pub fn run(args: &MatchArgs) -> Result<(), CliError> {
    let parameters = MatchParameters {
        rule: match args.rule {
            RuleArg::Nearest => MatchRule::Nearest,
            RuleArg::Mutual => MatchRule::Mutual,
            RuleArg::OneToOne => MatchRule::OneToOne,
        },
        max_ratio: args.max_ratio,
        max_distance: args.max_distance,
        ambiguity: args.ambiguity,
    };
    parameters.validate().map_err(|e| CliError::Usage(format!("wrong parameter: {e}")))?;
    let (first, second) = (Shape::load(&args.first)?, Shape::load(&args.second)?);
    let mut matching = match_shapes(&first, &second, &parameters)?;
    if args.same_vertices {
        let vertices = first.results.mesh.vertices().len();
        let read = |path: &PathBuf| mser3d_shrec11::read_symmetry(path, vertices);
        let mirror = args.symmetry.as_ref().map(read).transpose().map_err(CollectionError::from)?;
        judge(&mut matching, &first, &second, mirror, args.overlap)?;
    }
    let json = json!({
        "mser3d": env!("CARGO_PKG_VERSION"),
        "first": args.first.to_string_lossy(),
        "second": args.second.to_string_lossy(),
        "rule": args.rule.to_possible_value().map(|v| v.get_name().to_owned()),
        "max_ratio": args.max_ratio,
        "max_distance": args.max_distance,
        "ambiguity": args.ambiguity,
        "result": matching,
    });
    let json = format!("{json:#}\n");
    if let Some(folder) = &args.output {
        write(folder, &first.results, &second.results, &matching, &json, args)?;
    }
    for warning in &matching.warnings {
        eprintln!("mser3d: warning: {warning}");
    }
    let text = if args.json { json } else { table(&matching) };
    std::io::stdout().lock().write_all(text.as_bytes()).map_err(CliError::Stdout)
}

fn write(
    folder: &Path,
    first: &Results,
    second: &Results,
    matching: &Matching,
    json: &str,
    args: &MatchArgs,
) -> Result<(), CliError> {
    let fail = |source| CliError::OutputFolder { path: folder.to_path_buf(), source };
    std::fs::create_dir_all(folder).map_err(fail)?;
    let text =
        |name: &str, text: &str| write_atomically(&folder.join(name), |out| out.write_all(text.as_bytes()));
    text("matches.csv", &matching.to_csv())?;
    let pairs = matching.matches.iter();
    let pairs: Vec<Match> =
        pairs.map(|m| Match { first: m.partner, second: m.region, distance: m.distance }).collect();
    let options = RenderOptions { height: 600, up: args.up.into(), ..RenderOptions::default() };
    let sheet = first.match_sheet(second, &pairs, &options)?;
    write_atomically(&folder.join("matches.png"), |out| sheet.write_png(out).map_err(std::io::Error::other))?;
    if args.html {
        let title = format!("Regions of {} matched to {}", second.name(), first.name());
        text("matches.html", &first.match_page(second, &pairs, &title, args.up.into())?)?;
    }
    Ok(text("matches.json", json)?)
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
            let verdict = match truth.verdict {
                Verdict::OtherSide => "other side",
                other => other.name(),
            };
            let mirrored = optional(truth.mirrored_overlap, 2);
            let _ = write!(text, "  {:>7.2}  {mirrored:>8}  {verdict:<10}", truth.overlap);
        }
        let note = match m.rival {
            Some(rival) if m.symmetric => format!("or {rival}: left and right look alike"),
            Some(rival) if m.ambiguous => format!("or {rival}: about as near"),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {note}");
        text.truncate(text.trim_end().len());
        text.push('\n');
    }
    let regions = matching.matches.len() + matching.unmatched.len();
    let symmetric = matching.matches.iter().filter(|m| m.symmetric).count();
    let ambiguous = matching.matches.iter().filter(|m| m.ambiguous).count() - symmetric;
    let _ = writeln!(
        text,
        "{} of {regions} regions matched; {symmetric} could as well be their mirror image, {ambiguous} are \
         ambiguous otherwise",
        matching.matches.len(),
    );
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
