//! Shapes with their spectra, and what a detector finds there.

use std::error::Error;
use std::path::Path;

use mser3d::descriptors::Descriptors;
use mser3d::shape::{Eigenbasis, TriangleMesh};
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::VoxelizeParameters;
use mser3d::{Described, DiscreteShape, NO_PROGRESS, Parameters, Region, describe, find_regions};
use mser3d_evaluation::{DetectedRegions, IndexSet};
use mser3d_meshio::{ReadOptions, read_mesh};

/// A shape and its spectrum, which serve every detector.
pub struct Solved {
    vertices: usize,
    shape: DiscreteShape,
    basis: Eigenbasis,
}

impl Solved {
    /// The solid inside a mesh.
    pub fn volume(
        mesh: &TriangleMesh,
        voxelize: &VoxelizeParameters,
        spectrum: &SpectrumParameters,
    ) -> Result<Self, Box<dyn Error>> {
        Self::solve(mesh, DiscreteShape::volume(mesh, voxelize)?.0, spectrum)
    }

    /// The surface itself.
    pub fn surface(mesh: &TriangleMesh, spectrum: &SpectrumParameters) -> Result<Self, Box<dyn Error>> {
        Self::solve(mesh, DiscreteShape::surface(mesh)?, spectrum)
    }

    fn solve(
        mesh: &TriangleMesh,
        shape: DiscreteShape,
        spectrum: &SpectrumParameters,
    ) -> Result<Self, Box<dyn Error>> {
        let basis = shape.spectrum(spectrum, NO_PROGRESS)?.basis;
        Ok(Self { vertices: mesh.vertices().len(), shape, basis })
    }

    /// Size of a voxel; none on a surface.
    pub fn pitch(&self) -> Option<f64> {
        self.shape.grid().map(|grid| grid.frame().spacing()[0])
    }

    /// Volume, or area.
    pub fn measure(&self) -> f64 {
        self.basis.measure()
    }

    /// What heat flows on.
    pub fn shape(&self) -> &DiscreteShape {
        &self.shape
    }

    /// Its eigenpairs.
    pub fn basis(&self) -> &Eigenbasis {
        &self.basis
    }

    /// The regions that a detector finds.
    pub fn regions(&self, parameters: &Parameters) -> Result<Vec<Region>, Box<dyn Error>> {
        Ok(find_regions(&self.shape, &self.basis, parameters, NO_PROGRESS)?.regions)
    }

    /// What a detector finds, as sets of the mesh's vertices.
    pub fn detect(&self, parameters: &Parameters) -> Result<DetectedRegions, Box<dyn Error>> {
        let regions = self.regions(parameters)?;
        let described = self.describe(&regions, parameters)?;
        self.detection(&regions, &described.descriptors)
    }

    /// The descriptors of regions, and their sides.
    pub fn describe(&self, regions: &[Region], parameters: &Parameters) -> Result<Described, Box<dyn Error>> {
        Ok(describe(&self.shape, &self.basis, regions, parameters)?)
    }

    /// Regions with their descriptors, as sets of the mesh's vertices.
    pub fn detection(
        &self,
        regions: &[Region],
        descriptors: &Descriptors,
    ) -> Result<DetectedRegions, Box<dyn Error>> {
        let descriptors = descriptors.rows().map(<[f64]>::to_vec).collect();
        Ok(DetectedRegions { regions: self.vertex_sets(regions)?, descriptors })
    }

    /// Regions as sets of the mesh's vertices.
    pub fn vertex_sets(&self, regions: &[Region]) -> Result<Vec<IndexSet>, Box<dyn Error>> {
        let set = |region: &Region| IndexSet::from_members(self.vertices, region.vertices.iter().copied());
        Ok(regions.iter().map(set).collect::<Result<_, _>>()?)
    }
}

/// The mesh of a file.
pub fn mesh(path: &Path) -> Result<TriangleMesh, Box<dyn Error>> {
    Ok(read_mesh(path, &ReadOptions::default())?.mesh)
}

/// The name of a file without its folder and extension.
pub fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
