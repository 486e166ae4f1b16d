//! Twins and sides are the same everywhere: in JSON, arrays, tables, answers and pages.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::common::*;
use mser3d_fileio::{NpyValues, read_npz};
use mser3d_results::{Results, Up};
use mser3d_volumeio::{Affine, Volume, write_nifti};
use parquet::file::reader::{FileReader, SerializedFileReader};
use serde_json::Value;

/// Voxels of a figure along x, y and z. Its mirror image is itself, x the other way.
const DIMS: [usize; 3] = [64, 72, 28];

/// First and last voxel of a box.
type Part = [[usize; 3]; 2];

const BODY: [Part; 6] = [
    [[23, 24, 8], [40, 51, 19]],
    [[27, 52, 9], [36, 65, 18]],
    [[2, 42, 10], [22, 48, 17]],
    [[41, 42, 10], [61, 48, 17]],
    [[24, 3, 10], [30, 23, 17]],
    [[33, 3, 10], [39, 23, 17]],
];
/// Feet and a nose that point to the front, z.
const FRONT: [Part; 3] =
    [[[24, 0, 10], [30, 6, 26]], [[33, 0, 10], [39, 6, 26]], [[30, 55, 19], [33, 61, 25]]];

/// Two figures beside each other along x: 1 has a front, 2 is the same front and back.
fn two_figures() -> Volume {
    let [nx, ny, nz] = [2 * DIMS[0], DIMS[1], DIMS[2]];
    let within = |v: [usize; 3], part: &Part| (0..3).all(|a| (part[0][a]..=part[1][a]).contains(&v[a]));
    let value = |i: usize| {
        let [x, y, z] = [i % nx, i / nx % ny, i / (nx * ny)];
        let v = [x % DIMS[0], y, z];
        let inside = BODY.iter().any(|part| within(v, part));
        match x / DIMS[0] {
            0 => u8::from(inside || FRONT.iter().any(|part| within(v, part))),
            _ => 2 * u8::from(inside),
        }
    };
    let values: Vec<u8> = (0..nx * ny * nz).map(value).collect();
    let affine = Affine::new([[1., 0., 0., 0.], [0., 1., 0., 0.], [0., 0., 1., 0.]]).unwrap();
    Volume::new([nx, ny, nz], 1, affine, values).unwrap()
}

/// What a table or file says of a region: its twin and its side.
type Said = (Option<u64>, Option<f64>);

fn of_json(region: &Value) -> Said {
    (region["twin"].as_u64(), region["side"].as_f64())
}

/// `region_twin` and `region_side` of `features.npz`: -1 and NaN stand for none.
fn of_arrays(folder: &Path) -> Vec<Said> {
    let arrays = read_npz(&folder.join("features.npz")).unwrap();
    let (NpyValues::I32(twins), NpyValues::F64(sides)) =
        (arrays["region_twin"].values(), arrays["region_side"].values())
    else {
        panic!("{:?} {:?}", arrays["region_twin"], arrays["region_side"]);
    };
    assert!(twins.iter().all(|&twin| twin >= -1));
    let twins = twins.iter().map(|&twin| u64::try_from(twin).ok());
    twins.zip(sides.iter().map(|&side| Some(side).filter(|side| !side.is_nan()))).collect()
}

/// The rows of comma-separated values by their heads.
fn csv(path: &Path) -> Vec<BTreeMap<String, String>> {
    let table = fs::read_to_string(path).unwrap();
    let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        assert_eq!(cells.len(), heads.len(), "{line}");
        heads.iter().zip(cells).map(|(head, cell)| ((*head).to_owned(), cell.to_owned())).collect()
    };
    table.lines().skip(1).map(row).collect()
}

/// The rows of a Parquet file as JSON.
fn parquet(path: &Path) -> Vec<Value> {
    let file = SerializedFileReader::new(fs::File::open(path).unwrap()).unwrap();
    let rows = file.get_row_iter(None).unwrap();
    rows.map(|row| {
        let row = row.unwrap();
        let value = |name: &str| {
            use parquet::record::Field;
            match &row.get_column_iter().find(|(column, _)| *column == name)?.1 {
                Field::Int(x) => Some(Value::from(*x)),
                Field::Double(x) => Some(Value::from(*x)),
                Field::Str(x) => Some(Value::from(x.as_str())),
                _ => None,
            }
        };
        let names = ["shape", "region", "twin", "side", "sidedness", "sidedness_certainty"];
        names.iter().map(|name| ((*name).to_owned(), value(name).unwrap_or(Value::Null))).collect()
    })
    .collect()
}

#[test]
fn a_left_arm_has_the_right_one_as_its_twin_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_nifti(&path("two.nii.gz"), &two_figures()).unwrap();
    let output = detect(&path("two.nii.gz"), &path("out"), "--label all --reliability 0");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let names = ["two-001", "two-002"];
    let records = names.map(|name| json(&path("out").join(name).join("regions.json")));
    let regions = records.each_ref().map(|record| record["regions"].as_array().unwrap());

    // JSON: twins are mirror images; with a front, on opposite sides.
    for (figure, regions) in regions.iter().enumerate() {
        let middle = (figure * DIMS[0]) as f64 + 0.5 * (DIMS[0] - 1) as f64;
        let across = |region: &Value| region["centroid"][0].as_f64().unwrap() - middle;
        let mut arms = 0;
        for region in regions.iter() {
            let (twin, side) = of_json(region);
            match (twin, side) {
                (Some(twin), side) => {
                    let other = &regions[twin as usize];
                    assert!((across(region) + across(other)).abs() < 1e-9, "{region} {other}");
                    assert_eq!(other["twin"], region["id"]);
                    assert_eq!(of_json(other).1, side.map(|side| -side));
                    assert!(side.is_none_or(|side| side.abs() == 1.0));
                    // Nothing but an arm is so far out.
                    arms += usize::from(across(region).abs() > 15.0);
                }
                (None, side) => assert!(across(region).abs() < 1.0 && side.is_none_or(|s| s.abs() < 0.1)),
            }
            assert_eq!(side.is_some(), figure == 0, "{region}");
        }
        assert!(arms >= 2, "{arms} arms have twins");
    }
    let kinds = records.each_ref().map(|record| record["bodies"][0]["sidedness"].clone());
    assert_eq!((&kinds[0]["kind"], &kinds[1]["kind"]), (&"sided".into(), &"alike".into()));

    // Arrays.
    for (name, regions) in names.iter().zip(regions) {
        let said: Vec<Said> = regions.iter().map(of_json).collect();
        assert_eq!(of_arrays(&path("out").join(name)), said);
    }

    // Tables.
    let all =
        || names.iter().zip(regions).flat_map(|(name, regions)| regions.iter().map(move |r| (*name, r)));
    let rows = csv(&path("out/regions.csv"));
    assert_eq!(rows.len(), all().count());
    for (row, (name, region)) in rows.iter().zip(all()) {
        assert_eq!((&row["shape"][..], &row["region"]), (name, &region["id"].to_string()));
        assert_eq!((row["twin"].parse().ok(), row["side"].parse().ok()), of_json(region), "{row:?}");
        assert!(row["twin"].parse::<u64>().is_ok() || row["twin"].is_empty());
    }
    let rows = parquet(&path("out/regions.parquet"));
    assert_eq!(rows.len(), all().count());
    for (row, (name, region)) in rows.iter().zip(all()) {
        assert_eq!((&row["shape"], &row["region"]), (&name.into(), &region["id"]));
        assert_eq!(of_json(row), of_json(region), "{row}");
    }
    let (labels, shapes) = (csv(&path("out/labels.csv")), parquet(&path("out/shapes.parquet")));
    assert_eq!((labels.len(), shapes.len()), (2, 2));
    for ((label, shape), sidedness) in labels.iter().zip(&shapes).zip(&kinds) {
        assert_eq!(label["sidedness"], sidedness["kind"].as_str().unwrap());
        assert_eq!(label["sidedness_certainty"].parse().ok(), sidedness["certainty"].as_f64());
        assert_eq!(
            (&shape["sidedness"], &shape["sidedness_certainty"]),
            (&sidedness["kind"], &sidedness["certainty"])
        );
    }

    // Answers: nearest to each region is the region itself.
    for (name, regions) in names.iter().zip(regions) {
        let ask = |more: &[&str]| {
            let out = path("out").display().to_string();
            let output = mser3d([&["query", &out, name, "-k", "1", "--include-itself"], more].concat());
            assert!(output.status.success(), "{}", text(&output.stderr));
            text(&output.stdout).to_owned()
        };
        let found: Value = serde_json::from_str(&ask(&["--json"])).unwrap();
        for (answer, region) in found["regions"].as_array().unwrap().iter().zip(regions) {
            let hit = &answer["closest"][0];
            assert_eq!((&hit["shape"], &hit["region"]), (&(*name).into(), &region["id"]));
            assert_eq!(of_json(hit), of_json(region));
        }
        let heads = ask(&[]).lines().next().unwrap().matches("side").count();
        assert_eq!(heads, if *name == "two-001" { 2 } else { 0 });
    }

    // Pages.
    for ((name, regions), told) in names.iter().zip(regions).zip(["told, with certainty", "can't be told: "])
    {
        let results = Results::load(&path("out").join(name)).unwrap();
        let page = results.page("A figure", Up::Y).unwrap();
        let head = page_head(&page);
        let shape = &head["shapes"][0];
        let shown: Vec<Said> = shape["regions"].as_array().unwrap().iter().map(of_json).collect();
        assert_eq!(shown, regions.iter().map(of_json).collect::<Vec<_>>());
        let facts = shape["facts"].as_array().unwrap();
        let fact = facts.iter().find(|fact| fact[0] == "left and right").unwrap();
        assert!(fact[1].as_str().unwrap().starts_with(told), "{fact}");
    }
}

#[test]
fn the_printed_table_has_twins_and_sides_where_there_are_any() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    write_nifti(&path("two.nii.gz"), &two_figures()).unwrap();
    fs::write(
        path("club.npy"),
        npy([30, 12, 12], |x, y, z| x < 12 || [y, z].iter().all(|i| (4..8).contains(i))),
    )
    .unwrap();
    let run = |input: &str, options: &str| {
        let output = detect(&path(input), &path("out"), &format!("{options} --reliability 0"));
        assert!(output.status.success(), "{}", text(&output.stderr));
        let record = json(&path("out/regions.json"));
        (text(&output.stdout).to_owned(), record["regions"].as_array().unwrap().clone())
    };
    let note = "left and right can't be told: as far as can be seen, the body is the same front and back, \
                or top and bottom\n";
    let starts = |table: &str| {
        let lines = table.lines().skip(1).take_while(|line| line.contains('('));
        let words = lines.map(|line| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        words.collect::<Vec<_>>()
    };
    let twin = |region: &Value| region["twin"].as_u64().map_or("-".to_owned(), |twin| twin.to_string());

    let (table, regions) = run("two.nii.gz", "--label 1");
    assert!(table.starts_with(" id  parent  twin   side  measure %") && !table.contains(note), "{table}");
    assert_eq!(starts(&table).len(), regions.len());
    for words in starts(&table) {
        let region = &regions[words[0].parse::<usize>().unwrap()];
        let side = region["side"].as_f64().unwrap();
        assert_eq!(words[2], twin(region), "{table}");
        assert_eq!(words[3].starts_with(['+', '-']), words[3] != "0.00", "{table}");
        assert!((words[3].parse::<f64>().unwrap() - side).abs() <= 0.005, "{table}");
    }

    let (table, regions) = run("two.nii.gz", "--label 2");
    assert!(table.starts_with(" id  parent  twin  measure %") && table.matches(note).count() == 1, "{table}");
    for words in starts(&table) {
        assert_eq!(words[2], twin(&regions[words[0].parse::<usize>().unwrap()]), "{table}");
    }

    let (table, regions) = run("club.npy", "--eigenpairs 40");
    assert!(!regions.is_empty() && regions.iter().all(|region| region["twin"].is_null()));
    assert!(table.starts_with(" id  parent  measure %") && !table.contains("left and right"), "{table}");
}
