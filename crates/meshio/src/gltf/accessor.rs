//! Typed arrays within buffers. Every number of the file is checked before it is used.

use super::exact::Node;
use crate::budget::Budget;
use crate::error::Fault;
use gltf::json;
use json::accessor::{ComponentType, Type};
use json::validation::Checked;
use std::borrow::Cow;

/// A file's JSON and its buffers.
pub(super) struct Asset<'a> {
    pub root: json::Root,
    pub buffers: Vec<Cow<'a, [u8]>>,
    /// The nodes, with the digits that `root` has lost.
    pub nodes: Vec<Node>,
    /// What is left of the memory that reading may take.
    pub budget: &'a Budget<'a>,
}

/// Numbers in rows of equal width.
#[derive(Debug)]
pub(super) struct Rows {
    pub values: Vec<f64>,
    pub width: usize,
}

impl Rows {
    pub(super) fn len(&self) -> usize {
        self.values.len() / self.width
    }

    pub(super) fn iter<const N: usize>(&self) -> impl Iterator<Item = [f64; N]> + '_ {
        debug_assert_eq!(N, self.width);
        self.values.chunks_exact(self.width).map(|row| std::array::from_fn(|i| row[i]))
    }
}

pub(super) fn get<'a, T>(items: &'a [T], index: usize, what: &str) -> Result<&'a T, Fault> {
    let count = items.len();
    items.get(index).ok_or_else(|| {
        Fault::new(format!("{what} {index} is named, but there are {count} (numbered from 0)"))
    })
}

impl Asset<'_> {
    /// The rows of an accessor, which must be of the given type. "Normalized" integers become the
    /// fractions that they stand for.
    pub(super) fn rows(&self, accessor: json::Index<json::Accessor>, expected: Type) -> Result<Rows, Fault> {
        let number = accessor.value();
        let accessor = get(&self.root.accessors, number, "accessor")?;
        let fault = |reason: String| Fault::new(format!("accessor {number}: {reason}"));
        if accessor.type_ != Checked::Valid(expected) {
            return Err(fault(format!("it is not of type {expected:?}")));
        }
        let Checked::Valid(component) = accessor.component_type else {
            return Err(fault("its component type is unknown".into()));
        };
        let (component, width) = (component.0, expected.multiplicity());
        let count = usize::try_from(accessor.count.0).map_err(|_| fault("its count is absurd".into()))?;
        let held: usize = self.buffers.iter().map(|b| b.len()).sum();
        // More than there are bytes is refused as such.
        if count <= held {
            let bytes = 8 * (count * width) as u64;
            let what = || format!("accessor {number} declares {count} rows of {width}");
            self.budget.limits.check_memory(bytes, what)?;
        }
        let mut values = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.unwrap_or_default().0;
                self.array(view, offset, count, width, component).map_err(fault)?
            }
            // A sparse accessor without a view starts from zeros, and the size of the file does not bound
            // them.
            None if count > held => {
                return Err(fault(format!(
                    "it declares {count} rows, more than the file's {held} bytes can hold"
                )));
            }
            None => vec![0.0; count * width],
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_type) = sparse.indices.component_type else {
                return Err(fault("the component type of its sparse indices is unknown".into()));
            };
            let replaced =
                usize::try_from(sparse.count.0).map_err(|_| fault("its count is absurd".into()))?;
            let indices = self
                .array(sparse.indices.buffer_view, sparse.indices.byte_offset.0, replaced, 1, index_type.0)
                .map_err(fault)?;
            let rows = self
                .array(sparse.values.buffer_view, sparse.values.byte_offset.0, replaced, width, component)
                .map_err(fault)?;
            for (&index, row) in indices.iter().zip(rows.chunks_exact(width)) {
                let start = index as usize * width;
                let target = values.get_mut(start..start + width);
                target.ok_or_else(|| fault(format!("sparse row {index} of {count}")))?.copy_from_slice(row);
            }
        }
        if accessor.normalized {
            let (scale, low) = match component {
                ComponentType::I8 => (127.0, -1.0),
                ComponentType::U8 => (255.0, 0.0),
                ComponentType::I16 => (32767.0, -1.0),
                ComponentType::U16 => (65535.0, 0.0),
                ComponentType::U32 | ComponentType::F32 => (1.0, f64::NEG_INFINITY),
            };
            values.iter_mut().for_each(|x| *x = (*x / scale).max(low));
        }
        if let Some(at) = values.iter().position(|x| !x.is_finite()) {
            return Err(fault(format!("row {} has a value that is NaN or infinite", at / width)));
        }
        Ok(Rows { values, width })
    }

    /// `count` rows of `width` components from a place in a buffer view.
    fn array(
        &self,
        view: json::Index<json::buffer::View>,
        offset: u64,
        count: usize,
        width: usize,
        component: ComponentType,
    ) -> Result<Vec<f64>, String> {
        let view = get(&self.root.buffer_views, view.value(), "buffer view").map_err(|f| f.into_reason())?;
        let buffer = get(&self.buffers, view.buffer.value(), "buffer").map_err(|f| f.into_reason())?;
        let size = component.size();
        let stride = view.byte_stride.map_or(size * width, |s| s.0);
        let bytes = usize::try_from(view.byte_offset.unwrap_or_default().0)
            .ok()
            .zip(usize::try_from(view.byte_length.0).ok())
            .and_then(|(start, length)| buffer.get(start..start.checked_add(length)?))
            .ok_or("its buffer view reaches beyond its buffer")?;
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).unwrap_or_default();
        if stride < size * width {
            return Err(format!("its rows of {} bytes come every {stride} bytes", size * width));
        }
        let end = count.checked_sub(1).map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size * width));
        if end.is_none_or(|end| end > bytes.len()) {
            return Err(format!("its {count} rows reach beyond its buffer view of {} bytes", bytes.len()));
        }
        let mut values = Vec::with_capacity(count * width);
        for row in 0..count {
            let row = &bytes[row * stride..][..size * width];
            values.extend(row.chunks_exact(size).map(|b| match component {
                ComponentType::I8 => f64::from(b[0] as i8),
                ComponentType::U8 => f64::from(b[0]),
                ComponentType::I16 => i16::from_le_bytes([b[0], b[1]]).into(),
                ComponentType::U16 => u16::from_le_bytes([b[0], b[1]]).into(),
                ComponentType::U32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
                ComponentType::F32 => f32::from_le_bytes([b[0], b[1], b[2], b[3]]).into(),
            }));
        }
        Ok(values)
    }
}
