//! Experiments with our own detectors: what they find, and how well it repeats.

pub mod figures;
pub mod maps;
pub mod poses;
pub mod reliability;
pub mod selection;
pub mod shrec11;
pub mod sides;
pub mod tolerance;
pub mod tracks;
