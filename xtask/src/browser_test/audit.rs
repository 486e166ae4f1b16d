//! An audit of the page by axe-core, the library behind most checkers of accessibility: names, roles, focus, contrast, sizes of
//! targets.

use std::path::Path;
use std::process::Command;
use std::time::Duration;

use super::session::Session;
use crate::command::output;

/// axe-core from npm, in a folder of its own; none where it cannot be had.
pub fn axe(folder: &Path) -> Option<String> {
    let place = folder.join("npm");
    let script = place.join("node_modules/axe-core/axe.min.js");
    if !script.is_file() {
        std::fs::create_dir_all(&place).ok()?;
        let mut npm = Command::new("npm");
        npm.args(["install", "--silent", "--no-save", "--no-audit", "--no-fund", "--prefix"]).arg(&place);
        output(npm.arg("axe-core@4"), Duration::from_secs(120)).ok()?;
    }
    std::fs::read_to_string(script).ok()
}

/// Fails on whatever axe-core finds wrong in any of the states that the page can be in.
pub fn is_accessible(session: &mut Session<'_>, axe: &str) -> Result<(), String> {
    session.load("parts.html")?;
    session.browser.evaluate(&format!("{axe}; 0"))?;
    // Parts; a chosen and hidden one; a region with a word explained; the level sets; all of it dark, with the list of keys.
    let states: [(&str, &[&str]); 5] = [
        ("parts", &[]),
        ("a hidden part", &["n", "n", "h"]),
        ("a region", &["m", "n", "n"]),
        ("level sets", &["Escape", "m", "n"]),
        ("dark", &["d", "?", "x"]),
    ];
    for (name, keys) in states {
        for key in keys {
            session.browser.press(key)?;
        }
        if name == "a region" {
            session.press_button("#details .what")?;
        }
        wrong(session).map_err(|e| format!("{name}: {e}"))?;
    }
    session.browser.be_a_phone()?;
    for page in ["parts.html", "pair.html"] {
        session.load(page)?;
        session.browser.evaluate(&format!("{axe}; 0"))?;
        wrong(session).map_err(|e| format!("{page} on a phone: {e}"))?;
    }
    Ok(())
}

fn wrong(session: &mut Session<'_>) -> Result<(), String> {
    let script = "axe.run(document, { runOnly: ['wcag2a', 'wcag2aa', 'wcag21a', 'wcag21aa', 'wcag22aa', 'best-practice'] })
        .then((found) => found.violations.flatMap((v) => v.nodes.map((n) => `${v.id}: ${n.html.slice(0, 200)}`)))";
    let found = session.browser.evaluate(script)?;
    let found = found.as_array().ok_or("axe-core gave no answer")?;
    if found.is_empty() {
        return Ok(());
    }
    Err(found.iter().filter_map(|v| v.as_str()).collect::<Vec<_>>().join("\n"))
}
