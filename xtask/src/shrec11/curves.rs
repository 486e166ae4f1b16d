//! Curves over the overlap threshold (the paper's figures 4 and 5), as SVG.

use std::fmt::Write;

use mser3d_shrec11::{Score, mean_score};

use super::run::Scores;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 420.0;
const LEFT: f64 = 60.0;
const TOP: f64 = 40.0;
const SIDE: f64 = 320.0;
/// Okabe and Ito's palette, which the colour-blind can tell apart.
const COLOURS: [&str; 8] =
    ["#d55e00", "#0072b2", "#000000", "#cc79a7", "#009e73", "#e69f00", "#56b4e9", "#999999"];

/// The name and the text of each drawing.
pub fn all(scores: &Scores) -> Vec<(String, String)> {
    let mut drawings = Vec::new();
    let measures: [(&str, &str, fn(&Score, f64) -> f64); 3] = [
        ("repeatability", "Repeatability", Score::repeatability),
        ("correspondences", "Correspondences", |s, t| s.correspondences(t) as f64),
        ("matching", "Matching score", Score::matching),
    ];
    for (file, title, measure) in measures {
        for strength in [3, 5] {
            let title = format!("{title}, strengths up to {strength}");
            drawings.push((format!("{file}_{strength}.svg"), curves(scores, &title, strength, measure)));
        }
    }
    drawings
}

fn curves(scores: &Scores, title: &str, strength: u32, measure: fn(&Score, f64) -> f64) -> String {
    let thresholds: Vec<f64> = (0..=50).map(|i| f64::from(i) / 50.0).collect();
    let lines: Vec<(&str, Vec<f64>)> = scores
        .iter()
        .map(|(name, scores)| {
            let at = |t: &f64| mean_score(scores, None, strength, |s| measure(s, *t)).unwrap_or(0.0);
            (name.as_str(), thresholds.iter().map(at).collect())
        })
        .collect();
    let highest = lines.iter().flat_map(|(_, values)| values).fold(1.0, |a: f64, b| a.max(*b)).ceil();
    let place = |t: f64, value: f64| (LEFT + SIDE * t, TOP + SIDE * (1.0 - value / highest));

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
    for (number, (name, values)) in lines.iter().enumerate() {
        let colour = COLOURS[number % COLOURS.len()];
        let points: Vec<String> = thresholds
            .iter()
            .zip(values)
            .map(|(t, value)| place(*t, *value))
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let (x, y) = (LEFT + SIDE + 20.0, TOP + 14.0 + 20.0 * number as f64);
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.8\"/>\n\
             <path d=\"M{x} {}h24\" stroke=\"{colour}\" stroke-width=\"3\"/><text x=\"{}\" y=\"{y}\">{name}</text>",
            points.join(" "),
            y - 4.0,
            x + 32.0
        );
    }
    svg.push_str("</svg>\n");
    svg
}
