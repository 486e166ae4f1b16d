//! Which axes are those of space, and where they lie.
use super::header::Header;
use super::vectors::vectors;
use crate::error::Fault;
use crate::loaded::{World, WorldAxes};
use crate::{Affine, Samples};
use mser3d_shape::vector::{cross, norm};

/// The axes of the array, the first fastest.
pub(super) struct Axes {
    sizes: Vec<usize>,
    kinds: Vec<String>,
    /// The step of each axis in the space; none where the file has no `space directions`.
    directions: Option<Vec<Option<[f64; 3]>>>,
    /// The axes of space, at most three.
    space: Vec<usize>,
}

/// Kinds of axes along which the samples are parts of one value, not places.
fn is_of_values(kind: &str) -> bool {
    !matches!(kind, "domain" | "space" | "time" | "???" | "none" | "")
}

impl Axes {
    pub fn of(header: &Header, notes: &mut Vec<String>) -> Result<Self, Fault> {
        let sizes: Vec<usize> = header.numbers("sizes")?;
        let count = header.numbers::<usize>("dimension")?.first().copied().unwrap_or_default();
        if sizes.len() != count || !(1..=16).contains(&count) {
            let reason = format!("{count} axes of sizes {sizes:?}; NRRD has 1 to 16 axes, each with a size");
            return Err(Fault::invalid(reason));
        }
        let kinds = header.words("kinds").into_iter().map(|kind| kind.to_ascii_lowercase()).collect();
        let mut axes = Self { sizes, kinds, directions: axes_directions(header, count)?, space: Vec::new() };
        axes.space = axes.find_space(header, notes)?;
        if axes.space.len() > 3 {
            let reason =
                format!("{} axes of space, sizes {:?}; a volume has 3", axes.space.len(), axes.sizes);
            return Err(Fault::unsupported(reason));
        }
        if axes.space.is_empty() {
            return Err(Fault::unsupported("no axis is one of space; name them by kinds: domain"));
        }
        Ok(axes)
    }

    fn kind(&self, axis: usize) -> &str {
        self.kinds.get(axis).map_or("", String::as_str)
    }

    /// Those with a direction; else those whose kind and spacing do not say otherwise, and of four or more the first
    /// three.
    fn find_space(&self, header: &Header, notes: &mut Vec<String>) -> Result<Vec<usize>, Fault> {
        let all = 0..self.sizes.len();
        if let Some(directions) = &self.directions {
            return Ok(all.filter(|&axis| directions[axis].is_some()).collect());
        }
        let mut places: Vec<usize> = all.filter(|&axis| !is_of_values(self.kind(axis))).collect();
        if let Some(spacings) = header.per_axis("spacings", self.sizes.len())?
            && places.iter().any(|&axis| spacings[axis].is_finite())
        {
            places.retain(|&axis| !spacings[axis].is_nan());
        }
        if places.len() > 3 {
            places.retain(|&axis| self.kind(axis) != "time");
        }
        if places.len() > 3 {
            let sizes = &self.sizes;
            notes.push(format!(
                "nothing says which of the axes of sizes {sizes:?} are those of space; the first three were taken"
            ));
            places.truncate(3);
        }
        Ok(places)
    }

    /// Voxels along the three axes of space.
    pub fn dims(&self) -> [usize; 3] {
        std::array::from_fn(|i| self.space.get(i).map_or(1, |&axis| self.sizes[axis]))
    }

    fn others(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.sizes.len()).filter(|axis| !self.space.contains(axis))
    }

    /// Samples of a voxel, unless they are too many to count.
    pub fn channels(&self) -> Option<usize> {
        self.others().try_fold(1usize, |n, axis| n.checked_mul(self.sizes[axis]))
    }

    pub fn are_colours(&self) -> bool {
        self.others().all(|axis| self.sizes[axis] == 1 || self.kind(axis).contains("color"))
    }

    /// The samples with the channels of a voxel side by side, wherever the file has them.
    pub fn arranged(&self, samples: Samples) -> Samples {
        let stride = |axis: usize| self.sizes[..axis].iter().product::<usize>();
        // From the fastest axis of the result to the slowest.
        let order: Vec<usize> = self.others().chain(self.space.iter().copied()).collect();
        if order.iter().is_sorted() {
            return samples;
        }
        let order: Vec<(usize, usize)> =
            order.into_iter().map(|axis| (self.sizes[axis], stride(axis))).collect();
        samples.permuted(|mut i| {
            let mut from = 0;
            for &(size, stride) in &order {
                from += i % size * stride;
                i /= size;
            }
            from
        })
    }

    /// Index to world, in right-anterior-superior where the space is one of the body.
    pub fn placement(
        &self,
        header: &Header,
        notes: &mut Vec<String>,
    ) -> Result<(Affine, World, String), Fault> {
        let Some(directions) = &self.directions else { return self.along_axes(header) };
        let space = header.text("space").unwrap_or_default().to_ascii_lowercase();
        let (signs, axes, told) = match space.trim_end_matches("-time") {
            "right-anterior-superior" | "ras" | "rast" => ([1., 1., 1.], WorldAxes::Ras, "in RAS"),
            "left-anterior-superior" | "las" | "last" => ([-1., 1., 1.], WorldAxes::Ras, "LAS turned to RAS"),
            "left-posterior-superior" | "lps" | "lpst" => {
                ([-1., -1., 1.], WorldAxes::Ras, "LPS turned to RAS")
            }
            "" => ([1.; 3], WorldAxes::File, "in a space without a name"),
            other => {
                if other == "3d-left-handed" {
                    notes.push("its space is of the left hand: what is seen in it is mirrored".to_owned());
                }
                ([1.; 3], WorldAxes::File, other)
            }
        };
        // No -0.
        let turn = |v: [f64; 3]| std::array::from_fn(|i| signs[i] * v[i] + 0.0);
        let mut steps: Vec<[f64; 3]> =
            self.space.iter().filter_map(|&axis| directions[axis]).map(turn).collect();
        complete(&mut steps);
        let origin = match header.text("space origin") {
            None => [0.0; 3],
            Some(text) => match vectors(text).as_deref() {
                Some([Some(origin)]) => turn(spatial(origin)),
                Some([None]) => [0.0; 3],
                _ => return Err(Fault::invalid(format!("space origin {text:?}; (x,y,z) is expected"))),
            },
        };
        let mut units: Vec<String> = header.words("space units").into_iter().take(3).collect();
        units.dedup();
        if units.len() > 1 {
            notes.push(format!("the axes of its space have different units, {}", units.join(" and ")));
        }
        let unit = match &units[..] {
            [one] if !matches!(one.as_str(), "" | "???" | "none") => Some(one.clone()),
            _ => None,
        };
        let affine = Affine::from_steps(origin, [steps[0], steps[1], steps[2]])?;
        Ok((affine, World { axes, unit }, format!("space directions, {told}")))
    }

    /// By `spacings`, or by the ends of each axis; without them the voxels are of size 1.
    fn along_axes(&self, header: &Header) -> Result<(Affine, World, String), Fault> {
        let count = self.sizes.len();
        let field = |name: &str| header.per_axis(name, count);
        let (spacings, mins, maxs) = (field("spacings")?, field("axis mins")?, field("axis maxs")?);
        let centres = header.words("centerings");
        let (mut spacing, mut origin) = ([1.0; 3], [0.0; 3]);
        let known = |numbers: &Option<Vec<f64>>, axis: usize| {
            numbers.as_ref().map(|n| n[axis]).filter(|x| x.is_finite())
        };
        let mut by_ends = false;
        for (place, &axis) in self.space.iter().enumerate() {
            let node = centres.get(axis).is_some_and(|centre| centre == "node");
            let (min, max) = (known(&mins, axis), known(&maxs, axis));
            let between = self.sizes[axis] as f64 - f64::from(node);
            let by_range = min.zip(max).map(|(min, max)| (max - min) / between).filter(|h| h.is_normal());
            let step = known(&spacings, axis).filter(|h| h.is_normal()).or(by_range);
            spacing[place] = step.unwrap_or(1.0);
            if let Some(min) = min {
                // Samples stand in the middle of cells unless the axis says that they stand on its nodes.
                origin[place] = if node { min } else { min + spacing[place] / 2.0 };
                by_ends = true;
            }
        }
        let mut units: Vec<String> = header.words("units");
        units = self.space.iter().filter_map(|&axis| units.get(axis).cloned()).collect();
        units.dedup();
        let unit = match &units[..] {
            [one] if !matches!(one.as_str(), "" | "???" | "none") => Some(one.clone()),
            _ => None,
        };
        let by = match (spacings.is_some(), by_ends) {
            (true, false) => "spacings alone, from the first voxel on",
            (true, true) => "spacings and axis mins",
            (false, true) => "axis mins and maxs",
            (false, false) => "nothing: voxels of size 1",
        };
        Ok((Affine::along_axes(origin, spacing)?, World { axes: WorldAxes::File, unit }, by.to_owned()))
    }
}

fn axes_directions(header: &Header, axes: usize) -> Result<Option<Vec<Option<[f64; 3]>>>, Fault> {
    let Some(text) = header.text("space directions") else { return Ok(None) };
    let vectors = vectors(text).filter(|vectors| vectors.len() == axes);
    let vectors =
        vectors.ok_or_else(|| Fault::invalid(format!("space directions {text:?} do not fit {axes} axes")))?;
    let step = |vector: Option<Vec<f64>>| {
        let step = spatial(&vector?);
        // A step in time alone leads nowhere in space.
        Some(step).filter(|step| step.iter().any(|&x| x != 0.0))
    };
    Ok(Some(vectors.into_iter().map(step).collect()))
}

/// The first three numbers of a vector, whose fourth is time; those of a plane lie at z = 0.
fn spatial(vector: &[f64]) -> [f64; 3] {
    std::array::from_fn(|i| vector.get(i).copied().unwrap_or(0.0))
}

/// Steps of length 1 at right angles to those that are there, for images of fewer axes.
fn complete(steps: &mut Vec<[f64; 3]>) {
    while steps.len() < 3 {
        let across = match steps[..] {
            [x, y] => cross(x, y),
            [x] => {
                // The axis of space that x is furthest from.
                let least = (0..3).fold(0, |m, i| if x[i].abs() < x[m].abs() { i } else { m });
                cross(x, std::array::from_fn(|i| f64::from(i == least)))
            }
            _ => [1.0, 0.0, 0.0],
        };
        let length = norm(across);
        steps.push(across.map(|x| if length > 0.0 { x / length } else { 0.0 }));
    }
}
