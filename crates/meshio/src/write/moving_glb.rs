use super::check_length;
use super::glb::{Arrays, MATERIAL, bounds, floats, linear, pack};
use crate::MeshIoError;
use crate::error::Fault;
use mser3d_fileio::write_atomically;
use mser3d_shape::{InvalidParameter, TriangleMesh};
use std::io::Write;
use std::path::Path;

/// A mesh in motion: a moment of it.
#[derive(Clone, Debug)]
pub struct Moment {
    /// When it is, in seconds; ascending.
    pub time: f64,
    /// Where the vertices are.
    pub vertices: Vec<[f64; 3]>,
}

/// Writes a mesh in motion as binary glTF, for Blender and the web: the first moment as the mesh, with colours (`COLOR_0`), the
/// others as morph targets, and an animation that leads from one to the next. Between two moments vertices move in straight lines.
///
/// Of `mesh` the triangles count. Places are in f32 about the first moment's own, so n moments of v vertices have 12 n v bytes.
///
/// # Errors
/// [`MeshIoError::InvalidParameter`] for less than two moments, and times that do not ascend; [`MeshIoError::Shape`] for moments or
/// colours of another length; [`MeshIoError::Unsupported`] for a mesh that is empty, or beyond what f32 and GLB (4 GiB) hold;
/// [`MeshIoError::File`].
pub fn write_moving_glb(
    path: &Path,
    mesh: &TriangleMesh,
    moments: &[Moment],
    colors: &[[u8; 3]],
) -> Result<(), MeshIoError> {
    let [first, others @ ..] = moments else {
        return Err(InvalidParameter::new("moments", 0, "at least 2").into());
    };
    InvalidParameter::unless(!others.is_empty(), "moments", 1, "at least 2")?;
    let needed = mesh.vertices().len();
    check_length("vertex colors", colors.len(), needed)?;
    for moment in moments {
        check_length("vertices of a moment", moment.vertices.len(), needed)?;
    }
    for pair in moments.windows(2) {
        let ascends = pair[0].time.is_finite() && pair[1].time > pair[0].time;
        InvalidParameter::unless(ascends, "time of a moment", pair[1].time, "later than the one before")?;
    }
    let glb = encode(mesh, first, others, colors)
        .map_err(|reason| Fault::unsupported(None, reason).in_file(path))?;
    Ok(write_atomically(path, |out| out.write_all(&glb))?)
}

fn encode(
    mesh: &TriangleMesh,
    first: &Moment,
    others: &[Moment],
    colors: &[[u8; 3]],
) -> Result<Vec<u8>, &'static str> {
    if first.vertices.is_empty() || mesh.triangles().is_empty() {
        return Err("glTF cannot hold a mesh without triangles");
    }
    let mut arrays = Arrays::default();
    let mut places = |positions: Vec<[f32; 3]>| -> Result<usize, &'static str> {
        if positions.iter().flatten().any(|x| !x.is_finite()) {
            return Err(
                "coordinates beyond 3.4e38 do not fit the 32-bit numbers of glTF; scale the mesh down",
            );
        }
        let bytes = floats(positions.iter().flatten().copied());
        Ok(arrays.push(&bytes, "VEC3", 5126, positions.len(), &bounds(&positions)))
    };
    let single = |p: &[f64; 3]| p.map(|x| x as f32);
    let position = places(first.vertices.iter().map(single).collect())?;
    let mut targets = Vec::with_capacity(others.len());
    for moment in others {
        let moved = moment.vertices.iter().zip(&first.vertices);
        let moved = moved.map(|(p, from)| std::array::from_fn(|a| (p[a] - from[a]) as f32)).collect();
        targets.push(format!("{{\"POSITION\":{}}}", places(moved)?));
    }
    let bytes: Vec<u8> = colors
        .iter()
        .flat_map(|c| [linear(c[0]), linear(c[1]), linear(c[2]), u16::MAX])
        .flat_map(u16::to_le_bytes)
        .collect();
    let color = arrays.push(&bytes, "VEC4", 5123, colors.len(), ",\"normalized\":true");
    let indices: Vec<u8> = mesh.triangles().iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let indices = arrays.push(&indices, "SCALAR", 5125, 3 * mesh.triangles().len(), "");

    let times: Vec<f32> =
        std::iter::once(first).chain(others).map(|m| (m.time - first.time) as f32).collect();
    let end = times.iter().copied().fold(0.0, f32::max);
    let input = arrays.push_plain(
        &floats(times.iter().copied()),
        times.len(),
        &format!(",\"min\":[0],\"max\":[{end:?}]"),
    );
    let count = others.len();
    let weights =
        (0..=count).flat_map(|key| (0..count).map(move |target| f32::from(u8::from(target + 1 == key))));
    let output = arrays.push_plain(&floats(weights), (count + 1) * count, "");

    let json = format!(
        "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"mser3d\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\
         \"nodes\":[{{\"mesh\":0}}],\"meshes\":[{{\"weights\":[{}],\"primitives\":[{{\"attributes\":{{\"POSITION\":{position},\
         \"COLOR_0\":{color}}},\"indices\":{indices},\"material\":0,\"targets\":[{}]}}]}}],{MATERIAL},\
         \"animations\":[{{\"name\":\"sequence\",\"channels\":[{{\"sampler\":0,\"target\":{{\"node\":0,\"path\":\"weights\"}}}}],\
         \"samplers\":[{{\"input\":{input},\"output\":{output},\"interpolation\":\"LINEAR\"}}]}}]",
        vec!["0"; count].join(","),
        targets.join(",")
    );
    pack(json, arrays)
}
