//! `cargo xtask schema`: the JSON Schemas of `regions.json`, `msv.json`, `tracks.json` and `checksums.json`, from the types that write
//! these files.

use std::error::Error;
use std::path::{Path, PathBuf};

use mser3d_results::msv::MsvRecord;
use mser3d_results::{Checksums, FORMAT, Record, TracksRecord};
use schemars::transform::{Transform, transform_subschemas};
use schemars::{JsonSchema, Schema, SchemaGenerator, generate::SchemaSettings};
use serde_json::{Value, json};

/// What `cargo xtask schema` can be told.
#[derive(clap::Args)]
pub struct Arguments {
    /// Folder to write to [default: the workspace's docs/]
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Writes the schemas.
pub fn run(arguments: &Arguments) -> Result<(), Box<dyn Error>> {
    let folder = arguments.output.clone().unwrap_or_else(docs);
    std::fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    for (name, text) in files()? {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{}", path.display());
    }
    Ok(())
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// The name and the text of each file.
fn files() -> Result<[(&'static str, String); 4], serde_json::Error> {
    let text = |schema: Schema| serde_json::to_string_pretty(&schema).map(|text| text + "\n");
    Ok([
        ("regions.schema.json", text(schema::<Record>("regions.json of mser3d"))?),
        ("msv.schema.json", text(schema::<MsvRecord>("msv.json of mser3d"))?),
        ("tracks.schema.json", text(schema::<TracksRecord>("tracks.json of mser3d"))?),
        ("checksums.schema.json", text(schema::<Checksums>("checksums.json of mser3d"))?),
    ])
}

/// The schema of a record as it is written: keys that are always there are required.
fn schema<T: JsonSchema>(title: &str) -> Schema {
    let settings = SchemaSettings::default().for_serialize().with_transform(PlainText);
    let mut schema = SchemaGenerator::new(settings).into_root_schema_for::<T>();
    schema.insert("title".into(), title.into());
    if let Some(Value::String(text)) = schema.get_mut("description") {
        // What follows is about the type in Rust.
        text.truncate(text.find("\n\n").unwrap_or(text.len()));
    }
    if let Some(format) = schema.pointer_mut("/properties/format") {
        *format =
            json!({ "description": "The layout of the file. Programs refuse others.", "const": FORMAT });
    }
    schema
}

/// Descriptions for readers of JSON: as in the documentation of the types, but without links to them.
#[derive(Clone, Debug)]
struct PlainText;

impl Transform for PlainText {
    fn transform(&mut self, schema: &mut Schema) {
        if let Some(Value::String(text)) = schema.get_mut("description") {
            *text = plain(text);
        }
        transform_subschemas(self, schema);
    }
}

/// Markdown's ``[`crate::name`](target)`` as `name`, and lines that were broken for a width as one.
fn plain(markdown: &str) -> String {
    let mut text = String::new();
    let mut rest = markdown;
    while let Some((before, link)) = rest.split_once("[`") {
        let Some((name, after)) = link.split_once("`]") else { break };
        text.push_str(before);
        text.push_str(&format!("`{}`", name.rsplit("::").next().unwrap_or(name)));
        rest =
            after.strip_prefix('(').and_then(|target| target.split_once(')')).map_or(after, |(_, rest)| rest);
    }
    text.push_str(rest);
    let paragraphs = text.split("\n\n").map(|lines| lines.split_whitespace().collect::<Vec<_>>().join(" "));
    paragraphs.collect::<Vec<_>>().join("\n\n")
}

#[cfg(test)]
mod tests;
