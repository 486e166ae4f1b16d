//! The results folder: `regions.json`, `features.npz`, `surface.ply`, `volume.vti`.

mod folder;
mod report;

pub use folder::OutputFolder;
pub use report::{DiagnosisReport, Report, identity, method_name};
