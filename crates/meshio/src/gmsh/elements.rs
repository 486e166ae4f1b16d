//! `$Elements`: cells by the tags of their nodes.

use super::Version;
use super::kinds::kind;
use super::nodes::Nodes;
use super::source::Source;
use crate::cells::{Cells, Kind};
use crate::error::Fault;

pub(super) fn read(
    source: &mut Source,
    version: Version,
    nodes: &Nodes,
    cells: &mut Cells,
) -> Result<(), Fault> {
    let mut out = Out { nodes, cells, corners: Vec::new() };
    match (version, source.is_binary()) {
        (Version::V2, false) => {
            let count = source.text_size("the number of elements")?;
            for _ in 0..source.check_fits(count, 4, "elements")? {
                source.int("an element's number")?;
                let kind = kind_of(source)?;
                let tags = source.int("the number of an element's tags")?;
                let part = read_tags(source, tags)?;
                out.element(source, kind, part)?;
            }
        }
        (Version::V2, true) => {
            let count = source.text_size("the number of elements")?;
            let count = source.check_fits(count, 2, "elements")?;
            let mut read = 0;
            while read < count {
                let kind = kind_of(source)?;
                let block = source.int("the number of elements of a block")?;
                let tags = source.int("the number of an element's tags")?;
                if block < 1 || block > (count - read) as i64 {
                    return Err(
                        source.fault(format!("a block of {block} elements, where {} are left", count - read))
                    );
                }
                for _ in 0..block {
                    source.int("an element's number")?;
                    let part = read_tags(source, tags)?;
                    out.element(source, kind, part)?;
                }
                read += block as usize;
            }
        }
        _ => {
            let blocks = source.size("the number of blocks of elements")?;
            source.size("the number of elements")?;
            if version == Version::V41 {
                source.size("the least tag")?;
                source.size("the largest tag")?;
            }
            for _ in 0..blocks {
                let first = source.int("a block's entity")?;
                let second = source.int("a block's entity")?;
                let part = if version == Version::V41 { second } else { first };
                let kind = kind_of(source)?;
                let count = source.size("the number of elements")?;
                for _ in 0..source.check_fits(count, 2, "elements")? {
                    if version == Version::V41 {
                        source.size("an element's number")?;
                        out.element_41(source, kind, Some(part))?;
                    } else {
                        source.int("an element's number")?;
                        out.element(source, kind, Some(part))?;
                    }
                }
            }
        }
    }
    Ok(())
}

/// The kind of an element, and how many nodes it has.
fn kind_of(source: &mut Source) -> Result<(Kind, usize), Fault> {
    let number = source.int("an element's type")?;
    kind(number).ok_or_else(|| {
        source.unsupported(&format!(
            "elements of Gmsh's type {number} are not supported; save the mesh with order 1 or 2"
        ))
    })
}

/// The part that an element belongs to: its physical group, or else the entity that it lies on.
fn read_tags(source: &mut Source, count: i64) -> Result<Option<i64>, Fault> {
    let mut part = None;
    for number in 0..count {
        let tag = source.int("an element's tag")?;
        if number < 2 && part.is_none_or(|p| p == 0) {
            part = Some(tag);
        }
    }
    Ok(part)
}

/// Where elements go.
struct Out<'a> {
    nodes: &'a Nodes,
    cells: &'a mut Cells,
    corners: Vec<u32>,
}

impl Out<'_> {
    /// The nodes of an element, as `int`.
    #[inline]
    fn element(&mut self, source: &mut Source, kind: (Kind, usize), part: Option<i64>) -> Result<(), Fault> {
        let tag = |source: &mut Source| {
            source.int("an element's node").map(|tag| u64::try_from(tag).unwrap_or(u64::MAX))
        };
        self.element_of(source, kind, part, tag)
    }

    /// The same, as `size_t`.
    #[inline]
    fn element_41(
        &mut self,
        source: &mut Source,
        kind: (Kind, usize),
        part: Option<i64>,
    ) -> Result<(), Fault> {
        self.element_of(source, kind, part, |source| source.size("an element's node"))
    }

    #[inline]
    fn element_of(
        &mut self,
        source: &mut Source,
        (kind, nodes): (Kind, usize),
        part: Option<i64>,
        tag: impl Fn(&mut Source) -> Result<u64, Fault>,
    ) -> Result<(), Fault> {
        self.corners.clear();
        for _ in 0..nodes {
            let tag = tag(source)?;
            self.push(source, tag)?;
        }
        self.cells.push(kind, &self.corners, part).map_err(|reason| source.fault(reason))
    }

    #[inline]
    fn push(&mut self, source: &Source, tag: u64) -> Result<(), Fault> {
        let node = self.nodes.find(tag);
        let node = node.ok_or_else(|| {
            source.fault(format!("an element names node {}, which $Nodes does not list", tag as i64))
        })?;
        self.corners.push(node);
        Ok(())
    }
}
