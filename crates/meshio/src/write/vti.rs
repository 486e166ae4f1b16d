use super::check_length;
use super::vtk::{Appended, FLOAT64, INT32, UINT8, VtkFile};
use crate::MeshIoError;
use mser3d_fileio::write_atomically;
use mser3d_shape::{InvalidParameter, VoxelGrid};
use std::io::{self, Write};
use std::path::Path;

/// A named value for each occupied voxel of a grid.
#[derive(Clone, Copy, Debug)]
pub struct VoxelField<'a> {
    /// Its name in ParaView; `inside` is taken.
    pub name: &'a str,
    /// One value per occupied voxel, in the grid's order.
    pub values: VoxelValues<'a>,
}

/// The values of a [`VoxelField`].
#[derive(Clone, Copy, Debug)]
pub enum VoxelValues<'a> {
    /// Labels, such as region numbers with -1 for none; -2 is written for empty voxels.
    Labels(&'a [i32]),
    /// Numbers; NaN is written for empty voxels.
    Numbers(&'a [f64]),
}

impl VoxelValues<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Labels(values) => values.len(),
            Self::Numbers(values) => values.len(),
        }
    }
}

/// Writes a voxel grid as VTK's ImageData (`.vti`), as ParaView opens it: cell data over the box of the
/// occupied voxels and one voxel around it, x fastest, among them `inside` (1 for occupied voxels, 0 for empty
/// ones). The extent says which part of the grid that is, so that cell (i, j, k) is voxel (i, j, k).
///
/// # Errors
/// [`MeshIoError::File`]; [`MeshIoError::Shape`] for a field of another length;
/// [`MeshIoError::InvalidParameter`] for a name that is taken, empty or in need of escapes.
pub fn write_vti(path: &Path, grid: &VoxelGrid, fields: &[VoxelField]) -> Result<(), MeshIoError> {
    for (number, field) in fields.iter().enumerate() {
        check_length("voxel values", field.values.len(), grid.len())?;
        let taken = field.name == "inside" || fields[..number].iter().any(|f| f.name == field.name);
        if taken || field.name.is_empty() || field.name.contains(['<', '>', '&', '"']) {
            let expected = "a name that is not empty, not taken and free of < > & \"";
            return Err(InvalidParameter::new("field name", format!("{:?}", field.name), expected).into());
        }
    }
    let frame = grid.frame();
    let extent = extent(grid);
    let cells: u64 = extent.iter().map(|[from, to]| to - from).product();
    let [[x0, x1], [y0, y1], [z0, z1]] = extent;
    let triple = |v: [f64; 3]| format!("{:?} {:?} {:?}", v[0], v[1], v[2]);
    // Row by row, a column for each axis. VTK 9 and ParaView 5.8 read it; older ones pass over it.
    let directions = frame.directions();
    let direction = |row: usize| directions.map(|axis| axis[row]);
    let mut file = VtkFile::new("ImageData");
    file.line(&format!(
        "<ImageData WholeExtent=\"{x0} {x1} {y0} {y1} {z0} {z1}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{} {} {}\">",
        triple(frame.origin()),
        triple(frame.spacing()),
        triple(direction(0)),
        triple(direction(1)),
        triple(direction(2))
    ));
    let active = fields.first().map_or("inside", |f| f.name);
    file.line(&format!("<Piece Extent=\"{x0} {x1} {y0} {y1} {z0} {z1}\">\n<CellData Scalars=\"{active}\">"));
    for field in fields {
        let (kind, write): (_, Box<dyn Fn(&mut dyn Write) -> io::Result<()>>) = match field.values {
            VoxelValues::Labels(labels) => (
                INT32,
                Box::new(move |out| {
                    write_cells(grid, extent, (-2i32).to_le_bytes(), |v| labels[v].to_le_bytes(), out)
                }),
            ),
            VoxelValues::Numbers(numbers) => (
                FLOAT64,
                Box::new(move |out| {
                    write_cells(grid, extent, f64::NAN.to_le_bytes(), |v| numbers[v].to_le_bytes(), out)
                }),
            ),
        };
        file.array(Appended { kind, name: field.name, components: 1, rows: cells, write });
    }
    file.array(Appended {
        kind: UINT8,
        name: "inside",
        components: 1,
        rows: cells,
        write: Box::new(|out| write_cells(grid, extent, [0], |_| [1], out)),
    });
    file.line("</CellData>\n</Piece>");
    Ok(write_atomically(path, |out| file.write(out))?)
}

/// The part of the grid that holds the occupied voxels, and a voxel around it: from and to along each axis.
fn extent(grid: &VoxelGrid) -> [[u64; 2]; 3] {
    let dims = grid.frame().dims();
    let mut extent = [[u64::MAX, 0]; 3];
    for voxel in grid.voxels() {
        for a in 0..3 {
            let [from, to] = &mut extent[a];
            (*from, *to) = ((*from).min(voxel[a].into()), (*to).max(u64::from(voxel[a]) + 1));
        }
    }
    if grid.is_empty() {
        return dims.map(|d| [0, d as u64]);
    }
    std::array::from_fn(|a| [extent[a][0].saturating_sub(1), (extent[a][1] + 1).min(dims[a] as u64)])
}

/// Writes every cell of a part of the grid, x fastest: of an occupied one the value of its voxel, by the voxel's number. The
/// part holds all voxels.
fn write_cells<const N: usize>(
    grid: &VoxelGrid,
    [[x0, x1], [y0, y1], [z0, z1]]: [[u64; 2]; 3],
    empty: [u8; N],
    value: impl Fn(usize) -> [u8; N],
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut voxels = grid.voxels().enumerate().peekable();
    let mut row = vec![empty; (x1 - x0) as usize];
    for k in z0..z1 {
        for j in y0..y1 {
            row.fill(empty);
            while let Some((v, [i, ..])) = voxels.next_if(|(_, v)| [v[1], v[2]].map(u64::from) == [j, k]) {
                row[(u64::from(i) - x0) as usize] = value(v);
            }
            out.write_all(row.as_flattened())?;
        }
    }
    Ok(())
}
