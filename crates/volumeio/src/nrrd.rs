//! NRRD with its data in the same file (<https://teem.sourceforge.net/nrrd/format.html>).
use crate::error::Fault;
use crate::sample_type::SampleType;
use crate::volume::{Volume, interleaved};
use crate::{Affine, LoadedVolume, Samples, VolumeFormat, World};
use flate2::read::MultiGzDecoder;
use std::collections::HashMap;
use std::io::{BufRead, Read};

/// What the header says, by field names in lower case.
struct Header(HashMap<String, String>);

pub(crate) fn read(mut source: impl BufRead) -> Result<LoadedVolume, Fault> {
    let header = Header::read(&mut source)?;
    if header.0.contains_key("data file") || header.0.contains_key("datafile") {
        return Err(Fault::unsupported("the data is in another file; save header and data as one .nrrd"));
    }
    let sizes: Vec<usize> = header.numbers("sizes")?;
    let axes: usize = header.numbers("dimension")?.first().copied().unwrap_or_default();
    if sizes.len() != axes || !(1..=4).contains(&axes) {
        return Err(Fault::unsupported(format!(
            "{axes} axes of sizes {sizes:?}; a volume has 3, or 4 with channels"
        )));
    }
    let steps = header.steps(axes)?;
    // The axis that is none of space holds the channels; of four it is the first or last.
    let channel_axis = match axes {
        4 => Some(steps.iter().position(Option::is_none).unwrap_or(3)),
        3 => steps.iter().position(Option::is_none).filter(|_| steps.iter().any(Option::is_some)),
        _ => None,
    };
    if let Some(axis) = channel_axis.filter(|&a| a != 0 && a + 1 != axes) {
        return Err(Fault::unsupported(format!(
            "channels along axis {axis}; make them the first or last axis"
        )));
    }
    let mut dims = [1; 3];
    let mut space = [None; 3];
    let spatial = (0..axes).filter(|&a| Some(a) != channel_axis);
    for (place, axis) in spatial.enumerate() {
        (dims[place], space[place]) = (sizes[axis], steps[axis]);
    }
    let channels = channel_axis.map_or(1, |a| sizes[a]);
    let count = sizes.iter().try_fold(1usize, |n, &axis| n.checked_mul(axis)).unwrap_or(usize::MAX);
    let values = header.values(count, source)?;
    let values = if channel_axis == Some(0) { values } else { interleaved(values, channels) };
    let volume = Volume::new(dims, channels, header.affine(space)?, values)?;
    Ok(LoadedVolume { world: World::ras("mm"), ..LoadedVolume::plain(volume, VolumeFormat::Nrrd) })
}

impl Header {
    fn read(source: &mut impl BufRead) -> Result<Self, Fault> {
        // A header has a dozen lines; who sends gigabytes without a line's end gets an error.
        let mut source = source.take(1 << 20);
        let mut line = || -> Result<String, Fault> {
            let mut bytes = Vec::new();
            source.read_until(b'\n', &mut bytes)?;
            if bytes.last() != Some(&b'\n') {
                return Err(Fault::invalid("the file ends within its header; copy or export it again"));
            }
            Ok(String::from_utf8_lossy(&bytes).trim_end().to_owned())
        };
        if !line()?.starts_with("NRRD000") {
            return Err(Fault::invalid("not an NRRD file: it does not begin with NRRD000"));
        }
        let mut fields = HashMap::new();
        loop {
            let text = line()?;
            if text.is_empty() {
                return Ok(Self(fields));
            }
            // `key:=value` is a remark of the user's.
            if let Some((name, value)) = text.split_once(": ").filter(|_| !text.starts_with('#')) {
                fields.insert(name.trim().to_ascii_lowercase(), value.trim().to_owned());
            }
        }
    }

    fn text(&self, name: &str) -> Option<&str> {
        self.0.get(name).map(String::as_str)
    }

    fn required(&self, name: &str) -> Result<&str, Fault> {
        self.text(name).ok_or_else(|| Fault::invalid(format!("the header has no field {name:?}")))
    }

    fn numbers<T: std::str::FromStr>(&self, name: &str) -> Result<Vec<T>, Fault> {
        let text = self.required(name)?;
        let all = text.split_whitespace().map(|word| word.parse().ok()).collect::<Option<Vec<T>>>();
        all.ok_or_else(|| Fault::invalid(format!("field {name:?} is {text:?}; numbers are expected")))
    }

    /// Each axis's step from a voxel to the next; none of an axis that is not one of space.
    fn steps(&self, axes: usize) -> Result<Vec<Option<[f64; 3]>>, Fault> {
        let wrong = |name: &str| Fault::invalid(format!("field {name:?} does not fit {axes} axes"));
        let steps: Vec<Option<[f64; 3]>> = if let Some(text) = self.text("space directions") {
            vectors(text).ok_or_else(|| wrong("space directions"))?
        } else if self.text("spacings").is_some() {
            let spacings: Vec<f64> = self.numbers("spacings")?;
            let mut along = 0;
            let step = |length: f64| {
                if length.is_nan() || along == 3 {
                    return None;
                }
                let mut step = [0.0; 3];
                step[along] = length;
                along += 1;
                Some(step)
            };
            spacings.into_iter().map(step).collect()
        } else {
            vec![None; axes]
        };
        if steps.len() == axes { Ok(steps) } else { Err(wrong("space directions")) }
    }

    fn affine(&self, steps: [Option<[f64; 3]>; 3]) -> Result<Affine, Fault> {
        let origin = match self.text("space origin") {
            None => [0.0; 3],
            Some(text) => match vectors(text).as_deref() {
                Some(&[Some(origin)]) => origin,
                _ => return Err(Fault::invalid(format!("space origin {text:?}; (x,y,z) is expected"))),
            },
        };
        // Anatomical spaces, turned to right-anterior-superior as in NIfTI.
        let space = self.text("space").unwrap_or_default().to_ascii_lowercase();
        let signs = match space.as_str() {
            "left-posterior-superior" | "lps" => [-1.0, -1.0, 1.0],
            "left-anterior-superior" | "las" => [-1.0, 1.0, 1.0],
            _ => [1.0; 3],
        };
        let turn = |v: [f64; 3]| std::array::from_fn(|i| signs[i] * v[i]);
        let units = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
        let steps = std::array::from_fn(|axis| turn(steps[axis].unwrap_or(units[axis])));
        Ok(Affine::from_steps(turn(origin), steps)?)
    }

    fn sample(&self) -> Result<SampleType, Fault> {
        let name = self.required("type")?;
        Ok(match name {
            "uchar" | "unsigned char" | "uint8" | "uint8_t" => SampleType::U8,
            "signed char" | "int8" | "int8_t" => SampleType::I8,
            "ushort" | "unsigned short" | "unsigned short int" | "uint16" | "uint16_t" => SampleType::U16,
            "short" | "short int" | "signed short" | "signed short int" | "int16" | "int16_t" => {
                SampleType::I16
            }
            "uint" | "unsigned int" | "uint32" | "uint32_t" => SampleType::U32,
            "int" | "signed int" | "int32" | "int32_t" => SampleType::I32,
            "ulonglong" | "unsigned long long" | "unsigned long long int" | "uint64" | "uint64_t" => {
                SampleType::U64
            }
            "longlong"
            | "long long"
            | "long long int"
            | "signed long long"
            | "signed long long int"
            | "int64"
            | "int64_t" => SampleType::I64,
            "float" => SampleType::F32,
            "double" => SampleType::F64,
            _ => return Err(Fault::unsupported(format!("numbers of type {name:?}; save them as float"))),
        })
    }

    fn values(&self, count: usize, mut source: impl BufRead) -> Result<Samples, Fault> {
        let sample = self.sample()?;
        let big_endian = self.text("endian").is_some_and(|e| e.eq_ignore_ascii_case("big"));
        for name in ["line skip", "lineskip", "byte skip", "byteskip"] {
            if self.text(name).is_some_and(|n| n != "0") {
                return Err(Fault::unsupported(format!("field {name:?}; save the file again without it")));
            }
        }
        match self.required("encoding")?.to_ascii_lowercase().as_str() {
            "raw" => sample.read(count, big_endian, source),
            "gzip" | "gz" => sample.read(count, big_endian, MultiGzDecoder::new(source)),
            "ascii" | "text" | "txt" => {
                let mut text = String::new();
                source.read_to_string(&mut text)?;
                let numbers = text.split_whitespace().map(|word| word.parse().ok());
                let numbers: Option<Vec<f64>> = numbers.take(count).collect();
                let numbers = numbers.ok_or_else(|| Fault::invalid("a value is not a number"))?;
                if numbers.len() < count {
                    let found = numbers.len();
                    return Err(Fault::invalid(format!("{count} values are promised, {found} are there")));
                }
                Ok(Samples::F64(numbers))
            }
            other => Err(Fault::unsupported(format!("encoding {other:?}; save the file as raw or gzip"))),
        }
    }
}

/// `(1,0,0) none (0,0,2)`; vectors of fewer than three numbers are filled up with zeros.
fn vectors(text: &str) -> Option<Vec<Option<[f64; 3]>>> {
    let mut all = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix("none") {
            all.push(None);
            rest = after.trim_start();
            continue;
        }
        let (inside, after) = rest.strip_prefix('(')?.split_once(')')?;
        let mut vector = [0.0; 3];
        for (i, word) in inside.split(',').enumerate() {
            *vector.get_mut(i)? = word.trim().parse().ok()?;
        }
        all.push(Some(vector));
        rest = after.trim_start();
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn file(fields: &str, data: &[u8]) -> Vec<u8> {
        [format!("NRRD0004\n# made by hand\n{fields}\n\n").as_bytes(), data].concat()
    }

    const FIELDS: &str = "type: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 1 2\n\
        space directions: (0.5,0,0) (0,0.5,0) (0,0,2)\nspace origin: (10,20,30)\nendian: big\nencoding: raw";

    #[test]
    fn values_and_placement_as_written() {
        let volume = read(&file(FIELDS, &[0, 1, 255, 254, 0, 3, 1, 144])[..]).unwrap().volume;
        assert_eq!(*volume.samples(), Samples::I16(vec![1, -2, 3, 400]));
        assert_eq!(volume.affine().spacing(), [0.5, 0.5, 2.0]);
        assert_eq!(volume.affine().position([1.0, 0.0, 1.0]), [-10.5, -20.0, 32.0]);
    }

    #[test]
    fn channels_first_or_last_are_the_same() {
        let fields = |sizes: &str, directions: &str| {
            format!(
                "type: uchar\ndimension: 4\nsizes: {sizes}\nspace directions: {directions}\nencoding: ascii"
            )
        };
        let (xyz, none) = ("(1,0,0) (0,1,0) (0,0,1)", "none");
        let first =
            read(&file(&fields("2 3 1 1", &format!("{none} {xyz}")), b"1 10 2 20 3 30")[..]).unwrap().volume;
        let last =
            read(&file(&fields("3 1 1 2", &format!("{xyz} {none}")), b"1 2 3 10 20 30")[..]).unwrap().volume;
        assert_eq!(first, last);
        assert_eq!((first.dims(), first.channels()), ([3, 1, 1], 2));
    }

    #[test]
    fn what_is_not_read_says_why() {
        for (wrong, right, says) in [
            ("encoding: bzip2", "encoding: raw", "raw or gzip"),
            ("type: block", "type: short", "float"),
            ("sizes: 2 1", "sizes: 2 1 2", "axes"),
            ("sizes: 2 1 900000", "sizes: 2 1 2", "promises"),
            ("space origin: 1 2 3", "space origin: (10,20,30)", "(x,y,z)"),
            ("data file: other.raw", "endian: big", "another file"),
            ("byte skip: -1", "endian: big", "byte skip"),
        ] {
            let bytes = file(&FIELDS.replace(right, wrong), &[0; 8]);
            let error = read(&bytes[..]).unwrap_err().in_file(Path::new("a.nrrd")).to_string();
            assert!(error.contains(says), "{error}");
        }
        assert!(read(&b"NRRD0004\ntype: short"[..]).is_err());
        assert!(read(&b"P5"[..]).is_err());
    }
}
