use mser3d_shape::vector::{Vec3, add, dot, scale, sub, unit};

use crate::{PartRecord, RegionRecord, Results, ResultsError};

/// The cosine from which a direction is the one across the body, forwards or back.
const ALONG: f64 = 0.7;

impl Results {
    /// The same with the parts in place of the regions, to draw them and to give them to other programs as regions are. What
    /// only regions have, such as a stability, is missing then, and so are the trees.
    ///
    /// # Errors
    /// [`ResultsError::NoParts`] where no parts were asked for.
    pub fn with_parts_as_regions(&self) -> Result<Self, ResultsError> {
        let Some(parts) = self.part_records() else {
            return Err(ResultsError::NoParts { path: self.record.input.path.clone() });
        };
        let mut results = self.clone();
        results.record.regions = parts;
        results.record.parts = None;
        let count = results.record.regions.len();
        results.region_vertices = members(&self.vertex_part, count);
        results.region_voxels = members(&self.voxel_part, count);
        (results.vertex_part, results.voxel_part) = (Vec::new(), Vec::new());
        results.trees = Vec::new();
        (results.descriptors, results.descriptor_width, results.cosines) = (Vec::new(), 0, Vec::new());
        Ok(results)
    }

    /// The parts as far as they are like regions; none where there are none.
    pub(crate) fn part_records(&self) -> Option<Vec<RegionRecord>> {
        let parts = self.record.parts.as_ref()?;
        let mut records: Vec<RegionRecord> =
            parts.iter().map(|part| as_region(part, parts, &self.record.regions)).collect();
        add_sides(&mut records, &self.joints(parts));
        Some(records)
    }
}

/// The mirror image of a part: one that is alone; of several, that of the twin of the region it is like.
pub(crate) fn twin_of(part: &PartRecord, parts: &[PartRecord], regions: &[RegionRecord]) -> Option<u32> {
    if let [twin] = part.twins[..] {
        return Some(twin);
    }
    let region_twin = regions.get(part.region? as usize)?.twin?;
    let of_twin = |twin: &&u32| parts.get(**twin as usize).is_some_and(|p| p.region == Some(region_twin));
    part.twins.iter().find(of_twin).copied()
}

/// A part as far as it is like a region. Its side is that of the region it is like.
fn as_region(part: &PartRecord, parts: &[PartRecord], regions: &[RegionRecord]) -> RegionRecord {
    let region = part.region.and_then(|region| regions.get(region as usize));
    RegionRecord {
        id: part.id,
        parent: None,
        body: part.body,
        tree: 0,
        altitude: f64::NAN,
        stability: f64::NAN,
        reliability: None,
        lifetime: None,
        twin: twin_of(part, parts, regions),
        side: region.and_then(|region| region.side),
        volume: part.volume,
        volume_fraction: part.volume_fraction,
        voxels: part.voxels,
        vertices: part.vertices,
        centroid: part.centroid,
        tip: part.centroid,
        oriented_box: part.oriented_box,
        track: None,
        colour: None,
    }
}

/// Gives twins whose sides no region tells those of the other twins: the sides on which they meet the trunk.
fn add_sides(parts: &mut [RegionRecord], joints: &[Option<Vec3>]) {
    let pairs: Vec<[usize; 2]> = parts
        .iter()
        .filter_map(|part| {
            part.twin.filter(|twin| part.id < *twin).map(|twin| [part.id as usize, twin as usize])
        })
        .collect();
    let between = |[a, b]: [usize; 2]| Some(unit(sub(joints[a]?, joints[b]?)));
    let mut across = [0.0; 3];
    for &[a, b] in &pairs {
        match [parts[a].side, parts[b].side] {
            [Some(side), None] => parts[b].side = Some(-side),
            [None, Some(side)] => parts[a].side = Some(-side),
            _ => {}
        }
        if let (Some(p), Some(q), Some(direction)) = (parts[a].side, parts[b].side, between([a, b])) {
            across = add(across, scale(direction, 0.5 * (p - q)));
        }
    }
    for [a, b] in pairs {
        let cosine = between([a, b]).map_or(0.0, |direction| dot(direction, unit(across)));
        if parts[a].side.is_none() && parts[b].side.is_none() && cosine.abs() > ALONG {
            (parts[a].side, parts[b].side) = (Some(cosine), Some(-cosine));
        }
    }
}

/// What each label is given to.
fn members(labels: &[i32], count: usize) -> Vec<Vec<u32>> {
    let mut members = vec![Vec::new(); count];
    for (number, &label) in (0..).zip(labels) {
        if let Some(own) = usize::try_from(label).ok().and_then(|label| members.get_mut(label)) {
            own.push(number);
        }
    }
    members
}
