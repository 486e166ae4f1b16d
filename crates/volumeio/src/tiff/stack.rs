//! Which pages are layers, and which are other volumes: points in time, or channels.
use super::description::Description;
use super::directory::Source;
use super::page::Page;
use crate::Samples;
use crate::error::Fault;
use std::collections::HashMap;
use std::io::{Read, Seek};

/// How the pages of the main series make volumes.
pub(super) struct Stack {
    /// The pages to read, by their numbers in the series.
    pub pages: Vec<usize>,
    /// So many images follow the first one without directories.
    pub repeated: Option<usize>,
    pub layers: usize,
    pub volumes: usize,
    /// The axes of the pages, fastest first: length, and whether it is that of layers.
    axes: Vec<(usize, bool)>,
}

/// ImageJ shows so many channels at once; what has more channels in one layer has layers without the right name.
const MOST_CHANNELS: usize = 7;

impl Stack {
    pub fn of(
        description: &Description,
        main: &[(usize, Page)],
        source: &Source<impl Read + Seek>,
        notes: &mut Vec<String>,
    ) -> Result<Self, Fault> {
        let found = main.len();
        let mut pages: Vec<usize> = (0..found).collect();
        let (mut axes, program) = match description {
            Description::ImageJ(ij) => {
                let count = |key| ij.count(key).unwrap_or(1);
                let mut axes = vec![('C', count("channels")), ('Z', count("slices")), ('T', count("frames"))];
                if let Some(images) = ij.count("images")
                    && product(&axes) != Some(images)
                {
                    axes = vec![('Z', images)];
                }
                (axes, "ImageJ")
            }
            Description::Ome(ome) => {
                if ome.others > 0 {
                    notes.push(format!("the OME-XML has {} more images, which are left out", ome.others));
                }
                if let Some(planes) = &ome.pages {
                    let numbers = main.iter().enumerate().map(|(at, (number, _))| (*number, at));
                    let numbers: HashMap<usize, usize> = numbers.collect();
                    let in_series = |page: &usize| numbers.get(page).copied();
                    pages = planes.iter().map(in_series).collect::<Option<_>>().ok_or_else(|| {
                        Fault::invalid(
                            "the OME-XML of the file names a page that is not there, or of another size",
                        )
                    })?;
                }
                (ome.axes.clone(), "the OME-XML")
            }
            Description::Shaped(shaped) => (shaped.axes.iter().rev().copied().collect(), "the description"),
            Description::None => (vec![('Z', found)], ""),
        };
        let promised = product(&axes).unwrap_or(usize::MAX);
        let mut repeated = None;
        if promised != pages.len() {
            let page = &main[0].1;
            if found == 1 && page.has_room(source, promised) && promised > 1 {
                repeated = Some(promised);
                notes.push(format!(
                    "{promised} images follow each other with one directory, as {program} says"
                ));
            } else if found == 1 && page.has_room(source, 2) {
                return Err(Fault::invalid(format!(
                    "{program} promises {promised} images, but the file is too short for them; copy or export it again"
                )));
            } else {
                notes.push(format!(
                    "{program} promises {promised} images, but there are {found}: these are the layers"
                ));
                axes = vec![('Z', found)];
                pages = (0..found).collect();
            }
        }
        if !axes.iter().any(|&(letter, n)| letter == 'Z' && n > 1) {
            one_axis_is_z(&mut axes, main[0].1.samples, notes);
        }
        let size =
            |layers: bool| axes.iter().filter(|axis| (axis.0 == 'Z') == layers).map(|axis| axis.1).product();
        Ok(Self {
            pages,
            repeated,
            layers: size(true),
            volumes: size(false),
            axes: axes.iter().map(|&(letter, n)| (n, letter == 'Z')).collect(),
        })
    }

    /// Values page by page in the order of a [`Volume`](crate::Volume): x, y, layers, with channels side by side.
    pub fn arranged(&self, values: Samples, page: &Page) -> Samples {
        if self.volumes == 1 {
            return values;
        }
        let (area, samples) = (page.width * page.height, page.samples);
        let channels = self.volumes * samples;
        // The page of each layer of each volume.
        let mut of = vec![0; self.volumes * self.layers];
        for number in 0..of.len() {
            let (mut rest, mut layer, mut layers, mut volume, mut volumes) = (number, 0, 1, 0, 1);
            for &(n, is_layer) in &self.axes {
                let (at, many) =
                    if is_layer { (&mut layer, &mut layers) } else { (&mut volume, &mut volumes) };
                *at += rest % n * *many;
                *many *= n;
                rest /= n;
            }
            of[volume * self.layers + layer] = number;
        }
        values.permuted(|i| {
            let (voxel, channel) = (i / channels, i % channels);
            let (volume, sample) = (channel / samples, channel % samples);
            let page = of[volume * self.layers + voxel / area];
            (page * area + voxel % area) * samples + sample
        })
    }
}

fn product(axes: &[(char, usize)]) -> Option<usize> {
    axes.iter().try_fold(1usize, |n, axis| n.checked_mul(axis.1))
}

/// Stacks are often saved as a series in time, or of very many channels, or of channels that have colours.
fn one_axis_is_z(axes: &mut Vec<(char, usize)>, samples: usize, notes: &mut Vec<String>) {
    axes.retain(|axis| axis.1 > 1);
    if let [(letter, n)] = axes[..]
        && (letter != 'C' || n > MOST_CHANNELS || samples > 1)
    {
        match letter {
            'C' => notes.push(format!("{n} channels of one layer were taken as {n} layers")),
            'T' => notes.push(format!("{n} points in time of one layer were taken as {n} layers")),
            _ => {}
        }
        axes[0].0 = 'Z';
    }
}
