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

/// Writes a voxel grid as VTK's ImageData (`.vti`), as ParaView opens it: cell data over the whole
/// box, x fastest, among them `inside` (1 for occupied voxels, 0 for empty ones).
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
    let [nx, ny, nz] = frame.dims();
    let cells = nx as u64 * ny as u64 * nz as u64;
    let triple = |v: [f64; 3]| format!("{:?} {:?} {:?}", v[0], v[1], v[2]);
    // Row by row, a column for each axis. VTK 9 and ParaView 5.8 read it; older ones pass over it.
    let directions = frame.directions();
    let direction = |row: usize| directions.map(|axis| axis[row]);
    let mut file = VtkFile::new("ImageData");
    file.line(&format!(
        "<ImageData WholeExtent=\"0 {nx} 0 {ny} 0 {nz}\" Origin=\"{}\" Spacing=\"{}\" Direction=\"{} {} {}\">",
        triple(frame.origin()),
        triple(frame.spacing()),
        triple(direction(0)),
        triple(direction(1)),
        triple(direction(2))
    ));
    let active = fields.first().map_or("inside", |f| f.name);
    file.line(&format!("<Piece Extent=\"0 {nx} 0 {ny} 0 {nz}\">\n<CellData Scalars=\"{active}\">"));
    for field in fields {
        let (kind, write): (_, Box<dyn Fn(&mut dyn Write) -> io::Result<()>>) = match field.values {
            VoxelValues::Labels(labels) => (
                INT32,
                Box::new(move |out| {
                    each_cell(grid, |voxel| out.write_all(&voxel.map_or(-2, |v| labels[v]).to_le_bytes()))
                }),
            ),
            VoxelValues::Numbers(numbers) => (
                FLOAT64,
                Box::new(move |out| {
                    each_cell(grid, |voxel| {
                        out.write_all(&voxel.map_or(f64::NAN, |v| numbers[v]).to_le_bytes())
                    })
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
        write: Box::new(|out| each_cell(grid, |voxel| out.write_all(&[voxel.is_some().into()]))),
    });
    file.line("</CellData>\n</Piece>");
    Ok(write_atomically(path, |out| file.write(out))?)
}

/// Every cell of the box, x fastest, with the number of its voxel if it is occupied.
fn each_cell(grid: &VoxelGrid, mut write: impl FnMut(Option<usize>) -> io::Result<()>) -> io::Result<()> {
    let [nx, ny, nz] = grid.frame().dims();
    let mut next = 0;
    for row in 0..ny * nz {
        for i in 0..nx {
            let inside = grid.occupancy().get([i as u32, (row % ny) as u32, (row / ny) as u32]);
            write(inside.then_some(next))?;
            next += usize::from(inside);
        }
    }
    Ok(())
}
