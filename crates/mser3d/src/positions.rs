use mser3d_shape::VoxelGrid;

/// Where the elements of a shape are: centres of voxels, positions of vertices. Those of voxels are made as they are asked for,
/// and take no memory.
#[derive(Clone, Copy, Debug)]
pub struct Positions<'a>(Source<'a>);

#[derive(Clone, Copy, Debug)]
enum Source<'a> {
    Voxels(&'a VoxelGrid),
    Vertices(&'a [[f64; 3]]),
}

impl<'a> Positions<'a> {
    /// The centres of the voxels of a grid.
    pub fn of_voxels(grid: &'a VoxelGrid) -> Self {
        Self(Source::Voxels(grid))
    }

    /// The positions of vertices.
    pub fn of_vertices(vertices: &'a [[f64; 3]]) -> Self {
        Self(Source::Vertices(vertices))
    }

    /// How many there are.
    pub fn len(self) -> usize {
        match self.0 {
            Source::Voxels(grid) => grid.len(),
            Source::Vertices(vertices) => vertices.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(self) -> bool {
        self.len() == 0
    }

    /// Where an element is. For many elements [`for_each_of`](Self::for_each_of) is faster.
    pub fn at(self, element: u32) -> [f64; 3] {
        match self.0 {
            Source::Voxels(grid) => grid.frame().centre(grid.voxel(element)),
            Source::Vertices(vertices) => vertices[element as usize],
        }
    }

    /// Where all elements are, in their order.
    pub fn iter(self) -> impl Iterator<Item = [f64; 3]> + 'a {
        let (voxels, vertices) = match self.0 {
            Source::Voxels(grid) => (Some(grid), &[][..]),
            Source::Vertices(vertices) => (None, vertices),
        };
        let centres = |grid: &'a VoxelGrid| grid.voxels().map(|voxel| grid.frame().centre(voxel));
        voxels.into_iter().flat_map(centres).chain(vertices.iter().copied())
    }

    /// Calls `f` with each of some elements and where it is; ascending ones are fastest.
    #[inline]
    pub fn for_each_of(self, elements: &[u32], mut f: impl FnMut(u32, [f64; 3])) {
        match self.0 {
            Source::Voxels(grid) => {
                let frame = grid.frame();
                let voxels = elements.iter().zip(grid.voxels_of(elements));
                voxels.for_each(|(&element, voxel)| f(element, frame.centre(voxel)));
            }
            Source::Vertices(vertices) => {
                elements.iter().for_each(|&element| f(element, vertices[element as usize]));
            }
        }
    }
}
