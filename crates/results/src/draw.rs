use mser3d_viewer::{
    Cut, Image, LegendEntry, MISTAKE, Model, NO_REGION, PALETTE, Panel, RegionPair, RenderOptions, Rgb, Up,
    View, ViewerError, label_colour, linked_colours, region_colours, render, render_with_legend,
};

use crate::{Drawing, RegionRecord, Results, ResultsError};

/// How much of its colour a region loses that is never found again.
const FAINT: f32 = 0.7;
/// From before and from behind.
const BOTH_SIDES: [View; 2] = [View::THREE_QUARTER, View { azimuth: 215.0, elevation: 12.0 }];

impl Results {
    /// The voxels in the colours of their regions, those beyond a cut left out; `None` for a surface.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn voxel_model(&self, cut: Option<&Cut>) -> Result<Option<Model>, ResultsError> {
        let Some(grid) = &self.grid else { return Ok(None) };
        let colours = self.colours();
        let voxels: Vec<Rgb> = self.voxel_region().iter().map(|&l| label_colour(&colours, l)).collect();
        Ok(Some(Model::from_voxels(grid, &voxels, cut)?))
    }

    /// A plane that opens the shape towards a viewer before it: across an axis (0 to 2), by default the shorter horizontal one, leaving a
    /// share of the extent, 0 to 1; by default half of the volume, which lies in the trunk wherever limbs reach. `front` is the azimuth of the
    /// front ([`Results::front`]).
    pub fn cut(&self, axis: Option<usize>, kept: Option<f64>, up: Up, front: f64) -> Option<Cut> {
        let bounds = self.mesh.bounding_box()?;
        let [right, vertical, toward] = up.axes();
        let depth = if toward[2] == 0.0 { 1 } else { 2 };
        let extent = bounds.extent();
        let shorter = if extent[0] < extent[depth] { 0 } else { depth };
        let axis = axis.unwrap_or(shorter).min(2);
        let (sin, cos) = View::THREE_QUARTER.turned(front).azimuth.to_radians().sin_cos();
        let viewer = cos * toward[axis] + sin * right[axis] + vertical[axis];
        let across = |share: f64| Cut::across(&bounds, axis, share);
        let seen_from_behind = viewer < 0.0;
        let cut = match kept {
            Some(kept) if seen_from_behind => across(1.0 - kept),
            Some(kept) => across(kept),
            None => {
                let middle = self.middle(axis).unwrap_or(0.5 * (bounds.min[axis] + bounds.max[axis]));
                Cut { offset: middle, ..across(0.5) }
            }
        };
        Some(if seen_from_behind { cut.flipped() } else { cut })
    }

    /// Where along an axis half of the voxels lie on either side, between two of their layers.
    fn middle(&self, axis: usize) -> Option<f64> {
        let grid = self.grid.as_ref()?;
        let mut centres: Vec<f64> = grid.voxels().map(|voxel| grid.frame().centre(voxel)[axis]).collect();
        centres.sort_by(f64::total_cmp);
        Some(centres.get(centres.len() / 2)? + 0.5 * grid.frame().spacing()[axis])
    }

    /// One sheet: the regions from four sides, the body's own front first, and, of a volume, inside.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn sheet(&self, options: &RenderOptions) -> Result<Image, ResultsError> {
        let drawing = Drawing::new(self)?;
        let colours = self.colours();
        let model = drawing.regions(&colours)?;
        let front = self.front(options.up).unwrap_or(0.0);
        let mut panels = Panel::around(&model);
        panels.iter_mut().for_each(|panel| panel.view = panel.view.turned(front));
        let cut = self.cut(None, None, options.up, front).filter(|_| self.grid.is_some());
        let inside = cut.map(|cut| drawing.section(&colours, &cut)).transpose()?;
        if let Some(model) = &inside {
            let view = View::THREE_QUARTER.turned(front);
            panels.push(Panel { model, view, caption: "inside".to_owned() });
        }
        Ok(render_with_legend(&panels, &self.legend("region"), options)?)
    }

    /// What the colours of the regions mean: a line for each hue, with the regions' numbers and their share of the volume or area.
    /// `what` says what they are: regions, or parts.
    pub fn legend(&self, what: &str) -> Vec<LegendEntry> {
        let colours = self.colours();
        let shares = |ids: &[u32]| {
            let share =
                |id: &u32| format!("{:.1} %", 100.0 * self.record.regions[*id as usize].volume_fraction);
            let shares: Vec<String> = ids.iter().map(share).collect();
            if shares.iter().all(|s| *s == shares[0]) { shares[0].clone() } else { shares.join(", ") }
        };
        let text = |ids: &[u32]| {
            let plural = if ids.len() > 1 { "s" } else { "" };
            format!("{what}{plural} {}: {}", numbers(ids), shares(ids))
        };
        self.legend_of(&colours, text, &format!("in no {what}"))
    }

    /// A line for each region and its twin that have a colour of their own; the colours' text is that of their numbers.
    fn legend_of(&self, colours: &[Rgb], text: impl Fn(&[u32]) -> String, rest: &str) -> Vec<LegendEntry> {
        let regions = &self.record.regions;
        let own_colours = self.with_own_colour(colours);
        let own = |r: &RegionRecord| own_colours[r.id as usize];
        let mut entries: Vec<LegendEntry> = regions
            .iter()
            .filter(|r| own(r) && r.twin.is_none_or(|twin| r.id < twin || !own(&regions[twin as usize])))
            .map(|r| {
                let ids: Vec<u32> = [Some(r.id), r.twin.filter(|twin| own(&regions[*twin as usize]))]
                    .into_iter()
                    .flatten()
                    .collect();
                let mut squares: Vec<Rgb> = ids.iter().map(|id| colours[*id as usize]).collect();
                squares.dedup();
                LegendEntry { colours: squares, text: text(&ids) }
            })
            .collect();
        let toned = |entry: &LegendEntry| entry.colours.len() > 1;
        let sides = entries.iter().any(toned);
        let seen = |label: &i32| usize::try_from(*label).map_or(true, |label| colours[label] == NO_REGION);
        if self.vertex_region().iter().any(seen) {
            entries.push(LegendEntry { colours: vec![NO_REGION], text: rest.to_owned() });
        }
        if sides {
            entries.push(LegendEntry {
                colours: Vec::new(),
                text: "light and dark: one side and the other".to_owned(),
            });
        }
        entries
    }

    /// Each region by itself, by falling reliability: on the grey shape, the fainter the less reliable it is, from before or from behind,
    /// whichever it faces more.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn multiples(&self, options: &RenderOptions) -> Result<Image, ResultsError> {
        let regions = &self.record.regions;
        let mut order: Vec<&RegionRecord> = regions.iter().collect();
        let sure = |r: &RegionRecord| r.reliability.unwrap_or(0.0);
        order.sort_by(|a, b| sure(b).total_cmp(&sure(a)).then(a.id.cmp(&b.id)));
        let drawing = Drawing::new(self)?;
        let traits = self.traits();
        let front = self.front(options.up).unwrap_or(0.0);
        let views = BOTH_SIDES.map(|view| view.turned(front));
        let mut models = Vec::with_capacity(order.len());
        for region in &order {
            let colour = PALETTE[0].tone(traits[region.id as usize].side);
            let colour = colour.mix(NO_REGION, FAINT * (1.0 - region.reliability.unwrap_or(1.0)) as f32);
            let model = drawing.one(region.id, colour)?;
            let view = self.facing(region.id, options.up, views);
            let sure = region.reliability.map_or_else(String::new, |sure| format!(", found again {sure:.2}"));
            let caption = format!("{}: {:.1} %{sure}", region.id, 100.0 * region.volume_fraction);
            models.push((model, view, caption));
        }
        let panels: Vec<Panel<'_>> = models
            .iter()
            .map(|(model, view, caption)| Panel { model, view: *view, caption: caption.clone() })
            .collect();
        Ok(render(&panels, options)?)
    }

    /// The view that a region faces most.
    fn facing(&self, region: u32, up: Up, views: [View; 2]) -> View {
        let vertices = &self.region_vertices[region as usize];
        View::facing(&self.mesh, vertices, up, &views).unwrap_or(views[0])
    }

    /// One picture per wanted region: that region in its colour on the grey shape, from before or from
    /// behind, whichever it faces more. A region that lies inside is not seen.
    ///
    /// # Errors
    /// [`ResultsError::Viewer`], also for a region that is not there.
    pub fn region_pictures(
        &self,
        wanted: &[(u32, Rgb)],
        options: &RenderOptions,
    ) -> Result<Vec<Image>, ResultsError> {
        let drawing = Drawing::new(self)?;
        let picture = |number: usize, region: u32, colour: Rgb| {
            let count = self.region_vertices.len();
            if region as usize >= count {
                let (what, target, index) = ("picture", "region", region.into());
                return Err(ViewerError::OutOfRange { what, number, target, index, count }.into());
            }
            let (model, view) = (drawing.one(region, colour)?, self.facing(region, options.up, BOTH_SIDES));
            Ok(render(&[Panel { model: &model, view, caption: String::new() }], options)?)
        };
        wanted.iter().enumerate().map(|(number, &(region, colour))| picture(number, region, colour)).collect()
    }

    /// Both shapes from the front and from behind, in [`matched_colours`].
    ///
    /// # Errors
    /// [`ResultsError::Viewer`].
    pub fn match_sheet(
        &self,
        other: &Self,
        matches: &[RegionPair],
        options: &RenderOptions,
    ) -> Result<Image, ResultsError> {
        let [first, second] = matched_colours(self, other, matches);
        let models = [
            self.matched_model(&first, matches.iter().map(|pair| pair.first))?,
            other.matched_model(&second, matches.iter().map(|pair| pair.second))?,
        ];
        let names = [self.name(), other.name()];
        let fronts = [self, other].map(|results| results.front(options.up).unwrap_or(0.0));
        let panel = |view: View, shape: usize| Panel {
            model: &models[shape],
            view: view.turned(fronts[shape]),
            caption: names[shape].clone(),
        };
        let panels: Vec<Panel<'_>> =
            BOTH_SIDES.into_iter().flat_map(|view| [panel(view, 0), panel(view, 1)]).collect();
        let partner_of = |ids: &[u32]| {
            let partners =
                ids.iter().filter_map(|id| matches.iter().find(|m| m.first == *id).map(|m| m.second));
            format!("{} - {}", numbers(ids), numbers(&partners.collect::<Vec<_>>()))
        };
        let title = format!("regions of {} - {}:", self.name(), other.name());
        let mut legend = vec![LegendEntry { colours: Vec::new(), text: title }];
        legend.extend(self.legend_of(&first, partner_of, "not matched"));
        let own_colours = self.with_own_colour(&first);
        let inner = |pair: &&RegionPair| own_colours.get(pair.first as usize) == Some(&false);
        let inner: Vec<String> =
            matches.iter().filter(inner).map(|pair| format!("{} - {}", pair.first, pair.second)).collect();
        if !inner.is_empty() {
            let text = format!("in the colour around them: {}", inner.join(", "));
            legend.push(LegendEntry { colours: Vec::new(), text });
        }
        let mistakes: Vec<u32> = matches.iter().filter(|m| m.mistake).map(|m| m.second).collect();
        if !mistakes.is_empty() {
            let text = format!("matched wrongly: {}", numbers(&mistakes));
            legend.push(LegendEntry { colours: vec![MISTAKE], text });
        }
        Ok(render_with_legend(&panels, &legend, options)?)
    }

    /// Whether each region has another colour than what is around it.
    fn with_own_colour(&self, colours: &[Rgb]) -> Vec<bool> {
        let own = |(&colour, around): (&Rgb, Option<u32>)| {
            colour != NO_REGION && around.is_none_or(|around| colours[around as usize] != colour)
        };
        colours.iter().zip(self.around()).map(own).collect()
    }

    /// The surface with the numbers of these regions on it.
    fn matched_model(
        &self,
        colours: &[Rgb],
        matched: impl Iterator<Item = u32>,
    ) -> Result<Model, ResultsError> {
        let mut numbers = vec![String::new(); colours.len()];
        for region in matched {
            if let Some(number) = numbers.get_mut(region as usize) {
                *number = region.to_string();
            }
        }
        Ok(Drawing::new(self)?.regions(colours)?.with_labels(numbers))
    }
}

fn numbers(ids: &[u32]) -> String {
    ids.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")
}

/// The colours of two matched shapes: matched regions have the same, twins one hue, and the tone says on which side of the first
/// shape they are, or of the second where the first has no sides. What is not matched is [`NO_REGION`], and what is
/// matched wrongly is [`MISTAKE`] on the second shape.
pub fn matched_colours(first: &Results, second: &Results, matches: &[RegionPair]) -> [Vec<Rgb>; 2] {
    let pairs: Vec<[u32; 2]> = matches.iter().map(|m| [m.first, m.second]).collect();
    let mut traits = first.traits();
    let mut partners = vec![None; traits.len()];
    for [a, b] in &pairs {
        if let Some(partner) = partners.get_mut(*a as usize) {
            *partner = second.record.regions.get(*b as usize);
        }
    }
    for (traits, partner) in traits.iter_mut().zip(partners) {
        match partner {
            Some(partner) => traits.side = traits.side.or(partner.side),
            None => traits.family = None,
        }
    }
    let colours = region_colours(&traits, &first.vertex_region(), &first.mesh.edge_graph());
    let mut others = linked_colours(&colours, &pairs, second.record.regions.len());
    for pair in matches.iter().filter(|pair| pair.mistake) {
        if let Some(colour) = others.get_mut(pair.second as usize) {
            *colour = MISTAKE;
        }
    }
    [colours, others]
}
