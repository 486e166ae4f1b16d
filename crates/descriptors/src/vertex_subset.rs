//! Descriptors of all vertices, of a range, or of a list of them.
use crate::DescriptorError;
use mser3d_shape::EigenbasisView;
use std::ops::Range;

/// Which of n vertices descriptors are computed for: all, a range, or a list.
#[derive(Clone, Copy)]
pub(crate) struct VertexSubset<'a> {
    list: Option<&'a [u32]>,
    first: usize,
    n: usize,
}

impl<'a> VertexSubset<'a> {
    pub(crate) fn all(basis: EigenbasisView<'_>) -> Self {
        Self::range(0..basis.len())
    }

    pub(crate) fn range(vertices: Range<usize>) -> Self {
        Self { list: None, first: vertices.start, n: vertices.len() }
    }

    pub(crate) fn new(n: usize, list: Option<&'a [u32]>) -> Result<Self, DescriptorError> {
        if let Some(list) = list
            && let Some(number) = list.iter().position(|&v| v as usize >= n)
        {
            let (element, index) = ("selection entry", list[number]);
            return Err(DescriptorError::IndexOutOfRange { element, number, index, vertices: n });
        }
        Ok(Self { list, first: 0, n })
    }

    pub(crate) fn len(self) -> usize {
        self.list.map_or(self.n, <[u32]>::len)
    }

    /// The vertex whose descriptor is in this row.
    #[inline]
    pub(crate) fn vertex(self, row: usize) -> usize {
        self.list.map_or(self.first + row, |list| list[row] as usize)
    }
}
