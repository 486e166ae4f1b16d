//! Nodes still to visit.

/// A stack of nodes that starts at the root: on the program's stack as long as it is short.
pub(super) struct Stack {
    short: [u32; SHORT],
    len: usize,
    rest: Vec<u32>,
}

/// Deeper than any balanced hierarchy of 2^31 triangles.
const SHORT: usize = 40;

impl Stack {
    pub fn new() -> Self {
        Self { short: [0; SHORT], len: 1, rest: Vec::new() }
    }

    #[inline]
    pub fn push(&mut self, node: usize) {
        if self.len < SHORT {
            self.short[self.len] = node as u32;
            self.len += 1;
        } else {
            self.rest.push(node as u32);
        }
    }

    #[inline]
    pub fn pop(&mut self) -> Option<usize> {
        if let Some(node) = self.rest.pop() {
            return Some(node as usize);
        }
        self.len = self.len.checked_sub(1)?;
        Some(self.short[self.len] as usize)
    }
}
