//! `cargo xtask pictures`: the pictures in `docs/images`, from the shapes in `fixtures`, and for the gallery from public ones.

mod gallery;

use std::path::{Path, PathBuf};

use crate::browser::{self, Browser, SOFTWARE_GL};
use crate::command::mser3d;

/// Larger ones make the repository heavy.
const LARGEST: u64 = 300_000;

#[derive(clap::Args)]
pub struct Arguments {
    /// Folder for the pictures
    #[arg(short, long, default_value = "docs/images")]
    output: PathBuf,
    /// Folder with the public shapes of docs/gallery.md [default: ../shared/data, where it is there]
    #[arg(long)]
    data: Option<PathBuf>,
    /// The pictures of docs/gallery.md alone
    #[arg(long)]
    gallery: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Box<dyn std::error::Error>> {
    let work = std::path::absolute("target/pictures")?;
    let pictures = std::path::absolute(&arguments.output)?;
    std::fs::create_dir_all(&pictures).map_err(|e| format!("{}: {e}", pictures.display()))?;
    gallery::run(arguments.data.as_deref(), &work.join("gallery"), &pictures)?;
    if arguments.gallery {
        return report(&pictures);
    }
    let at = |name: &str| work.join(name).display().to_string();
    let picture = |name: &str| pictures.join(name).display().to_string();

    for pose in ["rest", "kick"] {
        mser3d(&["detect", &format!("fixtures/human_{pose}.off"), "-o", &at(pose), "--quiet"])?;
    }
    mser3d(&["render", &at("rest"), "-o", &picture("human_rest.png"), "--height", "600"])?;
    mser3d(&["detect", "fixtures/human_rest.off", "-o", &at("parted"), "--parts", "12", "--quiet"])?;
    mser3d(&["render", &at("parted"), "-o", &picture("human_parts.png"), "--height", "600"])?;
    let views = [
        "--show",
        "regions",
        "--views",
        "three-quarter,inside,voxels",
        "--cut-at",
        "0.26",
        "--height",
        "600",
    ];
    mser3d(&[&["render", &at("kick"), "-o", &picture("human_cut.png")][..], &views].concat())?;
    let views = ["--views", "three-quarter,back", "--height", "500"];
    mser3d(&[&["render", &at("kick"), "-o", &picture("human_sides.png")][..], &views].concat())?;
    mser3d(&["match", &at("rest"), &at("kick"), "-o", &at("match")])?;
    copy(&work.join("match/matches.png"), &pictures.join("human_match.png"))?;
    let shapes = ["human_rest.off", "human_walk.off", "human_wave.off", "quadruped_rest.off"];
    let shapes = shapes.map(|name| format!("fixtures/{name}"));
    let shapes: Vec<&str> = shapes.iter().map(String::as_str).collect();
    mser3d(&[&["batch", "-o", &at("all"), "--quiet"][..], &shapes].concat())?;
    mser3d(&["query", &at("all"), &at("kick"), "--html", &at("query.html")])?;
    mser3d(&["view", &at("rest")])?;
    match browser::find() {
        None => println!("no Chromium here: page.png, page_phone.png and query.png stay as they are"),
        Some(program) => screenshots(&program, &work, &pictures)?,
    }
    report(&pictures)
}

/// The pages, as a browser shows them.
fn screenshots(program: &Path, work: &Path, pictures: &Path) -> Result<(), String> {
    let mut browser = Browser::start(program, &SOFTWARE_GL)?;
    let shot = |browser: &mut Browser, name: &str| {
        let path = pictures.join(name);
        let png = browser.screenshot()?;
        std::fs::write(&path, png).map_err(|e| format!("{}: {e}", path.display()))
    };
    let page = work.join("rest/view.html");
    browser.load(&page)?;
    // An arm.
    for _ in 0..5 {
        browser.press("n")?;
    }
    shot(&mut browser, "page.png")?;
    browser.load(&work.join("query.html"))?;
    shot(&mut browser, "query.png")?;
    browser.be_a_phone()?;
    browser.load(&page)?;
    shot(&mut browser, "page_phone.png")
}

fn copy(from: &Path, to: &Path) -> Result<(), String> {
    std::fs::copy(from, to).map(|_| ()).map_err(|e| format!("{}: {e}", from.display()))
}

/// Says what there is now; a picture that is too large is an error.
fn report(pictures: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let mut names: Vec<PathBuf> =
        std::fs::read_dir(pictures)?.map(|entry| Ok(entry?.path())).collect::<std::io::Result<_>>()?;
    names.retain(|path| path.extension().is_some_and(|e| e == "png"));
    names.sort();
    let mut heavy = Vec::new();
    for path in names {
        let size = path.metadata()?.len();
        println!("{} {} kB", path.display(), size / 1000);
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if size > LARGEST || gallery::heavy(&name, size) {
            heavy.push(path.display().to_string());
        }
    }
    if heavy.is_empty() {
        return Ok(());
    }
    Err(format!("too large for the repository: {}", heavy.join(", ")).into())
}
