//! The pictures of docs/gallery.md, by the commands that the page shows.

use std::path::{Path, PathBuf};

use crate::command::mser3d;

/// Where the page's public shapes are, unless told otherwise.
const DATA: &str = "../shared/data";

/// The page is to load fast.
const LARGEST: u64 = 150_000;

/// Runs the page's commands. Words that begin with `data/` are in the given folder; what is written goes to `work`, and
/// pictures to `pictures`. Shapes that are not here are skipped, and named; that is an error if the folder was given.
pub fn run(data: Option<&Path>, work: &Path, pictures: &Path) -> Result<(), Box<dyn std::error::Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let folder = data.map_or_else(|| root.join(DATA), Path::to_path_buf);
    let page = std::fs::read_to_string(root.join("docs/gallery.md"))?;
    let (here, lacking): (Vec<_>, Vec<_>) = blocks(&page)
        .into_iter()
        .map(|block| (lacks(&block, &folder), block))
        .partition(|(lack, _)| lack.is_none());
    for path in lacking.iter().filter_map(|(lack, _)| lack.as_ref()) {
        let message = format!("{} is not here", path.display());
        if data.is_some() {
            return Err(format!("{message}; docs/gallery.md says where it comes from").into());
        }
        println!("skipped: {message}, so its picture stays as it is");
    }
    for (_, block) in here {
        for command in &block {
            let mut arguments = Vec::new();
            for (number, word) in command.iter().enumerate() {
                let written =
                    number == 1 && command[0] != "detect" || number > 0 && command[number - 1] == "-o";
                arguments.push(match word.split_once('/') {
                    Some(("data", name)) => folder.join(name),
                    Some(("fixtures", _)) => root.join(word),
                    _ if written && word.ends_with(".png") => pictures.join(word),
                    _ if written => work.join(word),
                    _ => PathBuf::from(word),
                });
            }
            mser3d(&arguments)?;
        }
    }
    Ok(())
}

/// The first of the public shapes of a block that is not in the folder.
fn lacks(block: &[Vec<String>], folder: &Path) -> Option<PathBuf> {
    let inputs = block.iter().flatten().filter_map(|word| word.strip_prefix("data/"));
    inputs.map(|name| folder.join(name)).find(|path| !path.exists())
}

/// Whether a picture of the gallery is too large.
pub fn heavy(name: &str, size: u64) -> bool {
    name.starts_with("gallery_") && size > LARGEST
}

/// The commands of each block of the page, without the program's name, as words.
fn blocks(page: &str) -> Vec<Vec<Vec<String>>> {
    let mut blocks = Vec::new();
    let mut inside = false;
    for line in page.lines() {
        if line.starts_with("```") {
            inside = !inside;
            if inside {
                blocks.push(Vec::new());
            }
        } else if let (true, Some(block), Some(command)) =
            (inside, blocks.last_mut(), line.strip_prefix("mser3d "))
        {
            block.push(command.split_whitespace().map(str::to_owned).collect());
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_shows_the_pictures_that_its_commands_make_and_no_others() {
        let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
        let page = std::fs::read_to_string(docs.join("gallery.md")).unwrap();
        let blocks = blocks(&page);
        let made: Vec<&str> = blocks
            .iter()
            .flatten()
            .flatten()
            .map(String::as_str)
            .filter(|word| word.ends_with(".png"))
            .collect();
        let shown: Vec<&str> =
            page.split("](images/").skip(1).map(|rest| rest.split(')').next().unwrap()).collect();
        assert_eq!(made, shown);
        assert_eq!(blocks.len(), 8, "shapes");
        for name in shown {
            let size = docs.join("images").join(name).metadata().unwrap().len();
            assert!(!heavy(name, size), "{name}: {size} bytes");
        }
    }

    #[test]
    fn who_names_a_folder_is_told_what_it_lacks() {
        let folder = tempfile::tempdir().unwrap();
        let error = run(Some(folder.path()), folder.path(), folder.path()).unwrap_err().to_string();
        assert!(error.contains("woman_rest.off is not here"), "{error}");
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 0, "nothing was made before");
    }
}
