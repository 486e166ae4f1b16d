//! Damage that keeps a file's form: other values in JSON, other arrays in a `.npz`. Bytes at random rarely pass a parser.

use arbitrary::Unstructured;
use mser3d_fileio::{NpyArray, NpyValues};
use serde_json::Value;

/// Integers that counts and numbers of things dislike.
const INTEGERS: [i64; 16] = [
    0,
    1,
    2,
    3,
    -1,
    -2,
    7,
    255,
    65_536,
    16_777_216,
    i32::MAX as i64,
    i32::MIN as i64,
    u32::MAX as i64,
    1 << 32,
    i64::MAX,
    i64::MIN,
];

const NUMBERS: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    1e-300,
    1e300,
    -1e300,
    f64::MAX,
    f64::MIN_POSITIVE,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e9,
];

fn integer(input: &mut Unstructured) -> arbitrary::Result<i64> {
    Ok(if input.arbitrary::<u8>()? < 200 { *input.choose(&INTEGERS)? } else { input.arbitrary()? })
}

fn number(input: &mut Unstructured) -> arbitrary::Result<f64> {
    Ok(if input.arbitrary::<u8>()? < 200 { *input.choose(&NUMBERS)? } else { input.arbitrary()? })
}

/// Changes some values of a document.
pub fn patch_json(document: &mut Value, input: &mut Unstructured) -> arbitrary::Result<()> {
    for _ in 0..8 {
        if input.is_empty() {
            break;
        }
        let count = count(document);
        let at = input.int_in_range(0..=count - 1)?;
        let other = nth(document, input.int_in_range(0..=count - 1)?).cloned();
        let kind = input.int_in_range(0..=9u8)?;
        let (number, whole, place) = (number(input)?, integer(input)?, input.arbitrary::<usize>()?);
        let Some(value) = nth(document, at) else { continue };
        match kind {
            0 => *value = Value::Null,
            1..=3 => *value = whole.into(),
            4 => *value = number.into(),
            5 => *value = "../..\u{1b}[31m".into(),
            6 => *value = other.unwrap_or_default(),
            7 => *value = Value::Array(Vec::new()),
            _ => match value {
                Value::Array(list) if !list.is_empty() => {
                    let place = place % list.len();
                    if kind == 8 { drop(list.remove(place)) } else { list.push(list[place].clone()) }
                }
                Value::Object(map) if !map.is_empty() => {
                    let key = map.keys().nth(place % map.len()).cloned().unwrap_or_default();
                    map.remove(&key);
                }
                Value::Bool(flag) => *flag = !*flag,
                _ => *value = (number.abs() as u64).into(),
            },
        }
    }
    Ok(())
}

/// How many values there are, those within others too.
fn count(value: &Value) -> usize {
    1 + match value {
        Value::Array(list) => list.iter().map(count).sum::<usize>(),
        Value::Object(map) => map.values().map(count).sum(),
        _ => 0,
    }
}

fn nth(value: &mut Value, at: usize) -> Option<&mut Value> {
    let mut left = at;
    find(value, &mut left)
}

fn find<'a>(value: &'a mut Value, left: &mut usize) -> Option<&'a mut Value> {
    if *left == 0 {
        return Some(value);
    }
    *left -= 1;
    match value {
        Value::Array(list) => list.iter_mut().find_map(|inner| find(inner, left)),
        Value::Object(map) => map.values_mut().find_map(|inner| find(inner, left)),
        _ => None,
    }
}

/// Changes some of these named arrays.
pub fn patch_arrays(
    arrays: &mut Vec<(String, NpyArray<'static>)>,
    input: &mut Unstructured,
) -> arbitrary::Result<()> {
    for _ in 0..8 {
        if input.is_empty() || arrays.is_empty() {
            break;
        }
        let at = input.int_in_range(0..=arrays.len() - 1)?;
        match input.int_in_range(0..=9u8)? {
            0 => drop(arrays.remove(at)),
            1 => {
                let from = input.int_in_range(0..=arrays.len() - 1)?;
                arrays[at].1 = arrays[from].1.clone();
            }
            2 => {
                let length = input.int_in_range(0..=arrays[at].1.values().len())?;
                arrays[at].1 = resized(&arrays[at].1, length);
            }
            3 => {
                let length = arrays[at].1.values().len();
                arrays[at].1 = NpyArray::flat(vec![number(input)?; length]);
            }
            4 => {
                let length = arrays[at].1.values().len() + input.int_in_range(1..=40)?;
                arrays[at].1 = resized(&arrays[at].1, length);
            }
            _ => {
                let (whole, number) = (integer(input)?, number(input)?);
                let place = input.arbitrary::<u32>()? as usize;
                arrays[at].1 = changed(&arrays[at].1, place, whole, number);
            }
        }
    }
    Ok(())
}

macro_rules! each_type {
    ($values:expr, $list:ident => $body:expr) => {
        match $values.clone() {
            NpyValues::F64(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::F64($list.into())
            }
            NpyValues::F32(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::F32($list.into())
            }
            NpyValues::I32(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::I32($list.into())
            }
            NpyValues::I64(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::I64($list.into())
            }
            NpyValues::U32(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::U32($list.into())
            }
            NpyValues::U8(list) => {
                let mut $list = list.into_owned();
                $body;
                NpyValues::U8($list.into())
            }
            other => other,
        }
    };
}

/// The array with as many values, its last one repeated; flat.
fn resized(array: &NpyArray<'static>, length: usize) -> NpyArray<'static> {
    NpyArray::flat(each_type!(array.values(), list => {
        let last = list.last().copied().unwrap_or_default();
        list.resize(length, last);
    }))
}

/// The array with another value at a place.
fn changed(array: &NpyArray<'static>, place: usize, whole: i64, number: f64) -> NpyArray<'static> {
    let values = match array.values().clone() {
        NpyValues::F64(list) => {
            let mut list = list.into_owned();
            let place = place % list.len().max(1);
            list.iter_mut().skip(place).take(1).for_each(|x| *x = number);
            NpyValues::F64(list.into())
        }
        NpyValues::F32(list) => {
            let mut list = list.into_owned();
            let place = place % list.len().max(1);
            list.iter_mut().skip(place).take(1).for_each(|x| *x = number as f32);
            NpyValues::F32(list.into())
        }
        other => each_type!(other, list => {
            let place = place % list.len().max(1);
            list.iter_mut().skip(place).take(1).for_each(|x| *x = whole as _);
        }),
    };
    NpyArray::new(array.shape(), values).unwrap_or_else(|error| panic!("{error}"))
}
