//! `$Nodes`: positions, each with a tag that elements name it by.

use super::Version;
use super::source::Source;
use crate::error::Fault;
use std::collections::HashMap;

#[derive(Default)]
pub(super) struct Nodes {
    /// In the order of the file.
    pub positions: Vec<[f64; 3]>,
    numbers: Numbers,
}

/// Which node has a tag.
#[derive(Default)]
enum Numbers {
    /// Node i has the tag i + 1, as it nearly always is.
    #[default]
    InOrder,
    /// The node of each tag, `u32::MAX` for none.
    Dense(Vec<u32>),
    Sparse(HashMap<u64, u32>),
}

impl Nodes {
    pub(super) fn read(source: &mut Source, version: Version) -> Result<Self, Fault> {
        let mut tags: Vec<u64> = Vec::new();
        let mut positions = Vec::new();
        match version {
            Version::V2 => {
                let count = source.text_size("the number of nodes")?;
                let count = source.check_fits(count, 4, "nodes")?;
                tags.reserve_exact(count);
                positions.reserve_exact(count);
                for _ in 0..count {
                    tags.push(tag(source.int("a node's number")?, source)?);
                    positions.push(position(source)?);
                }
            }
            Version::V40 | Version::V41 => {
                let blocks = source.size("the number of blocks of nodes")?;
                let count = source.size("the number of nodes")?;
                let count = source.check_fits(count, 4, "nodes")?;
                tags.reserve_exact(count);
                positions.reserve_exact(count);
                if version == Version::V41 {
                    source.size("the least tag")?;
                    source.size("the largest tag")?;
                }
                for _ in 0..blocks {
                    read_block(source, version, &mut tags, &mut positions)?;
                }
                if positions.len() != count {
                    return Err(source.fault(format!(
                        "{count} nodes are declared, but the blocks hold {}",
                        positions.len()
                    )));
                }
            }
        }
        if positions.len() > u32::MAX as usize {
            return Err(source.fault("the file has more than 2^32 nodes"));
        }
        let numbers =
            Numbers::new(&tags).map_err(|tag| source.fault(format!("two nodes have the number {tag}")))?;
        Ok(Self { positions, numbers })
    }

    /// The node with a tag.
    #[inline]
    pub(super) fn find(&self, tag: u64) -> Option<u32> {
        match &self.numbers {
            Numbers::InOrder => (1..=self.positions.len() as u64).contains(&tag).then(|| (tag - 1) as u32),
            Numbers::Dense(numbers) => {
                numbers.get(usize::try_from(tag).ok()?).copied().filter(|&n| n != u32::MAX)
            }
            Numbers::Sparse(numbers) => numbers.get(&tag).copied(),
        }
    }
}

impl Numbers {
    /// Fails with a tag that occurs twice.
    fn new(tags: &[u64]) -> Result<Self, u64> {
        if tags.iter().enumerate().all(|(i, &tag)| tag == i as u64 + 1) {
            return Ok(Self::InOrder);
        }
        let largest = tags.iter().copied().max().unwrap_or(0);
        if largest < 4 * tags.len() as u64 + 1024 {
            let mut numbers = vec![u32::MAX; largest as usize + 1];
            for (number, &tag) in tags.iter().enumerate() {
                if std::mem::replace(&mut numbers[tag as usize], number as u32) != u32::MAX {
                    return Err(tag);
                }
            }
            return Ok(Self::Dense(numbers));
        }
        let mut numbers = HashMap::with_capacity(tags.len());
        for (number, &tag) in tags.iter().enumerate() {
            if numbers.insert(tag, number as u32).is_some() {
                return Err(tag);
            }
        }
        Ok(Self::Sparse(numbers))
    }
}

fn read_block(
    source: &mut Source,
    version: Version,
    tags: &mut Vec<u64>,
    positions: &mut Vec<[f64; 3]>,
) -> Result<(), Fault> {
    let first = source.int("a block's entity")?;
    let second = source.int("a block's entity")?;
    // Version 4.0 gives the tag first.
    let dimension = if version == Version::V41 { first } else { second };
    let parametric = source.int("whether the nodes have parameters")? != 0;
    let parameters = if parametric { dimension.clamp(0, 3) } else { 0 };
    let count = source.size("the number of nodes")?;
    let count = source.check_fits(count, 4, "nodes")?;
    if version == Version::V41 {
        for _ in 0..count {
            tags.push(source.size("a node's number")?);
        }
    }
    for _ in 0..count {
        if version == Version::V40 {
            tags.push(tag(source.int("a node's number")?, source)?);
        }
        positions.push(position(source)?);
        for _ in 0..parameters {
            source.double("a parameter")?;
        }
    }
    Ok(())
}

fn tag(value: i64, source: &Source) -> Result<u64, Fault> {
    u64::try_from(value).map_err(|_| source.fault(format!("a node has the number {value}")))
}

fn position(source: &mut Source) -> Result<[f64; 3], Fault> {
    Ok([source.double("coordinate x")?, source.double("coordinate y")?, source.double("coordinate z")?])
}
