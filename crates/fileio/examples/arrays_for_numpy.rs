//! Hands a table and its labels to Python and takes them back: in numpy,
//! `numpy.load("waves.npz")["heights"]` is an array of shape (4, 3).

use mser3d_fileio::{NpyArray, NpyValues, read_npz, write_npz};
use std::error::Error;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::temp_dir().join(format!("mser3d-waves-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let path = folder.join("waves.npz");

    // Four waves at three places, the last axis fastest; and a label for each wave.
    let heights: Vec<f64> = (0..12).map(|i| f64::from(i).sin()).collect();
    let heights = NpyArray::new(&[4, 3], heights)?;
    write_npz(&path, &[("heights", heights), ("labels", NpyArray::flat(vec![0i32, 1, 1, -1]))])?;

    for (name, array) in read_npz(&path)? {
        print!("{name}: shape {:?}", array.shape());
        if let NpyValues::F64(values) = array.values() {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            print!(", from {low:.3} to {high:.3}");
        }
        println!();
    }
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
