use std::io::Write;

use mser3d_shape::InvalidParameter;

use crate::{Image, ViewerError};

/// Writes pictures of one size as an animated PNG that plays for ever. Programs that know no animation show the first.
///
/// ```
/// use mser3d_viewer::{Image, Rgb, write_animation};
/// let pictures = [Image::new(4, 3, Rgb::WHITE)?, Image::new(4, 3, Rgb([0; 3]))?];
/// let mut bytes = Vec::new();
/// write_animation(&pictures, 40.0, &mut bytes)?;
/// assert!(bytes.starts_with(b"\x89PNG") && bytes.windows(4).any(|chunk| chunk == b"acTL"));
/// # Ok::<(), mser3d_viewer::ViewerError>(())
/// ```
///
/// # Errors
/// [`ViewerError::InvalidParameter`] unless a picture lasts from 1 to 60000 milliseconds, [`ViewerError::Empty`] without pictures,
/// [`ViewerError::SizeMismatch`] for pictures of different sizes, [`ViewerError::Png`] when the sink fails.
pub fn write_animation(pictures: &[Image], milliseconds: f64, sink: impl Write) -> Result<(), ViewerError> {
    let valid = (1.0..=60000.0).contains(&milliseconds);
    InvalidParameter::unless(valid, "milliseconds", milliseconds, "from 1 to 60000")?;
    let Some(first) = pictures.first() else { return Err(ViewerError::Empty { reason: "no pictures" }) };
    let (width, height) = (first.width(), first.height());
    for picture in pictures {
        crate::model::fits("pixels of a picture's row", picture.width(), width)?;
        crate::model::fits("rows of a picture", picture.height(), height)?;
    }
    let mut encoder = png::Encoder::new(sink, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_animated(pictures.len() as u32, 0)?;
    encoder.set_frame_delay(milliseconds.round() as u16, 1000)?;
    let mut writer = encoder.write_header()?;
    for picture in pictures {
        let bytes: Vec<u8> = picture.pixels().iter().flat_map(|p| p.0).collect();
        writer.write_image_data(&bytes)?;
    }
    Ok(writer.finish()?)
}

/// How long each frame of a sequence is shown, in milliseconds, from the times of its frames in seconds: as long as it lasts, from 20
/// to 1000; 125 where there are no times.
pub fn frame_milliseconds(times: &[f64]) -> f64 {
    match times {
        [first, .., last] if last > first => {
            (1000.0 * (last - first) / (times.len() - 1) as f64).clamp(20.0, 1000.0).round()
        }
        _ => 125.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Rgb;

    #[test]
    fn frames_play_as_fast_as_they_were() {
        assert_eq!(frame_milliseconds(&[0.0, 0.04, 0.08]), 40.0);
        assert_eq!(frame_milliseconds(&[0.0, 5.0]), 1000.0);
        assert_eq!(frame_milliseconds(&[0.0]), 125.0);
    }

    #[test]
    fn every_picture_comes_back_with_its_time() {
        let colours = [Rgb([1, 2, 3]), Rgb([250, 0, 9]), Rgb([7, 7, 7])];
        let pictures = colours.map(|colour| Image::new(3, 2, colour).unwrap());
        let mut bytes = Vec::new();
        write_animation(&pictures, 41.6, &mut bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 3);
        for colour in colours {
            let mut back = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut back).unwrap();
            assert_eq!(back, colour.0.repeat(6));
            let control = reader.info().frame_control.unwrap();
            assert_eq!((control.delay_num, control.delay_den), (42, 1000));
        }
        let other = Image::new(2, 2, Rgb::WHITE).unwrap();
        let error = write_animation(&[pictures[0].clone(), other], 40.0, Vec::new()).unwrap_err();
        assert!(matches!(error, ViewerError::SizeMismatch { .. }));
        assert!(write_animation(&[], 40.0, Vec::new()).is_err());
        assert!(write_animation(&pictures, 0.0, Vec::new()).is_err());
    }
}
