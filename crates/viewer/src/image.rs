use std::io::Write;

use crate::{Rgb, ViewerError};

/// A picture: rows from the top, pixels from the left.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
}

/// Beyond this a size is a mistake: 2^28 pixels are 768 MiB.
const MAX_PIXELS: u128 = 1 << 28;

impl Image {
    /// A picture of one colour.
    ///
    /// # Errors
    /// [`ViewerError::TooLarge`] beyond 2^28 pixels.
    pub fn new(width: usize, height: usize, colour: Rgb) -> Result<Self, ViewerError> {
        if width as u128 * height as u128 > MAX_PIXELS {
            return Err(ViewerError::TooLarge { width, height });
        }
        Ok(Self { width, height, pixels: vec![colour; width * height] })
    }

    /// Pixels in a row.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All pixels, row by row.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// All pixels, to change.
    pub fn pixels_mut(&mut self) -> &mut [Rgb] {
        &mut self.pixels
    }

    /// Copies another picture in, its top left corner at (x, y); what does not fit is left out.
    pub fn paste(&mut self, other: &Self, x: usize, y: usize) {
        let columns = other.width.min(self.width.saturating_sub(x));
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let from = &other.pixels[row * other.width..][..columns];
            self.pixels[(y + row) * self.width + x..][..columns].copy_from_slice(from);
        }
    }

    /// Writes the picture as PNG (8-bit sRGB). The bytes depend on the pixels alone.
    ///
    /// # Errors
    /// [`ViewerError::Png`] when the picture is empty or the sink fails.
    pub fn write_png(&self, sink: impl Write) -> Result<(), ViewerError> {
        let mut encoder = png::Encoder::new(sink, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let bytes: Vec<u8> = self.pixels.iter().flat_map(|p| p.0).collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&bytes)?;
        Ok(writer.finish()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn png_gives_the_pixels_back() {
        let mut image = Image::new(5, 3, Rgb::WHITE).unwrap();
        image.pixels_mut()[7] = Rgb([1, 2, 3]);
        let mut bytes = Vec::new();
        image.write_png(&mut bytes).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut back).unwrap();
        assert_eq!((info.width, info.height, info.color_type), (5, 3, png::ColorType::Rgb));
        assert_eq!(back, image.pixels().iter().flat_map(|p| p.0).collect::<Vec<u8>>());
    }

    #[test]
    fn pasting_is_clipped_to_the_picture() {
        let mut image = Image::new(3, 2, Rgb::WHITE).unwrap();
        let black = Image::new(2, 2, Rgb([0; 3])).unwrap();
        image.paste(&black, 2, 1);
        image.paste(&black, 9, 9);
        assert_eq!(image.pixels().iter().filter(|p| **p != Rgb::WHITE).count(), 1);
        assert_eq!(image.pixels()[5], Rgb([0; 3]));
    }

    #[test]
    fn absurd_and_empty_pictures_are_errors() {
        assert!(matches!(Image::new(1 << 20, 1 << 20, Rgb::WHITE), Err(ViewerError::TooLarge { .. })));
        let empty = Image::new(0, 3, Rgb::WHITE).unwrap();
        assert!(matches!(empty.write_png(Vec::new()), Err(ViewerError::Png(_))));
    }
}
