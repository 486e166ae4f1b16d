//! Just enough of MAT-files of level 5 to read one real array: *MAT-File Format* (The MathWorks),
//! chapter 1. Elements may be compressed by zlib.

use std::io::Read;

const INT8: u32 = 1;
const UINT8: u32 = 2;
const INT16: u32 = 3;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Decompressed bytes beyond which to refuse: a symmetry map takes 8 a vertex.
const LIMIT: u64 = 1 << 28;

/// The numbers of a real array of this name, column by column.
pub(super) fn variable(bytes: &[u8], name: &str) -> Result<Vec<f64>, String> {
    let endian = bytes.get(126..128).ok_or("shorter than a MAT-file's header")?;
    match endian {
        b"IM" => {}
        b"MI" => return Err("a big-endian MAT-file; save it again, or as a text".into()),
        _ => return Err("not a MAT-file of level 5; save with -v6 or -v7, or as a text".into()),
    }
    let mut file = &bytes[128..];
    while !file.is_empty() {
        let (kind, data) = element(&mut file)?;
        let inflated;
        let (kind, data) = if kind == COMPRESSED {
            inflated = inflate(data)?;
            element(&mut &inflated[..])?
        } else {
            (kind, data)
        };
        if kind == MATRIX
            && let Some(numbers) = matrix(data, name)?
        {
            return Ok(numbers);
        }
    }
    Err(format!("no variable {name}"))
}

/// Takes an element from the front: its type and its data.
fn element<'b>(bytes: &mut &'b [u8]) -> Result<(u32, &'b [u8]), String> {
    let word = |at: usize| bytes.get(at..at + 4).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes);
    let cut = || "the file ends within an element; it is truncated".to_string();
    let tag = word(0).ok_or_else(cut)?;
    // A small element has its size in the upper half of the tag and its data in the next four bytes.
    let (kind, size, start) = match tag >> 16 {
        0 => (tag, word(4).ok_or_else(cut)? as usize, 8),
        size => (tag & 0xffff, size as usize, 4),
    };
    let data = bytes.get(start..).and_then(|b| b.get(..size)).ok_or_else(cut)?;
    // All but compressed elements are padded to eight bytes.
    let end = if kind == COMPRESSED { start + size } else { (start + size).next_multiple_of(8) };
    *bytes = bytes.get(end..).unwrap_or(&[]);
    Ok((kind, data))
}

fn inflate(data: &[u8]) -> Result<Vec<u8>, String> {
    let mut inflated = Vec::new();
    let mut reader = flate2::read::ZlibDecoder::new(data).take(LIMIT);
    reader.read_to_end(&mut inflated).map_err(|e| format!("a compressed element is damaged: {e}"))?;
    Ok(inflated)
}

/// The numbers of a matrix element of this name; `None` for another name.
fn matrix(mut data: &[u8], name: &str) -> Result<Option<Vec<f64>>, String> {
    let bytes = &mut data;
    let (_flags, _dimensions) = (element(bytes)?, element(bytes)?);
    if element(bytes)?.1 != name.as_bytes() {
        return Ok(None);
    }
    let (kind, data) = element(bytes)?;
    fn all<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Vec<f64> {
        data.as_chunks::<N>().0.iter().map(|c| number(*c)).collect()
    }
    Ok(Some(match kind {
        INT8 => all(data, |b: [u8; 1]| i8::from_le_bytes(b).into()),
        UINT8 => all(data, |b: [u8; 1]| b[0].into()),
        INT16 => all(data, |b| i16::from_le_bytes(b).into()),
        UINT16 => all(data, |b| u16::from_le_bytes(b).into()),
        INT32 => all(data, |b| i32::from_le_bytes(b).into()),
        UINT32 => all(data, |b| u32::from_le_bytes(b).into()),
        SINGLE => all(data, |b| f32::from_le_bytes(b).into()),
        DOUBLE => all(data, f64::from_le_bytes),
        kind => return Err(format!("variable {name} has numbers of type {kind}, which are not real")),
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    fn tagged(kind: u32, data: &[u8]) -> Vec<u8> {
        let mut bytes = [kind.to_le_bytes(), (data.len() as u32).to_le_bytes()].concat();
        bytes.extend(data);
        bytes.resize(bytes.len().next_multiple_of(8), 0);
        bytes
    }

    fn array(name: &str, kind: u32, data: &[u8]) -> Vec<u8> {
        let flags = tagged(UINT32, &[6, 0, 0, 0, 0, 0, 0, 0]);
        let dimensions = tagged(INT32, &[3, 0, 0, 0, 1, 0, 0, 0]);
        // The name as a small element.
        let mut small = vec![INT8 as u8, 0, name.len() as u8, 0];
        small.extend(name.as_bytes());
        small.resize(8, 0);
        tagged(MATRIX, &[flags, dimensions, small, tagged(kind, data)].concat())
    }

    fn file(elements: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = vec![b' '; 124];
        bytes.extend([0, 1, b'I', b'M']);
        bytes.extend(elements.concat());
        bytes
    }

    #[test]
    fn arrays_plain_and_compressed() {
        let doubles: Vec<u8> = [3.0f64, 2.0, 1.0].iter().flat_map(|x| x.to_le_bytes()).collect();
        let (other, isym) = (array("x", DOUBLE, &[0; 8]), array("isym", DOUBLE, &doubles));
        assert_eq!(variable(&file(&[other.clone(), isym.clone()]), "isym").unwrap(), [3.0, 2.0, 1.0]);

        let shorts = array("isym", UINT16, &[3, 0, 2, 0, 1, 1]);
        let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
        encoder.write_all(&shorts).unwrap();
        let packed = encoder.finish().unwrap();
        let mut element = [COMPRESSED.to_le_bytes(), (packed.len() as u32).to_le_bytes()].concat();
        element.extend(packed);
        // Compressed elements are not padded.
        assert_eq!(variable(&file(&[element.clone(), other.clone()]), "isym").unwrap(), [3.0, 2.0, 257.0]);
        assert_eq!(variable(&file(&[element, other]), "x").unwrap(), [0.0]);

        let whole = file(&[isym]);
        assert!(variable(&whole, "y").unwrap_err().contains("no variable y"));
        for cut in [3, 100, 127, 130, 150, 170, 200, whole.len() - 1] {
            assert!(variable(&whole[..cut], "isym").is_err(), "cut at {cut}");
        }
    }
}
