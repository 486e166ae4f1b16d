use std::path::Path;

use mser3d_fileio::write_text;
use mser3d_results::{Sighting, Track, TracksRecord};

use crate::CollectionError;
use crate::parquet::{self, Column};

pub(super) const CSV: &str = "tracks.csv";
pub(super) const PARQUET: &str = "tracks.parquet";

/// Writes `tracks.csv` and `tracks.parquet`: a row for each track and each frame in which it is found, by track and frame.
pub(super) fn write(folder: &Path, record: &TracksRecord) -> Result<(), CollectionError> {
    write_text(&folder.join(CSV), &csv(record))?;
    let rows: Vec<(&Track, &Sighting)> = rows(record).collect();
    let integers = |value: &dyn Fn(&(&Track, &Sighting)) -> u32| {
        Column::Integer(rows.iter().map(|row| value(row) as i32).collect())
    };
    let numbers =
        |value: &dyn Fn(&Sighting) -> f64| Column::Number(rows.iter().map(|(_, s)| value(s)).collect());
    let maybe = |value: &dyn Fn(&Sighting) -> Option<f64>| {
        Column::OptionalNumber(rows.iter().map(|(_, s)| value(s)).collect())
    };
    let columns = [
        ("track", integers(&|(track, _)| track.id)),
        ("frame", integers(&|(_, s)| s.frame as u32)),
        ("shape", Column::Text(rows.iter().map(|(_, s)| record.frames[s.frame].name.clone()).collect())),
        ("time", maybe(&|s| record.frames[s.frame].time)),
        ("region", integers(&|(_, s)| s.region)),
        ("overlap", maybe(&|s| s.overlap)),
        ("likeness", maybe(&|s| s.likeness)),
        ("reliability", maybe(&|s| s.reliability)),
        ("volume", numbers(&|s| s.volume)),
        ("volume_fraction", numbers(&|s| s.volume_fraction)),
        ("x", numbers(&|s| s.centroid[0])),
        ("y", numbers(&|s| s.centroid[1])),
        ("z", numbers(&|s| s.centroid[2])),
    ];
    parquet::write(&folder.join(PARQUET), &columns, &[])
}

fn rows(record: &TracksRecord) -> impl Iterator<Item = (&Track, &Sighting)> {
    record.tracks.iter().flat_map(|track| track.sightings.iter().map(move |sighting| (track, sighting)))
}

fn csv(record: &TracksRecord) -> String {
    let mut csv = String::from(
        "track,frame,shape,time,region,overlap,likeness,reliability,volume,volume_fraction,x,y,z\n",
    );
    let maybe = |value: Option<f64>| value.map_or(String::new(), |v| v.to_string());
    for (track, s) in rows(record) {
        let frame = &record.frames[s.frame];
        let numbers = [maybe(frame.time), s.region.to_string(), maybe(s.overlap), maybe(s.likeness)];
        let more = [s.volume, s.volume_fraction, s.centroid[0], s.centroid[1], s.centroid[2]];
        csv.push_str(&format!("{},{},{},", track.id, s.frame, quoted(&frame.name)));
        csv.push_str(&format!("{},{},", numbers.join(","), maybe(s.reliability)));
        csv.push_str(&(more.map(|x| x.to_string()).join(",") + "\n"));
    }
    csv
}

/// As RFC 4180 has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
