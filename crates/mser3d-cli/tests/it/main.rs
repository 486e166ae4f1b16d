//! The program as users meet it: its files, words, exit codes, and what its documentation promises.

mod cases;
mod collections;
mod common;
#[cfg(unix)]
mod corners;
#[cfg(unix)]
mod docs;
#[cfg(unix)]
mod every_command;
mod failures;
#[cfg(unix)]
mod faults;
#[cfg(unix)]
mod kills;
mod libraries;
mod limits;
mod maps;
mod msv;
mod names;
mod outputs;
mod results;
mod shell;
mod sides;
mod signatures;
#[cfg(unix)]
mod system;
mod track;
mod volumes;
mod voxelize;
mod weights;
#[cfg(unix)]
mod whole;
