"""Solids as voxels."""

from __future__ import annotations

import functools
import json
from typing import Any

import numpy as np

from . import _arrays, _native
from ._mesh import source
from ._options import with_options
from ._warnings import warn_all


class Voxels:
    """The voxels of a solid, and which of them are linked: neighbours between which no surface runs.

    Voxels are numbered x fastest, then y, then z; so are the rows of their Laplacian.
    """

    def __init__(self, native: _native.Voxels) -> None:
        self._native = native

    def __len__(self) -> int:
        return len(self._native)

    def __repr__(self) -> str:
        return f"<mser3d.Voxels: {len(self)} inside, of {' x '.join(map(str, self.shape))}>"

    @property
    def shape(self) -> tuple[int, int, int]:
        """Lengths of the grid along x, y and z."""
        nx, ny, nz = self._native.dims
        return nx, ny, nz

    @functools.cached_property
    def affine(self) -> np.ndarray:
        """Index to world, (4, 4): the centre of voxel (i, j, k) is ``affine @ (i, j, k, 1)``, in L."""
        return self._native.affine()

    @functools.cached_property
    def mask(self) -> np.ndarray:
        """Which voxels are inside, indexed [x, y, z]: bool."""
        return self._native.mask()

    @functools.cached_property
    def index(self) -> np.ndarray:
        """Place of each voxel in the grid, in the order of its number: (n, 3) int32."""
        return self._native.index()

    @property
    def centres(self) -> np.ndarray:
        """Centre of each voxel: (n, 3), in L."""
        return self.index @ self.affine[:3, :3].T + self.affine[:3, 3]

    @property
    def report(self) -> dict[str, Any]:
        """How it was made of a mesh: the inside test and why it was chosen, links that were cut, topology; {} for a mask."""
        return json.loads(self._native.report or "{}")

    def volume_of(self, values: Any, fill: Any = 0) -> np.ndarray:
        """Values of the voxels as an array indexed [x, y, z], filled with ``fill`` outside."""
        values = np.asarray(values)
        if len(values) != len(self):
            raise ValueError(f"values: must be one for each of {len(self)} voxels, not {len(values)}")
        full = np.full(self.shape + values.shape[1:], fill, dtype=values.dtype)
        full[tuple(self.index.T)] = values
        return full


@with_options("voxelize")
def voxelize(mesh: Any, faces: Any = None, *, threads: int | None = None, **options: Any) -> Voxels:
    """Makes the solid inside a mesh: all voxels whose centres are inside, linked where no surface runs between them.

    Parameters
    ----------
    mesh, faces
        As of `mser3d.detect`.
    threads : int
        Threads to use; the result is the same for any number.

    Returns
    -------
    Voxels

    Raises
    ------
    ValueError, MemoryError
        In the words of the command line.
    """
    voxels = Voxels(_native.voxelize(source(mesh, faces), options, threads))
    warn_all(voxels._native.warnings)
    return voxels


def solid(mask: Any, *, affine: Any = None, spacing: Any = 1.0) -> Voxels:
    """The voxels of a mask that are not zero, all neighbours linked.

    Parameters
    ----------
    mask : array
        Indexed [x, y] or [x, y, z].
    affine : array
        Index to world, 4 x 4, with right angles.
    spacing : float or three
        In its place: lengths of a voxel along the axes, in L.
    """
    found = _arrays.array("mask", mask)
    if found.ndim not in (2, 3):
        raise ValueError(f"mask: must be indexed [x, y] or [x, y, z], but has {found.ndim} axes")
    dims, _, numbers = _arrays.volume("mask", found)
    if affine is None:
        lengths = _arrays.finite("spacing", _arrays.numbers("spacing", spacing))
        if lengths.size not in (1, 3) or (lengths <= 0).any():
            raise ValueError("spacing: must be a positive length, or three")
        affine = np.diag([*np.broadcast_to(lengths.ravel(), 3), 1.0])
    return Voxels(_native.solid(dims, numbers, _arrays.affine("affine", affine)))
