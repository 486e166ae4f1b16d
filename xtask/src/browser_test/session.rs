//! A page under test, and what one does with it.

use std::collections::HashSet;
use std::path::Path;
use std::time::Duration;

use mser3d_results::Results;

use crate::browser::Browser;

/// A page under test, and what it should show.
pub struct Session<'a> {
    pub browser: &'a mut Browser,
    pub results: &'a Results,
    pub folder: &'a Path,
}

impl Session<'_> {
    pub fn load(&mut self, page: &str) -> Result<Duration, String> {
        self.browser.load(&self.folder.join(page))
    }

    pub fn shot(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let png = self.browser.screenshot()?;
        write(&self.folder.join(name), &png)?;
        Ok(png)
    }

    /// A number as the page shows it.
    pub fn shown(&mut self, number: f64, digits: u32) -> Result<String, String> {
        let text = self.browser.evaluate(&format!("String(Number(({number}).toPrecision({digits})))"))?;
        Ok(text.as_str().unwrap_or_default().to_owned())
    }

    /// Presses the first button that a selector finds.
    pub fn press_button(&mut self, selector: &str) -> Result<(), String> {
        let found = serde_json::json!(selector);
        let script = format!(
            "(() => {{ const e = document.querySelector({found}); e?.click(); return e !== null; }})()"
        );
        if self.browser.evaluate(&script)? != true {
            return Err(format!("there is no {selector}"));
        }
        self.browser.settle()
    }

    /// Fails unless the panel shows a region's numbers.
    pub fn expect_details(&mut self, region: usize) -> Result<(), String> {
        let text = self.browser.text("#details")?;
        let r = &self.results.record.regions[region];
        let (title, vertices) = (format!("Region {region}"), r.vertices.to_string());
        let wanted = [title, self.shown(100.0 * r.volume_fraction, 4)?, vertices];
        match wanted.iter().find(|w| !text.contains(w.as_str())) {
            Some(missing) => Err(format!("the panel says {text:?}, without {missing:?}")),
            None => Ok(()),
        }
    }

    /// The middle of an element's height, at a share of its width.
    pub fn centre(&mut self, selector: &str, share: f64) -> Result<[f64; 2], String> {
        let script = format!(
            "(() => {{ const e = document.querySelector('{selector}'); e.scrollIntoView({{ block: 'nearest' }});
               const b = e.getBoundingClientRect(); return [b.left + {share} * b.width, b.top + b.height / 2]; }})()"
        );
        let place = self.browser.evaluate(&script)?;
        let at = |i: usize| place[i].as_f64().ok_or_else(|| format!("{selector} has no place"));
        Ok([at(0)?, at(1)?])
    }

    /// A place in the window where an arm of the figure is seen from the front, and its region. In a
    /// page of several shapes side by side, that of shape `s`.
    pub fn arm(&mut self, s: usize, shapes: usize) -> Result<([f64; 2], usize), String> {
        let mesh = &self.results.mesh;
        let bounds = mesh.bounding_box().ok_or("no triangles")?;
        let middle = [0, 1, 2].map(|a| 0.5 * (bounds.min[a] + bounds.max[a]));
        // The vertex far out to the side whose neighbours are of one region with it.
        let labels = self.results.vertex_region();
        let graph = mesh.edge_graph();
        let reach = 0.6 * (bounds.max[0] - middle[0]);
        let gap = |v: &u32| (mesh.vertices()[*v as usize][0] - middle[0] - reach).abs();
        let vertex = (0..mesh.vertices().len() as u32)
            .filter(|&v| labels[v as usize] >= 0)
            .filter(|&v| graph.neighbours(v).iter().all(|&u| labels[u as usize] == labels[v as usize]))
            .filter(|&v| faces_front(mesh, &graph, v))
            .min_by(|p, q| gap(p).total_cmp(&gap(q)))
            .ok_or("no region reaches out to the side")?;
        let point = mesh.vertices()[vertex as usize];
        let box_of = |key: &str| format!("document.getElementById('canvas').getBoundingClientRect().{key}");
        let mut side = |key: &str| -> Result<f64, String> {
            self.browser.evaluate(&box_of(key))?.as_f64().ok_or_else(|| format!("no {key} of the canvas"))
        };
        let (left, top, width, height) = (side("left")?, side("top")?, side("width")?, side("height")?);
        let width = width / shapes as f64;
        let half = bounds.extent().map(|x| 0.5 * x);
        // As the page fits a shape.
        let wide = half[0].hypot(half[2]);
        let tall = 0.98 * half[1] + 0.21 * wide;
        let scale = 0.92 * (height / 2.0 / tall).min(width / 2.0 / wide);
        let x = left + width * (s as f64 + 0.5) + scale * (point[0] - middle[0]);
        let y = top + height / 2.0 - scale * (point[1] - middle[1]);
        Ok(([x, y], labels[vertex as usize] as usize))
    }
}

/// Whether the triangles around a vertex face +z: from the front it is not hidden by its own side.
pub fn faces_front(mesh: &mser3d::shape::TriangleMesh, graph: &mser3d::shape::Graph, vertex: u32) -> bool {
    let p = mesh.vertices()[vertex as usize];
    graph.neighbours(vertex).iter().all(|&u| mesh.vertices()[u as usize][2] <= p[2] + 1e-9)
}

/// How many colours a picture has.
pub fn colours(png: &[u8]) -> Result<usize, String> {
    let (pixels, samples) = decoded(png)?;
    Ok(pixels.chunks_exact(samples).collect::<HashSet<_>>().len())
}

/// How bright a picture is on the whole, from 0 to 255.
pub fn brightness(png: &[u8]) -> Result<f64, String> {
    let (pixels, samples) = decoded(png)?;
    let sum: f64 = pixels.chunks_exact(samples).map(|p| f64::from(p[1])).sum();
    Ok(sum / (pixels.len() / samples) as f64)
}

/// The share of two pictures' bytes that differ clearly.
pub fn difference(first: &[u8], second: &[u8]) -> Result<f64, String> {
    let [(p, _), (q, _)] = [decoded(first)?, decoded(second)?];
    let differ = p.iter().zip(&q).filter(|(a, b)| a.abs_diff(**b) > 8).count();
    Ok(differ as f64 / p.len().max(1) as f64)
}

/// The bytes of a picture, and how many a pixel has.
pub fn decoded(png: &[u8]) -> Result<(Vec<u8>, usize), String> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(png)).read_info().map_err(|e| e.to_string())?;
    let mut pixels = vec![0; reader.output_buffer_size().ok_or("a picture too large")?];
    let info = reader.next_frame(&mut pixels).map_err(|e| e.to_string())?;
    Ok((pixels, info.color_type.samples()))
}

pub fn write(path: &Path, bytes: &[u8]) -> Result<(), String> {
    std::fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}
