//! The sets of meshes that experiments on poses use: each with one vertex order, so that vertex i is the same place of
//! the body in all of them.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d::Parameters;
use mser3d::shape::TriangleMesh;
use mser3d::spectral::SpectrumParameters;
use mser3d::voxelize::{Pitch, VoxelizeParameters};
use mser3d_evaluation::{NullShape, read_symmetry};
use mser3d_meshio::{MeshFormat, ReadOptions, list_animations, read_mesh};
use rayon::prelude::*;

use crate::repeats::Found;
use crate::solved::{Solved, mesh, stem};

/// Which sets to use, and how finely.
#[derive(clap::Args)]
pub struct SetArguments {
    /// human, quadruped, makehuman, people, fox or rigged-figure; or a glTF file with animations; or a folder with
    /// meshes of one vertex order, the first by name sizing the voxels, and with the left-right symmetry in symmetry.txt
    /// if there is one [default: all six]
    #[arg(value_name = "SET")]
    pub sets: Vec<PathBuf>,
    /// Voxels of the first pose of each set, of which the others have the size, and of each person
    #[arg(long, default_value_t = 45_000)]
    pub voxels: usize,
}

/// Whose meshes these are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Poses of one body: all have the voxel size and the times of the first.
    Poses,
    /// Different persons: each has the voxel size and the times that its own volume gives.
    Persons,
}

/// Meshes with the same triangles.
pub struct PoseSet {
    pub name: String,
    pub kind: Kind,
    /// The first mesh, on which overlaps are measured, with the left-right symmetry where one is known.
    pub null: NullShape,
    /// Names and meshes, the first included.
    pub poses: Vec<(String, TriangleMesh)>,
}

/// A set that the project knows: where it lies, and which meshes it has.
struct Known {
    name: &'static str,
    kind: Kind,
    meshes: Meshes,
    /// Relative to the repository, as the meshes are.
    symmetry: Option<&'static str>,
}

enum Meshes {
    /// What all paths begin with, and how they go on before `.off`.
    Files(&'static str, &'static [&'static str]),
    /// The pose at rest of a glTF file, and three moments of each of its animations.
    Animations(&'static str),
}

const KNOWN: [Known; 6] = [
    Known {
        name: "human",
        kind: Kind::Poses,
        meshes: Meshes::Files(
            "fixtures/human_",
            &["rest", "walk", "kick", "sit", "wave", "crouch", "touch", "press"],
        ),
        symmetry: Some("fixtures/human_symmetry.txt"),
    },
    Known {
        name: "quadruped",
        kind: Kind::Poses,
        meshes: Meshes::Files("fixtures/quadruped_", &["rest", "gallop", "graze"]),
        symmetry: Some("fixtures/quadruped_symmetry.txt"),
    },
    Known {
        name: "makehuman",
        kind: Kind::Poses,
        meshes: Meshes::Files(
            "../shared/data/makehuman/",
            &["00_rest", "01_tpose", "02_arms_up", "03_walk", "06_kick", "08_twist", "09_wave"],
        ),
        symmetry: Some("../shared/data/makehuman/symmetry.txt"),
    },
    Known {
        name: "people",
        kind: Kind::Persons,
        meshes: Meshes::Files(
            "../shared/data/",
            &["makehuman/00_rest", "people/man_rest", "people/woman_rest", "people/child_rest"],
        ),
        symmetry: Some("../shared/data/makehuman/symmetry.txt"),
    },
    Known {
        name: "fox",
        kind: Kind::Poses,
        meshes: Meshes::Animations("../shared/data/gltf/Fox.glb"),
        symmetry: None,
    },
    Known {
        name: "rigged-figure",
        kind: Kind::Poses,
        meshes: Meshes::Animations("../shared/data/gltf/RiggedFigure.gltf"),
        symmetry: None,
    },
];

impl SetArguments {
    /// Reads the sets. Of those that are used without being asked for, what is not here is left out, and said.
    pub fn read(&self) -> Result<Vec<PoseSet>, Box<dyn Error>> {
        let known = |name: &Path| KNOWN.iter().find(|set| Path::new(set.name) == name);
        if !self.sets.is_empty() {
            let read = |set: &PathBuf| match known(set) {
                Some(set) => PoseSet::known(set),
                None if set.is_file() => PoseSet::new(stem(set), Kind::Poses, moments(set)?, None),
                None => PoseSet::folder(set),
            };
            return self.sets.iter().map(read).collect();
        }
        let (here, missing): (Vec<&Known>, Vec<&Known>) = KNOWN.iter().partition(|set| set.first().exists());
        for set in missing {
            eprintln!("skipped: {}, for {} is not here", set.name, set.first().display());
        }
        here.into_iter().map(PoseSet::known).collect()
    }
}

impl Known {
    fn first(&self) -> PathBuf {
        match self.meshes {
            Meshes::Files(start, ends) => in_repository(&format!("{start}{}.off", ends[0])),
            Meshes::Animations(path) => in_repository(path),
        }
    }
}

impl PoseSet {
    fn known(known: &Known) -> Result<Self, Box<dyn Error>> {
        let poses = match known.meshes {
            Meshes::Files(start, ends) => {
                let paths: Vec<_> =
                    ends.iter().map(|end| in_repository(&format!("{start}{end}.off"))).collect();
                read_all(&paths)?
            }
            Meshes::Animations(path) => moments(&in_repository(path))?,
        };
        let symmetry = known.symmetry.map(in_repository);
        Self::new(known.name.into(), known.kind, poses, symmetry.as_deref())
    }

    /// The meshes of a folder as poses of one body.
    fn folder(folder: &Path) -> Result<Self, Box<dyn Error>> {
        let entries = std::fs::read_dir(folder).map_err(|e| {
            let names = KNOWN.map(|set| set.name).join(", ");
            format!("{}: neither one of {names} nor a file or folder ({e})", folder.display())
        })?;
        let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<std::io::Result<Vec<_>>>()?;
        paths.retain(|path| MeshFormat::from_extension(path).is_some());
        paths.sort();
        let symmetry = folder.join("symmetry.txt");
        if !symmetry.exists() {
            eprintln!("{}: no symmetry.txt, so left and right are not exchanged", folder.display());
        }
        let symmetry = symmetry.exists().then_some(symmetry);
        Self::new(stem(folder), Kind::Poses, read_all(&paths)?, symmetry.as_deref())
    }

    fn new(
        name: String,
        kind: Kind,
        poses: Vec<(String, TriangleMesh)>,
        symmetry: Option<&Path>,
    ) -> Result<Self, Box<dyn Error>> {
        let [(first, null), others @ ..] = poses.as_slice() else {
            return Err(format!("{name}: no meshes").into());
        };
        if others.is_empty() {
            return Err(format!("{name}: only the mesh {first}; two or more are needed").into());
        }
        if let Some((other, _)) = others.iter().find(|(_, mesh)| mesh.triangles() != null.triangles()) {
            let wanted = "meshes of a set must have the same triangles";
            return Err(format!("{name}: {other} has other triangles than {first}; {wanted}").into());
        }
        let mut null = NullShape::new(null.clone());
        if let Some(path) = symmetry {
            let vertices = null.mesh().vertices().len();
            null = null.with_symmetry(read_symmetry(path, vertices)?)?;
        }
        Ok(Self { name, kind, null, poses })
    }

    /// Solids and spectra of all meshes. The pitch in `voxelize` is replaced by that of the first mesh with so many
    /// voxels, or by that number for each person.
    pub fn solve(
        &self,
        voxels: usize,
        voxelize: &VoxelizeParameters,
        spectrum: &SpectrumParameters,
    ) -> Result<Vec<Solved>, Box<dyn Error>> {
        let solve = |pose: usize, pitch: Pitch| {
            let (name, mesh) = &self.poses[pose];
            let voxelize = VoxelizeParameters { pitch, ..voxelize.clone() };
            Solved::volume(mesh, &voxelize, spectrum).map_err(|e| format!("{}: {name}: {e}", self.name))
        };
        let first = solve(0, Pitch::Voxels(voxels))?;
        let pitch = match (self.kind, first.pitch()) {
            (Kind::Poses, Some(size)) => Pitch::Size(size),
            _ => Pitch::Voxels(voxels),
        };
        let others = (1..self.poses.len()).into_par_iter().map(|pose| solve(pose, pitch));
        let others = others.collect::<Result<Vec<_>, String>>()?;
        Ok(std::iter::once(first).chain(others).collect())
    }

    /// The volume that times refer to: the first one's, or none, each person's own.
    pub fn reference_measure(&self, solved: &[Solved]) -> Option<f64> {
        solved.first().filter(|_| self.kind == Kind::Poses).map(Solved::measure)
    }

    /// What a detector finds on all meshes, poses at the times of the first.
    pub fn detect(&self, solved: &[Solved], parameters: &Parameters) -> Result<Vec<Found>, Box<dyn Error>> {
        let parameters =
            Parameters { reference_measure: self.reference_measure(solved), ..parameters.clone() };
        let find = |solved: &Solved| -> Result<Found, String> {
            let regions = solved.regions(&parameters).map_err(|e| e.to_string())?;
            let described = solved.describe(&regions, &parameters).map_err(|e| e.to_string())?;
            let detection = solved.detection(&regions, &described.descriptors).map_err(|e| e.to_string())?;
            Ok(Found { regions, detection })
        };
        Ok(solved.par_iter().map(find).collect::<Result<Vec<_>, String>>()?)
    }
}

/// A path that is given relative to the repository.
pub fn in_repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

fn read_all(paths: &[PathBuf]) -> Result<Vec<(String, TriangleMesh)>, Box<dyn Error>> {
    paths.iter().map(|path| Ok((stem(path), mesh(path)?))).collect()
}

/// The figure of a glTF file at rest, and at a quarter, a half and three quarters of each animation.
fn moments(path: &Path) -> Result<Vec<(String, TriangleMesh)>, Box<dyn Error>> {
    let mut poses = vec![("rest".to_owned(), mesh(path)?)];
    for animation in list_animations(path, &Default::default())? {
        let name = animation.name.unwrap_or_else(|| format!("animation_{}", animation.index));
        for quarter in [1, 2, 3] {
            let time = animation.start + 0.25 * f64::from(quarter) * (animation.end - animation.start);
            let options =
                ReadOptions { animation: Some(animation.index.to_string()), time, ..Default::default() };
            poses.push((format!("{name}_{quarter}_4"), read_mesh(path, &options)?.mesh));
        }
    }
    Ok(poses)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn read(sets: &[&Path]) -> Result<Vec<PoseSet>, String> {
        let sets = sets.iter().map(|set| set.to_path_buf()).collect();
        SetArguments { sets, voxels: 1000 }.read().map_err(|e| e.to_string())
    }

    fn tetrahedron(folder: &Path, name: &str, faces: &str) {
        let text = format!("OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n{faces}\n");
        fs::write(folder.join(name), text).unwrap();
    }

    const OUTWARD: &str = "3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2";

    #[test]
    fn fixtures_are_known_by_name() {
        let sets = read(&[Path::new("human"), Path::new("quadruped")]).unwrap();
        let kinds: Vec<_> = sets.iter().map(|s| (&s.name[..], s.kind, s.poses.len())).collect();
        assert_eq!(kinds, [("human", Kind::Poses, 8), ("quadruped", Kind::Poses, 3)]);
        assert_eq!(sets[0].poses[5].0, "human_crouch");
        assert!(sets.iter().all(|set| set.null.mirror().is_some()));
    }

    #[test]
    fn persons_share_vertices_and_sides_with_makehuman() {
        if !in_repository("../shared/data/people").exists() {
            println!("skipped: ../shared/data/people is not here");
            return;
        }
        let sets = read(&[Path::new("people"), Path::new("makehuman")]).unwrap();
        assert_eq!((sets[0].kind, sets[0].poses.len()), (Kind::Persons, 4));
        assert_eq!(sets[0].null.mirror(), sets[1].null.mirror());
        assert_eq!(sets[0].poses[0], sets[1].poses[0]);
        assert!(sets[0].poses.iter().all(|(_, mesh)| mesh.triangles() == sets[1].null.mesh().triangles()));
    }

    #[test]
    fn animations_are_read_at_three_moments() {
        let sets = read(&[&in_repository("fixtures/quadruped.glb")]).unwrap();
        let names: Vec<&str> = sets[0].poses.iter().map(|(name, _)| &name[..]).collect();
        assert_eq!(names, ["rest", "poses_1_4", "poses_2_4", "poses_3_4"]);
        // The animation lasts two seconds; its middle is the gallop, which the OFF file rounds to 0.1 mm.
        let gallop = mesh(&in_repository("fixtures/quadruped_gallop.off")).unwrap();
        let far = |a: &[f64; 3], b: &[f64; 3]| (0..3).any(|i| (a[i] - b[i]).abs() > 1e-4);
        let middle = &sets[0].poses[2].1;
        assert!(!middle.vertices().iter().zip(gallop.vertices()).any(|(a, b)| far(a, b)));
        assert!(middle.vertices().iter().zip(sets[0].poses[0].1.vertices()).any(|(a, b)| far(a, b)));
    }

    #[test]
    fn a_folder_is_a_set_if_its_meshes_are_poses() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::write(path.join("notes.txt"), "no mesh").unwrap();
        assert!(read(&[path]).err().unwrap().ends_with("no meshes"));
        tetrahedron(path, "b.off", OUTWARD);
        assert!(read(&[path]).err().unwrap().ends_with("only the mesh b; two or more are needed"));
        tetrahedron(path, "a.off", OUTWARD);
        let set = read(&[path]).unwrap().remove(0);
        assert_eq!(set.poses.iter().map(|(name, _)| &name[..]).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(set.null.mirror(), None);
        fs::write(path.join("symmetry.txt"), "0\n2\n1\n3\n").unwrap();
        assert_eq!(read(&[path]).unwrap()[0].null.mirror(), Some(&[0, 2, 1, 3][..]));
        tetrahedron(path, "c.off", "3 0 1 2\n3 0 1 3\n3 1 2 3\n3 0 3 2");
        let error = read(&[path]).err().unwrap();
        assert!(error.contains("c has other triangles than a"), "{error}");
        let error = read(&[&path.join("missing")]).err().unwrap();
        assert!(error.contains("neither one of human, quadruped, makehuman"), "{error}");
    }
}
