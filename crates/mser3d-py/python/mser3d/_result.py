"""What was found on a shape."""

from __future__ import annotations

import functools
import html
import json
import os
from collections.abc import Iterator, Sequence
from typing import Any, Literal, overload

import numpy as np

from . import _native
from ._options import with_options
from ._records import Record, Records

#: Pages larger than this, in bytes, are not put into a notebook: browsers get slow, and the file is kept for ever.
LARGEST_PAGE = 20_000_000


class Result:
    """The stable regions of a shape, their descriptors, its parts, and how they were found.

    Regions are numbered from 0, the largest first; so are parts. Label arrays hold the number of the smallest region
    that an element is in, -1 for none. Arrays are made when they are asked for first, and kept.

    Elements are the voxels of a solid, or the vertices of a surface. Lengths have the unit of the input, L.
    """

    def __init__(self, native: _native.Result) -> None:
        self._native = native

    def __repr__(self) -> str:
        elements = f"{self.record['domain']} of {self._elements} {'voxels' if self.is_volume else 'vertices'}"
        parts = f", {len(self.parts)} parts" if self.parts is not None else ""
        return f"<mser3d.Result of {self.name}: {len(self.regions)} regions{parts} in a {elements}>"

    @property
    def name(self) -> str:
        """What it is called: the name of its file, or "array"."""
        return self._native.name

    @property
    def is_volume(self) -> bool:
        """Whether a volume was searched, not a surface."""
        return self.record["domain"] == "volume"

    # The record.

    @functools.cached_property
    def record(self) -> dict[str, Any]:
        """What ``regions.json`` says, as a dict: input, parameters, spectrum, trees, regions, parts, warnings."""
        return json.loads(self._native.json())

    @functools.cached_property
    def regions(self) -> Records:
        """The regions, largest first: records with the fields of ``regions.json`` and ``vertices`` and ``voxels``."""
        return Records(
            Region(record, self._native, number) for number, record in enumerate(self.record["regions"])
        )

    @functools.cached_property
    def parts(self) -> Records | None:
        """The parts, largest first; None where they were not asked for."""
        parts = self.record["parts"]
        return None if parts is None else Records(Record(part) for part in parts)

    @property
    def report(self) -> dict[str, Any]:
        """What the run took: seconds of each stage, memory, threads."""
        return self.record["run"]

    @property
    def warnings(self) -> list[str]:
        """What the user should know, as it was told by ``Mser3dWarning``."""
        return self.record["warnings"] + self._native.warnings

    # The shape.

    @functools.cached_property
    def vertices(self) -> np.ndarray:
        """Vertices of the surface: (n, 3) float64, in L. Of a solid given as voxels, the corners of its outer faces."""
        return self._native.vertices()

    @functools.cached_property
    def faces(self) -> np.ndarray:
        """Triangles of the surface: (m, 3) int32."""
        return self._native.faces()

    @functools.cached_property
    def file_vertex(self) -> np.ndarray | None:
        """The vertex of each vertex of a file that repeats them (STL, glTF): int32; None for others."""
        return self._native.file_vertex()

    @functools.cached_property
    def voxel_index(self) -> np.ndarray:
        """Place of each voxel in the grid: (n, 3) int32; of a surface (0, 3)."""
        return self._native.voxel_index()

    @property
    def grid_shape(self) -> tuple[int, int, int] | None:
        """Lengths of the grid along x, y and z; None for a surface."""
        grid = self.record["grid"]
        return None if grid is None else tuple(grid["dims"])

    @property
    def affine(self) -> np.ndarray | None:
        """Index to world, (4, 4): the centre of voxel (i, j, k) is ``affine @ (i, j, k, 1)``, in L; None for a surface."""
        grid = self.record["grid"]
        return None if grid is None else np.array(grid["affine"], dtype=float)

    @property
    def voxel_centres(self) -> np.ndarray:
        """Centre of each voxel: (n, 3), in L."""
        affine = self.affine
        if affine is None:
            return np.empty((0, 3))
        return self.voxel_index @ affine[:3, :3].T + affine[:3, 3]

    # Labels.

    @functools.cached_property
    def vertex_labels(self) -> np.ndarray:
        """The smallest region of each vertex: (n,) int32, -1 for none."""
        return self._native.vertex_labels()

    @functools.cached_property
    def voxel_labels(self) -> np.ndarray:
        """The smallest region of each voxel: (n,) int32, -1 for none; of a surface, empty."""
        return self._native.voxel_labels()

    @functools.cached_property
    def vertex_parts(self) -> np.ndarray:
        """The part of each vertex: (n,) int32, -1 for bodies that were not searched; empty without parts."""
        return self._native.vertex_parts()

    @functools.cached_property
    def voxel_parts(self) -> np.ndarray:
        """The part of each voxel: (n,) int32; empty without parts, and of a surface."""
        return self._native.voxel_parts()

    @functools.cached_property
    def vertex_voxel(self) -> np.ndarray:
        """The voxel that each vertex takes its regions from: (n,) int32, -1 for none; of a surface, empty."""
        return self._native.vertex_voxel()

    def volume_of(self, values: Any, fill: Any = -1) -> np.ndarray:
        """Values of the voxels as an array indexed [x, y, z], filled with ``fill`` outside.

        ``result.volume_of(result.voxel_labels)`` is the label map of the regions.
        """
        if self.grid_shape is None:
            raise ValueError("values: a surface has no voxels")
        values = np.asarray(values)
        if len(values) != len(self.voxel_index):
            raise ValueError(f"values: must be one for each of {len(self.voxel_index)} voxels, not {len(values)}")
        full = np.full(self.grid_shape + values.shape[1:], fill, dtype=values.dtype)
        full[tuple(self.voxel_index.T)] = values
        return full

    # Numbers.

    @functools.cached_property
    def descriptors(self) -> np.ndarray:
        """A row for each region: (regions, q) float64."""
        return self._native.descriptors()

    @functools.cached_property
    def evals(self) -> np.ndarray:
        """Smallest eigenvalues of the Laplacian of the largest body: (k,), in L^-2."""
        return self._native.evals(0)

    @functools.cached_property
    def evecs(self) -> np.ndarray:
        """Eigenfunctions of the largest body in columns, orthonormal under the mass: (n, k); rows as in `evec_elements`.

        float64, or float32 where they are held so, as by a folder that was saved. They are as exact as `detect` was told by
        ``tolerance``: 1e-4, which regions need, unless it was given.
        """
        return self._native.evecs(0)

    @functools.cached_property
    def mass(self) -> np.ndarray:
        """Volume (surface: area) of each row of `evecs`: (n,), in L^3 (L^2)."""
        return self._native.mass(0)

    @functools.cached_property
    def evec_elements(self) -> np.ndarray:
        """Of a volume, the voxel of each row of `evecs`; of a surface, the row of each vertex, -1 for none."""
        return self._native.element_rows(0)

    def eigenpairs(self, body: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Eigenvalues, eigenfunctions, mass and elements of a body: `evals`, `evecs`, `mass` and `evec_elements` of any body.

        With ``bodies="all"`` there is one for each of ``record["bodies"]``.
        """
        native = self._native
        return native.evals(body), native.evecs(body), native.mass(body), native.element_rows(body)

    @property
    def trees(self) -> list[dict[str, np.ndarray]]:
        """The component trees: ``parents`` (-1 for a root), ``altitudes``, ``volumes``, and ``entry``, the node of each element."""
        names = ("parents", "altitudes", "volumes", "entry")
        return [dict(zip(names, self._native.tree(i))) for i in range(len(self.record["trees"]))]

    # Out.

    def save(self, folder: str | os.PathLike[str], write: Sequence[str] = ()) -> None:
        """Writes the folder that ``mser3d detect`` writes, with the same bytes, times aside.

        ``write`` are files besides, as of ``mser3d detect --write``: "nifti", "landmarks", "eigenfunctions", "fine-surface".
        """
        self._native.save(folder, [write] if isinstance(write, str) else list(write))

    def page(self, up: str = "y") -> str:
        """The HTML page that shows it in a browser, complete in itself."""
        return self._native.page(up)

    @overload
    def render(self, path: None = None, **options: Any) -> np.ndarray: ...
    @overload
    def render(self, path: str | os.PathLike[str], **options: Any) -> None: ...
    @with_options("render")
    def render(self, path: str | os.PathLike[str] | None = None, **options: Any) -> np.ndarray | None:
        """Draws it, without a display: (height, width, 3) uint8, or to the PNG file ``path``."""
        if path is None:
            return self._native.render(options, False)
        with open(path, "wb") as file:
            file.write(self._native.render(options, True))
        return None

    def _repr_html_(self) -> str | None:
        page = self.page()
        if len(page) > LARGEST_PAGE:
            return (
                f"<p>{html.escape(repr(self))}: its page has {len(page) / 1e6:.0f} MB, too much for a notebook. "
                "Write <code>result.page()</code> to a file, or draw <code>result.render()</code>.</p>"
            )
        return f'<iframe srcdoc="{html.escape(page)}" width="100%" height="600" style="border:0"></iframe>'

    def to_pandas(self) -> Any:
        """The regions as a pandas DataFrame, a row each."""
        return self.regions.to_pandas()

    def to_pyvista(self, what: Literal["surface", "volume"] = "surface") -> Any:
        """The surface as pyvista.PolyData, or the voxels as pyvista.UnstructuredGrid, with ``region`` and ``part``."""
        try:
            import pyvista
        except ImportError as error:
            raise ImportError("to_pyvista needs PyVista: pip install pyvista") from error
        if what == "surface":
            faces = np.hstack([np.full((len(self.faces), 1), 3), self.faces]).ravel()
            data = pyvista.PolyData(self.vertices, faces)
            data.point_data["region"] = self.vertex_labels
            if self.parts is not None:
                data.point_data["part"] = self.vertex_parts
            return data
        if what != "volume" or not self.is_volume:
            raise ValueError(f"what: {what!r} is not there; 'surface' or, of volumes, 'volume'")
        corners, cells = _voxel_cells(self.voxel_index, self.affine)
        data = pyvista.UnstructuredGrid({pyvista.CellType.HEXAHEDRON: cells}, corners)
        data.cell_data["region"] = self.voxel_labels
        if self.parts is not None:
            data.cell_data["part"] = self.voxel_parts
        return data

    def to_polyscope(self, name: str | None = None) -> Any:
        """Adds the surface to Polyscope with ``region``, ``part`` and, for each region, whether a vertex is in it: its SurfaceMesh.

        Call ``polyscope.init()`` before and ``polyscope.show()`` after.
        """
        try:
            import polyscope
        except ImportError as error:
            raise ImportError("to_polyscope needs Polyscope: pip install polyscope") from error
        mesh = polyscope.register_surface_mesh(self.name if name is None else name, self.vertices, self.faces)
        mesh.add_scalar_quantity("region", self.vertex_labels, datatype="categorical", enabled=self.parts is None)
        if self.parts is not None:
            mesh.add_scalar_quantity("part", self.vertex_parts, datatype="categorical", enabled=True)
        for region in self.regions:
            inside = np.zeros(len(self.vertices))
            inside[region.vertices] = 1.0
            mesh.add_scalar_quantity(f"in region {region.id}", inside)
        return mesh

    @property
    def _elements(self) -> int:
        return len(self.voxel_index) if self.is_volume else len(self.vertices)


class Region(Record):
    """A region: the fields of ``regions.json``, and which elements are in it."""

    def __init__(self, fields: dict[str, Any], native: _native.Result, number: int) -> None:
        super().__init__(fields)
        self._native, self._number = native, number

    @property
    def vertices(self) -> np.ndarray:
        """Its vertices, ascending: int32."""
        return self._native.region_vertices(self._number)

    @property
    def voxels(self) -> np.ndarray:
        """Its voxels, ascending: int32; of a surface, empty."""
        return self._native.region_voxels(self._number)


def _voxel_cells(index: np.ndarray, affine: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Corners of voxels in the world, each once, and the eight of each voxel in VTK's order."""
    steps = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    places = (index[:, None, :] + steps[None]).reshape(-1, 3)
    corners, cells = np.unique(places, axis=0, return_inverse=True)
    affine = np.eye(4) if affine is None else affine
    world = (corners - 0.5) @ affine[:3, :3].T + affine[:3, 3]
    return world, cells.reshape(-1, 8)


def load(folder: str | os.PathLike[str]) -> Result:
    """Reads a folder that ``mser3d detect`` or `Result.save` wrote.

    Eigenfunctions are there where they were written (``--write eigenfunctions``), with the precision of float32.

    Raises
    ------
    ValueError
        For a folder that holds no result, or one of another version.
    """
    return Result(_native.load(os.fspath(folder)))
