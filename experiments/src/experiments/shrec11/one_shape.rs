//! What our detectors find on one shape.

use std::error::Error;

use mser3d::descriptors::{
    Descriptors, HksParameters, IntegralInvariantParameters, SiHksParameters, TimeScale, Vocabulary,
    VocabularyParameters, integral_invariants, region_descriptors, si_hks,
};
use mser3d::shape::{Domain, TriangleMesh, VoxelGrid};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d::{Descriptor, Parameters, Region};
use mser3d_evaluation::DetectedRegions;
use mser3d_evaluation::shrec::{ShapeName, SpaceMap};

use super::detectors::{Description, Detector, Medium};
use super::store::{Digest, Store};
use super::voxel_overlap::best_overlaps;
use crate::solved::Solved;

/// Sizes of a run.
#[derive(Clone, Copy, Debug)]
pub struct Sizes {
    /// Voxels of a null shape.
    pub voxels: usize,
    /// Eigenpairs of each solid and surface.
    pub eigenpairs: usize,
}

/// What the transforms of a null shape take over from it.
pub struct Shared {
    sizes: Sizes,
    pitch: f64,
    volume: f64,
    area: f64,
    /// One unit of the time of SI-vHKS and SI-HKS, in length^2.
    units: [f64; 2],
    vocabulary: Option<Vocabulary>,
    /// What was found on the null shape, for each detector.
    found: Vec<OnNull>,
}

/// What a detector found on the null shape.
struct OnNull {
    /// It is found again in each run: where it differs from what an earlier run found, so may
    /// everything else.
    digest: Digest,
    regions: Vec<Region>,
    grid: Option<VoxelGrid>,
}

/// What a detector found on a shape: its regions, and a detection for each descriptor.
struct Found {
    regions: Vec<Region>,
    entries: Vec<(String, DetectedRegions)>,
}

/// A shape as heat sees it: solved once for all detectors that need it.
struct Media<'m> {
    mesh: &'m TriangleMesh,
    pitch: Pitch,
    eigenpairs: usize,
    solved: [Option<Solved>; 3],
}

impl<'m> Media<'m> {
    fn new(mesh: &'m TriangleMesh, pitch: Pitch, eigenpairs: usize) -> Self {
        Self { mesh, pitch, eigenpairs, solved: [None, None, None] }
    }

    fn get(&mut self, medium: Medium) -> Result<&Solved, Box<dyn Error>> {
        let slot = &mut self.solved[medium as usize];
        if slot.is_none() {
            let spectrum = SpectrumParameters { eigenpairs: self.eigenpairs.into(), ..Default::default() };
            let cut_links = medium == Medium::Volume;
            let voxelize = VoxelizeParameters { pitch: self.pitch, cut_links, ..Default::default() };
            *slot = Some(match medium {
                Medium::Volume | Medium::UncutVolume => Solved::volume(self.mesh, &voxelize, &spectrum)?,
                Medium::Surface => Solved::surface(self.mesh, &spectrum)?,
            });
        }
        slot.as_ref().ok_or_else(|| "not solved".into())
    }
}

impl Shared {
    /// Detects on a null shape, and writes what is found.
    pub fn of_null(
        null: &TriangleMesh,
        name: &ShapeName,
        sizes: Sizes,
        detectors: &[Detector],
        store: &Store,
    ) -> Result<Self, Box<dyn Error>> {
        let mut media = Media::new(null, Pitch::Voxels(sizes.voxels), sizes.eigenpairs);
        let own = SiHksParameters::default();
        let volume = media.get(Medium::Volume)?;
        let pitch = volume.pitch().ok_or("a solid without voxels")?;
        let voxels = volume.measure();
        let wanted = |d: &Detector| d.descriptors.contains(&Description::Vocabulary);
        let vocabulary = if detectors.iter().any(wanted) {
            let training = si_hks(volume.basis(), &own, None)?;
            Some(Vocabulary::train(&training, &VocabularyParameters::default())?)
        } else {
            None
        };
        let units = [own.unit(volume.basis()), null.area() / own.reference_area];
        let (volume, area) = (voxels, null.area());
        let mut shared = Self { sizes, pitch, volume, area, units, vocabulary, found: Vec::new() };
        for detector in detectors {
            let mut digest = Digest::default();
            digest.text(&format!("{} {sizes:?} {:?}", env!("CARGO_PKG_VERSION"), detector.parameters));
            digest.mesh(null);
            let found = shared.detect(&mut media, detector, false)?;
            for (entry, detection) in &found.entries {
                digest.detection(detection);
                detection.write(&store.folder(entry)?, name)?;
            }
            let grid = media.get(detector.medium)?.shape().grid().cloned();
            shared.found.push(OnNull { digest, regions: found.regions, grid });
        }
        Ok(shared)
    }

    /// Detects on a transform what is not there yet. What fails is returned. With a map of space,
    /// regions are compared voxel by voxel as well.
    pub fn transform(
        &self,
        mesh: &TriangleMesh,
        name: &ShapeName,
        map: Option<&SpaceMap>,
        detectors: &[Detector],
        store: &Store,
    ) -> Vec<String> {
        let scaled = is_scaled(&name.class);
        let pitch = if scaled { Pitch::Voxels(self.sizes.voxels) } else { Pitch::Size(self.pitch) };
        let mut media = Media::new(mesh, pitch, self.sizes.eigenpairs);
        let mut one = |detector: &Detector, null: &OnNull| -> Result<(), Box<dyn Error>> {
            let key = key(null, mesh);
            if store.has(detector, name, &key) {
                return Ok(());
            }
            store.unseal(detector, name)?;
            let found = self.detect(&mut media, detector, scaled)?;
            for (entry, detection) in &found.entries {
                detection.write(&store.folder(entry)?, name)?;
            }
            let grid = media.get(detector.medium)?.shape().grid();
            if let (Some(map), Some(null_grid), Some(grid)) = (map, &null.grid, grid) {
                let overlaps =
                    best_overlaps(null_grid, &elements(&null.regions), map, grid, &elements(&found.regions));
                store.write_voxel_overlaps(detector, name, &overlaps)?;
            }
            store.seal(detector, name, &key)
        };
        let mut problems = Vec::new();
        for (detector, null) in detectors.iter().zip(&self.found) {
            problems.extend(one(detector, null).err().map(|e| format!("{}: {e}", detector.name)));
        }
        problems
    }

    /// Whether nothing of a shape is left to detect.
    pub fn is_done(
        &self,
        mesh: &TriangleMesh,
        name: &ShapeName,
        detectors: &[Detector],
        store: &Store,
    ) -> bool {
        detectors.iter().zip(&self.found).all(|(d, null)| store.has(d, name, &key(null, mesh)))
    }

    /// The regions of a detector, once for each of its descriptors.
    fn detect(
        &self,
        media: &mut Media<'_>,
        detector: &Detector,
        scaled: bool,
    ) -> Result<Found, Box<dyn Error>> {
        let mut parameters = detector.parameters.clone();
        if !scaled {
            let volume = detector.medium.domain() == Domain::Volume;
            parameters.reference_measure = Some(if volume { self.volume } else { self.area });
        }
        let regions = media.get(detector.medium)?.regions(&parameters)?;
        let mut entries = Vec::new();
        for (entry, description) in detector.entries() {
            let descriptors = match description {
                Description::SidedSiHks => {
                    media.get(detector.medium)?.describe(&regions, &parameters)?.descriptors
                }
                Description::SizedSiHks => {
                    let descriptor = Descriptor::SizedSiHks(SiHksParameters::default());
                    let own = Parameters { descriptor, ..parameters.clone() };
                    media.get(detector.medium)?.describe(&regions, &own)?.descriptors
                }
                Description::SiHks => {
                    let descriptor = Descriptor::SiHks(SiHksParameters::default());
                    let own = Parameters { descriptor, ..parameters.clone() };
                    media.get(detector.medium)?.describe(&regions, &own)?.descriptors
                }
                Description::Hks => {
                    // The null shape's times, as in the paper: this descriptor knows of no scale.
                    let unit = self.volume.powf(2.0 / 3.0);
                    let mut own = HksParameters::default();
                    for time in &mut own.times {
                        *time = TimeScale::Absolute(time.with_unit(unit)?);
                    }
                    let own = Parameters { descriptor: Descriptor::Hks(own), ..parameters.clone() };
                    media.get(detector.medium)?.describe(&regions, &own)?.descriptors
                }
                Description::Vocabulary => self.bags(media.get(detector.medium)?, &regions, scaled)?,
                Description::IntegralInvariants => {
                    self.invariants(media.get(detector.medium)?, &regions, scaled)?
                }
                Description::SurfaceSiHks => {
                    self.on_surface(media.get(Medium::Surface)?, &regions, scaled)?
                }
            };
            entries.push((entry, media.get(detector.medium)?.detection(&regions, &descriptors)?));
        }
        Ok(Found { regions, entries })
    }

    fn si_hks_parameters(&self, domain: Domain, scaled: bool) -> SiHksParameters {
        let unit = self.units[if domain == Domain::Volume { 0 } else { 1 }];
        SiHksParameters { unit: (!scaled).then_some(unit), ..Default::default() }
    }

    fn bags(&self, solved: &Solved, regions: &[Region], scaled: bool) -> Result<Descriptors, Box<dyn Error>> {
        let vocabulary = self.vocabulary.as_ref().ok_or("no vocabulary was trained")?;
        let parameters = self.si_hks_parameters(Domain::Volume, scaled);
        Ok(region_descriptors(&elements(regions), solved.basis().mass(), |voxels| {
            vocabulary.encode(&si_hks(solved.basis(), &parameters, Some(voxels))?)
        })?)
    }

    fn invariants(
        &self,
        solved: &Solved,
        regions: &[Region],
        scaled: bool,
    ) -> Result<Descriptors, Box<dyn Error>> {
        let grid = solved.shape().grid().ok_or("integral invariants need voxels")?;
        let unit = (!scaled).then_some(self.volume.cbrt());
        let parameters = IntegralInvariantParameters { unit, ..Default::default() };
        Ok(region_descriptors(&elements(regions), solved.basis().mass(), |voxels| {
            integral_invariants(grid, &parameters, Some(voxels))
        })?)
    }

    fn on_surface(
        &self,
        surface: &Solved,
        regions: &[Region],
        scaled: bool,
    ) -> Result<Descriptors, Box<dyn Error>> {
        let parameters = self.si_hks_parameters(Domain::Surface, scaled);
        let members: Vec<&[u32]> = regions.iter().map(|r| &r.vertices[..]).collect();
        Ok(region_descriptors(&members, surface.basis().mass(), |vertices| {
            si_hks(surface.basis(), &parameters, Some(vertices))
        })?)
    }
}

/// Scaled shapes get a pitch and times of their own: the null shape's, scaled.
pub fn is_scaled(class: &str) -> bool {
    ["scaling", "scale"].contains(&class)
}

/// The voxels or vertices of each region.
fn elements(regions: &[Region]) -> Vec<&[u32]> {
    regions.iter().map(|r| &r.elements[..]).collect()
}

/// Everything that a detection on a transform depends on.
fn key(null: &OnNull, mesh: &TriangleMesh) -> Digest {
    let mut key = null.digest.clone();
    key.mesh(mesh);
    key
}
