use mser3d_viewer::PageGrey;
use mser3d_volumeio::Volume;

/// More grey values make a page heavy; of a larger volume every second, third ... voxel is shown.
const MOST: usize = 4_000_000;
/// The share of the values that is as dark, or as bright, as can be: single outliers must not make the rest one grey.
const CLIPPED: f64 = 0.002;

/// The grey values of a volume for a page: the mean of the channels, stretched from dark to bright.
pub(super) fn page_grey(volume: &Volume) -> PageGrey {
    let (dims, channels) = (volume.dims(), volume.channels());
    let step = (1..).find(|&step| coarse(dims, step).iter().product::<usize>() <= MOST).unwrap_or(1);
    let values = volume.samples().to_f64();
    let of = |i: usize| values[i * channels..][..channels].iter().sum::<f64>() / channels as f64;
    let [nx, ny, nz] = dims;
    let along = |n: usize| (0..n).step_by(step);
    let values: Vec<f64> = along(nz)
        .flat_map(|k| along(ny).map(move |j| (j, k)))
        .flat_map(|(j, k)| along(nx).map(move |i| (k * ny + j) * nx + i))
        .map(of)
        .collect();
    let mut sorted: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let clipped = (CLIPPED * sorted.len() as f64) as usize;
    let low = sorted.get(clipped).copied().unwrap_or(0.0);
    let high = sorted.iter().rev().nth(clipped).copied().unwrap_or(0.0);
    let width = if high > low { high - low } else { 1.0 };
    // What is not a number is dark.
    let byte = |x: f64| (255.0 * ((x - low) / width).clamp(0.0, 1.0)).round() as u8;
    PageGrey { dims: coarse(dims, step), step, values: values.into_iter().map(byte).collect() }
}

/// How many voxels of each axis are left when every so many is taken.
fn coarse(dims: [usize; 3], step: usize) -> [usize; 3] {
    dims.map(|n| n.div_ceil(step))
}

#[cfg(test)]
mod tests {
    use mser3d_volumeio::Affine;

    use super::*;

    #[test]
    fn greys_are_stretched_and_large_volumes_thinned() {
        let volume =
            Volume::new([3, 2, 1], 1, Affine::default(), vec![-1.0f64, 0.0, 1.0, f64::NAN, 1.0, -1.0]);
        let grey = page_grey(&volume.unwrap());
        assert_eq!((grey.dims, grey.step), ([3, 2, 1], 1));
        assert_eq!(grey.values, [0, 128, 255, 0, 255, 0]);
        // Ten of five million voxels are bright as nothing else.
        let dims = [500, 100, 100];
        let value = |v: usize| if v < 10 { 60_000u16 } else { (v % 500 / 2) as u16 };
        let volume = Volume::new(dims, 1, Affine::default(), (0..5_000_000).map(value).collect::<Vec<_>>());
        let grey = page_grey(&volume.unwrap());
        assert_eq!((grey.dims, grey.step, grey.values.len()), ([250, 50, 50], 2, 625_000));
        assert!(
            grey.values[249] > 250 && (grey.values[125] as i32 - 128).abs() < 4,
            "{:?}",
            &grey.values[..250]
        );
    }
}
