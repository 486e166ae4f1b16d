//! The results as tables.

use std::collections::BTreeSet;
use std::fmt::Write;

use mser3d_evaluation::Score;
use mser3d_evaluation::shrec::{ShapeName, ShapeScore, mean_score};

use super::all_shapes::Scored;

/// The classes that leave one solid with all its parts. The others take parts away, open it, glue it or
/// change the sizes of its parts, so that even a perfect detector would not find everything again.
pub const SOLID_CLASSES: [&str; 8] =
    ["affine", "isometry", "microholes", "noise", "rasterize", "sampling", "scaling", "shotnoise"];

/// Numbers with names for rows and columns.
pub struct Table {
    pub title: String,
    corner: &'static str,
    columns: Vec<String>,
    rows: Vec<(String, Vec<Option<f64>>)>,
}

impl Table {
    pub fn markdown(&self) -> String {
        let mut text = format!("| {} |", self.corner);
        self.columns.iter().for_each(|c| text.push_str(&format!(" {c} |")));
        text.push_str(&format!("\n|---|{}\n", "---|".repeat(self.columns.len())));
        for (name, cells) in &self.rows {
            let cells: Vec<String> = cells.iter().map(|c| cell(*c)).collect();
            let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
        }
        text
    }

    /// Shares are shaded by what they lack.
    pub fn html(&self) -> String {
        let mut text = format!("<table><tr><th>{}</th>", self.corner);
        self.columns.iter().for_each(|c| text.push_str(&format!("<th>{}</th>", escape(c))));
        text.push_str("</tr>\n");
        for (name, cells) in &self.rows {
            let _ = write!(text, "<tr><th>{}</th>", escape(name));
            for value in cells {
                let shade = value.filter(|v| (0.0..=1.0).contains(v)).map(|v| {
                    // From white at 1 to red at 0.
                    let light = 100.0 - 45.0 * (1.0 - v);
                    format!(" style=\"background:hsl(12 90% {light:.0}%)\"")
                });
                let _ = write!(text, "<td{}>{}</td>", shade.unwrap_or_default(), cell(*value));
            }
            text.push_str("</tr>\n");
        }
        text.push_str("</table>\n");
        text
    }
}

fn cell(value: Option<f64>) -> String {
    match value {
        None => String::new(),
        Some(x) if x > 2.0 => format!("{x:.1}"),
        Some(x) => format!("{x:.3}"),
    }
}

type Measure = fn(&Score) -> f64;

/// Means over shapes for each detector, up to a strength: over the classes that leave a solid, and over all.
pub fn overview(all: &[Scored], up_to_strength: u32) -> Table {
    let solid = move |s: &ShapeName| s.strength <= up_to_strength && is_solid(s);
    let any = move |s: &ShapeName| s.strength <= up_to_strength;
    let columns: [(&str, bool, Measure); 11] = [
        ("regions", true, |s| s.regions() as f64),
        ("repeatability at .7", true, |s| s.repeatability(0.7)),
        ("at .8", true, |s| s.repeatability(0.8)),
        ("at .9", true, |s| s.repeatability(0.9)),
        ("correspondences at .8", true, |s| s.correspondences(0.8) as f64),
        ("matching at .8", true, |s| s.matching_score(0.8)),
        ("at .9", true, |s| s.matching_score(0.9)),
        ("first ten regions: repeatability at .8", true, |s| s.of_first(10).repeatability(0.8)),
        ("matching at .8", true, |s| s.of_first(10).matching_score(0.8)),
        ("all classes: repeatability at .8", false, |s| s.repeatability(0.8)),
        ("matching at .8", false, |s| s.matching_score(0.8)),
    ];
    let row = |scored: &Scored| {
        let cells = columns.iter().map(|(_, on_solids, measure)| {
            if *on_solids {
                mean_score(&scored.scores, solid, measure)
            } else {
                mean_score(&scored.scores, any, measure)
            }
        });
        (scored.name.clone(), cells.collect())
    };
    let strengths =
        if up_to_strength < 5 { format!("strengths up to {up_to_strength}") } else { "all strengths".into() };
    Table {
        title: format!("Means over shapes of the eight classes that leave a solid, {strengths}"),
        corner: "detector",
        columns: columns.iter().map(|c| c.0.to_string()).collect(),
        rows: all.iter().map(row).collect(),
    }
}

/// Means by class for each detector.
pub fn by_class(all: &[Scored]) -> Vec<Table> {
    let tables: [(&str, u32, bool, Measure); 9] = [
        ("Repeatability at overlap 0.8, all strengths", 5, true, |s| s.repeatability(0.8)),
        ("Repeatability at overlap 0.8, strengths up to 3", 3, true, |s| s.repeatability(0.8)),
        ("Repeatability at overlap 0.7, all strengths", 5, true, |s| s.repeatability(0.7)),
        ("Repeatability at overlap 0.9, all strengths", 5, true, |s| s.repeatability(0.9)),
        ("Repeatability at overlap 0.8 on the common part, all strengths", 5, true, |s| {
            s.repeatability_on_common_part(0.8)
        }),
        ("Matching score at overlap 0.8, all strengths", 5, false, |s| s.matching_score(0.8)),
        ("Matching score at overlap 0.8, strengths up to 3", 3, false, |s| s.matching_score(0.8)),
        ("Regions of a shape", 5, true, |s| s.regions() as f64),
        ("Correspondences at overlap 0.8", 5, true, |s| s.correspondences(0.8) as f64),
    ];
    let classes: BTreeSet<&str> =
        all.iter().flat_map(|s| s.scores.iter().map(|s| s.shape.class.as_str())).collect();
    let mut made = Vec::new();
    for (title, strength, once, measure) in tables {
        let shown: Vec<&Scored> = all.iter().filter(|s| !(once && s.same_regions)).collect();
        let row = |name: &str, wanted: &dyn Fn(&ShapeName) -> bool| {
            let wanted = |s: &ShapeName| s.strength <= strength && wanted(s);
            (name.to_string(), shown.iter().map(|s| mean_score(&s.scores, wanted, measure)).collect())
        };
        let mut rows: Vec<_> = classes.iter().map(|class| row(class, &|s| s.class == *class)).collect();
        rows.push(row("mean over the eight", &is_solid));
        rows.push(row("mean over all", &|_| true));
        let columns = shown.iter().map(|s| s.name.clone()).collect();
        made.push(Table { title: title.into(), corner: "class", columns, rows });
    }
    made.push(voxels(all, &classes));
    made
}

/// How much voxels and vertices agree: mean best overlaps.
fn voxels(all: &[Scored], classes: &BTreeSet<&str>) -> Table {
    let known = |s: &&Scored| s.voxels.iter().any(|v| !v.is_empty());
    let shown: Vec<&Scored> = all.iter().filter(known).collect();
    let mean = |values: &[&f64]| {
        (!values.is_empty()).then(|| values.iter().copied().sum::<f64>() / values.len() as f64)
    };
    let row = |class: &&str| {
        let cells = shown.iter().flat_map(|scored| {
            let of_class: Vec<(&ShapeScore, &Vec<f64>)> = scored
                .scores
                .iter()
                .zip(&scored.voxels)
                .filter(|(s, v)| s.shape.class == *class && !v.is_empty())
                .collect();
            let vertices: Vec<&f64> = of_class.iter().flat_map(|(s, _)| &s.score.best).collect();
            let voxels: Vec<&f64> = of_class.iter().flat_map(|(_, v)| *v).collect();
            [mean(&vertices), mean(&voxels)]
        });
        (class.to_string(), cells.collect())
    };
    Table {
        title: "Mean best overlap by area and in voxels, where there is a correspondence of voxels".into(),
        corner: "class",
        columns: shown.iter().flat_map(|s| [format!("{} by area", s.name), "in voxels".into()]).collect(),
        rows: classes.iter().map(row).collect(),
    }
}

/// How a detector falls off with the strength.
pub fn by_strength(scored: &Scored, title: &str, measure: Measure) -> Table {
    let names = || scored.scores.iter().map(|s| &s.shape);
    let classes: BTreeSet<&str> = names().map(|s| s.class.as_str()).collect();
    let strengths: BTreeSet<u32> = names().map(|s| s.strength).collect();
    let row = |class: &&str| {
        let at = |strength: &u32| {
            mean_score(&scored.scores, |s| s.class == *class && s.strength == *strength, measure)
        };
        (class.to_string(), strengths.iter().map(at).collect())
    };
    Table {
        title: format!("{title}, {}, by strength", scored.name),
        corner: "class",
        columns: strengths.iter().map(u32::to_string).collect(),
        rows: classes.iter().map(row).collect(),
    }
}

/// Whether a class leaves a solid.
pub fn is_solid(shape: &ShapeName) -> bool {
    SOLID_CLASSES.contains(&shape.class.as_str())
}

/// All tables, as Markdown, below what they were made from.
pub fn summary(all: &[Scored], settings: &str) -> String {
    let mut tables = vec![overview(all, 5), overview(all, 3)];
    if let Some(first) = all.first() {
        tables.push(by_strength(first, "Repeatability at overlap 0.8", |s| s.repeatability(0.8)));
        tables.push(by_strength(first, "Matching score at overlap 0.8", |s| s.matching_score(0.8)));
    }
    tables.extend(by_class(all));
    let tables: String = tables.iter().map(|t| format!("\n## {}\n\n{}", t.title, t.markdown())).collect();
    format!("# Scores of detectors and descriptors\n\n```text\n{settings}```\n{tables}")
}

/// A row for each region of each transformed shape.
pub fn regions_csv(all: &[Scored]) -> String {
    let mut csv = String::from(
        "detector,null,class,strength,region,best_overlap,best_overlap_on_common_part,best_overlap_in_voxels,\
         matched_overlap\n",
    );
    for scored in all {
        for (ShapeScore { shape, score }, voxels) in scored.scores.iter().zip(&scored.voxels) {
            for (region, best) in score.best.iter().enumerate() {
                let [common, voxels, matched] = [&score.best_on_common_part, voxels, &score.matched]
                    .map(|values| values.get(region).map_or(String::new(), f64::to_string));
                let ShapeName { null, class, strength } = shape;
                let _ = writeln!(
                    csv,
                    "{},{null},{class},{strength},{region},{best},{common},{voxels},{matched}",
                    scored.name
                );
            }
        }
    }
    csv
}

/// A row for each transformed shape.
pub fn shapes_csv(all: &[Scored]) -> String {
    let mut csv = String::from(
        "detector,null,class,strength,regions,repeatability_0.7,repeatability_0.8,repeatability_0.9,\
         correspondences_0.8,matching_0.7,matching_0.8,matching_0.9\n",
    );
    for scored in all {
        for ShapeScore { shape, score } in &scored.scores {
            let [a, b, c] = [0.7, 0.8, 0.9].map(|t| score.repeatability(t));
            let [d, e, f] = [0.7, 0.8, 0.9].map(|t| score.matching_score(t));
            let (regions, pairs) = (score.regions(), score.correspondences(0.8));
            let ShapeName { null, class, strength } = shape;
            let _ = writeln!(
                csv,
                "{},{null},{class},{strength},{regions},{a},{b},{c},{pairs},{d},{e},{f}",
                scored.name
            );
        }
    }
    csv
}

/// A text within HTML.
pub(super) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores() -> Vec<Scored> {
        let score = |class: &str, strength, best: &[f64], matched: &[f64]| ShapeScore {
            shape: ShapeName { null: 1, class: class.into(), strength },
            score: Score {
                best: best.to_vec(),
                best_on_common_part: best.to_vec(),
                matched: matched.to_vec(),
            },
        };
        let scores = vec![
            score("noise", 1, &[0.95, 0.85, 0.75, 0.0], &[0.95, 0.0, 0.75, 0.0]),
            score("noise", 5, &[], &[]),
            score("holes", 2, &[0.9], &[0.9]),
        ];
        let voxels = vec![vec![0.9, 0.8, 0.7, 0.0], vec![], vec![]];
        vec![Scored { name: "ours".into(), same_regions: false, scores, voxels }]
    }

    #[test]
    fn shapes_count_alike_however_many_regions_they_have() {
        let table = &by_class(&scores())[0].markdown();
        assert!(table.contains("| noise | 0.250 |"), "{table}");
        assert!(table.contains("| holes | 1.000 |"));
        assert!(table.contains("| mean over the eight | 0.250 |"));
        assert!(table.contains("| mean over all | 0.500 |"));
        let row = "| ours | 2.000 | 0.375 | 0.250 | 0.125 | 1.000 | 0.125 | 0.125 | 0.250 | 0.125 | 0.500 | 0.417 |";
        assert!(overview(&scores(), 5).markdown().contains(row), "{}", overview(&scores(), 5).markdown());
        let by_strength = by_strength(&scores()[0], "Repeatability", |s| s.repeatability(0.8)).markdown();
        assert!(by_strength.contains("| noise | 0.500 |  | 0.000 |"), "{by_strength}");
    }

    #[test]
    fn every_region_and_every_shape_has_a_row() {
        let regions = regions_csv(&scores());
        assert_eq!(regions.lines().count(), 1 + 4 + 1);
        assert_eq!(regions.lines().nth(2).unwrap(), "ours,1,noise,1,1,0.85,0.85,0.8,0");
        let shapes = shapes_csv(&scores());
        let rows: Vec<&str> = shapes.lines().collect();
        assert_eq!(rows[1], "ours,1,noise,1,4,0.75,0.5,0.25,2,0.5,0.25,0.25");
        assert_eq!(rows[2], "ours,1,noise,5,0,0,0,0,0,0,0,0");
        let columns = |row: &&str| row.split(',').count();
        assert!(rows.iter().all(|row| columns(row) == columns(&rows[0])));
        assert!(regions.lines().all(|row| row.split(',').count() == 9));
    }
}
