//! Regions, their tree and their matches: shown, chosen, cut.

use std::time::Duration;

use super::session::{Session, colours};

/// The page should show its first picture within this time, drawn without a graphics card.
const GOAL: Duration = Duration::from_secs(2);
/// And that of a mesh of 500,000 vertices.
const FINE_GOAL: Duration = Duration::from_secs(3);
/// On a machine that is busy with other things it may take longer, but beyond this it is broken.
const BROKEN: Duration = Duration::from_secs(15);

pub fn shows_regions(session: &mut Session<'_>) -> Result<(), String> {
    opens_soon(session, "figure.html", GOAL)?;
    let colours = colours(&session.shot("regions.png")?)?;
    if colours < 200 {
        return Err(format!("only {colours} colours are seen: the shape is not drawn"));
    }
    Ok(())
}

/// Fails unless the first picture of a page comes in time.
fn opens_soon(session: &mut Session<'_>, page: &str, goal: Duration) -> Result<(), String> {
    // The machine may be busy with other things: the best of three.
    let mut times = Vec::new();
    for _ in 0..3 {
        session.browser.open_page()?;
        times.push(session.load(page)?);
    }
    let best = times.iter().min().copied().unwrap_or_default();
    if best > BROKEN {
        return Err(format!("the first picture took {best:?}, longer than {BROKEN:?}"));
    }
    let seconds: Vec<String> = times.iter().map(|t| format!("{:.2}", t.as_secs_f64())).collect();
    let verdict = if best <= goal { "within" } else { "beyond" };
    println!("    first picture after {} s: {verdict} the goal of {goal:?}", seconds.join(", "));
    Ok(())
}

pub fn fine_meshes_open_soon(session: &mut Session<'_>) -> Result<(), String> {
    opens_soon(session, "fine.html", FINE_GOAL)?;
    session.shot("fine.png")?;
    let facts = session.browser.text("#facts")?;
    if facts.contains("numbers are of all") { Ok(()) } else { Err(format!("the page says {facts:?}")) }
}

pub fn legs_merge(session: &mut Session<'_>) -> Result<(), String> {
    session.load("parts.html")?;
    // The largest limb is a leg; from its part to its region, and to the merge.
    let parts = session.results.record.parts.clone().unwrap_or_default();
    let leg = parts.iter().find(|part| part.region.is_some()).ok_or("there is no limb")?;
    let (id, region) = (leg.id, leg.region.unwrap_or_default());
    session.press_button(&format!("#tables tr[data-id=\"{id}\"] button"))?;
    session.press_button(&format!("#details [aria-label=\"region {region}\"]"))?;
    session.press_button("#details [aria-label^=\"Show the merge\"]")?;
    session.shot("merge.png")?;
    let mode = "document.querySelector('input[name=mode]:checked').value";
    let mode = session.browser.evaluate(mode)?;
    let text = session.browser.text("#level-text")?;
    if mode != "level" || !text.contains("component") {
        return Err(format!("the merge is shown as {mode}: {text:?}"));
    }
    Ok(())
}

pub fn arm_shows_its_numbers(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.browser.press("1")?;
    let (place, region) = session.arm(0, 1)?;
    session.browser.click(place)?;
    session.shot("arm.png")?;
    session.expect_details(region)?;
    // Again: the region around it, if there is one; that one's name is there to be clicked as well.
    let regions = &session.results.record.regions;
    let Some(parent) = regions[region].parent else { return Ok(()) };
    session.browser.click(place)?;
    session.expect_details(parent as usize)?;
    session.browser.press("Escape")?;
    session.browser.click(place)?;
    session.browser.evaluate("document.querySelector('#details .link').click()")?;
    session.expect_details(parent as usize)
}

pub fn twin_is_seen_and_chosen(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.browser.press("1")?;
    let (place, region) = session.arm(0, 1)?;
    let twin = session.results.record.regions[region].twin.ok_or("the arm has no twin")? as usize;
    session.browser.click(place)?;
    session.shot("twin.png")?;
    let rows = "[...document.querySelectorAll('#tables tbody tr')]";
    let lit = format!(
        "{rows}.filter((row) => row.classList.contains('twin')).map((row) => Number(row.dataset.id))"
    );
    let lit = session.browser.evaluate(&lit)?;
    if lit != serde_json::json!([twin]) {
        return Err(format!("rows {lit} are marked as twins of region {region}, not {twin}"));
    }
    // In the table, in the panel, and back: a choice is another region, not none.
    session.browser.evaluate(&format!("{rows}[{region}].querySelector('.link').click()"))?;
    session.expect_details(twin)?;
    session.press_button(&format!("#details [aria-label=\"region {region}\"]"))?;
    session.expect_details(region)?;
    let heads = session.browser.text("#tables thead")?;
    let sided = session.results.record.regions[region].side.is_some();
    if !heads.contains("twin") || heads.contains("side") != sided {
        return Err(format!("the table is headed {heads:?}"));
    }
    Ok(())
}

pub fn tree_and_slider_work(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    let mark = session.centre("#tree circle.region", 0.5)?;
    session.browser.click(mark)?;
    let name = "document.querySelector('#tree circle.region.on').getAttribute('aria-label')";
    let name = session.browser.evaluate(name)?;
    let region = name.as_str().and_then(|n| n.strip_prefix("Region ")?.parse().ok());
    session.expect_details(region.ok_or_else(|| format!("the tree's mark is called {name}"))?)?;
    // Near its right end, everything has entered and is one component.
    for (share, components) in [(0.4, "components"), (0.99, "1 component")] {
        let before = session.browser.screenshot()?;
        let place = session.centre("#level", share)?;
        session.browser.click(place)?;
        let text = session.browser.text("#level-text")?;
        if !text.contains("weight") || !text.ends_with(components) {
            return Err(format!("the slider at {share} says {text:?}"));
        }
        if session.shot("slider.png")? == before {
            return Err(format!("the slider at {share} changes nothing"));
        }
    }
    Ok(())
}

pub fn works_by_keyboard(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.browser.press("n")?;
    session.expect_details(0)?;
    session.browser.press("n")?;
    session.expect_details(1)?;
    session.browser.press("Escape")?;
    if session.browser.text("#details h2")?.contains("Region 1") {
        return Err("Escape does not leave the region".into());
    }
    session.browser.press("m")?;
    let before = session.browser.text("#level-text")?;
    session.browser.press("]")?;
    let after = session.browser.text("#level-text")?;
    session.shot("level.png")?;
    if before == after || !after.contains("component") {
        return Err(format!("the level does not rise: {before:?}, {after:?}"));
    }
    let still = session.browser.screenshot()?;
    session.browser.evaluate("document.getElementById('canvas').focus()")?;
    session.browser.press("ArrowLeft")?;
    if session.browser.screenshot()? == still {
        return Err("an arrow key does not turn the shape".into());
    }
    Ok(())
}

pub fn cut_shows_the_inside(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.browser.press("1")?;
    let whole = session.browser.screenshot()?;
    let (place, region) = session.arm(0, 1)?;
    // From off to x, y, z: across the line of sight.
    for _ in 0..3 {
        session.browser.press("c")?;
    }
    if session.shot("cut.png")? == whole {
        return Err("the cut changes nothing".into());
    }
    // The flat face inside the arm, or the arm behind it, belongs to the same region.
    session.browser.click(place)?;
    session.expect_details(region)
}

pub fn works_on_a_phone(session: &mut Session<'_>) -> Result<(), String> {
    session.browser.be_a_phone()?;
    session.load("figure.html")?;
    session.browser.evaluate("document.querySelector('[data-view=\"1\"]').click()")?;
    let (place, region) = session.arm(0, 1)?;
    session.browser.tap(place)?;
    session.shot("phone.png")?;
    session.expect_details(region)?;
    let wide = session.browser.evaluate("document.documentElement.scrollWidth > innerWidth")?;
    if wide == true { Err("the page is wider than the screen".into()) } else { Ok(()) }
}

pub fn matches_are_linked(session: &mut Session<'_>) -> Result<(), String> {
    session.load("pair.html")?;
    session.browser.press("1")?;
    let (place, region) = session.arm(1, 2)?;
    // Parts first: that of the arm on both shapes.
    session.browser.click(place)?;
    session.shot("pair-parts.png")?;
    let (title, text) = (session.browser.text("#details h2")?, session.browser.text("#details")?);
    let part =
        title.strip_prefix("Part ").and_then(|rest| rest.split(' ').next()).unwrap_or("none").to_owned();
    let rows = session.browser.evaluate("document.querySelectorAll('tr.chosen').length")?;
    if !text.contains(&format!("matchpart {part}")) || rows != 2 {
        return Err(format!("a click on an arm chooses {rows} parts and says {text:?}"));
    }
    session.browser.press("Escape")?;
    session.browser.press("m")?;
    session.browser.click(place)?;
    session.shot("pair.png")?;
    session.expect_details(region)?;
    let rows = session.browser.evaluate("document.querySelectorAll('tr.chosen').length")?;
    if rows != 2 {
        return Err(format!("{rows} rows are chosen, not one of each shape"));
    }
    // The largest region has no match.
    session.browser.evaluate("document.querySelector('#tables tbody tr').click()")?;
    let rows = session.browser.evaluate("document.querySelectorAll('tr.chosen').length")?;
    if rows != 1 { Err(format!("{rows} rows are chosen for a region without a match")) } else { Ok(()) }
}

pub fn says_that_webgl_is_missing(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.shot("no-webgl.png")?;
    let shown = session.browser.evaluate("!document.getElementById('failure').hidden")?;
    let text = session.browser.text("#failure")?;
    if shown != true || !text.contains("WebGL2") {
        return Err(format!("without WebGL2 the page says {text:?}"));
    }
    session.browser.press("n")?;
    session.expect_details(0)
}
