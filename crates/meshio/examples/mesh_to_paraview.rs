//! Reads a polygonal mesh, colours it by height, and writes it for ParaView and for the web.

use mser3d_meshio::{
    MeshFormat, ReadOptions, VertexAttributes, read_mesh, read_mesh_from, write_glb, write_vtp,
};
use std::error::Error;
use std::path::Path;

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    // A house: walls of four corners, gables of five.
    let text = "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 2\nv 2 0 2\nv 2 3 2\nv 0 3 2\nv 1 0 3\nv 1 3 3\n\
        f 4 3 2 1\nf 1 2 6 9 5\nf 3 4 8 10 7\nf 2 3 7 6\nf 4 1 5 8\nf 6 7 10 9\nf 8 5 9 10\n";
    let path = Path::new("house.obj");
    let read = read_mesh_from(MeshFormat::Obj, text.as_bytes(), path, &ReadOptions::default())?;
    let mesh = &read.mesh;
    println!("{} polygons became {} triangles", read.polygons, mesh.triangles().len());
    println!("volume {}, area {:.3}", mesh.signed_volume(), mesh.area());
    for note in &read.notes {
        println!("note: {note}");
    }

    let colors: Vec<[u8; 3]> =
        mesh.vertices().iter().map(|p| [(80.0 * p[2]) as u8, 90, 255 - (80.0 * p[2]) as u8]).collect();
    let attributes = VertexAttributes { colors: Some(&colors), ..Default::default() };
    let folder = std::env::temp_dir().join(format!("mser3d-house-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    write_vtp(&folder.join("house.vtp"), mesh, &attributes)?;
    for note in write_glb(&folder.join("house.glb"), mesh, &attributes)? {
        println!("note: {note}");
    }

    // Binary glTF repeats no vertex here, so the mesh comes back as it was.
    let again = read_mesh(&folder.join("house.glb"), &ReadOptions::default())?.mesh;
    println!("read back: {} vertices, volume {}", again.vertices().len(), again.signed_volume());
    std::fs::remove_dir_all(&folder)?;
    Ok(())
}
