//! `--write signatures,fields`: what is known of each voxel.

use std::fs;

use mser3d_fileio::{NpyValues, read_npz};

use crate::common::*;

const OPTIONS: &str = "--eigenpairs 30 --reliability 0 -q";

#[test]
fn descriptors_are_means_of_signatures() {
    let folder = tempfile::tempdir().unwrap();
    let input = fixtures().join("human_walk.off");
    for (name, options, elements) in [
        ("volume", "--voxels 2500 --write signatures,fields", "voxels"),
        ("surface", "--surface --write signatures", "vertices"),
    ] {
        let out = folder.path().join(name);
        let record = regions(&input, &out, &format!("{OPTIONS} {options}"));
        assert!(record["regions"].as_array().unwrap().len() > 4);
        let own = read_npz(&out.join("signatures.npz")).unwrap();
        let features = read_npz(&out.join("features.npz")).unwrap();
        let (NpyValues::F64(signature), NpyValues::F64(descriptor)) =
            (own["signature"].values(), features["region_descriptor"].values())
        else {
            panic!("{:?}", own.keys());
        };
        let (q, width) = (own["signature"].shape()[1], features["region_descriptor"].shape()[1]);
        assert_eq!(q, 6);
        let (NpyValues::U32(members), NpyValues::I64(starts)) = (
            features[&format!("region_{elements}")[..]].values(),
            features[&format!("region_{elements}_start")[..]].values(),
        ) else {
            panic!("{:?}", features.keys());
        };
        let NpyValues::I32(row_of_vertex) = own["vertex_row"].values() else { panic!("vertex_row") };
        for region in 0..starts.len() - 1 {
            let members = &members[starts[region] as usize..starts[region + 1] as usize];
            if elements == "vertices" {
                // Weighed by areas, which are not in the file: the mean is within the range.
                let rows = members.iter().map(|&v| row_of_vertex[v as usize] as usize);
                let first = rows.map(|row| signature[row * q]);
                let (low, high) = first.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
                assert!((low..=high).contains(&descriptor[region * width]));
                continue;
            }
            for j in 0..q {
                let sum: f64 = members.iter().map(|&v| signature[v as usize * q + j]).sum();
                let (mean, expected) = (sum / members.len() as f64, descriptor[region * width + j]);
                assert!((mean - expected).abs() < 1e-9 * expected.abs(), "{region} {j}: {mean} {expected}");
            }
        }
    }
    let vti = fs::read(folder.path().join("volume/fields.vti")).unwrap();
    let head = String::from_utf8_lossy(&vti);
    for name in ["eigenfunction_0", "eigenfunction_11", "signature_0", "signature_5", "inside"] {
        assert!(head.contains(&format!("Name=\"{name}\"")), "{name}");
    }
    assert!(!head.contains("eigenfunction_12") && !head.contains("signature_6"));
    assert!(!folder.path().join("volume/eigenfunctions.npz").exists());
}

#[test]
fn a_surface_has_no_fields() {
    let folder = tempfile::tempdir().unwrap();
    let output =
        detect(&fixtures().join("human_walk.off"), &folder.path().join("out"), "--surface --write fields");
    assert_fails(&output, 2, &["--write fields", "--surface", "eigenfunctions,signatures"]);
    assert!(!folder.path().join("out").exists());
}
