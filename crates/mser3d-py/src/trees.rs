//! Component trees of grids, solids and graphs.

use std::sync::Arc;

use mser3d::comptree::{self, GreyValue, Polarity, TreeError};
use mser3d::shape::Connectivity;
use mser3d_cli::CliError;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{flat, indices, wrong};
use crate::errors::{of_library, usage};
use crate::run::{Call, run};
use crate::voxels::Voxels;
use crate::with_numbers;

/// A component tree.
#[pyclass(frozen, module = "mser3d._native")]
pub struct ComponentTree {
    tree: Arc<comptree::ComponentTree>,
}

#[pymethods]
impl ComponentTree {
    fn __len__(&self) -> usize {
        self.tree.len()
    }

    /// -1 for a root.
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let nodes = 0..self.tree.len() as u32;
        flat(py, nodes.map(|n| self.tree.parent(n).map_or(-1, |p| p as i32)).collect()).into_any()
    }

    fn altitudes<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.tree.altitudes().to_vec()).into_any()
    }

    fn volumes<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, (0..self.tree.len() as u32).map(|n| self.tree.volume(n)).collect()).into_any()
    }

    fn persistence<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        flat(py, self.tree.persistence()).into_any()
    }

    /// The smallest node of each element.
    fn node_of<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        let nodes = self.tree.nodes_of_vertices();
        flat(py, nodes.iter().map(|&n| n as i32).collect()).into_any()
    }

    /// The elements of a node.
    fn elements<'py>(&self, py: Python<'py>, node: u32) -> PyResult<Bound<'py, PyAny>> {
        if node as usize >= self.tree.len() {
            return Err(wrong("node", format!("{node} of {}", self.tree.len())));
        }
        Ok(flat(py, self.tree.vertices(node).iter().map(|&v| v as i32).collect()).into_any())
    }
}

/// How trees are built.
struct Settings {
    polarity: Polarity,
    connectivity: Connectivity,
    volumes: Option<Vec<f64>>,
    volume: f64,
}

impl Settings {
    fn new(
        polarity: &str,
        connectivity: &str,
        volume: f64,
        volumes: Option<PyReadonlyArray1<'_, f64>>,
    ) -> PyResult<Self> {
        Ok(Self {
            polarity: polarity.parse().map_err(|e| wrong("polarity", e))?,
            connectivity: connectivity.parse().map_err(|e| wrong("connectivity", e))?,
            volumes: volumes.map(|v| Ok::<_, PyErr>(v.as_slice()?.to_vec())).transpose()?,
            volume,
        })
    }

    fn volumes(&self) -> comptree::Volumes<'_> {
        match &self.volumes {
            Some(volumes) => volumes.into(),
            None => self.volume.into(),
        }
    }
}

fn build(
    py: Python<'_>,
    work: impl FnOnce() -> Result<comptree::ComponentTree, TreeError> + Send + 'static,
) -> PyResult<ComponentTree> {
    let tree = run(py, &Call { progress: None, threads: None }, move |_| work().map_err(of_library))?;
    Ok(ComponentTree { tree: Arc::new(tree) })
}

/// 64-bit integers as f64, where that is exact.
fn exact(values: impl Iterator<Item = Option<f64>>) -> Result<Vec<f64>, CliError> {
    let values: Option<Vec<f64>> = values.collect();
    values.ok_or_else(|| usage("values: an integer beyond 2^53 is not exact as float64; give another type"))
}

/// The numbers of an array of one axis, in the type that a tree takes; `$values` is a vector.
macro_rules! with_grey_values {
    ($array:expr, $values:ident => $action:expr) => {{
        if let Ok(read) = $array.extract::<PyReadonlyArray1<'_, i64>>() {
            let most = 1i64 << 53;
            let each = read.as_slice()?.iter().map(|&x| (-most..=most).contains(&x).then_some(x as f64));
            let $values: Vec<f64> = exact(each).map_err(crate::errors::exception)?;
            $action
        } else if let Ok(read) = $array.extract::<PyReadonlyArray1<'_, u64>>() {
            let each = read.as_slice()?.iter().map(|&x| (x <= 1 << 53).then_some(x as f64));
            let $values: Vec<f64> = exact(each).map_err(crate::errors::exception)?;
            $action
        } else if let Ok(read) = $array.extract::<PyReadonlyArray1<'_, bool>>() {
            let $values: Vec<u8> = read.as_slice()?.iter().map(|&x| u8::from(x)).collect();
            $action
        } else {
            with_numbers!($array, read => {
                let $values = read.as_slice()?.to_vec();
                $action
            }, [u8, i8, u16, i16, u32, i32, f32, f64])
        }
    }};
}

fn of_grid<V: GreyValue>(
    py: Python<'_>,
    dims: [usize; 3],
    values: Vec<V>,
    settings: Settings,
) -> PyResult<ComponentTree> {
    build(py, move || {
        let Settings { polarity, connectivity, .. } = settings;
        comptree::ComponentTree::from_grid(dims, connectivity, &values, settings.volumes(), polarity)
    })
}

/// The tree of an image or a volume: a value for each voxel, the first of `dims` fastest.
#[pyfunction]
#[pyo3(signature = (dims, values, polarity, connectivity, volume=1.0, volumes=None))]
pub fn grid_tree(
    py: Python<'_>,
    dims: [usize; 3],
    values: &Bound<'_, PyAny>,
    polarity: &str,
    connectivity: &str,
    volume: f64,
    volumes: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<ComponentTree> {
    let settings = Settings::new(polarity, connectivity, volume, volumes)?;
    with_grey_values!(values, values => of_grid(py, dims, values, settings))
}

/// The tree of the linked voxels of a solid: a value for each of them.
#[pyfunction]
#[pyo3(signature = (voxels, values, polarity, connectivity, volume=1.0, volumes=None))]
pub fn solid_tree(
    py: Python<'_>,
    voxels: &Voxels,
    values: PyReadonlyArray1<'_, f64>,
    polarity: &str,
    connectivity: &str,
    volume: f64,
    volumes: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<ComponentTree> {
    let settings = Settings::new(polarity, connectivity, volume, volumes)?;
    let (grid, values) = (Arc::clone(&voxels.grid), values.as_slice()?.to_vec());
    build(py, move || {
        let Settings { polarity, connectivity, .. } = settings;
        comptree::ComponentTree::from_voxel_grid(&grid, connectivity, &values, settings.volumes(), polarity)
    })
}

/// The tree of a graph with weights on its vertices, or on its edges.
#[pyfunction]
#[pyo3(signature = (n, edges, values, of_edges, polarity, volume=1.0, volumes=None))]
#[allow(clippy::too_many_arguments)]
pub fn graph_tree(
    py: Python<'_>,
    n: usize,
    edges: PyReadonlyArray2<'_, i64>,
    values: PyReadonlyArray1<'_, f64>,
    of_edges: bool,
    polarity: &str,
    volume: f64,
    volumes: Option<PyReadonlyArray1<'_, f64>>,
) -> PyResult<ComponentTree> {
    let settings = Settings::new(polarity, "6", volume, volumes)?;
    let edges = indices::<2>("graph", &edges, n)?;
    let values = values.as_slice()?.to_vec();
    build(py, move || {
        let polarity = settings.polarity;
        if of_edges {
            comptree::ComponentTree::from_edge_weights(n, &edges, &values, settings.volumes(), polarity)
        } else {
            comptree::ComponentTree::from_vertex_weights(&edges, &values, settings.volumes(), polarity)
        }
    })
}
