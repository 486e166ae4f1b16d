//! Results as pages for the browser.

use mser3d::comptree::Polarity;
use mser3d::descriptors::TimeScale;
use mser3d_viewer::{
    PageData, PagePart, PageParts, PageRegion, PageShape, PageTree, RegionPair, Rgb, Up, page, region_colours,
};

use crate::results::traits;
use crate::{PartRecord, RegionRecord, Results, ResultsError, left_and_right, matched_colours};

impl Results {
    /// A page that shows these results in a browser: the parts first, where there are any, then the regions. It counts its views from
    /// the body's own front, where that can be told ([`Results::front`]).
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn page(&self, title: &str, up: Up) -> Result<String, ResultsError> {
        let shapes = vec![self.page_shape(up)];
        let (matches, part_matches) = (Vec::new(), Vec::new());
        Ok(page(&PageData { title: title.to_owned(), shapes, matches, part_matches, up })?)
    }

    /// A page of two shapes beside each other, in [`matched_colours`], each seen from its own front. Where both have parts they are
    /// shown first, and are matched as the regions that they grew from are ([`matched_parts`]).
    ///
    /// # Errors
    /// [`ResultsError::Viewer`], also for a match of regions that are not there.
    pub fn match_page(
        &self,
        other: &Self,
        matches: &[RegionPair],
        title: &str,
        up: Up,
    ) -> Result<String, ResultsError> {
        let mut shapes = vec![self.page_shape(up), other.page_shape(up)];
        for (shape, colours) in shapes.iter_mut().zip(matched_colours(self, other, matches)) {
            shape.regions.iter_mut().zip(colours).for_each(|(region, colour)| region.colour = colour);
        }
        let mut part_matches = Vec::new();
        if shapes.iter().all(|shape| shape.parts.is_some()) {
            part_matches = matched_parts(self, other, matches);
            let [first, second] = [self.with_parts_as_regions()?, other.with_parts_as_regions()?];
            let colours = matched_colours(&first, &second, &part_matches);
            for (parts, colours) in shapes.iter_mut().filter_map(|shape| shape.parts.as_mut()).zip(colours) {
                parts.list.iter_mut().zip(colours).for_each(|(part, colour)| part.colour = colour);
            }
        } else {
            // Beside parts that have none to be matched with, regions say more.
            shapes.iter_mut().for_each(|shape| shape.parts = None);
        }
        let (title, matches) = (title.to_owned(), matches.to_vec());
        Ok(page(&PageData { title, shapes, matches, part_matches, up })?)
    }

    /// These results as one shape of a page.
    fn page_shape(&self, up: Up) -> PageShape<'_> {
        let colours = self.colours();
        // Trees of several bodies do not share a level, and a page shows only what enters its tree.
        let all_enter = self.trees.iter().all(|tree| !tree.entry.contains(&u32::MAX));
        let one = self.record.bodies.len() == 1 && all_enter;
        let regions = self.record.regions.iter().enumerate().map(|(id, r)| PageRegion {
            colour: colours[id],
            parent: r.parent,
            altitude: r.altitude,
            stability: r.stability,
            reliability: r.reliability,
            lifetime: r.lifetime,
            twin: r.twin,
            side: r.side,
            volume: r.volume,
            volume_fraction: r.volume_fraction,
            vertices: &self.region_vertices[id],
            voxels: &self.region_voxels[id],
            node: self.node(id).filter(|_| one).map(|node| [r.tree, node]),
        });
        let trees =
            self.record.trees.iter().zip(&self.trees).filter(|_| one).map(|(record, tree)| PageTree {
                name: tree_name(record.time_scale),
                superlevel: record.polarity == Polarity::Superlevel,
                parents: &tree.parents,
                altitudes: &tree.altitudes,
                volumes: &tree.volumes,
                entry: &tree.entry,
            });
        PageShape {
            name: self.name(),
            front: self.front(up),
            mesh: &self.mesh,
            grid: self.grid.as_ref(),
            vertex_voxel: &self.vertex_voxel,
            regions: regions.collect(),
            parts: self.page_parts(),
            grey: None,
            trees: trees.collect(),
            facts: self.facts(up),
        }
    }

    fn page_parts(&self) -> Option<PageParts<'_>> {
        let (records, regions) = (self.record.parts.as_ref()?, self.part_records()?);
        let colours = region_colours(&traits(&regions), &self.vertex_part, &self.mesh.edge_graph());
        let part = |((part, as_region), &colour): ((&PartRecord, &RegionRecord), &Rgb)| PagePart {
            colour,
            trunk: part.trunk,
            region: part.region,
            twins: part.twins.clone(),
            side: as_region.side,
            volume: part.volume,
            volume_fraction: part.volume_fraction,
        };
        let list = records.iter().zip(&regions).zip(&colours).map(part).collect();
        Some(PageParts { list, vertices: &self.vertex_part, voxels: &self.voxel_part })
    }

    fn facts(&self, up: Up) -> Vec<[String; 2]> {
        let fact = |name: &str, value: String| [name.to_owned(), value];
        let mut facts = vec![
            fact("vertices", self.mesh.vertices().len().to_string()),
            fact("triangles", self.mesh.triangles().len().to_string()),
        ];
        if let Some(grid) = &self.grid {
            facts.push(fact("voxels", grid.len().to_string()));
            facts.push(fact("pitch", format!("{:.4}", grid.frame().spacing()[0])));
        }
        facts.push(fact("eigenpairs", self.eigenvalues.iter().map(Vec::len).sum::<usize>().to_string()));
        if !self.record.input.path.is_empty() {
            facts.push(fact("input", self.record.input.path.clone()));
        }
        facts.push(fact("weight", self.record.parameters.weight.to_string()));
        let bodies = &self.record.bodies;
        let sides = bodies.iter().map(|body| left_and_right(body.sidedness)).enumerate();
        facts.extend(sides.filter_map(|(body, told)| {
            let of_body = if bodies.len() > 1 { format!(" of body {body}") } else { String::new() };
            Some(fact(&format!("left and right{of_body}"), told?))
        }));
        if self.record.parts.is_some() {
            facts.push(fact("front", front_told(self.front(up), up)));
        }
        facts.push(fact("mser3d", self.record.mser3d.clone()));
        facts
    }
}

fn tree_name(scale: Option<TimeScale>) -> String {
    match scale {
        Some(TimeScale::Relative(t)) => format!("t_rel = {t}"),
        Some(TimeScale::Absolute(t)) => format!("t = {t}"),
        None => "commute time".to_owned(),
    }
}

/// The parts of two shapes whose regions are matched: those that grew from a region and from its partner.
pub fn matched_parts(first: &Results, second: &Results, matches: &[RegionPair]) -> Vec<RegionPair> {
    let from = |results: &Results, region: u32| {
        let parts = results.record.parts.as_ref()?;
        parts.iter().find(|part| part.region == Some(region)).map(|part| part.id)
    };
    let parts = |pair: &RegionPair| {
        let (first, second) = (from(first, pair.first)?, from(second, pair.second)?);
        Some(RegionPair { first, second, ..*pair })
    };
    matches.iter().filter_map(parts).collect()
}

/// Which way the front looks, in words.
fn front_told(front: Option<f64>, up: Up) -> String {
    let [ahead, aside] = match up {
        Up::Y => ["+z", "x"],
        Up::Z => ["-y", "x"],
    };
    match front.map(f64::round) {
        None => format!("not told by the parts: {ahead} of the file"),
        Some(0.0) => format!("told by the parts: {ahead}"),
        Some(angle) => {
            let sign = if angle < 0.0 { '-' } else { '+' };
            format!("told by the parts: {}° from {ahead} to {sign}{aside}", angle.abs())
        }
    }
}
