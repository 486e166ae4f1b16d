//! The results as a page.

use std::fmt::Write;

use super::all_shapes::Scored;
use super::tables::{self, SOLID_CLASSES, escape};

/// What the page shows besides the scores.
pub struct Contents<'a> {
    /// The settings of the run, a line each.
    pub settings: &'a str,
    /// What the benchmark should have and has not.
    pub missing: &'a [String],
    /// Files of the curves.
    pub curves: &'a [String],
    /// Files of the pictures, and what they show.
    pub pictures: &'a [(String, String)],
}

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:1200px;margin:2em auto;padding:0 1em;color:#222}\
table{border-collapse:collapse;font-size:13px;margin:.6em 0 1.6em}\
th,td{border:1px solid #ccc;padding:2px 7px;text-align:right}th:first-child{text-align:left}\
.scroll{overflow-x:auto}.curves img{width:49%;min-width:380px}figure{margin:1em 0}figure img{max-width:100%}\
pre{background:#f4f4f4;padding:.7em;overflow-x:auto}summary{cursor:pointer;font-weight:600}";

/// One HTML page; pictures and curves lie beside it.
pub fn page(all: &[Scored], contents: &Contents<'_>) -> String {
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Regions found again</title>\n\
         <style>{STYLE}</style>\n<h1>Regions found again</h1>\n\
         <p>Every detector finds regions on a null shape and on its transforms. A region of a transform is carried \
         to the null shape by the known correspondence.</p>\n<ul>\n\
         <li><b>overlap</b>(A, B) = area(A and B) / area(A or B) there; the mirrored map counts too where the shape \
         has a symmetry.</li>\n\
         <li><b>repeatability</b>: the share of a transform's regions whose best overlap with a region of the null \
         shape is above a threshold. <b>Correspondences</b>: their number.</li>\n\
         <li><b>matching score</b>: the share whose nearest null region by descriptor has an overlap above it.</li>\n\
         <li>Means are over shapes. A shape on which nothing is found counts 0.</li>\n\
         <li>The eight classes that leave a solid with all its parts: {}.</li></ul>\n",
        SOLID_CLASSES.join(", ")
    );
    section(&mut html, &tables::overview(all, 5), true);
    section(&mut html, &tables::overview(all, 3), true);
    let _ = writeln!(html, "<h2>Over the threshold, the eight classes</h2>\n<div class=\"curves\">");
    for file in contents.curves {
        let _ = writeln!(html, "<img src=\"{0}\" alt=\"{0}\">", escape(file));
    }
    let _ = writeln!(html, "</div>\n<h2>By strength</h2>");
    if let Some(first) = all.first() {
        section(
            &mut html,
            &tables::by_strength(first, "Repeatability at overlap 0.8", |s| s.repeatability(0.8)),
            true,
        );
        section(
            &mut html,
            &tables::by_strength(first, "Matching score at overlap 0.8", |s| s.matching_score(0.8)),
            true,
        );
    }
    let _ = writeln!(html, "<h2>By class</h2>");
    for (number, table) in tables::by_class(all).iter().enumerate() {
        section(&mut html, table, number == 0);
    }
    let first = all.first().map_or("", |s| &s.name);
    let _ = writeln!(
        html,
        "<h2>Shapes</h2>\n<p>With the regions of {}, innermost where they are nested. A region has the colour of the \
         null shape's region that it overlaps most; it is grey if that is half or less, and so is what lies in no region.</p>",
        escape(first)
    );
    for (file, shows) in contents.pictures {
        let (file, shows) = (escape(file), escape(shows));
        let _ = writeln!(
            html,
            "<figure><figcaption>{shows}</figcaption><img src=\"{file}\" alt=\"{shows}\" loading=\"lazy\"></figure>"
        );
    }
    let _ = writeln!(
        html,
        "<h2>How it was made</h2>\n<pre>{}</pre>\n<p>All numbers: <a href=\"regions.csv\">regions.csv</a> (a row for \
         each region), <a href=\"shapes.csv\">shapes.csv</a> (a row for each shape).</p>",
        escape(contents.settings)
    );
    if !contents.missing.is_empty() {
        let _ = writeln!(
            html,
            "<p>Not there, and left out:</p><pre>{}</pre>",
            escape(&contents.missing.join("\n"))
        );
    }
    html.push_str("</html>\n");
    html
}

fn section(html: &mut String, table: &tables::Table, open: bool) {
    let _ = writeln!(
        html,
        "<details{}><summary>{}</summary><div class=\"scroll\">{}</div></details>",
        if open { " open" } else { "" },
        escape(&table.title),
        table.html()
    );
}
