//! The regions of a body stay when it moves.

use std::sync::LazyLock;

use mser3d::voxelize::Pitch;
use mser3d::{Features, Parameters};
use mser3d_evaluation::{Correspondence, NullShape, Overlaps, share_above};
use mser3d_tests::{coarse, fixture, mirror, solid_features, vertex_sets};

/// A figure at rest: what its other poses are compared with.
struct Rest {
    figure: &'static str,
    shape: NullShape,
    features: Features,
    /// The pitch and the reference volume of the rest pose.
    parameters: Parameters,
}

impl Rest {
    fn new(figure: &'static str, voxels: usize, eigenpairs: usize) -> Self {
        let mesh = fixture(&format!("{figure}_rest.off"));
        let mut parameters = coarse(voxels, eigenpairs);
        let features = solid_features(&mesh, &parameters);
        parameters.voxelize.pitch = Pitch::Size(features.shape.grid().unwrap().frame().spacing()[0]);
        parameters.reference_measure = Some(features.bodies[0].measure());
        let shape = NullShape::new(mesh).with_symmetry(mirror(figure)).unwrap();
        Self { figure, shape, features, parameters }
    }

    fn compare(&self, pose: &str, parameters: &Parameters) -> Comparison {
        let mesh = fixture(&format!("{}_{pose}.off", self.figure));
        let found = solid_features(&mesh, parameters);
        let transfer = Correspondence::identity(mesh.vertices().len());
        let (rest, moved) = (vertex_sets(&self.features), vertex_sets(&found));
        let overlaps = Overlaps::new(&self.shape, &rest, &moved, &transfer).unwrap();
        let matched = overlaps.matched(&descriptors(&self.features), &descriptors(&found)).unwrap();
        Comparison {
            regions: moved.len(),
            repeatability: share_above(&overlaps.best(), 0.8),
            matching: share_above(&matched, 0.8),
        }
    }
}

fn descriptors(features: &Features) -> Vec<Vec<f64>> {
    (0..features.regions.len()).map(|i| features.descriptors.row(i).to_vec()).collect()
}

/// A pose against the rest pose, at overlap 0.8, where left may stand for right.
#[derive(Debug)]
struct Comparison {
    /// Regions of the pose.
    regions: usize,
    /// Share of them that are regions of the rest pose too.
    repeatability: f64,
    /// Share of them whose nearest descriptor is that of the same region of the rest pose.
    matching: f64,
}

/// A quarter of the default voxels: regions of one percent have 120 of them, and few are lost.
static HUMAN: LazyLock<Rest> = LazyLock::new(|| Rest::new("human", 12_000, 60));

#[test]
fn a_human_keeps_its_regions_and_their_descriptors() {
    for pose in ["walk", "kick", "wave"] {
        let found = HUMAN.compare(pose, &HUMAN.parameters);
        assert!(found.regions >= 15, "{pose}: {found:?}");
        assert!(found.repeatability >= 0.85 && found.matching >= 0.85, "{pose}: {found:?}");
    }
}

#[test]
fn cut_links_keep_limbs_apart_that_touch_or_press() {
    let mut glued = HUMAN.parameters.clone();
    glued.voxelize.cut_links = false;
    for pose in ["touch", "press"] {
        let cut = HUMAN.compare(pose, &HUMAN.parameters);
        assert!(cut.regions >= 15 && cut.repeatability >= 0.8, "{pose}: {cut:?}");
        let linked = HUMAN.compare(pose, &glued);
        assert!(linked.repeatability < cut.repeatability - 0.05, "{pose}: {linked:?}, cut {cut:?}");
    }
}

#[test]
fn a_quadruped_keeps_its_regions() {
    let rest = Rest::new("quadruped", 12_000, 60);
    let gallop = rest.compare("gallop", &rest.parameters);
    assert!(gallop.regions >= 20 && gallop.repeatability >= 0.85, "{gallop:?}");
}
