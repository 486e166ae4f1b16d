//! Names of what is written promise what it is.

use std::fs;

use crate::common::*;

/// A command that writes files, without its output's name; how the name may end, and what is said of others.
struct Writer {
    command: &'static str,
    endings: &'static [&'static str],
    says: &'static str,
}

const WRITERS: [Writer; 5] = [
    Writer {
        command: "render nowhere -o",
        endings: &[".png"],
        says: "pictures are written as PNG; end the name in .png",
    },
    Writer {
        command: "view nowhere -o",
        endings: &[".html", ".htm"],
        says: "pages are written as HTML; end the name in .html or .htm",
    },
    Writer {
        command: "query nowhere shape --html",
        endings: &[".html", ".htm"],
        says: "pages are written as HTML; end the name in .html or .htm",
    },
    Writer {
        command: "export nowhere -o",
        endings: &[".glb", ".ply", ".vtp", ".vti", ".nii.gz", ".nii", ".mrk.json"],
        says: "no such format; end the name in .glb, .ply, .vtp, .vti, .nii.gz, .nii or .mrk.json",
    },
    Writer {
        command: "voxelize nowhere.off -o",
        endings: &[".nii.gz", ".nii", ".npy"],
        says: "masks are written as NIfTI or NumPy; end the name in .nii.gz, .nii or .npy",
    },
];

#[test]
fn files_of_other_endings_are_refused_before_anything_is_read() {
    let others = [
        "a.jpg",
        "a.svg",
        "a.pdf",
        "a.html.gz",
        "a.hdr",
        "a.img",
        "a.json",
        "a.png.tif",
        "a",
        "png",
        ".png",
        ".nii",
        "a.",
        "html",
    ];
    let folder = tempfile::tempdir().unwrap();
    for Writer { command, endings, says } in WRITERS {
        let run = |name: &str| {
            let path = folder.path().join(name);
            mser3d(command.split(' ').chain([path.to_str().unwrap()]))
        };
        for name in others {
            assert_fails(&run(name), 2, &[name, says]);
        }
        // A name that is right leads on, to the input that isn't there.
        for ending in endings {
            for name in [format!("a{ending}"), format!("B{}", ending.to_uppercase())] {
                assert_fails(&run(&name), 1, &["nowhere"]);
            }
        }
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
}

#[test]
fn a_folder_is_not_named_like_a_file_unless_it_is_there() {
    let folder = tempfile::tempdir().unwrap();
    let says = "this is to be a folder, and the name is that of a file";
    for command in [
        "match nowhere nowhere -o",
        "detect nowhere.off -o",
        "msv nowhere.npy -o",
        "batch nowhere.off -o",
        "track nowhere.off -o",
    ] {
        let run = |name: &str| {
            let path = folder.path().join(name);
            mser3d(command.split(' ').chain([path.to_str().unwrap()]))
        };
        for name in ["matches.png", "regions.JSON", "table.csv", "a.nii.gz", "a.svg"] {
            assert_fails(&run(name), 2, &[name, says]);
        }
        for name in ["results", "results.v2", "png"] {
            assert_fails(&run(name), 1, &["nowhere"]);
        }
        let there = folder.path().join("there.png");
        fs::create_dir_all(&there).unwrap();
        assert_fails(&run("there.png"), 1, &["nowhere"]);
        fs::remove_dir_all(&there).unwrap();
    }
    let manual = folder.path().join("man.html");
    assert_fails(&mser3d(["man", "-o", manual.to_str().unwrap()]), 2, &["man.html", says]);
}

#[test]
fn endings_in_capitals_are_honoured() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let input = folder.path().join("box.npy");
    fs::write(&input, npy([6, 6, 14], |_, _, _| true)).unwrap();
    regions(&input, &folder.path().join("result"), "--quiet");
    let result = path("result");
    for (command, name, begins) in [
        ("render", "picture.PNG", &b"\x89PNG"[..]),
        ("view", "page.Htm", b"<!"),
        ("export", "labels.NII.GZ", b"\x1f\x8b"),
        ("export", "mesh.PLY", b"ply"),
    ] {
        let output = mser3d([command, &result, "-o", &path(name)]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        assert!(fs::read(path(name)).unwrap().starts_with(begins), "{name}");
    }
}
