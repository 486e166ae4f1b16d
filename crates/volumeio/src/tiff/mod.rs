//! TIFF 6.0 and BigTIFF, a page for each layer (<https://www.itu.int/itudoc/itu-t/com16/tiff-fx/docs/tiff6.pdf>).
//!
//! Read here and not by the crate `tiff`: that one inverts values that are stored as white is zero, leaves bits of
//! bilevel pages packed, and reads no page without a directory.
mod codec;
mod description;
mod directory;
mod fax;
mod layout;
mod ome;
mod page;
mod spacing;
mod stack;
mod xml;

use crate::error::Fault;
use crate::loaded::{ChannelKind, LoadedVolume, World, WorldAxes};
use crate::volume::allowed_count;
use crate::{Affine, Samples, Volume, VolumeFormat};
use description::Description;
use directory::{Directory, Source};
use mser3d_fileio::ReadLimits;
use page::Page;
use stack::Stack;
use std::io::{Read, Seek};

pub(crate) fn read(reader: impl Read + Seek, limits: &ReadLimits) -> Result<LoadedVolume, Fault> {
    let (mut source, first) = Source::open(reader)?;
    let directories = source.directories(first)?;
    let mut notes = Vec::new();
    let main = main_series(&source, &directories, &mut notes)?;
    let (first, page) = &main[0];
    let description = Description::of(source.text(&directories[*first], 270).as_deref(), page)?;
    let stack = Stack::of(&description, &main, &source, &mut notes)?;
    let (spacing, unit, placed_by) =
        spacing::of(&source, &directories[*first], &description, stack.layers, &mut notes);
    what_is_kept(&source, &directories[*first], page, &mut notes);

    let dims = [page.width, page.height, stack.layers];
    let channels = stack.volumes.saturating_mul(page.samples);
    let count = allowed_count(dims, channels, page.value_bytes(), limits)?;
    // A page is there packed, unpacked and put together, beside the pages before it.
    let each = if stack.repeated.is_some() { count } else { count / stack.pages.len().max(1) };
    let bytes = (count as u64).saturating_add(4 * each as u64).saturating_mul(page.value_bytes() as u64);
    limits.check_memory(bytes, || {
        format!("it declares {} of {}", pages_of(stack.pages.len()), page.describe())
    })?;
    let values = match stack.repeated {
        Some(count) => page.repeated(count)?.read(&mut source)?,
        None => {
            let mut all: Option<Samples> = None;
            for &number in &stack.pages {
                let values = main[number].1.read(&mut source)?;
                match &mut all {
                    None => all = Some(values),
                    Some(all) => {
                        all.append(values);
                    }
                }
            }
            all.ok_or_else(|| Fault::invalid("the file has no page"))?
        }
    };
    let values = stack.arranged(values, page);
    let volume = Volume::new(dims, channels, Affine::along_axes([0.0; 3], spacing)?, values)?;
    let mut loaded = LoadedVolume::plain(volume, VolumeFormat::Tiff);
    if stack.volumes == 1 && (page.photometric == 2 || page.has_alpha) {
        loaded.channels = if page.samples > 1 { ChannelKind::Colours } else { ChannelKind::One };
    }
    loaded.world = World { axes: WorldAxes::Image, unit };
    loaded.placed_by = placed_by;
    loaded.notes = notes;
    Ok(loaded)
}

/// The pages of the largest series of like ones, with their numbers in the file. What is left out is noted.
fn main_series(
    source: &Source<impl Read + Seek>,
    directories: &[Directory],
    notes: &mut Vec<String>,
) -> Result<Vec<(usize, Page)>, Fault> {
    // Reduced copies and transparency masks are no layers, unless there is nothing else.
    let is_extra = |directory: &Directory| source.number(directory, 254).is_some_and(|kind| kind & 5 != 0);
    let only_extras = directories.iter().all(is_extra);
    let (mut pages, mut extras) = (Vec::new(), 0);
    for (number, directory) in directories.iter().enumerate() {
        if is_extra(directory) && !only_extras {
            extras += 1;
            continue;
        }
        pages.push((number, Page::of(source, directory)?));
    }
    if extras > 0 {
        notes.push(format!("{extras} reduced images or masks are left out"));
    }
    // Each page is compared with the first of each series.
    const MOST_SERIES: usize = 100;
    // The series with the most pages; of equally many the one with the largest pages.
    let mut series: Vec<Vec<(usize, Page)>> = Vec::new();
    for (number, page) in pages {
        match series.iter().position(|series| series[0].1.is_like(&page)) {
            Some(at) => series[at].push((number, page)),
            None if series.len() < MOST_SERIES => series.push(vec![(number, page)]),
            None => {
                let reason = format!("pages of more than {MOST_SERIES} sizes; export those of one size");
                return Err(Fault::unsupported(reason));
            }
        }
    }
    let rank = |s: &Vec<(usize, Page)>| (s.len(), s[0].1.width * s[0].1.height);
    let best = (0..series.len()).fold(0, |m, i| if rank(&series[i]) > rank(&series[m]) { i } else { m });
    let main = series.swap_remove(best);
    for other in series {
        let (left, read) = (other[0].1.describe(), main[0].1.describe());
        notes.push(format!(
            "left out: {} of {left}; read: {} of {read}",
            pages_of(other.len()),
            pages_of(main.len())
        ));
    }
    Ok(main)
}

fn pages_of(count: usize) -> String {
    if count == 1 { "1 page".to_owned() } else { format!("{count} pages") }
}

/// Notes what of the page's description does not change the values.
fn what_is_kept(
    source: &Source<impl Read + Seek>,
    directory: &Directory,
    page: &Page,
    notes: &mut Vec<String>,
) {
    match page.photometric {
        0 => notes.push("white is stored as 0 (an inverted look-up table); values are as stored".to_owned()),
        3 => notes.push("colours are numbers of a palette; the numbers are read".to_owned()),
        5 | 8 | 9 => notes.push("colours are not RGB (CMYK or Lab); values are as stored".to_owned()),
        _ => {}
    }
    if let Some(orientation) = source.number(directory, 274).filter(|&o| o != 1) {
        notes.push(format!("the tag Orientation is {orientation}, which is left out: rows are as stored"));
    }
}

#[cfg(test)]
mod tests;
