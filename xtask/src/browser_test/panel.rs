//! Parts, words, the table, and what one does with the view.

use std::time::Duration;

use base64::Engine;

use super::session::{Session, brightness, colours, difference, write};

pub fn parts_are_first(session: &mut Session<'_>) -> Result<(), String> {
    session.load("parts.html")?;
    session.shot("parts.png")?;
    let mode = session.browser.evaluate("document.querySelector('input[name=mode]:checked').value")?;
    if mode != "parts" {
        return Err(format!("the page begins with {mode}"));
    }
    session.browser.press("1")?;
    let (place, innermost) = session.arm(0, 1)?;
    session.browser.click(place)?;
    session.shot("part.png")?;
    let records = session.results.record.parts.clone().unwrap_or_default();
    let title = session.browser.text("#details h2")?;
    let part: usize = title.strip_prefix("Part ").and_then(|id| id.parse().ok()).ok_or(title)?;
    let (own, text) = (&records[part], session.browser.text("#details")?);
    let share = session.shown(100.0 * own.volume_fraction, 4)?;
    let twin = *own.twins.first().ok_or("the arm has no twin")?;
    let region = own.region.ok_or("the arm grew from no region")?;
    let wanted = [share, format!("part {twin}"), format!("region {region}"), own.vertices.to_string()];
    if let Some(missing) = wanted.iter().find(|word| !text.contains(word.as_str())) {
        return Err(format!("the panel says {text:?}, without {missing:?}"));
    }
    // To its twin, and back by the table; then to its region.
    session.press_button(&format!("#details [aria-label=\"part {twin}\"]"))?;
    if session.browser.text("#details h2")? != format!("Part {twin}") {
        return Err("the twin's name does not lead to it".into());
    }
    session.press_button(&format!("#tables tr[data-id=\"{part}\"] button"))?;
    session.press_button(&format!("#details [aria-label=\"region {region}\"]"))?;
    session.shot("part-region.png")?;
    session.expect_details(region as usize)?;
    // The switch leads back to the part that grew from it.
    session.press_button("input[value=parts]")?;
    match session.browser.text("#details h2")? {
        title if title == format!("Part {part}") => {
            // Among the regions a click chooses what is seen there, not what lies around the part's region.
            session.browser.press("m")?;
            if innermost != region as usize {
                session.browser.click(place)?;
                session.expect_details(innermost)?;
            }
            Ok(())
        }
        title => Err(format!("of region {region} the switch leads to {title:?}, not to part {part}")),
    }
}

pub fn words_are_explained(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    session.browser.press("n")?;
    let question = session.centre("#details .what", 0.5)?;
    session.browser.click(question)?;
    session.shot("word.png")?;
    let shown =
        "(() => { const n = document.getElementById('note'); return n && !n.hidden && n.textContent; })()";
    let text = session.browser.evaluate(shown)?;
    if !text.as_str().unwrap_or_default().starts_with("reliability The chance") {
        return Err(format!("the question mark after reliability says {text}"));
    }
    session.browser.press("Escape")?;
    if session.browser.evaluate(shown)? != false {
        return Err("Escape does not close what a question mark opened".into());
    }
    session.expect_details(0)?;
    // All words, by keyboard: each has a sentence, and the link comes next.
    let count = session.browser.evaluate("document.querySelectorAll('.what').length")?.as_u64().unwrap_or(0);
    if count < 8 {
        return Err(format!("only {count} words are explained"));
    }
    for number in 0..count {
        session.browser.evaluate(&format!("document.querySelectorAll('.what')[{number}].focus()"))?;
        session.browser.press("Enter")?;
        session.browser.press("Tab")?;
        let link = session.browser.evaluate("document.activeElement.href ?? ''")?;
        let text = session.browser.evaluate(shown)?;
        let enough = text.as_str().is_some_and(|text| text.len() > 40);
        if !enough || !link.as_str().is_some_and(|link| link.contains("/blob/main/")) {
            return Err(format!("question mark {number} says {text}, and its link is {link}"));
        }
        session.browser.press("Escape")?;
    }
    Ok(())
}

pub fn table_is_sorted(session: &mut Session<'_>) -> Result<(), String> {
    session.load("figure.html")?;
    let heads = session
        .browser
        .evaluate("[...document.querySelectorAll('#tables th .sort')].map((head) => head.textContent)")?;
    let heads: Vec<String> = serde_json::from_value(heads).map_err(|e| e.to_string())?;
    let column = heads.iter().position(|h| h == "lifetime").ok_or(format!("no lifetime among {heads:?}"))?;
    let regions = session.results.record.regions.clone();
    let none = |sign: f64, lifetime: Option<f64>| lifetime.unwrap_or(sign * f64::INFINITY);
    for (direction, sign) in [("descending", -1.0), ("ascending", 1.0)] {
        session
            .browser
            .evaluate(&format!("document.querySelectorAll('#tables th .sort')[{column}].click()"))?;
        let mut wanted: Vec<u32> = regions.iter().map(|r| r.id).collect();
        let key = |id: &u32| sign * none(sign, regions[*id as usize].lifetime);
        wanted.sort_by(|p, q| key(p).total_cmp(&key(q)).then(p.cmp(q)));
        let rows = "[...document.querySelectorAll('#tables tbody tr')].map((row) => Number(row.dataset.id))";
        let rows = session.browser.evaluate(rows)?;
        let told = format!("document.querySelectorAll('#tables th')[{column}].getAttribute('aria-sort')");
        let told = session.browser.evaluate(&told)?;
        if rows != serde_json::json!(wanted) || told != direction {
            return Err(format!("by lifetime, {told} for {direction}: {rows} for {wanted:?}"));
        }
        session.browser.press("Escape")?;
        session.browser.press("n")?;
        session.expect_details(wanted[0] as usize)?;
    }
    session.shot("sorted.png").map(|_| ())
}

pub fn hides_and_isolates(session: &mut Session<'_>) -> Result<(), String> {
    session.load("parts.html")?;
    session.browser.press("1")?;
    let (place, _) = session.arm(0, 1)?;
    session.browser.click(place)?;
    let arm = session.browser.text("#details h2")?;
    let whole = session.browser.screenshot()?;
    session.browser.press("i")?;
    let alone = session.shot("isolated.png")?;
    session.browser.press("h")?;
    if alone == whole || session.browser.screenshot()? == alone {
        return Err("the picture stays when a part is isolated or hidden".into());
    }
    session.browser.press("Escape")?;
    session.browser.click(place)?;
    session.shot("hidden.png")?;
    if session.browser.text("#details h2")? == arm {
        return Err(format!("{arm} is hidden, and a click still finds it"));
    }
    session.browser.press("Escape")?;
    session.browser.press("a")?;
    session.browser.click(place)?;
    match session.browser.text("#details h2")? {
        title if title == arm => Ok(()),
        title => Err(format!("when all is shown a click finds {title:?}, not {arm}")),
    }
}

pub fn link_restores_the_view(session: &mut Session<'_>) -> Result<(), String> {
    session.load("parts.html")?;
    for key in ["2", "m", "n", "n", "x", "c", ".", "+"] {
        session.browser.press(key)?;
    }
    // The address follows what is seen, once it stays.
    std::thread::sleep(Duration::from_millis(600));
    let hash = session.browser.evaluate("location.hash")?;
    let hash = hash.as_str().unwrap_or_default().to_owned();
    let title = session.browser.text("#details h2")?;
    let before = session.browser.screenshot()?;
    session.browser.open_page()?;
    session.load(&format!("parts.html{hash}"))?;
    let again = session.shot("link.png")?;
    // Up to rounding of the last digit.
    let changed = difference(&again, &before)?;
    if session.browser.text("#details h2")? != title || changed > 0.002 {
        return Err(format!("{hash} shows another view: {changed} of the picture differ"));
    }
    // What does not fit the page is left out.
    session.browser.open_page()?;
    session.load(
        "parts.html#mode=parts&chosen=map:0&view=a,b&cut=q,7&hidden=-1,77,9:9&others=x&tree=9&zoom=0",
    )?;
    match session.browser.text("#details h2")? {
        text if text.ends_with("parts") => Ok(()),
        text => Err(format!("a link that does not fit shows {text:?}")),
    }
}

pub fn looks_and_pictures(session: &mut Session<'_>) -> Result<(), String> {
    session.load("parts.html")?;
    let light = session.browser.screenshot()?;
    session.browser.press("d")?;
    session.browser.press("x")?;
    let dark = session.shot("dark.png")?;
    let [light, dark] = [brightness(&light)?, brightness(&dark)?];
    if light < 200.0 || dark > 80.0 {
        return Err(format!("the light page is {light:.0} bright, the dark one {dark:.0}"));
    }
    let bar = session.browser.text("#bar-text")?;
    let axes = session.browser.evaluate("document.querySelectorAll('#axes line').length")?;
    if bar.parse::<f64>().is_err() || axes != 3 {
        return Err(format!("the scale bar says {bar:?}, and there are {axes} axes"));
    }
    // The saved picture, as the page gives it to the browser.
    let script = "new Promise((done) => {
        const make = URL.createObjectURL;
        URL.createObjectURL = (blob) => { const reader = new FileReader();
            reader.onload = () => done(reader.result); reader.readAsDataURL(blob); return make(blob); };
        document.getElementById('picture').click(); })";
    let url = session.browser.evaluate(script)?;
    let data = url.as_str().and_then(|url| url.strip_prefix("data:image/png;base64,"));
    let png = base64::engine::general_purpose::STANDARD.decode(data.ok_or("no PNG")?);
    let png = png.map_err(|e| e.to_string())?;
    write(&session.folder.join("saved.png"), &png)?;
    let seen = colours(&png)?;
    if seen < 200 { Err(format!("the saved picture has {seen} colours")) } else { Ok(()) }
}

pub fn grey_values_are_seen(session: &mut Session<'_>) -> Result<(), String> {
    session.load("volume.html")?;
    session.shot("volume.png")?;
    // The middle of the dark ball lies at 14.5 of 48 voxels from the left of the slice through the middle.
    let place = session.centre("#grey", 14.5 / 48.0)?;
    session.browser.click(place)?;
    session.shot("slice.png")?;
    let title = session.browser.text("#details h2")?;
    let text = session.browser.text("#grey-text")?;
    if !title.starts_with("Region ") || text != "17 of 32" {
        return Err(format!("a click on slice {text:?} shows {title:?}"));
    }
    let script = "[...document.getElementById('grey').getContext('2d').getImageData(0, 0, 1, 1).data]";
    let corner = session.browser.evaluate(script)?;
    let grey = corner[0] == corner[1] && corner[1] == corner[2] && corner[3] == 255;
    if !grey { Err(format!("the corner of the slice is {corner}")) } else { Ok(()) }
}
