//! TIFF files with one page for each layer.
use crate::error::Fault;
use crate::{Affine, LoadedVolume, Samples, Volume, VolumeFormat};
use std::io::{BufRead, Seek};
use tiff::decoder::{Decoder, DecodingResult};
use tiff::{ColorType, TiffError};

impl From<TiffError> for Fault {
    fn from(error: TiffError) -> Self {
        match error {
            TiffError::IoError(error) => error.into(),
            TiffError::UnsupportedError(what) => {
                Fault::unsupported(format!("{what}; export it without that"))
            }
            other => Fault::invalid(format!("not a whole TIFF file: {other}")),
        }
    }
}

pub(crate) fn read(source: impl BufRead + Seek) -> Result<LoadedVolume, Fault> {
    let mut decoder = Decoder::new(source)?;
    let first = (decoder.dimensions()?, decoder.colortype()?);
    let channels = match first.1 {
        ColorType::Gray(_) => 1,
        ColorType::GrayA(_) => 2,
        ColorType::RGB(_) => 3,
        ColorType::RGBA(_) => 4,
        ColorType::Multiband { num_samples, .. } => num_samples.into(),
        other => {
            return Err(Fault::unsupported(format!("colours of type {other:?}; export grey values or RGB")));
        }
    };
    let mut values = values(decoder.read_image()?)?;
    let mut layers = 1;
    while decoder.more_images() {
        decoder.next_image()?;
        let page = (decoder.dimensions()?, decoder.colortype()?);
        if page != first {
            return Err(Fault::invalid(format!(
                "page {} is {page:?}, but the first is {first:?}; the pages of a stack are alike",
                layers + 1
            )));
        }
        append(&mut values, self::values(decoder.read_image()?)?)?;
        layers += 1;
    }
    let (width, height) = first.0;
    let dims = [width as usize, height as usize, layers];
    let volume = Volume::new(dims, channels, Affine::default(), values)?;
    Ok(LoadedVolume::plain(volume, VolumeFormat::Tiff))
}

fn values(page: DecodingResult) -> Result<Samples, Fault> {
    Ok(match page {
        DecodingResult::U8(v) => Samples::U8(v),
        DecodingResult::I8(v) => Samples::I8(v),
        DecodingResult::U16(v) => Samples::U16(v),
        DecodingResult::I16(v) => Samples::I16(v),
        DecodingResult::U32(v) => Samples::U32(v),
        DecodingResult::I32(v) => Samples::I32(v),
        DecodingResult::U64(v) => Samples::U64(v),
        DecodingResult::I64(v) => Samples::I64(v),
        DecodingResult::F16(v) => Samples::F32(v.into_iter().map(f32::from).collect()),
        DecodingResult::F32(v) => Samples::F32(v),
        DecodingResult::F64(v) => Samples::F64(v),
    })
}

fn append(all: &mut Samples, page: Samples) -> Result<(), Fault> {
    let (first, other) = (all.type_name(), page.type_name());
    if !all.append(page) {
        return Err(Fault::invalid(format!(
            "pages of {first} and of {other}; the pages of a stack are alike"
        )));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Cursor;
    use tiff::encoder::{TiffEncoder, colortype};

    #[test]
    fn pages_become_layers_and_rows_y() {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        encoder.write_image::<colortype::Gray16>(3, 2, &[1, 2, 3, 4, 5, 6]).unwrap();
        encoder.write_image::<colortype::Gray16>(3, 2, &[7, 8, 9, 10, 11, 12]).unwrap();
        let whole = file.into_inner();
        let volume = read(Cursor::new(&whole)).unwrap().volume;
        assert_eq!((volume.dims(), volume.channels()), ([3, 2, 2], 1));
        assert_eq!(*volume.samples(), Samples::U16((1..=12).collect()));
        assert!(read(Cursor::new(&whole[..whole.len() / 2])).is_err());
    }

    #[test]
    fn colours_become_channels_and_unlike_pages_are_refused() {
        let mut file = Cursor::new(Vec::new());
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        encoder.write_image::<colortype::RGB8>(1, 2, &[1, 2, 3, 4, 5, 6]).unwrap();
        let volume = read(Cursor::new(file.get_ref())).unwrap().volume;
        assert_eq!((volume.dims(), volume.channels()), ([1, 2, 1], 3));
        let mut encoder = TiffEncoder::new(&mut file).unwrap();
        encoder.write_image::<colortype::RGB8>(1, 1, &[1, 2, 3]).unwrap();
        encoder.write_image::<colortype::Gray8>(1, 1, &[1]).unwrap();
        assert!(read(Cursor::new(file.get_ref())).is_err());
    }
}
