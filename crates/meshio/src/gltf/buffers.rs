//! The bytes that a glTF file refers to: its binary chunk, data URIs, files beside it.

use crate::budget::Budget;
use crate::error::Fault;
use crate::{MeshFormat, MeshIoError};
use base64::Engine;
use gltf::json;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// What a glTF or GLB file is made of: its JSON as text and parsed, and its binary chunk.
pub(super) type Pieces<'a> = (Cow<'a, [u8]>, json::Root, Option<Cow<'a, [u8]>>);

/// Bytes of memory for an object of the JSON, however short its text is.
const OBJECT: u64 = 600;

/// Takes a glTF or GLB file apart.
pub(super) fn split<'a>(format: MeshFormat, bytes: &'a [u8], budget: &Budget) -> Result<Pieces<'a>, Fault> {
    let (text, chunk) = if format == MeshFormat::Glb {
        if !bytes.starts_with(b"glTF") {
            return Err(Fault::new("a GLB file begins with glTF; this one doesn't"));
        }
        let length = bytes.get(8..12).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        if length.is_none_or(|n| (n as usize) < 12 || n as usize > bytes.len()) {
            return Err(Fault::new("the file is shorter than its header says; it is truncated"));
        }
        let glb = gltf::Glb::from_slice(bytes)
            .map_err(|e| Fault::new(format!("not a GLB file of version 2: {}", reason(&e))))?;
        (glb.json, glb.bin)
    } else {
        (Cow::Borrowed(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)), None)
    };
    let objects = text.iter().filter(|&&byte| byte == b'{').count() as u64;
    budget.take(OBJECT.saturating_mul(objects), || format!("its JSON has {objects} objects"))?;
    let root = json::Root::from_slice(&text).map_err(|e| {
        let line = (e.line() > 0 && chunk.is_none()).then(|| e.line());
        let message = format!("not the JSON of glTF 2.0: {e}");
        line.map_or_else(|| Fault::new(&message), |line| Fault::at(line, &message))
    })?;
    Ok((text, root, chunk))
}

fn reason(error: &gltf::Error) -> String {
    match error {
        gltf::Error::Binary(error) => error.to_string(),
        error => error.to_string(),
    }
}

/// Every buffer, each at least as long as it declares.
pub(super) fn load<'a>(
    root: &json::Root,
    mut chunk: Option<Cow<'a, [u8]>>,
    path: &Path,
    budget: &Budget,
) -> Result<Vec<Cow<'a, [u8]>>, MeshIoError> {
    let mut buffers = Vec::new();
    for (number, buffer) in root.buffers.iter().enumerate() {
        let fault = |reason: String| Fault::new(format!("buffer {number}: {reason}")).in_file(path);
        let data = match &buffer.uri {
            None => chunk.take().ok_or_else(|| {
                fault("it has no address and the file no binary chunk; export again as .glb".into())
            })?,
            Some(uri) if uri.starts_with("data:") => {
                let bytes = uri.len() as u64;
                let what = || format!("buffer {number} has {bytes} characters");
                budget.take(bytes, what).map_err(|fault| fault.in_file(path))?;
                Cow::Owned(decode(uri).map_err(fault)?)
            }
            Some(uri) if uri.contains("://") => {
                let reason = format!("buffer {number} is at {uri}; only files beside this one are read");
                return Err(Fault::unsupported(None, reason).in_file(path));
            }
            Some(uri) => {
                let named = budget.limits.named_file(path, &percent_decode(uri)).map_err(|reason| {
                    fault(format!("{reason}; or export as .glb, which holds its buffers"))
                })?;
                let bytes = std::fs::metadata(&named).map_or(0, |found| found.len());
                let what = || format!("buffer {number} is a file of {bytes} bytes");
                budget.take(bytes, what).map_err(|fault| fault.in_file(path))?;
                let mut data = Vec::new();
                let read =
                    std::fs::File::open(&named).and_then(|file| file.take(bytes).read_to_end(&mut data));
                read.map_err(|error| fault(format!("{}: {error}", named.display())))?;
                Cow::Owned(data)
            }
        };
        if buffer.byte_length.0 > data.len() as u64 {
            return Err(fault(format!(
                "{} bytes are declared, but there are {}; it is truncated; copy or export it again",
                buffer.byte_length.0,
                data.len()
            )));
        }
        buffers.push(data);
    }
    Ok(buffers)
}

fn decode(uri: &str) -> Result<Vec<u8>, String> {
    let (_, data) = uri.split_once(";base64,").ok_or("its data URI is not in base64")?;
    let engine = base64::engine::general_purpose::GeneralPurpose::new(
        &base64::alphabet::STANDARD,
        base64::engine::GeneralPurposeConfig::new()
            .with_decode_padding_mode(base64::engine::DecodePaddingMode::Indifferent),
    );
    engine.decode(data).map_err(|e| format!("its data URI is broken: {e}"))
}

/// `my%20model.bin` is `my model.bin`.
fn percent_decode(uri: &str) -> String {
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let code = uri.get(at + 1..at + 3).filter(|_| bytes[at] == b'%');
        match code.and_then(|code| u8::from_str_radix(code, 16).ok()) {
            Some(byte) => {
                out.push(byte);
                at += 3;
            }
            None => {
                out.push(bytes[at]);
                at += 1;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_and_data_uris_are_decoded() {
        assert_eq!(percent_decode("a%20b%2Fc%zz%"), "a b/c%zz%");
        assert_eq!(decode("data:application/octet-stream;base64,AAEC/w==").unwrap(), [0, 1, 2, 255]);
        assert_eq!(decode("data:;base64,AAEC/w").unwrap(), [0, 1, 2, 255]);
        assert!(decode("data:text/plain,hello").unwrap_err().contains("base64"));
        assert!(decode("data:;base64,A$").unwrap_err().contains("broken"));
    }
}
