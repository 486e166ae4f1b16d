//! Words of a command line: they are understood or refused with one message, and what is understood gives valid parameters.

use mser3d_cli::{
    BatchArgs, CliError, DetectArgs, MatchArgs, MsvArgs, QueryArgs, RenderArgs, TrackArgs, VoxelizeArgs,
    parse,
};

use crate::scratch::check_message;

/// The first byte chooses the command, the words after it are parted by line ends.
pub fn run(input: &[u8]) {
    let Some((&command, words)) = input.split_first() else { return };
    let words: Vec<String> = words
        .split(|&byte| byte == b'\n')
        .take(24)
        .map(|w| String::from_utf8_lossy(w).into_owned())
        .collect();
    // Files that options name are none of this target's business.
    let names_file = |word: &String| word.starts_with('/') || word.contains("..");
    if words.iter().any(names_file) {
        return;
    }
    match command % 9 {
        0 => {
            if let Some(args) = understood(parse::<DetectArgs>("detect", words)) {
                if let Some(parameters) = understood(args.parameters()) {
                    parameters.validate().unwrap_or_else(|error| panic!("{error}"));
                }
                let _ = (understood(args.threads()), understood(args.shape_options()));
            }
        }
        1 => drop(understood(parse::<BatchArgs>("batch", words))),
        2 => {
            if let Some(args) = understood(parse::<MatchArgs>("match", words)) {
                let _ = understood(args.parameters());
            }
        }
        3 => drop(understood(parse::<MsvArgs>("msv", words))),
        4 => drop(understood(parse::<QueryArgs>("query", words))),
        5 => drop(understood(parse::<RenderArgs>("render", words))),
        6 => drop(understood(parse::<TrackArgs>("track", words))),
        7 => drop(understood(parse::<VoxelizeArgs>("voxelize", words))),
        _ => {
            let whole = std::iter::once("mser3d".to_owned()).chain(words);
            if let Err(error) = mser3d_cli::command().try_get_matches_from(whole) {
                assert!(!error.to_string().is_empty());
            }
        }
    }
}

fn understood<T>(result: Result<T, CliError>) -> Option<T> {
    result.map_err(|error| check_message(&error.to_string(), "")).ok()
}

pub fn seeds() -> Vec<Vec<u8>> {
    let lines: [(u8, &str); 14] = [
        (0, "body.off\n--voxels=5000\n--polarity=superlevel\n-o\nout"),
        (0, "body.off\n--pitch\n0.5,0.5,1\n--origin=-1,2,3\n--eigenpairs\n40"),
        (0, "body.off\n--surface\n--weight\nedge\n--time-scale=0.5,1e-3\n--reliability\n0"),
        (0, "seg.nii.gz\n--label\nall\n--write\nnifti,landmarks\n--spacing\n1,1,2"),
        (0, "body.off\n--memory-limit=2GB\n--threads\n2\n--lambda-max\n3e9\n--parts=12"),
        (1, "a.off\nb.off\n-o\nall\n--shard=1/3\n--frames=4\n--jobs=2"),
        (2, "a\nb\n--consistency=0\n--symmetry\nmap.txt\n--min-overlap=0.7"),
        (3, "brain.nii\n--contrast=dark\n--delta\n5\n--connectivity=26"),
        (4, "all\na\n-k\n5\n--json"),
        (5, "out\n--views=front,inside\n--height=400\n--cut-at\n0.5\n--background=white"),
        (6, "fox.glb\n--animation=walk\n--frames=4\n--fps\n24\n-o\nmoving"),
        (7, "a.off\n--resolution=64\n--inside=parity\n--overlap=join\n-o\na.nii.gz"),
        (8, "detect\nbody.off\n-o\nout\n-vv"),
        (8, "completions\nbash"),
    ];
    lines.iter().map(|(command, words)| [&[*command][..], words.as_bytes()].concat()).collect()
}
