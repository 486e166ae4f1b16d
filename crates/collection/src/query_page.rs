use std::collections::BTreeMap;

use mser3d_results::{Image, RenderOptions, Results, Up, side_text};
use mser3d_viewer::{Gallery, GalleryPicture, GalleryRow, NO_REGION, Rgb, gallery};

use crate::{CollectionError, DescribedResult, Index, RegionHits};

/// Height of a picture in pixels; the page shows it at half of that.
const HEIGHT: usize = 300;
/// The page is meant to be sent and opened from disk.
const LARGEST_PAGE: usize = 10_000_000;

impl Index {
    /// One HTML file with what was found: a row for each region of the shape that was searched for, with
    /// its picture and those of the regions closest to it, all in its colour.
    ///
    /// `found` is what [`nearest`](Self::nearest) gives, or a part of it.
    ///
    /// Cost: reads the result of each shape that is seen, lights it once, and draws one picture for each
    /// hit: some 50 ms CPU a picture and 200 ms a shape of 10^4 vertices.
    ///
    /// # Errors
    /// [`CollectionError::Results`] for a shape whose result is gone; [`CollectionError::LargePage`] beyond
    /// 10 MB.
    pub fn page(
        &self,
        shape: &DescribedResult,
        found: &[RegionHits],
        up: Up,
    ) -> Result<String, CollectionError> {
        let colours = shape.results.colours();
        let options = RenderOptions { height: HEIGHT, up, ..RenderOptions::default() };
        let colour = |region: u32| colours.get(region as usize).copied().unwrap_or(NO_REGION);
        let own: Vec<(u32, Rgb)> = found.iter().map(|hits| (hits.region, colour(hits.region))).collect();
        let own = shape.results.region_pictures(&own, &options)?;

        // Each shape of the collection is read and lit once, for all its pictures.
        let mut wanted: BTreeMap<&str, Vec<(u32, Rgb)>> = BTreeMap::new();
        for RegionHits { region, closest } in found {
            for hit in closest {
                wanted.entry(&hit.shape).or_default().push((hit.region, colour(*region)));
            }
        }
        let mut drawn: BTreeMap<&str, std::vec::IntoIter<Image>> = BTreeMap::new();
        for (name, pictures) in wanted {
            let results = Results::load(&self.folder().join(name))?;
            drawn.insert(name, results.region_pictures(&pictures, &options)?.into_iter());
        }

        let numbers = |fraction: f64, side: Option<f64>| {
            let side = side.map_or(String::new(), |side| format!(", side {}", side_text(side)));
            format!("{:.1} %{side}", 100.0 * fraction)
        };
        let mut rows = Vec::with_capacity(found.len());
        for (RegionHits { region, closest }, image) in found.iter().zip(own) {
            let own = &shape.results.record.regions[*region as usize];
            let subject = GalleryPicture {
                image,
                label: format!("Region {region}"),
                numbers: numbers(own.volume_fraction, own.side),
            };
            // The pictures come back in the order in which they were asked for.
            let others = closest.iter().filter_map(|hit| {
                Some(GalleryPicture {
                    image: drawn.get_mut(hit.shape.as_str())?.next()?,
                    label: format!("{}, region {}", hit.shape, hit.region),
                    numbers: format!(
                        "distance {:.4}, {}",
                        hit.distance,
                        numbers(hit.volume_fraction, hit.side)
                    ),
                })
            });
            rows.push(GalleryRow { subject, others: others.collect() });
        }
        let of_hits = found.iter().flat_map(|hits| hits.closest.iter().map(|hit| hit.side));
        let mut sides = shape.results.record.regions.iter().map(|region| region.side).chain(of_hits);
        let words = match sides.any(|side| side.is_some()) {
            true => " The side runs from -1 on one side of the body to +1 on the other.",
            false => "",
        };
        let pictures = rows.iter().map(|row| 1 + row.others.len()).sum();
        let html = gallery(&Gallery {
            title: format!("Regions like those of {}", shape.results.name()),
            lead: format!(
                "Left, a region and its share of the {}; beside it, the regions of the collection \"{}\" whose \
                 descriptors are closest to its, nearest first, of {} searched.{words}",
                match shape.results.domain() {
                    mser3d::Domain::Volume => "volume",
                    mser3d::Domain::Surface => "area",
                },
                self.folder().file_name().unwrap_or_default().to_string_lossy(),
                self.len(),
            ),
            rows,
        })
        .map_err(mser3d_results::ResultsError::from)?;
        if html.len() > LARGEST_PAGE {
            return Err(CollectionError::LargePage { bytes: html.len(), limit: LARGEST_PAGE, pictures });
        }
        Ok(html)
    }
}
