"""Component trees of whatever has weights: images, volumes, meshes and graphs."""

from __future__ import annotations

import functools
from typing import Any, Literal

import numpy as np

from . import _arrays, _native
from ._operators import _scipy_sparse
from ._voxels import Voxels


class ComponentTree:
    """All components of the level sets of a weight, as a tree: max-tree (superlevel) or min-tree (sublevel).

    Nodes are numbered so that children come before parents, and the descendants of a node directly before it.
    """

    def __init__(self, native: _native.ComponentTree, shape: tuple[int, ...]) -> None:
        self._native, self._shape = native, shape

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return f"<mser3d.ComponentTree: {len(self)} nodes over {int(np.prod(self._shape))} elements>"

    @functools.cached_property
    def parents(self) -> np.ndarray:
        """The smallest component that properly contains each node: (nodes,) int32, -1 for a root."""
        return self._native.parents()

    @functools.cached_property
    def altitudes(self) -> np.ndarray:
        """The level at which each node comes into being, in units of the weight: (nodes,)."""
        return self._native.altitudes()

    @functools.cached_property
    def volumes(self) -> np.ndarray:
        """The volume of each node, the sum over its elements: (nodes,)."""
        return self._native.volumes()

    @functools.cached_property
    def persistence(self) -> np.ndarray:
        """How far the level moves from each node's first element to its merge with an older component, or to the root."""
        return self._native.persistence()

    @functools.cached_property
    def node_of(self) -> np.ndarray:
        """The smallest node of each element, in the shape of the values: int32."""
        return self._native.node_of().reshape(self._shape)

    def elements(self, node: int) -> np.ndarray:
        """The elements of a node, by their place in the values made flat."""
        return self._native.elements(node)


def component_tree(
    values: Any = None,
    graph: Any = None,
    *,
    edge_values: Any = None,
    polarity: Literal["sublevel", "superlevel"] = "sublevel",
    connectivity: Literal[6, 26, "6", "26"] = 6,
    volumes: Any = 1.0,
) -> ComponentTree:
    """The component tree of weights.

    Parameters
    ----------
    values : array
        A weight for each element. Without ``graph`` an image or a volume of up to three axes, whose pixels or voxels are
        neighbours as ``connectivity`` says. With ``graph`` the weight of each of its vertices, (n,).
    graph : sparse matrix, array, mesh or Voxels
        A symmetric sparse adjacency matrix, (n, n), whose numbers are the weights of its edges where ``values`` is None; edges,
        (m, 2); triangles, (m, 3); a mesh of trimesh or alike, whose edges it is; or voxels of a solid with their links.
    edge_values : array
        With edges, (m, 2): the weight of each.
    polarity : str
        Which way the level moves: "sublevel" sets grow while it rises (min-tree), "superlevel" while it falls (max-tree).
    connectivity : int
        Neighbours of a voxel: 6 or 26; of a pixel these are 4 and 8.
    volumes : float or array
        The volume of each element.

    Returns
    -------
    ComponentTree
        With the arrays ``parents``, ``altitudes``, ``volumes`` and ``node_of``.
    """
    way, neighbours = str(polarity), str(connectivity)
    if graph is None:
        if values is None:
            raise ValueError("values: missing; give an image or a volume, or a graph")
        found = _arrays.array("values", values)
        if not 1 <= found.ndim <= 3 or found.size == 0:
            raise ValueError(f"values: must have one to three axes and not be empty, not the shape {found.shape}")
        # The last axis is the fastest.
        dims = [*reversed(found.shape), 1, 1][:3]
        volume, each = _volumes(volumes, found.shape)
        flat = np.ascontiguousarray(_arrays.plain(found)).ravel()
        return ComponentTree(_native.grid_tree(dims, flat, way, neighbours, volume, each), found.shape)
    if isinstance(graph, Voxels):
        weights = _arrays.numbers("values", values, (len(graph),))
        volume, each = _volumes(volumes, weights.shape)
        native = _native.solid_tree(graph._native, weights, way, neighbours, volume, each)
        return ComponentTree(native, weights.shape)
    n, edges, of_edges = _edges(graph, None if values is None else len(_arrays.array("values", values)))
    if values is not None and edge_values is not None:
        raise ValueError("edge_values: given beside values; a tree has weights on vertices or on edges")
    if values is None:
        given = of_edges if edge_values is None else edge_values
        if given is None:
            raise ValueError("values: missing; or give edge_values for the edges")
        weights = _arrays.numbers("edge_values", given, (len(edges),))
        if n is None:
            n = int(edges.max()) + 1 if len(edges) else 0
    else:
        weights = _arrays.numbers("values", values, (n,))
        n = len(weights)
    volume, each = _volumes(volumes, (n,))
    native = _native.graph_tree(n, edges, weights, values is None, way, volume, each)
    return ComponentTree(native, (n,))


def _volumes(volumes: Any, shape: tuple[int, ...]) -> tuple[float, np.ndarray | None]:
    found = _arrays.finite("volumes", _arrays.numbers("volumes", volumes))
    if found.ndim == 0:
        return float(found), None
    _arrays.check_shape("volumes", found, shape)
    return 1.0, found.ravel()


def _edges(graph: Any, n: int | None) -> tuple[int | None, np.ndarray, np.ndarray | None]:
    """Vertices, if known, edges (m, 2), and weights of a matrix."""
    if hasattr(graph, "tocoo"):
        upper = _scipy_sparse("a graph as a matrix is").triu(graph, k=1).tocoo()
        if graph.shape[0] != graph.shape[1]:
            raise ValueError(f"graph: must be square, not {graph.shape[0]} x {graph.shape[1]}")
        if abs(graph - graph.T).nnz:
            raise ValueError("graph: must be symmetric: the weight from u to v is that from v to u")
        return graph.shape[0], np.ascontiguousarray(np.stack([upper.row, upper.col], axis=1), dtype=np.int64), upper.data
    if hasattr(graph, "faces"):
        graph = graph.faces
    found = _arrays.array("graph", graph)
    if found.ndim == 2 and found.shape[1] == 3:
        triangles = _arrays.indices("graph", found, (None, 3))
        sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        return n, np.ascontiguousarray(np.unique(np.sort(sides, axis=1), axis=0)), None
    return n, _arrays.indices("graph", found, (None, 2)), None
