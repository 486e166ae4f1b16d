use std::path::Path;

use mser3d::Features;
use mser3d_fileio::{NpyArray, NpzWriter, write_npz_by, write_text};

use crate::beside::beside;
use crate::eigenfunctions::write_eigenfunctions;
use crate::folder::Kind;
use crate::{Results, ResultsError, ResultsFolder, TreeArrays};

mser3d_shape::choice! {
    /// What can be written to a folder of results besides.
    pub enum Extra("file to write besides") {
        /// The regions as a label map on the grid of the input, regions.nii.gz
        #[default]
        Nifti = "nifti",
        /// The regions' centres and tips for 3D Slicer, landmarks.mrk.json
        Landmarks = "landmarks",
        /// The eigenpairs that the regions were found with, eigenfunctions.npz, which a map between two shapes needs
        Eigenfunctions = "eigenfunctions",
        /// The signature of each voxel or vertex, signatures.npz: what a region's descriptor is the mean of
        Signatures = "signatures",
        /// The first eigenfunctions and the signature of each voxel for ParaView, fields.vti
        Fields = "fields",
        /// The surface with triangles no larger than a voxel, fine_surface.ply: of a mesh of few vertices, what the voxels have
        FineSurface = "fine-surface",
    }
}

impl Extra {
    /// The name of the file.
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Nifti => "regions.nii.gz",
            Self::Landmarks => "landmarks.mrk.json",
            Self::Eigenfunctions => "eigenfunctions.npz",
            Self::Signatures => "signatures.npz",
            Self::Fields => "fields.vti",
            Self::FineSurface => "fine_surface.ply",
        }
    }

    /// Whether it is made of the eigenpairs, which have to be kept for it.
    pub fn needs_eigenfunctions(self) -> bool {
        matches!(self, Self::Eigenfunctions | Self::Signatures | Self::Fields)
    }
}

/// A file of a result.
enum File {
    Arrays,
    Surface,
    Volume,
    Extra(Extra),
    Record,
}

impl Results {
    /// Writes the folder, which is made if it is not there: `regions.json`, `features.npz`, `surface.ply` of a mesh,
    /// `volume.vti` of a volume, and `checksums.json` of them all.
    ///
    /// The new files take the place of those of an older result, its page too, when all are written: what is promised stands at
    /// [`ResultsFolder`], which also finds out early whether a folder can be written to. The same results make the same bytes.
    ///
    /// # Errors
    /// [`ResultsError::OutputFolder`], [`ResultsError::Busy`], [`ResultsError::Io`], [`ResultsError::File`] or
    /// [`ResultsError::Mesh`], naming the file.
    pub fn write(&self, folder: &Path) -> Result<(), ResultsError> {
        ResultsFolder::create(folder)?.write(self, &[])
    }

    /// Writes `regions.json` and `surface.ply` of a folder that holds these results anew, for changes of the record that
    /// concern no other file: the regions' tracks and colours.
    ///
    /// # Errors
    /// [`ResultsError::Busy`], [`ResultsError::Io`], [`ResultsError::File`] or [`ResultsError::Mesh`], naming the file.
    pub fn write_colours(&self, folder: &Path) -> Result<(), ResultsError> {
        let changed = Kind { others: &[], ..Self::FILES };
        ResultsFolder::create(folder)?.replace(&changed, |staged| {
            if !self.mesh_of_voxels {
                self.export(&staged.join("surface.ply"))?;
            }
            self.write_record(staged)
        })
    }

    fn write_record(&self, folder: &Path) -> Result<(), ResultsError> {
        let path = folder.join("regions.json");
        let json = self.record.to_json();
        let json = json.map_err(|error| ResultsError::Io { path: path.clone(), error: error.into() })?;
        Ok(write_text(&path, &json)?)
    }

    /// Writes all files into an empty folder, beside each other.
    pub(crate) fn write_files(
        &self,
        folder: &Path,
        extras: &[Extra],
        features: Option<&Features>,
    ) -> Result<(), ResultsError> {
        let mut files = vec![File::Arrays];
        files.extend((!self.mesh_of_voxels).then_some(File::Surface));
        files.extend(self.grid.is_some().then_some(File::Volume));
        files.extend(extras.iter().copied().map(File::Extra));
        files.push(File::Record);
        let write = |file: &File| match file {
            File::Arrays => self.write_arrays(folder, features),
            File::Surface => self.export(&folder.join("surface.ply")).map(drop),
            File::Volume => self.export(&folder.join("volume.vti")).map(drop),
            File::Extra(extra) => self.write_extra(*extra, folder),
            File::Record => self.write_record(folder),
        };
        beside(&files, write).into_iter().collect()
    }

    fn write_extra(&self, extra: Extra, folder: &Path) -> Result<(), ResultsError> {
        let path = folder.join(extra.file_name());
        match (extra, &self.eigenfunctions) {
            (Extra::Eigenfunctions, Some(bodies)) => write_eigenfunctions(bodies, &path),
            (Extra::Signatures, Some(bodies)) => self.write_signatures(bodies, &path),
            (Extra::Fields, Some(bodies)) => self.write_fields(bodies, &path),
            (extra, None) if extra.needs_eigenfunctions() => {
                Err(ResultsError::NoEigenfunctions { folder: folder.to_owned() })
            }
            (Extra::FineSurface, _) => self.write_fine_surface(&path),
            _ => self.export(&path).map(drop),
        }
    }

    /// Writes `features.npz`, one array after the other.
    fn write_arrays(&self, folder: &Path, features: Option<&Features>) -> Result<(), ResultsError> {
        write_npz_by(&folder.join("features.npz"), |npz| {
            if !self.mesh_of_voxels {
                npz.add("vertex_region", &NpyArray::flat(self.vertex_region()))?;
                add_lists(npz, "region_vertices", &self.region_vertices)?;
                if self.grid.is_some() {
                    npz.add("vertex_voxel", &NpyArray::flat(&self.vertex_voxel[..]))?;
                }
                if self.record.parts.is_some() {
                    npz.add("vertex_part", &NpyArray::flat(&self.vertex_part[..]))?;
                }
            }
            if let Some(file_vertex) = &self.file_vertex {
                npz.add("file_vertex", &NpyArray::flat(&file_vertex[..]))?;
            }
            if let Some(grid) = &self.grid {
                npz.add("voxel_region", &NpyArray::flat(self.voxel_region()))?;
                add_lists(npz, "region_voxels", &self.region_voxels)?;
                if self.record.parts.is_some() {
                    npz.add("voxel_part", &NpyArray::flat(&self.voxel_part[..]))?;
                }
                let mut index = Vec::with_capacity(3 * grid.len());
                index.extend(grid.voxels().flatten());
                npz.add("voxel_index", &NpyArray::new(&[grid.len(), 3], index)?)?;
                let affine = self.record.grid.map_or(grid.frame().affine(), |grid| grid.affine);
                let affine = affine.matrix().as_flattened().to_vec();
                npz.add("grid_affine", &NpyArray::new(&[4, 4], affine)?)?;
            }
            let shape = [self.record.regions.len(), self.descriptor_width];
            for (body, eigenvalues) in self.eigenvalues.iter().enumerate() {
                npz.add(&of_body("eigenvalues", body), &NpyArray::flat(&eigenvalues[..]))?;
            }
            npz.add("region_descriptor", &NpyArray::new(&shape, &self.descriptors[..])?)?;
            let shape = [self.record.regions.len(); 2];
            npz.add("region_cosine", &NpyArray::new(&shape, &self.cosines[..])?)?;
            // In numpy -1 is handier for none, and NaN.
            let regions = self.record.regions.iter();
            let twins: Vec<i32> = regions.clone().map(|r| r.twin.map_or(-1, |twin| twin as i32)).collect();
            let sides: Vec<f64> = regions.map(|r| r.side.unwrap_or(f64::NAN)).collect();
            npz.add("region_twin", &NpyArray::flat(twins))?;
            npz.add("region_side", &NpyArray::flat(sides))?;
            self.add_trees(npz, features)
        })
    }

    /// Adds the trees: those that are here, or those of the features.
    fn add_trees(&self, npz: &mut NpzWriter, features: Option<&Features>) -> Result<(), ResultsError> {
        for (number, tree) in self.trees.iter().enumerate() {
            add_tree(npz, number, tree)?;
        }
        let Some(features) = features.filter(|_| self.trees.is_empty()) else { return Ok(()) };
        (0..features.trees.len()).try_for_each(|tree| add_tree(npz, tree, &TreeArrays::of(features, tree)?))
    }
}

fn add_tree(npz: &mut NpzWriter, number: usize, tree: &TreeArrays) -> Result<(), ResultsError> {
    // In numpy -1 is handier for none than 2^32 - 1.
    let signed = |numbers: &[u32]| NpyArray::flat(numbers.iter().map(|&n| n as i32).collect::<Vec<_>>());
    npz.add(&format!("tree{number}_parent"), &signed(&tree.parents))?;
    npz.add(&format!("tree{number}_altitude"), &NpyArray::flat(&tree.altitudes[..]))?;
    npz.add(&format!("tree{number}_volume"), &NpyArray::flat(&tree.volumes[..]))?;
    Ok(npz.add(&format!("tree{number}_entry"), &signed(&tree.entry))?)
}

/// The name of an array of a body.
pub(crate) fn of_body(what: &str, body: usize) -> String {
    match body {
        0 => what.to_owned(),
        body => format!("body{body}_{what}"),
    }
}

/// Adds lists one after another, and where each begins and the last ends.
fn add_lists(npz: &mut NpzWriter, name: &str, lists: &[Vec<u32>]) -> Result<(), ResultsError> {
    let mut starts = vec![0i64];
    for list in lists {
        starts.push(starts[starts.len() - 1] + list.len() as i64);
    }
    npz.add(name, &NpyArray::flat(lists.concat()))?;
    Ok(npz.add(&format!("{name}_start"), &NpyArray::flat(starts))?)
}
