//! Meshes of cells against what their cells are: volumes, which vertices there are, what is told.

use mser3d_meshio::{LoadedMesh, MeshFormat, ReadOptions, read_mesh, read_mesh_from};
use mser3d_shape::TriangleMesh;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

fn read(format: MeshFormat, bytes: &[u8]) -> LoadedMesh {
    read_mesh_from(format, bytes, Path::new("made"), &ReadOptions::default()).unwrap()
}

/// V - E + F of the vertices that are used, after checking that each edge is used once each way.
fn euler(mesh: &TriangleMesh) -> i64 {
    let mut edges: HashMap<[u32; 2], [usize; 2]> = HashMap::new();
    for &[a, b, c] in mesh.triangles() {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            edges.entry([u.min(v), u.max(v)]).or_default()[usize::from(u < v)] += 1;
        }
    }
    assert!(edges.values().all(|&[there, back]| there == back), "the boundary is closed");
    let used: BTreeSet<u32> = mesh.triangles().as_flattened().iter().copied().collect();
    used.len() as i64 - edges.len() as i64 + mesh.triangles().len() as i64
}

/// What `tests/files/make.py` says of each file beside it.
#[test]
fn files_of_vtk_meshio_and_gmsh_hold_the_same_solid() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files"));
    let mut read = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        if MeshFormat::from_extension(&path).is_none() {
            continue;
        }
        let loaded = read_mesh(&path, &ReadOptions::default()).unwrap();
        assert!((loaded.mesh.signed_volume() - 2.0).abs() < 1e-12, "{name}: {}", loaded.mesh.signed_volume());
        assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len()), (2, 20), "{name}");
        // Version 2 of Gmsh saves the vertices that are used.
        let vertices = loaded.mesh.vertices();
        let far = usize::from(!name.starts_with("gmsh_2.2"));
        assert_eq!(vertices.iter().filter(|p| **p == [9.0; 3]).count(), far, "{name}");
        assert_eq!(
            (vertices.len(), vertices[7], vertices[vertices.len() - 1]),
            (12 + far, [0., 1., 1.], [0.5, -1., 1.])
        );
        assert!(loaded.weld.is_none());
        let mut notes = vec!["the mesh is the boundary of 4 volume cells"];
        if !name.starts_with("meshio") {
            notes.extend(["1 triangles or polygons beside the volume cells left out", "1 lines left out"]);
        }
        assert_eq!(loaded.notes, notes, "{name}");
        read += 1;
    }
    assert_eq!(read, 18);
}

/// A box of cubes as a legacy file of VTK, each cut into cells by a rule.
fn cubes([nx, ny, nz]: [usize; 3], cut: impl Fn(usize, [usize; 8]) -> Vec<(u8, Vec<usize>)>) -> String {
    let number = |i: usize, j: usize, k: usize| i + (nx + 1) * (j + (ny + 1) * k);
    let mut points = String::new();
    for k in 0..=nz {
        for j in 0..=ny {
            for i in 0..=nx {
                // Skewed, so that nothing is right by symmetry.
                points +=
                    &format!("{} {} {}\n", i as f64 + 0.25 * j as f64, j, 2.0 * k as f64 + 0.5 * i as f64);
            }
        }
    }
    let mut cells = Vec::new();
    for k in 0..nz {
        for j in 0..ny {
            for i in 0..nx {
                let corner = |c: usize| number(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
                cells.extend(cut(i + j + k, std::array::from_fn(corner)));
            }
        }
    }
    let size: usize = cells.iter().map(|c| 1 + c.1.len()).sum();
    let mut text = format!(
        "# vtk DataFile Version 3.0\ncubes\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {} double\n{points}CELLS {} {size}\n",
        (nx + 1) * (ny + 1) * (nz + 1),
        cells.len()
    );
    for (_, nodes) in &cells {
        let nodes: Vec<String> = nodes.iter().map(usize::to_string).collect();
        text += &format!("{} {}\n", nodes.len(), nodes.join(" "));
    }
    text += &format!("CELL_TYPES {}\n", cells.len());
    cells.iter().for_each(|(kind, _)| text += &format!("{kind}\n"));
    text
}

#[test]
fn the_boundary_has_the_volume_of_the_cells() {
    let voxels = |_: usize, c: [usize; 8]| vec![(11, c.to_vec())];
    let hexahedra = |_: usize, c: [usize; 8]| vec![(12, [0, 1, 3, 2, 4, 5, 7, 6].map(|i| c[i]).to_vec())];
    // The same, seen in a mirror.
    let mirrored = |_: usize, c: [usize; 8]| vec![(12, [1, 0, 2, 3, 5, 4, 6, 7].map(|i| c[i]).to_vec())];
    let wedges = |_: usize, c: [usize; 8]| {
        [[0, 1, 3, 4, 5, 7], [0, 2, 3, 4, 6, 7]].map(|w| (13, w.map(|i| c[i]).to_vec())).into()
    };
    // Five tetrahedra, cut the other way in every second cube; corners in no order, so every second is inverted.
    let tetrahedra = |parity: usize, c: [usize; 8]| {
        let c = if parity.is_multiple_of(2) { c } else { [1, 0, 3, 2, 5, 4, 7, 6].map(|i| c[i]) };
        let five = [[0, 1, 2, 4], [3, 1, 2, 7], [5, 1, 4, 7], [6, 2, 4, 7], [1, 2, 4, 7]];
        five.map(|t| (10, t.map(|i| c[i]).to_vec())).into()
    };
    let (dims, volume) = ([4, 3, 5], 4.0 * 3.0 * 5.0 * 2.0);
    let squares = 2 * (4 * 3 + 3 * 5 + 4 * 5);
    for text in [
        cubes(dims, voxels),
        cubes(dims, hexahedra),
        cubes(dims, mirrored),
        cubes(dims, wedges),
        cubes(dims, tetrahedra),
    ] {
        let loaded = read(MeshFormat::Vtk, text.as_bytes());
        assert!(
            (loaded.mesh.signed_volume() / volume - 1.0).abs() < 1e-12,
            "{}",
            loaded.mesh.signed_volume()
        );
        assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len()), (2, 2 * squares));
        assert_eq!(loaded.mesh.vertices().len(), 5 * 4 * 6);
        assert_eq!(loaded.notes.len(), 1, "{:?}", loaded.notes);
    }
    // Without the cube in the middle there is a ring. Its first corner is the sixth point.
    let ring = cubes([3, 3, 1], |_, c| if c[0] == 5 { vec![] } else { vec![(11, c.to_vec())] });
    let ring = read(MeshFormat::Vtk, ring.as_bytes()).mesh;
    assert_eq!(euler(&ring), 0);
    assert!((ring.signed_volume() - 16.0).abs() < 1e-12);
}

#[test]
fn cells_of_all_kinds_fit_together_where_their_faces_differ() {
    // Two tetrahedra on each side of a cube's face, which VTK's and Gmsh's transitions have: the quadrilateral and
    // the triangles on it are inside.
    let points = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1 .5 .5 2";
    let text = format!(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 9 double\n{points}\nCELLS 3 19\n\
         8 0 1 2 3 4 5 6 7\n4 4 5 7 8\n4 5 6 7 8\nCELL_TYPES 3\n12\n10\n10\n"
    );
    let loaded = read(MeshFormat::Vtk, text.as_bytes());
    assert!((loaded.mesh.signed_volume() - 4.0 / 3.0).abs() < 1e-12);
    assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len()), (2, 14));
}

/// Tetrahedra as a Medit file: points by three numbers, cells by four from 1 on and a reference.
fn tetrahedra(points: &[[f64; 3]], cells: &[[usize; 5]]) -> LoadedMesh {
    let mut text = format!("MeshVersionFormatted 2\nDimension 3\nVertices {}\n", points.len());
    points.iter().for_each(|[x, y, z]| text += &format!("{x} {y} {z} 0\n"));
    text += &format!("Tetrahedra {}\n", cells.len());
    cells.iter().for_each(|[a, b, c, d, part]| text += &format!("{a} {b} {c} {d} {part}\n"));
    read(MeshFormat::Medit, text.as_bytes())
}

const CORNERS: [[f64; 3]; 6] =
    [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [1., 1., 1.], [0., 0., -1.]];

#[test]
fn what_overlaps_or_repeats_is_told() {
    let first = "the mesh is the boundary of";
    let two = tetrahedra(&CORNERS, &[[1, 2, 3, 4, 7], [2, 3, 4, 5, 8]]);
    assert!((two.mesh.signed_volume() - 0.5).abs() < 1e-15);
    assert_eq!(two.notes, [format!("{first} 2 volume cells"), "cells of 2 parts are one solid".into()]);

    // Each cell twice, the second time in another order.
    let twice = [[1, 2, 3, 4, 7], [2, 3, 4, 5, 7], [4, 3, 2, 1, 7], [5, 2, 3, 4, 7]];
    let twice = tetrahedra(&CORNERS, &twice);
    assert_eq!((twice.mesh.signed_volume(), twice.mesh.triangles().len()), (two.mesh.signed_volume(), 6));
    assert_eq!(twice.notes[1], "2 volume cells that repeat an earlier one left out");

    // On one side of a face: volumes of both, one within the other.
    let inside = [CORNERS[0], CORNERS[1], CORNERS[2], CORNERS[3], [0.1, 0.1, 0.5]];
    let overlap = tetrahedra(&inside, &[[1, 2, 3, 4, 0], [1, 2, 3, 5, 0]]);
    assert!((overlap.mesh.signed_volume() - 1.5 / 6.0).abs() < 1e-15);
    assert!(
        overlap.notes[1].starts_with("1 faces have both of their cells on one side"),
        "{:?}",
        overlap.notes
    );

    // Three cells at a face.
    let crowd = [inside[0], inside[1], inside[2], inside[3], inside[4], [0., 0., -1.]];
    let crowd = tetrahedra(&crowd, &[[1, 2, 3, 4, 0], [1, 2, 3, 5, 0], [1, 2, 3, 6, 0]]);
    assert!((crowd.mesh.signed_volume() - 2.5 / 6.0).abs() < 1e-15);
    assert!(crowd.notes[1].starts_with("1 faces belong to more than two cells"), "{:?}", crowd.notes);
}

#[test]
fn vertices_at_one_place_join_cells_and_keep_their_numbers() {
    // The two tetrahedra have a face in common, but each its own corners there.
    let mut points = CORNERS.to_vec();
    points.extend([CORNERS[1], CORNERS[2], CORNERS[3]]);
    points[6][1] = -0.0;
    let loaded = tetrahedra(&points, &[[1, 2, 3, 4, 0], [7, 8, 9, 5, 0]]);
    assert!((loaded.mesh.signed_volume() - 0.5).abs() < 1e-15);
    assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len(), loaded.mesh.vertices().len()), (2, 6, 9));
    assert_eq!(loaded.notes[1], "3 vertices at the place of an earlier one joined with it");
}

#[test]
fn flat_cells_lie_as_their_neighbours_want() {
    // A tetrahedron without volume on the face 2 3 4, whose fourth corner is in that plane.
    let mut points = CORNERS.to_vec();
    points[4] = [1.0, -0.5, 0.5];
    for flat in [[2, 3, 4, 5, 0], [3, 2, 4, 5, 0]] {
        let loaded = tetrahedra(&points, &[[1, 2, 3, 4, 0], flat]);
        assert!((loaded.mesh.signed_volume() - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len()), (2, 6));
    }
    // Nothing but flat cells is no solid.
    let text = "MeshVersionFormatted 2\nDimension 3\nVertices 3\n0 0 0 0\n1 0 0 0\n0 1 0 0\nTetrahedra 1\n1 2 3 3 0\n";
    let read = read_mesh_from(MeshFormat::Medit, text.as_bytes(), Path::new("flat"), &ReadOptions::default());
    assert!(read.unwrap_err().to_string().starts_with("flat: the volume cells have no boundary"));
}

#[test]
fn cells_whose_corners_fall_together_are_what_is_left() {
    // A hexahedron with a collapsed edge is a wedge; its neighbour has a triangle there.
    let points = "0 0 0 1 0 0 1 1 0 0 0 1 1 0 1 1 1 1 0.5 0.25 2";
    let text = format!(
        "# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 double\n{points}\nCELLS 2 14\n\
         8 0 1 2 2 3 4 5 5\n4 3 4 5 6\nCELL_TYPES 2\n12\n10\n"
    );
    let loaded = read(MeshFormat::Vtk, text.as_bytes());
    assert!((loaded.mesh.signed_volume() - (0.5 + 1.0 / 6.0)).abs() < 1e-15);
    assert_eq!((euler(&loaded.mesh), loaded.mesh.triangles().len()), (2, 10));
}

#[test]
fn cells_of_surfaces_are_the_mesh_where_there_are_no_volumes() {
    let text = "# vtk DataFile Version 2.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 7 float\n\
        0 0 0 1 0 0 0 1 0 1 1 0 2 0 0 2 1 0 0.5 0.2 0\nCELLS 6 31\n3 0 1 6\n4 0 1 2 3\n4 1 4 5 3\n5 0 1 4 5 3\n\
        6 0 1 2 3 4 5\n2 0 1\nCELL_TYPES 6\n5\n8\n9\n7\n22\n3\n";
    let text = text.replace("6 0 1 2 3 4 5", "6 0 1 3 6 6 6").replace("CELLS 6 31", "CELLS 6 30");
    let loaded = read(MeshFormat::Vtk, text.as_bytes());
    let triangles =
        [[0, 1, 6], [0, 1, 3], [0, 3, 2], [1, 4, 5], [1, 5, 3], [0, 1, 4], [0, 4, 5], [0, 5, 3], [0, 1, 3]];
    assert_eq!(loaded.mesh.triangles(), triangles);
    assert_eq!(loaded.polygons, 3);
    assert_eq!(
        loaded.notes,
        ["1 cells with nodes between their corners taken as straight", "1 lines left out"]
    );
}
