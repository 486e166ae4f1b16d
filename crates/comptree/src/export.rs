//! Trees as DOT, and as bytes.
use std::fmt;
use std::io::{self, Read, Write};

use crate::tree::{NONE, NodeVolumes, Nodes};
use crate::{ComponentTree, Polarity, Volumes};

/// The first bytes of a saved tree; the last of them is the version.
const MAGIC: [u8; 8] = *b"comptre\x01";

impl ComponentTree {
    /// The tree in Graphviz's language: altitude and volume of each node, edges from parents to children.
    ///
    /// ```
    /// use mser3d_comptree::{ComponentTree, Polarity};
    ///
    /// let tree = ComponentTree::from_vertex_weights(&[[0, 1]], &[0.5, 2.0], 1.0, Polarity::Sublevel)?;
    /// assert!(tree.dot().to_string().contains("1 -> 0"));
    /// # Ok::<(), mser3d_comptree::TreeError>(())
    /// ```
    pub fn dot(&self) -> impl fmt::Display + '_ {
        struct Dot<'a>(&'a ComponentTree);
        impl fmt::Display for Dot<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                writeln!(f, "digraph {{")?;
                for node in 0..self.0.len() as u32 {
                    let (altitude, volume) = (self.0.altitude(node), self.0.volume(node));
                    writeln!(f, "    {node} [label=\"{altitude}\\n{volume}\"]")?;
                    if let Some(parent) = self.0.parent(node) {
                        writeln!(f, "    {parent} -> {node}")?;
                    }
                }
                write!(f, "}}")
            }
        }
        Dot(self)
    }

    /// Writes the tree: little-endian, 20 bytes a node and vertex, and 8 more with volumes that differ.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn save(&self, mut to: impl Write) -> io::Result<()> {
        to.write_all(&MAGIC)?;
        let polarity = match self.polarity {
            Polarity::Sublevel => 0u64,
            Polarity::Superlevel => 1,
        };
        let (differ, uniform) = match &self.volumes {
            NodeVolumes::Uniform(volume) => (0u64, *volume),
            NodeVolumes::Each(_) => (1, 0.0),
        };
        for number in [polarity, differ, self.len() as u64, self.vertices.len() as u64, uniform.to_bits()] {
            to.write_all(&number.to_le_bytes())?;
        }
        let ends: Vec<u32> = (0..self.len() as u32).map(|node| self.end(node) as u32).collect();
        for numbers in [&self.parents, &ends, &self.vertices] {
            write_all(&mut to, numbers, |n| n.to_le_bytes())?;
        }
        write_all(&mut to, &self.altitudes, |x| x.to_le_bytes())?;
        if let NodeVolumes::Each(volumes) = &self.volumes {
            write_all(&mut to, volumes, |x| x.to_le_bytes())?;
        }
        to.flush()
    }

    /// Reads a tree that [`save`](Self::save) wrote.
    ///
    /// # Errors
    /// Those of the reader; [`io::ErrorKind::InvalidData`] when the bytes are no tree.
    pub fn load(mut from: impl Read) -> io::Result<Self> {
        let mut head = [0u8; 48];
        from.read_exact(&mut head)?;
        let (magic, numbers) = head.split_at(8);
        if magic != MAGIC {
            return Err(invalid("these bytes are no component tree, or of another version"));
        }
        let numbers = numbers.as_chunks::<8>().0;
        let [polarity, differ, nodes, vertices, uniform] =
            std::array::from_fn(|i| u64::from_le_bytes(numbers[i]));
        if polarity > 1 || differ > 1 || nodes > u64::from(NONE) || vertices > u64::from(NONE) {
            return Err(invalid("the head of the component tree is damaged"));
        }
        let parents = read_all(&mut from, nodes, u32::from_le_bytes)?;
        let ends = read_all(&mut from, nodes, u32::from_le_bytes)?;
        let order = read_all(&mut from, vertices, u32::from_le_bytes)?;
        let altitudes = read_all(&mut from, nodes, f64::from_le_bytes)?;
        let polarity = if polarity == 0 { Polarity::Sublevel } else { Polarity::Superlevel };
        let nodes = Nodes { parents, altitudes, ends, vertices: order };
        check(&nodes, polarity)?;
        let count = nodes.parents.len() as u64;
        let mut tree = Self::assemble(nodes, Volumes::Uniform(f64::from_bits(uniform)), polarity);
        if differ == 1 {
            tree.volumes = NodeVolumes::Each(read_all(&mut from, count, f64::from_le_bytes)?);
        }
        Ok(tree)
    }
}

fn invalid(what: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, what)
}

/// Whatever the accessors rely on: a permutation, slices, and postorder with rising levels.
fn check(nodes: &Nodes, polarity: Polarity) -> io::Result<()> {
    let Nodes { parents, altitudes, ends, vertices } = nodes;
    let mut seen = vec![false; vertices.len()];
    let mut new = |v: u32| seen.get_mut(v as usize).is_some_and(|seen| !std::mem::replace(seen, true));
    let permutation = vertices.iter().all(|&v| new(v));
    let slices = ends.is_sorted() && ends.last().copied().unwrap_or(0) as usize == vertices.len();
    // In postorder the nodes that wait for their parents are a stack, and a parent takes those on top.
    let mut waiting: Vec<usize> = Vec::new();
    let mut sound = permutation && slices;
    for node in 0..parents.len() {
        let mut parts = u32::from(ends[node] > if node == 0 { 0 } else { ends[node - 1] });
        while let Some(child) = waiting.pop_if(|&mut child| parents[child] as usize == node) {
            sound &= polarity.orient(altitudes[child]) < polarity.orient(altitudes[node]);
            parts += 1;
        }
        sound &= parts > 0;
        waiting.push(node);
    }
    sound &= waiting.iter().all(|&root| parents[root] == NONE);
    if sound { Ok(()) } else { Err(invalid("the component tree is damaged")) }
}

fn write_all<T: Copy, const N: usize>(
    to: &mut impl Write,
    items: &[T],
    bytes: fn(T) -> [u8; N],
) -> io::Result<()> {
    for chunk in items.chunks(1 << 14) {
        let block: Vec<u8> = chunk.iter().flat_map(|&item| bytes(item)).collect();
        to.write_all(&block)?;
    }
    Ok(())
}

/// Reads in blocks, so that a damaged count costs no memory.
fn read_all<T, const N: usize>(
    from: &mut impl Read,
    count: u64,
    item: fn([u8; N]) -> T,
) -> io::Result<Vec<T>> {
    let mut items = Vec::new();
    let mut left = count as usize;
    while left > 0 {
        let mut block = vec![0u8; left.min(1 << 14) * N];
        from.read_exact(&mut block)?;
        items.extend(block.as_chunks::<N>().0.iter().map(|&bytes| item(bytes)));
        left -= block.len() / N;
    }
    Ok(items)
}
