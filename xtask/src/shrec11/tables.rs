//! The results as tables.

use std::collections::BTreeSet;
use std::fmt::Write;

use mser3d_shrec11::{Score, mean_score};

use super::run::Scores;

/// A row for each region of each transformed shape.
pub fn regions_csv(scores: &Scores) -> String {
    let mut csv = String::from(
        "detector,class,strength,region,best_overlap,best_overlap_on_common_part,matched_overlap\n",
    );
    for (detector, scores) in scores {
        for s in scores {
            for (region, best) in s.best.iter().enumerate() {
                let common = s.best_common.get(region).map_or(String::new(), f64::to_string);
                let matched = s.matched.get(region).map_or(String::new(), f64::to_string);
                let _ =
                    writeln!(csv, "{detector},{},{},{region},{best},{common},{matched}", s.class, s.strength);
            }
        }
    }
    csv
}

/// A row for each transformed shape.
pub fn shapes_csv(scores: &Scores) -> String {
    let mut csv = String::from(
        "detector,class,strength,regions,repeatability_0.7,repeatability_0.8,repeatability_0.9,correspondences_0.8,\
         matching_0.7,matching_0.8,matching_0.9\n",
    );
    for (detector, scores) in scores {
        for s in scores {
            let [a, b, c] = [0.7, 0.8, 0.9].map(|t| s.repeatability(t));
            let [d, e, f] = [0.7, 0.8, 0.9].map(|t| s.matching(t));
            let (class, strength, regions, pairs) =
                (&s.class, s.strength, s.best.len(), s.correspondences(0.8));
            let _ = writeln!(csv, "{detector},{class},{strength},{regions},{a},{b},{c},{pairs},{d},{e},{f}");
        }
    }
    csv
}

/// Means by class and over all classes, as Markdown.
pub fn summary(scores: &Scores) -> String {
    let mut text = String::new();
    let tables: [(&str, u32, fn(&Score) -> f64); 9] = [
        ("Repeatability at overlap 0.8, all strengths", 5, |s| s.repeatability(0.8)),
        ("Repeatability at overlap 0.8, strengths up to 3", 3, |s| s.repeatability(0.8)),
        ("Repeatability at overlap 0.7, all strengths", 5, |s| s.repeatability(0.7)),
        ("Repeatability at overlap 0.9, all strengths", 5, |s| s.repeatability(0.9)),
        ("Repeatability at overlap 0.8 on the common part, all strengths", 5, |s| {
            s.repeatability_on_common_part(0.8)
        }),
        ("Matching score at overlap 0.8, all strengths", 5, |s| s.matching(0.8)),
        ("Matching score at overlap 0.8, strengths up to 3", 3, |s| s.matching(0.8)),
        ("Regions of a shape", 5, |s| s.best.len() as f64),
        ("Correspondences at overlap 0.8", 5, |s| s.correspondences(0.8) as f64),
    ];
    for (title, strength, measure) in tables {
        let _ = writeln!(text, "## {title}\n");
        table(&mut text, scores, strength, measure);
        text.push('\n');
    }
    text
}

fn table(text: &mut String, scores: &Scores, strength: u32, measure: fn(&Score) -> f64) {
    let classes: BTreeSet<&str> =
        scores.iter().flat_map(|(_, s)| s.iter().map(|s| s.class.as_str())).collect();
    let _ = write!(text, "| class |");
    for (detector, _) in scores {
        let _ = write!(text, " {detector} |");
    }
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(scores.len()));
    for class in classes.iter().map(|c| Some(*c)).chain([None]) {
        let _ = write!(text, "| {} |", class.unwrap_or("mean over shapes"));
        for (_, scores) in scores {
            let cell =
                mean_score(scores, class, strength, measure).map_or(String::new(), |m| format!("{m:.3}"));
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scores() -> Scores {
        let score = |class: &str, strength, best: &[f64], matched: &[f64]| Score {
            class: class.into(),
            strength,
            best: best.to_vec(),
            best_common: best.to_vec(),
            matched: matched.to_vec(),
        };
        let ours = vec![
            score("noise", 1, &[0.95, 0.85, 0.75, 0.0], &[0.95, 0.0, 0.75, 0.0]),
            score("noise", 5, &[], &[]),
            score("holes", 2, &[0.9], &[0.9]),
        ];
        vec![("ours".into(), ours)]
    }

    #[test]
    fn shapes_count_alike_however_many_regions_they_have() {
        let summary = summary(&scores());
        let all = &summary[..summary.find("strengths up to 3").unwrap()];
        assert!(all.contains("| noise | 0.250 |"), "{all}");
        assert!(all.contains("| holes | 1.000 |"));
        assert!(all.contains("| mean over shapes | 0.500 |"));
    }

    #[test]
    fn every_region_and_every_shape_has_a_row() {
        assert_eq!(regions_csv(&scores()).lines().count(), 1 + 4 + 1);
        let shapes = shapes_csv(&scores());
        let rows: Vec<&str> = shapes.lines().collect();
        assert_eq!(rows[1], "ours,noise,1,4,0.75,0.5,0.25,2,0.5,0.25,0.25");
        assert_eq!(rows[2], "ours,noise,5,0,0,0,0,0,0,0,0");
        let columns = |row: &&str| row.split(',').count();
        assert!(rows.iter().all(|row| columns(row) == columns(&rows[0])));
    }
}
