//! The arrays of `features.npz`.

use mser3d::{Features, Region};
use mser3d_meshio::NpyArray;

use crate::input::Input;

/// Innermost regions as numbers, -1 for none.
pub fn labels(regions: &[Option<u32>]) -> Vec<i32> {
    regions.iter().map(|r| r.map_or(-1, |r| r as i32)).collect()
}

/// Names and arrays; vertices are those of the mesh, `file_vertex` leads to them where the file
/// repeats vertices.
pub fn features(input: &Input, features: &Features) -> Vec<(&'static str, NpyArray<'static>)> {
    let mut arrays = Vec::new();
    arrays.push(("vertex_region", NpyArray::flat(labels(&features.region_of_vertex()))));
    let (start, members) = concatenated(&features.regions, |r| &r.vertices);
    arrays.push(("region_vertices", NpyArray::flat(members)));
    arrays.push(("region_vertices_start", NpyArray::flat(start)));
    if let Some(weld) = input.loaded().and_then(|loaded| loaded.weld.clone()) {
        arrays.push(("file_vertex", NpyArray::flat(weld)));
    }
    if let Some(grid) = features.body.grid() {
        arrays.push(("voxel_region", NpyArray::flat(labels(&features.region_of_element()))));
        let (start, members) = concatenated(&features.regions, |r| &r.elements);
        arrays.push(("region_voxels", NpyArray::flat(members)));
        arrays.push(("region_voxels_start", NpyArray::flat(start)));
        let index: Vec<u32> = grid.voxels().flatten().collect();
        arrays.push(("voxel_index", table(grid.len(), 3, index)));
        arrays.push(("grid_origin", NpyArray::flat(grid.frame().origin().to_vec())));
        arrays.push(("pitch", scalar(grid.frame().spacing()[0])));
    }
    arrays.push(("eigenvalues", NpyArray::flat(features.basis.eigenvalues().to_vec())));
    let descriptors = &features.descriptors;
    let values = descriptors.values().to_vec();
    arrays.push(("region_descriptor", table(descriptors.len(), descriptors.width(), values)));
    arrays
}

/// The members of all regions one after the other, and where each region's begin.
fn concatenated(regions: &[Region], members: impl Fn(&Region) -> &Vec<u32>) -> (Vec<i64>, Vec<u32>) {
    let mut start = vec![0i64];
    let mut all = Vec::new();
    for region in regions {
        all.extend_from_slice(members(region));
        start.push(all.len() as i64);
    }
    (start, all)
}

fn table<T>(rows: usize, columns: usize, values: Vec<T>) -> NpyArray<'static>
where
    Vec<T>: Into<mser3d_meshio::NpyValues<'static>>,
{
    NpyArray::new(&[rows, columns], values).expect("rows times columns values")
}

fn scalar(value: f64) -> NpyArray<'static> {
    NpyArray::new(&[], vec![value]).expect("one value")
}
