//! `cargo xtask tolerance`: whether regions stay the same when eigenpairs are less exact.

use std::error::Error;
use std::fmt::Write as _;
use std::path::PathBuf;

use mser3d::shape::{Domain, IndexSet, ShapeError, TriangleMesh};
use mser3d::voxelize::Pitch;
use mser3d::{Detector, Features, Input, Parameters, Sidedness, Stage, Weight};

use crate::pose_sets::SetArguments;

/// What `cargo xtask tolerance` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    sets: SetArguments,
    /// Tolerances to try beside the exact one
    #[arg(long, value_delimiter = ',', default_value = "1e-6,1e-4,1e-3")]
    tolerances: Vec<f64>,
    /// Where tolerance.md is written
    #[arg(short, long, default_value = "docs/results")]
    output: PathBuf,
}

/// What regions are compared with: eigenpairs as exact as those of a user who asks for eigenpairs.
const EXACT: f64 = 1e-9;

/// What is searched, and on what the tree is built.
const CASES: [(&str, Domain, Weight); 4] = [
    ("volume, heat", Domain::Volume, Weight::Heat),
    ("volume, commute", Domain::Volume, Weight::Commute),
    ("volume, diffusion", Domain::Volume, Weight::Diffusion),
    ("surface, heat", Domain::Surface, Weight::Heat),
];

/// How results differ from exact ones, summed over shapes.
#[derive(Clone)]
struct Difference {
    shapes: usize,
    /// Shapes with the same sets of regions, element by element.
    same_shapes: usize,
    /// Regions of the exact results, and those of them that are in the others, element by element.
    regions: usize,
    same: usize,
    /// Regions of either that overlap with none of the other as much as they should.
    lost: usize,
    /// Least overlap of a region of either with the best of the other.
    least_overlap: f64,
    /// Largest difference of the descriptors of two regions that are the same, over their length.
    descriptor: f64,
    /// Elements, and those of them that are in another part.
    elements: usize,
    other_part: usize,
    /// Bodies of which one result knows left and right, and the other not.
    other_sides: usize,
    /// For the exact eigenpairs, and for the others.
    seconds: [f64; 2],
}

/// At which overlap a region counts as found.
const FOUND: f64 = 0.9;

/// Detects on all meshes with all tolerances, and writes the table.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let meshes = meshes(&arguments.sets)?;
    let mut text = head(arguments, meshes.len())?;
    for (title, domain, weight) in CASES {
        let mut sums = vec![Difference::none(); arguments.tolerances.len()];
        for (name, mesh) in &meshes {
            let find = |tolerance| {
                let input = match domain {
                    Domain::Volume => Input::Volume(mesh),
                    Domain::Surface => Input::Surface(mesh),
                };
                detect(input, weight, tolerance, arguments).map_err(|e| format!("{name}: {e}"))
            };
            let exact = find(EXACT)?;
            for (sum, &tolerance) in sums.iter_mut().zip(&arguments.tolerances) {
                let own = Difference::of(&exact, &find(tolerance)?)?;
                if own.same < own.regions || own.other_part > 0 || own.descriptor > 1e-3 {
                    eprintln!("{title}: {name}: {tolerance:e} {}", own.row());
                }
                sum.add(&own);
            }
        }
        for (sum, tolerance) in sums.iter().zip(&arguments.tolerances) {
            writeln!(text, "| {title} | {tolerance:e} {}", sum.row())?;
        }
    }
    std::fs::create_dir_all(&arguments.output)?;
    std::fs::write(arguments.output.join("tolerance.md"), &text)?;
    print!("{text}");
    Ok(())
}

/// The meshes of all sets, each once.
fn meshes(sets: &SetArguments) -> Result<Vec<(String, TriangleMesh)>, Box<dyn Error>> {
    let mut all: Vec<(String, TriangleMesh)> = Vec::new();
    for set in sets.read()? {
        for (pose, mesh) in set.poses {
            if all.iter().all(|(_, other)| *other != mesh) {
                all.push((format!("{} {pose}", set.name), mesh));
            }
        }
    }
    Ok(all)
}

fn detect(input: Input, weight: Weight, tolerance: f64, arguments: &Arguments) -> Result<Features, String> {
    let mut parameters = Parameters::of_weight(weight);
    parameters.voxelize.pitch = Pitch::Voxels(arguments.sets.voxels);
    parameters.spectrum.tolerance = tolerance;
    // Copies have a tolerance of their own.
    parameters.reliability.deformations = Some(0);
    Detector::new(parameters).detect(input).map_err(|e| e.to_string())
}

impl Difference {
    fn none() -> Self {
        Self {
            shapes: 0,
            same_shapes: 0,
            regions: 0,
            same: 0,
            lost: 0,
            least_overlap: 1.0,
            descriptor: 0.0,
            elements: 0,
            other_part: 0,
            other_sides: 0,
            seconds: [0.0; 2],
        }
    }

    /// How a result differs from the exact one of the same shape.
    fn of(exact: &Features, other: &Features) -> Result<Self, ShapeError> {
        let mut own =
            Self { shapes: 1, regions: exact.regions.len(), elements: exact.shape.len(), ..Self::none() };
        // Regions of one size may have changed places.
        for (at, region) in exact.regions.iter().enumerate() {
            let Some(to) = other.regions.iter().position(|r| r.elements == region.elements) else {
                continue;
            };
            own.same += 1;
            let length = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
            let [a, b] = [exact.descriptors.row(at), other.descriptors.row(to)];
            let far = length(&mut a.iter().zip(b).map(|(x, y)| x - y)) / length(&mut a.iter().copied());
            own.descriptor = own.descriptor.max(far);
        }
        own.same_shapes = usize::from(own.same == own.regions && other.regions.len() == own.regions);
        let weight = vec![1.0; exact.shape.len()];
        let sets = |features: &Features| -> Result<Vec<IndexSet>, ShapeError> {
            let elements = features.regions.iter().map(|region| region.elements.iter().copied());
            elements.map(|elements| IndexSet::from_members(weight.len(), elements)).collect()
        };
        let (exact_sets, other_sets) = (sets(exact)?, sets(other)?);
        for (from, to) in [(&exact_sets, &other_sets), (&other_sets, &exact_sets)] {
            for region in from {
                let best = to.iter().map(|set| region.overlap(set, &weight)).fold(0.0, f64::max);
                own.lost += usize::from(best < FOUND);
                own.least_overlap = own.least_overlap.min(best);
            }
        }
        if let (Some(a), Some(b)) = (&exact.partition, &other.partition) {
            let labels = a.part_of_element.iter().zip(&b.part_of_element);
            own.other_part = labels.filter(|(a, b)| a != b).count();
        }
        let sided = |f: &Features| {
            f.bodies.iter().map(|b| matches!(b.sidedness, Sidedness::Sided { .. })).collect::<Vec<_>>()
        };
        own.other_sides = sided(exact).iter().zip(sided(other)).filter(|(a, b)| **a != *b).count();
        own.seconds = [exact, other].map(|f| {
            let stages = f.run.stages.iter().filter(|s| s.stage == Stage::Spectrum);
            stages.map(|s| s.seconds).sum()
        });
        Ok(own)
    }

    fn add(&mut self, other: &Self) {
        self.shapes += other.shapes;
        self.same_shapes += other.same_shapes;
        self.regions += other.regions;
        self.same += other.same;
        self.lost += other.lost;
        self.least_overlap = self.least_overlap.min(other.least_overlap);
        self.descriptor = self.descriptor.max(other.descriptor);
        self.elements += other.elements;
        self.other_part += other.other_part;
        self.other_sides += other.other_sides;
        self.seconds = [0, 1].map(|i| self.seconds[i] + other.seconds[i]);
    }

    fn row(&self) -> String {
        format!(
            "| {} of {} | {} of {} | {} | {:.4} | {:.0e} | {:.1e} | {} | {:.2} |",
            self.same_shapes,
            self.shapes,
            self.same,
            self.regions,
            self.lost,
            self.least_overlap,
            self.descriptor,
            self.other_part as f64 / self.elements as f64,
            self.other_sides,
            self.seconds[1] / self.seconds[0],
        )
    }
}

fn head(arguments: &Arguments, shapes: usize) -> Result<String, Box<dyn Error>> {
    let mut text = String::from("# How exact eigenpairs have to be\n\n");
    writeln!(
        text,
        "Made by `cargo xtask tolerance` on {shapes} shapes of {} voxels, or their surfaces, with the default parameters but for what \
         the first two columns say. Each result is compared with that of a tolerance of {EXACT:e}.\n",
        arguments.sets.voxels
    )?;
    text.push_str(
        "* *The same*: element by element. *Overlap*: intersection over union of elements, of a region of either with the best of the other.\n\
         * *Change of a descriptor*: its length over that of the descriptor, of regions that are the same.\n\
         * *In other parts*: where rounding decides a tie, as between mirror images or about the sides of a body that hardly has any, \
         every tolerance can decide it in another way, the smallest too.\n\n\
         | search | tolerance | shapes with the same regions | the same regions | not found at .9 | least overlap | \
         largest change of a descriptor | elements in other parts | bodies with other sides | seconds for eigenpairs, of exact |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose_sets::in_repository;
    use crate::solved::mesh;

    #[test]
    fn what_is_missing_or_changed_is_counted() {
        let mesh = mesh(&in_repository("fixtures/quadruped_rest.off")).unwrap();
        let mut parameters = Parameters::default();
        parameters.voxelize.pitch = Pitch::Voxels(2000);
        parameters.spectrum.eigenpairs = 20.into();
        parameters.reliability.deformations = Some(0);
        let exact = Detector::new(parameters).detect(Input::Volume(&mesh)).unwrap();
        let count = exact.regions.len();
        assert!(count > 3);

        let same = Difference::of(&exact, &exact).unwrap();
        assert_eq!((same.same_shapes, same.same, same.lost), (1, count, 0));
        assert_eq!((same.least_overlap, same.descriptor, same.other_part), (1.0, 0.0, 0));

        // One region with an element less, and an element in another part.
        let mut other = exact.clone();
        other.regions[0].elements.pop();
        let parts = &mut other.partition.as_mut().unwrap().part_of_element;
        parts[0] += 1;
        let changed = Difference::of(&exact, &other).unwrap();
        let whole = exact.regions[0].elements.len() as f64;
        assert_eq!((changed.same_shapes, changed.same, changed.lost), (0, count - 1, 0));
        assert!((changed.least_overlap - (whole - 1.0) / whole).abs() < 1e-12, "{}", changed.least_overlap);
        assert_eq!(changed.other_part, 1);

        // No region at all: none of the exact ones is found.
        other.regions.clear();
        let nothing = Difference::of(&exact, &other).unwrap();
        assert_eq!((nothing.same, nothing.lost, nothing.least_overlap), (0, count, 0.0));
    }
}
