"""Maximally stable volumes of grey values."""

from __future__ import annotations

import functools
import json
import os
from typing import Any

import numpy as np

from . import _arrays, _native
from ._options import with_options
from ._records import Record, Records
from ._warnings import warn_all


class MsvResult:
    """The maximally stable regions of a volume: a search for each kind (dark, bright, alike)."""

    def __init__(self, native: _native.Msv) -> None:
        self._native = native

    def __repr__(self) -> str:
        counts = ", ".join(f"{len(regions)} {kind}" for kind, regions in self.regions.items())
        return f"<mser3d.MsvResult: {counts}>"

    @functools.cached_property
    def record(self) -> dict[str, Any]:
        """What ``msv.json`` says, as a dict."""
        return json.loads(self._native.json())

    @functools.cached_property
    def regions(self) -> dict[str, Records]:
        """The regions of each kind, largest first."""
        return {s["contrast"]: Records(Record(r) for r in s["regions"]) for s in self.record["searches"]}

    @functools.cached_property
    def labels(self) -> dict[str, np.ndarray]:
        """The smallest region of each voxel, indexed [x, y, z], for each kind: int32, -1 for none."""
        return {s["contrast"]: self._native.labels(i) for i, s in enumerate(self.record["searches"])}


@with_options("msv")
def msv(
    volume: Any, *, affine: Any = None, volume_number: int | None = None, save: str | os.PathLike[str] | None = None, **options: Any
) -> MsvResult:
    """Finds the maximally stable regions of a grey-value volume or an image (MSER).

    Parameters
    ----------
    volume : array or path
        Grey values, indexed [x, y] or [x, y, z]; [x, y, z, channel] for colours.
    affine : array
        Index to world, 4 x 4.
    volume_number : int
        Which of several volumes, from 0.
    save : path
        Also write the folder of ``mser3d msv``.

    Returns
    -------
    MsvResult
    """
    path = given = None
    options["volume"] = volume_number
    if affine is not None and isinstance(affine, (str, os.PathLike)):
        options["affine"], affine = affine, None
    matrix = None if affine is None else _arrays.affine("affine", affine)
    if isinstance(volume, (str, os.PathLike)):
        path = os.fspath(volume)
        if matrix is not None:
            raise ValueError("affine: with a file, give a file too")
    else:
        given = (*_arrays.volume("volume", volume), matrix)
    native = _native.msv(path, given, options, save)
    warn_all(native.notes, path)
    return MsvResult(native)
