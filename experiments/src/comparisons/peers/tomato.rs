//! ToMATo (Chazal, Guibas, Oudot, Skraba 2013) on our voxels: clusters of the heat kernel by persistence, which Skraba,
//! Ovsjanikov, Chazal and Guibas (2010) do on surfaces.

use std::error::Error;
use std::path::Path;

use mser3d::descriptors::{TimeScale, auto_diffusivity};
use mser3d::shape::{Connectivity, IndexSet};

use super::cases::Shape;
use super::{COUNTS, Parts, is_part};
use crate::comparisons::python::{Python, answer};

/// How to get it.
pub const ADVICE: &str = "pip install numpy gudhi, or --install";

/// The one of GUDHI.
pub struct Tomato {
    pub version: String,
    python: Python,
}

impl Tomato {
    pub fn find(python: &Python) -> Option<Self> {
        let version = python.probe("tomato.py")["gudhi"].as_str()?.to_owned();
        Some(Self { version, python: python.clone() })
    }

    /// As many clusters as are asked for, but for those that are no parts.
    pub fn parts(&self, shape: &Shape, file: &Path) -> Result<Parts, Box<dyn Error>> {
        let grid = shape.solved.shape().grid().ok_or("a solid without voxels")?;
        let basis = shape.solved.basis();
        let unit = shape.reference.unwrap_or(basis.measure()).powf(2.0 / 3.0);
        let heat = auto_diffusivity(basis, TimeScale::Relative(0.25).with_unit(unit)?)?;
        let links: Vec<[u32; 2]> = grid.graph(Connectivity::Six)?.edges().collect();
        let mut problem: Vec<u8> =
            [heat.len(), links.len()].iter().flat_map(|&n| (n as u64).to_le_bytes()).collect();
        problem.extend(heat.iter().flat_map(|h| h.ln().to_le_bytes()));
        problem.extend(links.iter().flatten().flat_map(|v| v.to_le_bytes()));
        std::fs::write(file, problem)?;
        let out = file.with_extension("labels");
        answer(self.python.script("tomato.py").args([file, &out]).args(COUNTS.map(|n| n.to_string())))?;
        let labels = read_labels(&out, COUNTS.len(), heat.len())?;
        [file, &out].into_iter().try_for_each(std::fs::remove_file)?;

        let voxels = shape.solved.shape().element_of_vertex();
        let mut parts = Parts::default();
        for (parts, labels) in parts.iter_mut().zip(labels) {
            for label in 0..=labels.iter().copied().max().unwrap_or(-1) {
                let size = labels.iter().filter(|&&l| l == label).count();
                if is_part(size as f64 / heat.len() as f64) {
                    let inside = |v: usize| voxels[v].is_some_and(|voxel| labels[voxel as usize] == label);
                    parts.push(IndexSet::from_fn(voxels.len(), inside));
                }
            }
        }
        Ok(parts)
    }
}

/// Some labellings of as many elements, 32 bits each.
pub fn read_labels(path: &Path, labellings: usize, elements: usize) -> Result<Vec<Vec<i32>>, Box<dyn Error>> {
    let bytes = std::fs::read(path)?;
    if bytes.len() != 4 * labellings * elements {
        let problem = format!("{} bytes in place of {labellings} x {elements} labels", bytes.len());
        return Err(format!("{}: {problem}", path.display()).into());
    }
    let labels: Vec<i32> =
        bytes.chunks_exact(4).map(|b| i32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
    Ok(labels.chunks(elements.max(1)).map(<[i32]>::to_vec).collect())
}
