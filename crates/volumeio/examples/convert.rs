//! Volumes from any format to NumPy's or NIfTI: `convert IN OUT [IN OUT ...]`, where each OUT ends in `.npy`, `.nii`
//! or `.nii.gz`. Says what each file holds, a line of JSON for each.

use mser3d_volumeio::{VolumeIoError, read_volume, write_nifti_in, write_npy};
use std::error::Error;
use std::path::Path;

/// Reads, writes, and says what was read.
pub fn convert(from: &Path, to: &Path) -> Result<serde_json::Value, VolumeIoError> {
    let loaded = read_volume(from, &Default::default())?;
    let volume = &loaded.volume;
    match to.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("npy")) {
        true => write_npy(to, volume)?,
        false => write_nifti_in(to, volume, loaded.world.unit.as_deref())?,
    }
    let segment = |s: &mser3d_volumeio::Segment| serde_json::json!([s.value, s.layer, s.name]);
    Ok(serde_json::json!({
        "dims": volume.dims(),
        "channels": volume.channels(),
        "kind": loaded.channels.to_string(),
        "type": volume.samples().type_name(),
        "affine": volume.affine().matrix(),
        "world": loaded.world.to_string(),
        "placed_by": loaded.placed_by,
        "segments": loaded.segments.iter().map(segment).collect::<Vec<_>>(),
        "notes": loaded.notes,
    }))
}

/// Runs the example.
#[allow(dead_code)] // The tests call what it is made of.
pub fn main() -> Result<(), Box<dyn Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() {
        return Err("which files? convert IN OUT [IN OUT ...]".into());
    }
    let mut failed = 0;
    for pair in files.chunks(2) {
        let [from, to] = pair else { return Err("give pairs of files: convert IN OUT [IN OUT ...]".into()) };
        match convert(from.as_ref(), to.as_ref()) {
            Ok(said) => println!("{said}"),
            Err(error) => {
                failed += 1;
                println!("{}", serde_json::json!({ "error": error.to_string() }));
            }
        }
    }
    if failed > 0 { Err(format!("{failed} files were not read").into()) } else { Ok(()) }
}
