//! Header and data in two files, `.hdr` and `.img`, each of which may be packed.
use crate::bytes::beside;
use crate::error::Fault;
use mser3d_fileio::ReadLimits;
use std::path::{Path, PathBuf};

pub(super) struct Pair {
    pub header: PathBuf,
    pub data: PathBuf,
}

/// Both files of a pair, found from either; none for a name of a single file.
pub(super) fn files(path: &Path, limits: &ReadLimits) -> Result<Option<Pair>, Fault> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let lower = name.to_ascii_lowercase();
    let packed = lower.ends_with(".gz");
    let without = if packed { name.len() - 3 } else { name.len() };
    let stem = match lower.get(..without) {
        Some(lower) if lower.ends_with(".hdr") || lower.ends_with(".img") => &name[..without - 4],
        _ => return Ok(None),
    };
    let is_header = lower[..without].ends_with(".hdr");
    let (own, partner) = if is_header { ("hdr", "img") } else { ("img", "hdr") };
    let capitals = name[..without].ends_with(&own.to_ascii_uppercase());
    let partner = if capitals { partner.to_ascii_uppercase() } else { partner.to_owned() };
    let named = |ending: &str| format!("{stem}.{partner}{ending}");
    let endings = if packed { [".gz", ""] } else { ["", ".gz"] };
    let found = endings.into_iter().map(named).find(|name| path.with_file_name(name).exists()).ok_or_else(|| {
        let what = if is_header { "data" } else { "header" };
        Fault::invalid(format!(
            "its {what}, {stem}.{partner} or {stem}.{partner}.gz, is missing; both files of a pair belong into the \
             same folder"
        ))
    })?;
    let found = beside(path, &found, limits)?;
    let own = path.to_path_buf();
    let (header, data) = if is_header { (own, found) } else { (found, own) };
    Ok(Some(Pair { header, data }))
}
