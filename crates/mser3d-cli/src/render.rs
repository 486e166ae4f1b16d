//! `mser3d render`: a result as a picture.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mser3d::shape::Choice;
use mser3d_fileio::write_atomically;
use mser3d_results::msv::MsvResults;
use mser3d_results::{Background, Drawing, Image, RenderOptions, Results, ResultsError, Up};
use mser3d_viewer::{NamedView, Panel, View, render_with_legend};

use crate::choice::choice;
use crate::error::CliError;
use crate::output::{PICTURE, file};

/// What `mser3d render` is told.
#[derive(clap::Args, Clone, Debug)]
pub struct RenderArgs {
    /// Folder that `mser3d detect` or `mser3d msv` wrote
    pub folder: PathBuf,
    /// Picture to write, .png [default: parts.png or regions.png in the folder, by what is shown]
    #[arg(short, long, value_name = "FILE", value_parser = file(PICTURE))]
    pub output: Option<PathBuf>,
    /// What is shown [default: parts, where the folder has them]
    #[arg(long, value_enum, value_name = "WHAT")]
    pub show: Option<Show>,
    /// From where, from left to right, by the file's axes [default: all but voxels and top, by the body's own front; inside for volumes]
    #[arg(long, value_parser = shots(), value_delimiter = ',', value_name = "VIEW,...")]
    pub views: Vec<Shot>,
    /// Height of each view, in pixels
    #[arg(long, value_name = "PIXELS", default_value_t = RenderOptions::default().height)]
    pub height: usize,
    /// Views beside each other before a new row begins; 0: all in one row
    #[arg(long, value_name = "N", default_value_t = RenderOptions::default().columns)]
    pub columns: usize,
    /// Axis that the cut of inside and voxels runs across [default: the shorter horizontal one]
    #[arg(long, value_enum, value_name = "AXIS")]
    pub cut_axis: Option<Axis>,
    /// Where it cuts: 0 leaves nothing, 1 all [default: where half of the volume is left]
    #[arg(long, value_name = "SHARE")]
    pub cut_at: Option<f64>,
    /// What is behind the shape
    #[arg(long, value_parser = choice::<Background>(), default_value_t = Background::default())]
    pub background: Background,
    /// Show where x, y and z point
    #[arg(long)]
    pub axes: bool,
    /// Axis that points up
    #[arg(long, value_parser = choice::<Up>(), default_value_t = Up::default())]
    pub up: Up,
}

/// What of a result is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Show {
    /// The parts: each place is in one
    Parts,
    /// The regions, one in the other: each place has the colour of the innermost
    Regions,
    /// Each region by itself, the surest first
    Each,
}

/// From where a panel shows it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shot {
    /// The surface, from a side
    Surface(NamedView),
    /// The surface cut open
    Inside,
    /// The voxels, cut open
    Voxels,
}

/// The names of the viewer's views, and two more.
fn shots() -> impl TypedValueParser<Value = Shot> {
    let views = NamedView::ALL.iter().map(|view| PossibleValue::new(view.name()).help(view.about()));
    let open = PossibleValue::new("inside").help("The surface cut open");
    let voxels = PossibleValue::new("voxels").help("The voxels, cut open");
    PossibleValuesParser::new(views.chain([open, voxels])).try_map(|name| match name.as_str() {
        "inside" => Ok(Shot::Inside),
        "voxels" => Ok(Shot::Voxels),
        name => name.parse().map(Shot::Surface),
    })
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Axis {
    X,
    Y,
    Z,
}

impl Shot {
    fn view(self) -> View {
        match self {
            Self::Surface(view) => view.into(),
            Self::Inside | Self::Voxels => NamedView::ThreeQuarter.into(),
        }
    }

    fn caption(self) -> String {
        match self {
            Self::Surface(view) => view.to_string(),
            Self::Inside => "inside".to_owned(),
            Self::Voxels => "voxels".to_owned(),
        }
    }
}

impl RenderArgs {
    fn options(&self) -> RenderOptions {
        RenderOptions {
            height: self.height,
            columns: self.columns,
            up: self.up,
            scale_bar: true,
            background: self.background,
            axes: self.axes,
            ..RenderOptions::default()
        }
    }

    /// Draws a result.
    ///
    /// # Errors
    /// [`CliError::Usage`] for what a result has no picture of, [`CliError::Results`].
    pub fn draw(&self, results: &Results) -> Result<Image, CliError> {
        Ok(self.draw_named(results)?.0)
    }

    /// The picture, and how its file is called if it is not said.
    fn draw_named(&self, results: &Results) -> Result<(Image, &'static str), CliError> {
        let options = self.options();
        let parts = if results.record.parts.is_some() { Show::Parts } else { Show::Regions };
        let front = results.front(self.up).unwrap_or(0.0);
        Ok(match self.show.unwrap_or(parts) {
            Show::Parts => {
                (draw(self, &results.with_parts_as_regions()?, "part", front, &options)?, "parts.png")
            }
            Show::Regions => (draw(self, results, "region", front, &options)?, "regions.png"),
            Show::Each => (each(self, results, options)?, "each.png"),
        })
    }
}

pub(crate) fn run(args: &RenderArgs) -> Result<(), CliError> {
    let (picture, name) = if MsvResults::is_in(&args.folder) && args.show.is_none() {
        if !args.views.is_empty() || args.cut_axis.is_some() {
            let why = "--views and --cut-axis need a result of `mser3d detect`; one of `mser3d msv` has one picture";
            return Err(CliError::Usage(why.into()));
        }
        (MsvResults::load(&args.folder)?.sheet(&args.options())?, "regions.png")
    } else {
        args.draw_named(&Results::load(&args.folder)?)?
    };
    let output = args.output.clone().unwrap_or_else(|| args.folder.join(name));
    let mut png = Vec::new();
    picture.write_png(&mut png).map_err(ResultsError::from)?;
    Ok(write_atomically(&output, |out| std::io::Write::write_all(out, &png))?)
}

fn each(args: &RenderArgs, results: &Results, mut options: RenderOptions) -> Result<Image, CliError> {
    if !args.views.is_empty() || args.cut_axis.is_some() {
        let why = "--views and --cut-axis are for parts and regions; --show each shows each region from where it is seen";
        return Err(CliError::Usage(why.into()));
    }
    if results.record.regions.is_empty() {
        return Err(CliError::Usage("--show each: there are no regions".into()));
    }
    if options.columns == 0 {
        options.columns = 8;
    }
    Ok(results.multiples(&options)?)
}

fn draw(
    args: &RenderArgs,
    results: &Results,
    what: &str,
    facing: f64,
    options: &RenderOptions,
) -> Result<Image, CliError> {
    let solid = results.grid.is_some();
    // Whoever names views means those of the file's axes.
    let front = if args.views.is_empty() { facing } else { 0.0 };
    let shots = match &args.views[..] {
        [] => {
            let sides = [NamedView::Front, NamedView::ThreeQuarter, NamedView::Side, NamedView::Back];
            sides.map(Shot::Surface).into_iter().chain(solid.then_some(Shot::Inside)).collect()
        }
        chosen => chosen.to_vec(),
    };
    if !solid && shots.iter().any(|s| [Shot::Inside, Shot::Voxels].contains(s)) {
        return Err(CliError::Usage("--views inside and voxels need a volume, and this is a surface".into()));
    }
    let cut = results.cut(args.cut_axis.map(|axis| axis as usize), args.cut_at, args.up, front);
    let (drawing, colours) = (Drawing::new(results)?, results.colours());
    let surface = drawing.numbered(&colours)?;
    let mut open = None;
    let mut voxels = None;
    if shots.contains(&Shot::Inside) {
        open = cut.as_ref().map(|cut| drawing.section(&colours, cut)).transpose()?;
    }
    if shots.contains(&Shot::Voxels) {
        voxels = results.voxel_model(cut.as_ref())?;
    }
    let panels: Vec<Panel<'_>> = shots
        .iter()
        .map(|shot| {
            let model = match shot {
                Shot::Inside => open.as_ref(),
                Shot::Voxels => voxels.as_ref(),
                _ => None,
            };
            let (model, view) = (model.unwrap_or(&surface), shot.view().turned(front));
            Panel { model, view, caption: shot.caption() }
        })
        .collect();
    Ok(render_with_legend(&panels, &results.legend(what), options).map_err(ResultsError::from)?)
}
