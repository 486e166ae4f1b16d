use std::collections::HashSet;

use mser3d_results::{RegionPair, Results, Up, matched_parts};
use mser3d_viewer::{MISTAKE, NO_REGION};
use serde_json::{Value, json};

use crate::front::{detected, fixture, turned};

fn head(html: &str) -> Value {
    let (_, rest) = html.split_once("id=\"head\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

/// Each region matched with itself, some wrongly.
fn itself(results: &Results, wrong: impl Fn(u32) -> bool) -> Vec<RegionPair> {
    let pair = |id| RegionPair { first: id, second: id, distance: 0.5, mistake: wrong(id) };
    (0..results.record.regions.len() as u32).map(pair).collect()
}

#[test]
fn a_page_is_seen_from_the_body_s_front_and_of_two_each_from_its_own() {
    let [rest, aside] = [0.0, 90.0].map(|azimuth| detected(&turned(&fixture("human_rest.off"), azimuth)));
    let one = head(&aside.page("aside", Up::Y).unwrap());
    assert_eq!(one["shapes"][0]["front"].as_f64(), aside.front(Up::Y));
    let facts: Vec<[String; 2]> = serde_json::from_value(one["shapes"][0]["facts"].clone()).unwrap();
    assert!(facts.contains(&["front".into(), "told by the parts: 90° from +z to +x".into()]), "{facts:?}");
    let two = head(&rest.match_page(&aside, &[], "two", Up::Y).unwrap());
    let fronts: Vec<f64> = (0..2).map(|s| two["shapes"][s]["front"].as_f64().unwrap()).collect();
    assert!(fronts[0].abs() < 1.0 && (fronts[1] - 90.0).abs() < 1.0, "{fronts:?}");
    // Without parts nothing tells.
    let mut without = rest.clone();
    without.record.parts = None;
    assert_eq!(head(&without.page("rest", Up::Y).unwrap())["shapes"][0]["front"], Value::Null);
}

#[test]
fn parts_are_matched_as_the_regions_they_grew_from() {
    let results = detected(&fixture("human_rest.off"));
    let parts = results.record.parts.clone().unwrap();
    let limbs: Vec<(u32, u32)> = parts.iter().filter_map(|part| Some((part.id, part.region?))).collect();
    let [(missing, unmatched), (mistaken, wrong), ..] = limbs[..] else { panic!("few limbs: {limbs:?}") };
    let mut matches = itself(&results, |id| id == wrong);
    matches.retain(|pair| pair.first != unmatched);
    let found = matched_parts(&results, &results, &matches);
    let wanted: HashSet<u32> = limbs.iter().map(|limb| limb.0).filter(|&id| id != missing).collect();
    assert_eq!(found.iter().map(|pair| pair.first).collect::<HashSet<_>>(), wanted);
    assert!(found.iter().all(|pair| pair.first == pair.second && pair.mistake == (pair.first == mistaken)));

    let page = head(&results.match_page(&results, &matches, "two", Up::Y).unwrap());
    let colour = |s: usize, part: u32| page["shapes"][s]["parts"][part as usize]["colour"].clone();
    for part in &parts {
        let paired = wanted.contains(&part.id);
        let second = if part.id == mistaken { json!(MISTAKE.0) } else { colour(0, part.id) };
        assert_eq!(colour(0, part.id) == json!(NO_REGION.0), !paired, "part {}", part.id);
        assert_eq!(colour(1, part.id), second, "part {}", part.id);
    }
    let pairs: Vec<Value> =
        found.iter().map(|pair| json!([pair.first, pair.second, 0.5, pair.mistake])).collect();
    assert_eq!(page["matches"]["parts"], json!(pairs));
}

#[test]
fn where_one_has_no_parts_a_page_of_two_shows_regions() {
    let results = detected(&fixture("human_rest.off"));
    let mut without = results.clone();
    without.record.parts = None;
    let page = head(&results.match_page(&without, &itself(&results, |_| false), "two", Up::Y).unwrap());
    assert!((0..2).all(|s| page["shapes"][s]["parts"] == Value::Null));
    assert_eq!(page["matches"]["parts"], json!([]));
}
