//! `cargo xtask browser-test`: the page that `mser3d view` writes, in a real browser.
//!
//! Loads the page of a figure in headless Chromium over the DevTools protocol, clicks, taps and types
//! as a user would, and checks what the page says. Screenshots go to `target/browser-test`.

mod audit;
mod pages;
mod panel;
mod regions;
mod sequence;
mod session;

use std::path::PathBuf;

use mser3d::voxelize::Pitch;
use mser3d::{Detector, Input, Parameters, PartParameters};
use mser3d_meshio::{ReadOptions, read_mesh};
use mser3d_results::{RegionPair, Results, Up};

use self::session::{Session, write};
use crate::browser::{self, Browser, SOFTWARE_GL};

/// A page must be smaller, however fine the mesh: in bytes.
const LARGEST_PAGE: usize = 10_000_000;
/// As many vertices as there are in a scan.
const FINE: usize = 500_000;

#[derive(clap::Args)]
pub struct Arguments {
    /// Mesh of a standing figure, +y up, arms to the sides
    #[arg(long, default_value = "fixtures/human_rest.off")]
    input: PathBuf,
    /// Voxels of the figure
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Don't try to install a missing browser
    #[arg(long)]
    no_install: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let Some(program) = browser::find().or_else(|| (!arguments.no_install).then(browser::install)?) else {
        println!("browser-test skipped: no Chromium here, and it cannot be installed (apt-get as root)");
        return Ok(());
    };
    let results = detect(arguments)?;
    let folder = std::path::absolute("target/browser-test")?;
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let parts = folder.join("parts.html");
    let single = folder.join("figure.html");
    let pair = folder.join("pair.html");
    write(&parts, results.page("A figure's parts", Up::Y)?.as_bytes())?;
    for (name, least) in [("middling.html", 50_000), ("fine.html", FINE)] {
        let fine = pages::refined(&results, least)?;
        let html = fine.page("A fine figure", Up::Y)?;
        let (bytes, vertices) = (html.len(), fine.mesh.vertices().len());
        println!("    {bytes} bytes for {vertices} vertices");
        if bytes > LARGEST_PAGE {
            return Err(format!("that is more than {LARGEST_PAGE}").into());
        }
        write(&folder.join(name), html.as_bytes())?;
    }
    write(&folder.join("volume.html"), pages::volume()?.as_bytes())?;
    let mut without_parts = results.clone();
    without_parts.record.parts = None;
    write(&single, without_parts.page("A figure", Up::Y)?.as_bytes())?;
    // The largest region stays without a match.
    let matches: Vec<RegionPair> = (1..results.record.regions.len() as u32)
        .map(|id| RegionPair { first: id, second: id, distance: 0.0, mistake: false })
        .collect();
    let html = results.match_page(&results, &matches, "Two figures", Up::Y)?;
    write(&pair, html.as_bytes())?;

    sequence::page(&results, &folder.join("sequence.html"))?;
    sequence::track(&folder.join("moving"))?;

    let mut browser = Browser::start(&program, &SOFTWARE_GL)?;
    let tests: [(&str, fn(&mut Session<'_>) -> Result<(), String>); 19] = [
        ("the first picture comes soon, and shows the regions' colours", regions::shows_regions),
        ("parts are shown first, and lead to their twins and regions", panel::parts_are_first),
        ("a click on an arm shows the arm's numbers", regions::arm_shows_its_numbers),
        (
            "an arm's twin is seen faintly, and a click on its name chooses it",
            regions::twin_is_seen_and_chosen,
        ),
        (
            "the tree is a picture to choose from, and a slider raises its level",
            regions::tree_and_slider_work,
        ),
        ("words are explained where they stand, by mouse and keyboard", panel::words_are_explained),
        ("the table is sorted by any column, and the keys follow it", panel::table_is_sorted),
        ("what is in the way is hidden, and a click goes through it", panel::hides_and_isolates),
        ("a link brings back what was seen", panel::link_restores_the_view),
        ("dark mode, axes and a saved picture", panel::looks_and_pictures),
        ("a very fine mesh opens soon, too", regions::fine_meshes_open_soon),
        ("a click shows where both legs become one", regions::legs_merge),
        ("slices of grey values stand beside the regions", panel::grey_values_are_seen),
        ("everything works by keyboard", regions::works_by_keyboard),
        ("a cut shows the inside, and its regions", regions::cut_shows_the_inside),
        ("a tap on a phone shows the arm's numbers", regions::works_on_a_phone),
        ("a choice on one shape chooses its match on the other", regions::matches_are_linked),
        ("a sequence plays, and a track shows its numbers over time", sequence::plays),
        ("an animated file plays in the colours of its tracks", sequence::animation_plays),
    ];
    let mut passed = 0;
    for (name, test) in tests {
        browser.open_page()?;
        let mut session = Session { browser: &mut browser, results: &results, folder: &folder };
        test(&mut session).map_err(|e| format!("{name}: {e}"))?;
        quiet(&browser).map_err(|e| format!("{name}: {e}"))?;
        println!("ok: {name}");
        passed += 1;
    }
    match audit::axe(&folder) {
        None => println!("skipped: axe-core audits nothing, for npm is not here or cannot install it"),
        Some(axe) => {
            let name = "axe-core finds nothing wrong: names, roles, focus, contrast, sizes of targets";
            browser.open_page()?;
            let mut session = Session { browser: &mut browser, results: &results, folder: &folder };
            audit::is_accessible(&mut session, &axe).map_err(|e| format!("{name}: {e}"))?;
            println!("ok: {name}");
            passed += 1;
        }
    }
    drop(browser);
    let mut blind = Browser::start(&program, &["--disable-3d-apis"])?;
    let mut session = Session { browser: &mut blind, results: &results, folder: &folder };
    regions::says_that_webgl_is_missing(&mut session)?;
    sequence::is_read_without_webgl(&mut session)?;
    quiet(&blind)?;
    println!("ok: a browser without WebGL2 is told so, and still gets the table");
    println!("browser-test: {} passed, 0 failed; screenshots in {}", passed + 1, folder.display());
    Ok(())
}

/// Fails if the console holds an error or a request left the machine.
fn quiet(browser: &Browser) -> Result<(), String> {
    let complaints = browser.complaints();
    if complaints.is_empty() { Ok(()) } else { Err(complaints.join("\n")) }
}

fn detect(arguments: &Arguments) -> Result<Results, String> {
    let mesh = read_mesh(&arguments.input, &ReadOptions::default()).map_err(|e| e.to_string())?.mesh;
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(arguments.voxels);
    parameters.parts = Some(PartParameters::default());
    let features = Detector::new(parameters)
        .detect(Input::Volume(&mesh))
        .map_err(|e| format!("{}: {e}", arguments.input.display()))?;
    let path = arguments.input.to_string_lossy();
    Results::new(&features, Some(&mesh), &path).map_err(|e| e.to_string())
}
