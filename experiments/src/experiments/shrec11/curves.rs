//! Curves over the overlap threshold (the paper's figures 4 and 5), as SVG.

use std::fmt::Write;

use mser3d_evaluation::Score;
use mser3d_evaluation::shrec::{ShapeName, mean_score};

use super::all_shapes::Scored;
use super::tables::is_solid;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 40.0;
const SIDE: f64 = 320.0;
/// Okabe and Ito's palette, which the colour-blind can tell apart.
const COLOURS: [&str; 8] =
    ["#d55e00", "#0072b2", "#000000", "#cc79a7", "#009e73", "#e69f00", "#56b4e9", "#999999"];

/// The name and the text of each drawing: means over the classes that leave a solid (over all, where
/// none of these were asked for).
pub fn all(all: &[Scored]) -> Vec<(String, String)> {
    let solids = all.iter().flat_map(|s| &s.scores).any(|s| is_solid(&s.shape));
    let mut numbered: Vec<(usize, &Scored)> = Vec::new();
    for same_regions in [false, true] {
        let of = all.iter().filter(|s| s.same_regions == same_regions);
        numbered.extend((numbered.len()..).zip(of).collect::<Vec<_>>());
    }
    let mut drawings = Vec::new();
    let measures: [(&str, &str, bool, fn(&Score, f64) -> f64); 3] = [
        ("repeatability", "Repeatability", true, Score::repeatability),
        ("correspondences", "Correspondences", true, |s, t| s.correspondences(t) as f64),
        ("matching", "Matching score", false, Score::matching_score),
    ];
    for (file, title, once, measure) in measures {
        // A detector has the same colour in all drawings.
        let shown: Vec<(usize, &Scored)> =
            numbered.iter().copied().filter(|(_, s)| !(once && s.same_regions)).collect();
        for strength in [3, 5] {
            let title = format!("{title}, strengths up to {strength}");
            let wanted = move |s: &ShapeName| s.strength <= strength && (is_solid(s) || !solids);
            drawings.push((format!("{file}_{strength}.svg"), curves(&shown, &title, &wanted, measure)));
        }
    }
    drawings
}

fn curves(
    shown: &[(usize, &Scored)],
    title: &str,
    wanted: &dyn Fn(&ShapeName) -> bool,
    measure: fn(&Score, f64) -> f64,
) -> String {
    let thresholds: Vec<f64> = (0..=50).map(|i| f64::from(i) / 50.0).collect();
    let lines: Vec<(&str, usize, Vec<f64>)> = shown
        .iter()
        .map(|(number, scored)| {
            let at = |t: &f64| mean_score(&scored.scores, wanted, |s| measure(s, *t)).unwrap_or(0.0);
            (scored.name.as_str(), *number, thresholds.iter().map(at).collect())
        })
        .collect();
    let highest = lines.iter().flat_map(|(_, _, values)| values).fold(1.0, |a: f64, b| a.max(*b)).ceil();
    let place = |x: f64, value: f64| (LEFT + SIDE * x, TOP + SIDE * (1.0 - value / highest));

    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"12\">\n<rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"white\"/>\n\
         <text x=\"{LEFT}\" y=\"24\" font-size=\"15\">{title}</text>\n"
    );
    // Writing to a String cannot fail.
    for i in 0..=5 {
        let share = f64::from(i) / 5.0;
        let (x, y) = place(share, highest * share);
        let (right, bottom) = (LEFT + SIDE, TOP + SIDE);
        let _ = writeln!(
            svg,
            "<path d=\"M{x} {TOP}V{bottom}M{LEFT} {y}H{right}\" stroke=\"#ddd\" fill=\"none\"/>\n\
             <text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{share}</text>\n\
             <text x=\"{}\" y=\"{}\" text-anchor=\"end\">{:.1}</text>",
            bottom + 18.0,
            LEFT - 8.0,
            y + 4.0,
            highest * share
        );
    }
    let _ = writeln!(
        svg,
        "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">overlap</text>",
        LEFT + SIDE / 2.0,
        TOP + SIDE + 40.0
    );
    for (row, (name, number, values)) in lines.iter().enumerate() {
        let colour = COLOURS[number % COLOURS.len()];
        // When colours run out, lines are dashed.
        let dashes = if *number < COLOURS.len() { "" } else { " stroke-dasharray=\"5 3\"" };
        let points: Vec<String> = thresholds
            .iter()
            .zip(values)
            .map(|(x, value)| place(*x, *value))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let (x, y) = (LEFT + SIDE + 20.0, TOP + 14.0 + 20.0 * row as f64);
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"{dashes}/>\n\
             <path d=\"M{x} {}h24\" stroke=\"{colour}\" stroke-width=\"3\"{dashes}/>\
             <text x=\"{}\" y=\"{y}\">{name}</text>",
            points.join(" "),
            y - 4.0,
            x + 32.0
        );
    }
    svg.push_str("</svg>\n");
    svg
}
