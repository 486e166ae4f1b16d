//! `cargo xtask tracks`: whether regions keep their identity through a sequence, and what following them costs.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use mser3d::descriptors::assign;
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Domain, Parameters};
use mser3d_collection::{
    BatchParameters, Plan, Sampling, plan_sequence, run_batch, share_parameters, track_results,
};
use mser3d_evaluation::IndexSet;
use mser3d_results::{Results, TrackParameters, TracksRecord};

use crate::comparisons::resources::{Stopwatch, Usage};
use crate::pose_sets::in_repository;

/// What `cargo xtask tracks` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Animated glTF files; of each, all animations are taken [default: the fox and the rigged figure of ../shared/data, and
    /// the human of fixtures/]
    #[arg(value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Frames of each animation
    #[arg(long, default_value_t = 24)]
    frames: usize,
    /// Voxels of the first frame
    #[arg(long, default_value_t = 45_000)]
    voxels: usize,
    /// Where tracks.md is written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// At which overlap by vertices a region exists in two frames.
const EXISTS: f64 = 0.5;

/// How much of two overlaps by vertices is the same: on coarse meshes several regions have the same vertices.
const EQUAL: f64 = 1e-9;

/// At which overlap by voxels regions of few and of many eigenpairs are said to be alike.
const ALIKE: f64 = 0.98;

/// Where a region of each frame is, by vertices.
type Frames = Vec<Vec<IndexSet>>;

/// Measures all animations, and writes the page.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let files = match &arguments.files[..] {
        [] => ["../shared/data/gltf/Fox.glb", "../shared/data/gltf/RiggedFigure.gltf", "fixtures/human.glb"]
            .map(in_repository)
            .into(),
        files => files.to_vec(),
    };
    let (mut kept, mut costs) = (String::new(), String::new());
    for file in files {
        if !file.exists() {
            eprintln!("skipped: {} is not here", file.display());
            continue;
        }
        for animation in mser3d_meshio::list_animations(&file, &Default::default())? {
            let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            let name = match &animation.name {
                Some(name) => format!("{stem}, {name}"),
                None => format!("{stem}, {}", animation.index),
            };
            eprintln!("{name}");
            let number = animation.index.to_string();
            measure(arguments, &file, &number, &name, &mut kept, &mut costs)?;
        }
    }
    let text = page(arguments, &kept, &costs);
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("tracks.md"), &text)?;
    print!("{text}");
    Ok(())
}

fn measure(
    arguments: &Arguments,
    file: &Path,
    animation: &str,
    name: &str,
    kept: &mut String,
    costs: &mut String,
) -> Result<(), Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let at = |name: &str| folder.path().join(name);
    let mut parameters = Parameters::default();
    parameters.voxelize.pitch = Pitch::Voxels(arguments.voxels);
    let sampling = Sampling::Count(arguments.frames);
    let frames = || plan_sequence(&[file.to_owned()], Some(animation), sampling, &Default::default());

    let watch = Stopwatch::start();
    let tracks = follow(&mut frames()?, &at("tracked"), &parameters)?;
    let cost = watch.stop();
    let watch = Stopwatch::start();
    let mut plan = frames()?;
    let scaled = share_parameters(&mut plan, Domain::Volume, &parameters, false)?;
    plan.jobs.iter_mut().for_each(|job| job.parameters = None);
    let scaled = Parameters { reliability: parameters.reliability, ..scaled };
    search(&plan, &at("alone"), scaled)?;
    let alone = watch.stop();
    let [all, equal, alike] = same_regions(&tracks, &at("tracked"), &at("alone"))?;
    let share = |part: fn(&Usage) -> f64| part(&cost) / part(&alone);
    writeln!(
        costs,
        "| {name} | {:.1} s | {:.1} s | {:.2} | {:.1} s | {:.1} s | {:.2} | {equal} | {alike} | {all} |",
        cost.cpu,
        alone.cpu,
        share(|usage| usage.cpu),
        cost.wall,
        alone.wall,
        share(|usage| usage.wall)
    )?;

    // The same frames as files of their own, the triangles of each listed in another order.
    let mut plan = frames()?;
    for (number, job) in plan.jobs.iter_mut().enumerate() {
        let mesh = job.read()?.mesh().cloned().ok_or("no mesh")?;
        let mut triangles = mesh.triangles().to_vec();
        let first = number % triangles.len().max(1);
        triangles.rotate_left(first);
        job.path = at(&format!("{}.ply", job.name));
        let other = mser3d::shape::TriangleMesh::new(mesh.vertices().to_vec(), triangles)?;
        mser3d_meshio::write_ply(&job.path, &other, &Default::default())?;
        job.options = Default::default();
    }
    let by_descriptor = follow(&mut plan, &at("others"), &parameters)?;

    let (here, areas) = regions(&tracks, &at("tracked"))?;
    let (there, _) = regions(&by_descriptor, &at("others"))?;
    let own = Identities::of(&tracks, &here, &areas)?;
    let other = Identities::of(&by_descriptor, &there, &areas)?;
    let lasting = tracks.tracks.iter().filter(|t| t.found * 10 >= 9 * tracks.frames.len()).count();
    let count: usize = here.iter().map(Vec::len).sum();
    writeln!(
        kept,
        "| {name} | {:.1} | {:.3} | {:.3} | {:.3} | {:.3} | {:.3} | {} | {lasting} |",
        count as f64 / here.len() as f64,
        own.pairs as f64 / own.regions as f64,
        own.kept as f64 / own.pairs as f64,
        own.true_to_start as f64 / own.sightings.max(1) as f64,
        other.kept as f64 / other.pairs as f64,
        other.true_to_start as f64 / other.sightings.max(1) as f64,
        tracks.tracks.len(),
    )?;
    Ok(())
}

/// As `mser3d track` does it.
fn follow(plan: &mut Plan, folder: &Path, parameters: &Parameters) -> Result<TracksRecord, Box<dyn Error>> {
    let shared = share_parameters(plan, Domain::Volume, parameters, true)?;
    search(plan, folder, shared)?;
    Ok(track_results(folder, plan, &TrackParameters::default(), &|_| true)?)
}

fn search(plan: &Plan, folder: &Path, parameters: Parameters) -> Result<(), Box<dyn Error>> {
    let batch = BatchParameters { workers: rayon::current_num_threads(), ..Default::default() };
    let summary = run_batch(folder, plan, Domain::Volume, &Detector::new(parameters), &batch, &|_| {})?;
    match summary.failed.first() {
        Some(failed) => Err(format!("{}: {}", failed.name, failed.error).into()),
        None => Ok(()),
    }
}

/// Of the regions that full searches found: how many there are, how many tracked frames have to the voxel, and how many at an
/// overlap of [`ALIKE`].
fn same_regions(tracks: &TracksRecord, tracked: &Path, alone: &Path) -> Result<[usize; 3], Box<dyn Error>> {
    let mut counts = [0; 3];
    for frame in &tracks.frames {
        let sets = |folder: &Path| -> Result<Vec<IndexSet>, Box<dyn Error>> {
            let results = Results::load(&folder.join(&frame.name))?;
            let voxels = results.grid.as_ref().map_or(0, |grid| grid.len());
            let set = |region: &Vec<u32>| IndexSet::from_members(voxels, region.iter().copied());
            Ok(results.region_voxels.iter().map(set).collect::<Result<_, _>>()?)
        };
        let few = sets(tracked)?;
        for region in sets(alone)? {
            let overlap = |other: &IndexSet| {
                let shared = region.intersection(other).len();
                shared as f64 / (region.len() + other.len() - shared).max(1) as f64
            };
            let best = few.iter().map(overlap).fold(0.0, f64::max);
            let found = [true, best == 1.0, best >= ALIKE];
            counts.iter_mut().zip(found).for_each(|(count, found)| *count += usize::from(found));
        }
    }
    Ok(counts)
}

/// The vertices of the regions of each frame, and the areas of the first one's vertices.
fn regions(tracks: &TracksRecord, folder: &Path) -> Result<(Frames, Vec<f64>), Box<dyn Error>> {
    let mut areas = Vec::new();
    let mut frames = Vec::new();
    for frame in &tracks.frames {
        let results = Results::load(&folder.join(&frame.name))?;
        if areas.is_empty() {
            areas = results.mesh.vertex_areas();
        }
        let set = |region: &Vec<u32>| IndexSet::from_members(areas.len(), region.iter().copied());
        frames.push(results.region_vertices.iter().map(set).collect::<Result<Vec<_>, _>>()?);
    }
    Ok((frames, areas))
}

/// What became of the identities of regions.
#[derive(Default)]
struct Identities {
    /// Regions of all frames but the last.
    regions: usize,
    /// Those of them that exist in the next frame, and those of these that keep their track.
    pairs: usize,
    kept: usize,
    /// Later sightings of tracks, and those that overlap the first one.
    sightings: usize,
    true_to_start: usize,
}

impl Identities {
    fn of(tracks: &TracksRecord, frames: &Frames, areas: &[f64]) -> Result<Self, Box<dyn Error>> {
        let mut found = Self::default();
        let mut next = vec![Vec::new(); frames.len()];
        for (frame, next) in next.iter_mut().enumerate() {
            *next = vec![None; frames[frame].len()];
        }
        for track in &tracks.tracks {
            for pair in track.sightings.windows(2).filter(|pair| pair[1].frame == pair[0].frame + 1) {
                next[pair[0].frame][pair[0].region as usize] = Some(pair[1].region as usize);
            }
            let first = &track.sightings[0];
            let start = &frames[first.frame][first.region as usize];
            for later in track.sightings.iter().skip(1).filter(|_| !start.is_empty()) {
                found.sightings += 1;
                let overlap = start.overlap(&frames[later.frame][later.region as usize], areas);
                found.true_to_start += usize::from(overlap >= EXISTS);
            }
        }
        for (number, pair) in frames.windows(2).enumerate() {
            let overlap = |a: usize, b: usize| pair[0][a].overlap(&pair[1][b], areas);
            let gain = |a: usize, b: usize| (overlap(a, b) - EXISTS).max(0.0);
            let (rows, columns) = (pair[0].len(), pair[1].len());
            let costs: Vec<f64> =
                (0..rows).flat_map(|a| (0..columns).map(move |b| (a, b))).map(|(a, b)| -gain(a, b)).collect();
            found.regions += rows;
            for (region, partner) in assign(&costs, rows, columns)?.into_iter().enumerate() {
                let Some(partner) = partner.filter(|&partner| overlap(region, partner) >= EXISTS) else {
                    continue;
                };
                found.pairs += 1;
                let as_good = |other: usize| overlap(region, other) >= overlap(region, partner) - EQUAL;
                found.kept += usize::from(next[number][region].is_some_and(as_good));
            }
        }
        Ok(found)
    }
}

fn page(arguments: &Arguments, kept: &str, costs: &str) -> String {
    let Arguments { frames, voxels, .. } = arguments;
    format!(
        "# Regions followed through time

Made by `cargo xtask tracks --frames {frames} --voxels {voxels}`: animations in {frames} frames each, {voxels} voxels in the first,
tracked as `mser3d track` does it.

The truth is by vertices, which are the same in all frames: a region exists in the next frame if one there overlaps it by at
least {EXISTS}, by vertex area, one to one with the largest total. Its identity is kept if its track goes on in that region, or in
one with the same vertices. *True to the start* is the share of all later sightings of a track that overlap its first one by at
least {EXISTS}: tracks that drift from region to region lose there.

Some of what is not kept is no mistake: where one of two regions of nearly one size is missing in a frame, the truth continues it in the
other one, while tracks wait for it to come back.

*By vertices* is the rule for frames with the same triangles. *By descriptor and place* is the rule for others: the
frames are read as files, with the triangles of each listed in another order.

| animation | regions in a frame | exist in the next | by vertices: kept | true to the start | by descriptor and place: kept | true to the start | tracks | found in 90 % of the frames |
|---|---|---|---|---|---|---|---|---|
{kept}
What tracking costs, beside the same frames each on its own with the default parameters (a batch, {threads} at a time), with {threads} threads;
and how many of the regions that are found on their own tracked frames have, to the voxel and at an overlap of {ALIKE}:

| animation | tracked, CPU | alone, CPU | ratio | tracked, wall | alone, wall | ratio | regions to the voxel | at {ALIKE} | of |
|---|---|---|---|---|---|---|---|---|---|
{costs}
Tracked frames compute only the eigenpairs that the shortest time needs, and each frame is deformed and searched again
once, not six times: a region's reliability comes from the copies of several frames.
",
        threads = rayon::current_num_threads()
    )
}
