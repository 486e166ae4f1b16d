//! Masks and label maps: where they lie, which voxels are the body, and how results go back to where users work.

use std::fs;
use std::path::Path;

use crate::cases::case;
use crate::common::*;
use mser3d_volumeio::{Affine, Samples, Volume, read_volume, write_nifti, write_npy};
use serde_json::Value;

const DIMS: [usize; 3] = [36, 20, 16];

/// A trunk with an arm along x, a shorter one along y and a bump: no symmetry.
fn label([x, y, z]: [usize; 3]) -> u8 {
    let trunk = (2..16).contains(&x) && (2..14).contains(&y) && (2..14).contains(&z);
    let arm = (16..34).contains(&x) && (5..9).contains(&y) && (4..8).contains(&z);
    let short = (4..8).contains(&x) && (14..19).contains(&y) && (8..12).contains(&z);
    u8::from(trunk || arm || short)
}

/// The figure in an array whose axis a is axis `order[a]` of the figure, backwards where `flip[a]`; and an affine that
/// puts it where `affine` puts the figure itself.
fn reordered(affine: &Affine, order: [usize; 3], flip: [bool; 3]) -> Volume {
    let dims = order.map(|a| DIMS[a]);
    let figure = |v: [usize; 3]| {
        let mut place = [0; 3];
        (0..3).for_each(|a| place[order[a]] = if flip[a] { dims[a] - 1 - v[a] } else { v[a] });
        place
    };
    let values: Vec<u8> = (0..dims.iter().product())
        .map(|i| label(figure([i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])])))
        .collect();
    let steps = affine.steps();
    let steps = std::array::from_fn(|a| steps[order[a]].map(|x| if flip[a] { -x } else { x }));
    let origin = affine.position(figure([0; 3]).map(|i| i as f64));
    Volume::new(dims, 1, Affine::from_steps(origin, steps).unwrap(), values).unwrap()
}

/// All orders of three axes.
const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

/// Volume, centroid and tip of each region.
fn found(report: &Value) -> Vec<(f64, Vec<f64>, Vec<f64>)> {
    let regions = report["regions"].as_array().unwrap();
    let of = |r: &Value| (r["volume"].as_f64().unwrap(), numbers(&r["centroid"]), numbers(&r["tip"]));
    regions.iter().map(of).collect()
}

const FEW: &str = "--eigenpairs 30 --quiet";

#[test]
fn a_figure_is_the_same_in_every_order_of_axes_and_every_direction() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("m.nii"), folder.path().join("out"));
    // Numbers that single precision holds.
    let plain = Affine::along_axes([-90.0, -126.0, 72.0], [1.0, 1.5, 0.75]).unwrap();
    let mut expected: Option<Vec<_>> = None;
    for order in ORDERS {
        for flips in 0..8 {
            let flip = [0, 1, 2].map(|bit| flips >> bit & 1 == 1);
            write_nifti(&file, &reordered(&plain, order, flip)).unwrap();
            let found = found(&regions(&file, &out, FEW));
            let expected = expected.get_or_insert_with(|| found.clone());
            assert!(found.len() == expected.len() && found.len() >= 3, "{order:?} {flip:?}");
            for (a, b) in found.iter().zip(expected.iter()) {
                assert_eq!(a.0, b.0, "{order:?} {flip:?}");
                let away =
                    |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
                assert!(away(&a.1, &b.1) < 1e-4, "{order:?} {flip:?} {a:?} {b:?}");
            }
        }
    }
}

#[test]
fn oblique_figures_lie_where_their_affine_says_in_every_output() {
    let folder = tempfile::tempdir().unwrap();
    let (file, out) = (folder.path().join("m.nii.gz"), folder.path().join("out"));
    let plain = Affine::along_axes([0.0; 3], [1.0, 1.5, 0.75]).unwrap();
    write_nifti(&file, &reordered(&plain, [0, 1, 2], [false; 3])).unwrap();
    let straight = found(&regions(&file, &out, FEW));
    for (angle, mirror) in [(0.3f64, 1.0), (1.2, -1.0), (-2.5, 1.0), (0.01, -1.0)] {
        let (s, c) = angle.sin_cos();
        let [x, y] = [[c, s, 0.0], [-s * 0.6, c * 0.6, 0.8]];
        let z = [s * 0.8, -c * 0.8, 0.6].map(|v| mirror * v);
        let (x, y, z) = (x, y.map(|v| 1.5 * v), z.map(|v| 0.75 * v));
        let affine = Affine::from_steps([500.0, -20.0, 3.0], [x, y, z]).unwrap();
        let volume = reordered(&affine, [0, 1, 2], [false; 3]);
        write_nifti(&file, &volume).unwrap();
        let report = regions(&file, &out, &format!("{FEW} --write nifti,landmarks"));
        // As the header has it, in single precision.
        let affine = *read_volume(&file, &Default::default()).unwrap().volume.affine();
        for (a, b) in found(&report).iter().zip(&straight) {
            assert!((a.0 / b.0 - 1.0).abs() < 1e-5);
            // The straight figure's places are millimetres along the axes: turned, they are these.
            let index = [b.1[0], b.1[1] / 1.5, b.1[2] / 0.75];
            let there = affine.position(index);
            assert!(a.1.iter().zip(there).all(|(p, q)| (p - q).abs() < 0.05), "{a:?} {there:?}");
        }
        let arrays = mser3d_fileio::read_npz(&out.join("features.npz")).unwrap();
        let mser3d_fileio::NpyValues::F64(grid) = arrays["grid_affine"].values() else { panic!() };
        assert_eq!(grid[..], *affine.matrix().as_flattened());
        let map = read_volume(&out.join("regions.nii.gz"), &Default::default()).unwrap().volume;
        assert_eq!((map.affine(), map.dims()), (&affine, DIMS));
        let vti = fs::read(out.join("volume.vti")).unwrap();
        let head = String::from_utf8_lossy(&vti[..800]).into_owned();
        let direction = head.split("Direction=\"").nth(1).unwrap().split('"').next().unwrap();
        let direction: Vec<f64> = direction.split(' ').map(|x| x.parse().unwrap()).collect();
        let axes = affine.directions();
        assert!((0..9).all(|i| (direction[i] - axes[i % 3][i / 3]).abs() < 1e-12), "{head}");
        // Landmarks are in LPS.
        let marks = json(&out.join("landmarks.mrk.json"));
        let centre = numbers(&marks["markups"][0]["controlPoints"][0]["position"]);
        let centroid = numbers(&report["regions"][0]["centroid"]);
        assert_eq!(centre, [-centroid[0], -centroid[1], centroid[2]]);
        assert_eq!(marks["markups"][1]["coordinateSystem"], "LPS");
    }
}

#[test]
fn a_place_that_is_given_stands_in_place_of_the_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let volume = reordered(&Affine::default(), [0, 1, 2], [false; 3]);
    write_npy(&path("m.npy"), &volume).unwrap();
    write_nifti(&path("m.nii"), &volume.clone().with_affine(Affine::along_axes([7.0; 3], [3.0; 3]).unwrap()))
        .unwrap();
    fs::write(path("affine.txt"), "0 -1 0 5\n2 0 0 6\n0 0 4 7\n0 0 0 1\n").unwrap();
    let run = |name: &str, options: &str| {
        let output = detect(&path(name), &path("out"), &format!("--eigenpairs 30 {options}"));
        assert!(output.status.success(), "{}", text(&output.stderr));
        let report = json(&path("out/regions.json"));
        let affine: Vec<f64> =
            report["grid"]["affine"].as_array().unwrap().iter().flat_map(numbers).collect();
        (affine, text(&output.stderr).to_owned())
    };
    let matrix = |rows: [[f64; 4]; 3]| Affine::new(rows).unwrap().matrix().as_flattened().to_vec();
    let plain = |h: [f64; 3], o: [f64; 3]| {
        matrix([[h[0], 0.0, 0.0, o[0]], [0.0, h[1], 0.0, o[1]], [0.0, 0.0, h[2], o[2]]])
    };
    assert_eq!(run("m.npy", ""), (plain([1.0; 3], [0.0; 3]), String::new()));
    assert_eq!(run("m.npy", "--spacing 0.5,1,2 --origin 1,2,3").0, plain([0.5, 1.0, 2.0], [1.0, 2.0, 3.0]));
    assert_eq!(run("m.npy", "--pitch 0.25").0, plain([0.25; 3], [0.0; 3]));
    let (affine, said) = run("m.nii", "--spacing 2,2,1");
    assert_eq!(affine, plain([2.0, 2.0, 1.0], [7.0; 3]));
    assert!(said.contains("placed as asked, not as the file says"), "{said}");
    let option = format!("--affine {}", path("affine.txt").display());
    let turned = matrix([[0.0, -1.0, 0.0, 5.0], [2.0, 0.0, 0.0, 6.0], [0.0, 0.0, 4.0, 7.0]]);
    assert_eq!(run("m.npy", &option).0, turned);
    let wrong = |options: &str| detect(&path("m.npy"), &path("no"), options);
    assert_fails(&wrong(&format!("{option} --origin 1,2,3")), 2, &["affine", "alone"]);
    assert_fails(&wrong("--spacing 1,1"), 2, &["--spacing takes three numbers"]);
    fs::write(path("shear.txt"), "1 0.3 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n").unwrap();
    let sheared = format!("--affine {}", path("shear.txt").display());
    assert_fails(&wrong(&sheared), 1, &["m.npy: ", "not at right angles (off by 16.7 degrees)", "resample"]);
    assert_fails(
        &detect(&fixtures().join("human_rest.off"), &path("no"), "--label 3"),
        2,
        &["--label needs a volume"],
    );
    assert!(!path("no").exists());
}

#[test]
fn each_label_of_a_label_map_is_a_shape() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    // The figure as 3, twice: a second piece of 7 lies apart; a speck of 9.
    let dims = [36, 44, 16];
    let at = |i: usize| [i % dims[0], i / dims[0] % dims[1], i / (dims[0] * dims[1])];
    let value = |[x, y, z]: [usize; 3]| match y {
        0..20 => 3 * i16::from(label([x, y, z])),
        20..40 => 7 * i16::from(label([x, y - 20, z])),
        _ if y > 40 && (x, z) == (30, 3) => 9,
        _ if y > 41 && x < 4 && z < 4 => 7,
        _ => 0,
    };
    let values: Vec<i16> = (0..dims.iter().product()).map(|i| value(at(i))).collect();
    let affine = Affine::new([[-2., 0., 0., 90.], [0., 0., 1.5, -100.], [0., 1., 0., 30.]]).unwrap();
    let map = Volume::new(dims, 1, affine, values.clone()).unwrap();
    write_nifti(&path("seg.nii.gz"), &map).unwrap();
    fs::write(path("names.csv"), "label,name\n3,\"liver, left\"\n7,spleen\n9,speck\n").unwrap();

    let choose = detect(&path("seg.nii.gz"), &path("no"), "");
    assert_fails(&choose, 2, &["several labels", "3 (2384 voxels)", "--label"]);
    let names = path("names.csv");
    let options = format!("--label all --labels {} --eigenpairs 30 --write nifti,landmarks", names.display());
    let output = detect(&path("seg.nii.gz"), &path("out"), &options);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("label 9 speck has only"), "{}", text(&output.stderr));

    let sums = |wanted: i16| {
        let all = values.iter().enumerate().filter(|(_, v)| **v == wanted).map(|(i, _)| at(i));
        let (mut count, mut sum) = (0, [0.0; 3]);
        for v in all {
            count += 1;
            (0..3).for_each(|a| sum[a] += v[a] as f64);
        }
        (count, affine.position(sum.map(|s| s / f64::from(count))))
    };
    let labels = fs::read_to_string(path("out/labels.csv")).unwrap();
    let rows: Vec<&str> = labels.lines().skip(1).collect();
    assert_eq!(rows.len(), 3, "{labels}");
    for (row, (value, name, status, pieces)) in rows.iter().zip([
        (3, "\"liver, left\"", "searched", "1"),
        (7, "spleen", "searched", "2"),
        (9, "speck", "too small", ""),
    ]) {
        let plain = row.replace("liver, left", "liver");
        let fields: Vec<&str> = plain.split(',').collect();
        assert!(row.contains(&format!(",{value},{name},{status},")), "{row}");
        let (count, centre) = sums(value);
        assert_eq!(fields[6], count.to_string());
        if status == "searched" {
            let of = |i: usize| fields[i].parse::<f64>().unwrap();
            assert_eq!(of(7), f64::from(count) * 3.0, "{row}");
            assert!((0..3).all(|a| (of(8 + a) - centre[a]).abs() < 1e-9), "{row} {centre:?}");
            assert_eq!(fields[11], pieces, "{row}");
        }
    }
    let regions = fs::read_to_string(path("out/regions.csv")).unwrap();
    let first = json(&path("out/seg-003-liver, left/regions.json"));
    let second = json(&path("out/seg-007-spleen/regions.json"));
    let [a, b] = [&first, &second].map(|r| r["regions"].as_array().unwrap().len());
    assert_eq!(regions.lines().count(), 1 + a + b);
    assert_eq!((first["input"]["volume"]["body"]["label"].as_i64(), a), (Some(3), b));
    // One map of all regions; each voxel has the number that regions.csv says.
    let written = read_volume(&path("out/regions.nii.gz"), &Default::default()).unwrap().volume;
    assert_eq!((written.affine(), written.dims()), (&affine, dims));
    let Samples::U8(map) = written.samples() else { panic!("{}", written.samples().type_name()) };
    let own = read_volume(&path("out/seg-007-spleen/regions.nii.gz"), &Default::default()).unwrap().volume;
    for (i, number) in map.iter().enumerate() {
        let label = if *number == 0 {
            values[i]
        } else if usize::from(*number) <= a {
            3
        } else {
            7
        };
        assert_eq!(values[i], label);
        let single = own.samples().value(i) as u8;
        assert!(single == 0 || *number == single + a as u8);
    }
    let marks = json(&path("out/landmarks.mrk.json"));
    assert_eq!(marks["markups"][0]["controlPoints"].as_array().unwrap().len(), a + b);
    // A second time everything is kept, and a batch of the folder finds the same.
    let again = detect(&path("seg.nii.gz"), &path("out"), &options);
    assert!(
        text(&again.stdout).starts_with("0 shapes computed, 2 kept, 0 failed"),
        "{}",
        text(&again.stdout)
    );
    fs::create_dir(path("maps")).unwrap();
    fs::create_dir(path("maps/deep")).unwrap();
    fs::copy(path("seg.nii.gz"), path("maps/deep/seg.nii.gz")).unwrap();
    let batch = |more: &[&str]| {
        let mut all = vec!["batch".to_owned(), path("maps").display().to_string(), "-o".to_owned()];
        all.push(path("batch").display().to_string());
        all.extend(["--label", "all", "--eigenpairs", "30", "--quiet"].map(str::to_owned));
        all.extend(more.iter().map(|s| (*s).to_string()));
        mser3d(all)
    };
    assert_fails(&batch(&[]), 1, &["no meshes and no volumes", "--recursive"]);
    assert!(batch(&["--recursive"]).status.success());
    assert_eq!(json(&path("batch/seg-007/regions.json"))["regions"], second["regions"]);
}

/// What `inspect --json` says.
fn inspected(path: &Path, options: &[&str]) -> Value {
    let mut all = vec!["inspect".as_ref(), path.as_os_str(), "--json".as_ref()];
    all.extend(options.iter().map(std::ffi::OsStr::new));
    let output = mser3d(all);
    assert!(output.status.success(), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Volumes that other programs made: the voxels of the body and its centre, by nibabel, pynrrd, tifffile and NumPy.
#[test]
fn volumes_of_other_programs_lie_where_they_should() {
    // The body's middle in its array, in voxels.
    let middle = [14.172240802675585, 14.573578595317725, 11.102006688963211];
    let spaced = [middle[0] * 0.5, middle[1] * 0.5, middle[2] * 2.0];
    let cases: [(&str, &[&str], u64, [f64; 3]); 15] = [
        (
            "nifti_orientation/las.nii.gz",
            &[],
            2392,
            [77.24498361548453, -112.88377961167524, -44.24498327759197],
        ),
        (
            "nifti_orientation/oblique.nii.gz",
            &[],
            2392,
            [3.306678876679479, 40.01034795033144, 25.548219238884474],
        ),
        (
            "nifti_orientation/slicer_lps.nrrd",
            &[],
            2392,
            [-17.086120401337794, -28.744147157190636, 52.20401337792642],
        ),
        ("batch_folder_masks/ras_s.nii.gz", &[], 2392, middle),
        ("batch_folder_masks/u8.npy", &[], 2392, middle),
        ("tiff_spacing/ij.tif", &[], 2392, spaced),
        ("tiff_spacing/ome.ome.tif", &[], 2392, spaced),
        ("tiff_one_ifd/imagej_like_over_4gb.tif", &[], 9600, [14.5, 17.5, 9.5]),
        ("tiff_1bit/bool.tif", &[], 2392, middle),
        ("tiff_1bit/pil1.tif", &[], 2392, middle),
        ("tiff_inverted_lut/miniswhite.tif", &[], 2392, middle),
        ("mask_labels_4d/4d2.nii", &["--volume", "1"], 2392, [29.0 - middle[0], middle[1], middle[2]]),
        (
            "mask_labels_4d/two.seg.nrrd",
            &["--label", "1", "--volume", "0"],
            2392,
            [-middle[0], -middle[1], middle[2]],
        ),
        ("mask_labels_4d/ct.nii", &["--threshold", "0"], 2392, middle),
        ("mask_formats_hint/pair.hdr", &[], 2392, middle),
    ];
    for (name, options, voxels, centre) in cases {
        let Some(path) = case(name) else { return };
        let said = inspected(&path, options);
        let body = &said["volume"]["body"];
        assert_eq!(body["voxels"], voxels, "{name}: {said}");
        let found = numbers(&body["centroid"]);
        assert!(found.iter().zip(centre).all(|(a, b)| (a - b).abs() < 1e-4), "{name}: {found:?} {centre:?}");
    }
}

#[test]
fn what_has_to_be_chosen_is_said() {
    for (name, words) in [
        (
            "mask_labels_4d/labels.nii",
            "several labels: 0 (26408 voxels), 1 (1440 voxels), 2 (792 voxels), 3 (160 voxels)",
        ),
        ("mask_labels_4d/4d2.nii", "the file holds 2 volumes; choose one with --volume N, from 0 to 1"),
        ("mask_labels_4d/ct.nii", "grey values: -1024 (26408 voxels), 300 (2392 voxels)"),
        ("mask_labels_4d/prob.nii", "grey values: 1915 different values from 0 to 0.99"),
        (
            "mask_labels_4d/two.seg.nrrd",
            "a segmentation of 2 layers with a, b; choose a segment with --label NAME",
        ),
    ] {
        let Some(path) = case(name) else { return };
        let folder = tempfile::tempdir().unwrap();
        assert_fails(&detect(&path, &folder.path().join("o"), ""), 2, &[words]);
        let said = inspected(&path, &[]);
        assert!(said["choose"].as_str().unwrap().contains(words), "{said}");
        assert!(said["estimate"].is_null() && said["volume"]["body"].is_null());
    }
}
