"""From a shape to its regions."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _arrays, _native
from ._mesh import source
from ._options import with_options
from ._progress import Progress, listening
from ._result import Result
from ._warnings import warn_all


@with_options("detect")
def detect(mesh: Any, faces: Any = None, *, progress: Progress = None, **options: Any) -> Result:
    """Finds and describes the stable regions of a mesh, or of the shape in a file.

    The same options, defaults and results as ``mser3d detect``. Ctrl-C ends it within a second.

    Parameters
    ----------
    mesh : path, array or object
        A file (mesh or volume); vertices, (n, 3), with ``faces``; a pair of both; or a mesh of trimesh, meshio or PyVista.
    faces : array
        Triangles, (m, 3) integers, with vertices numbered from 0.
    progress : callable or "tqdm"
        Called with (stage, share of the stage, share of all) now and then; what it raises cancels the work.

    Returns
    -------
    Result

    Raises
    ------
    ValueError
        Wrong input, in the words of the command line.
    MemoryError
        For work that would not fit into memory.

    Notes
    -----
    ``weight`` may be an array too, with a value (n,) or a vector (n, d) for each vertex; ``affine`` a 4 x 4 array, and
    ``labels`` a dict from numbers to names, for files of volumes.
    """
    found = source(mesh, faces)
    weight, affine, names = _taken(options)
    with listening(progress) as hear:
        return _result(_native.detect(found, options, weight, affine, names, hear))


@with_options("detect", leave_out=("animation", "time", "surface"))
def detect_volume(
    volume: Any,
    *,
    volume_number: int | None = None,
    affine: Any = None,
    labels: Mapping[int, str] | str | os.PathLike[str] | None = None,
    progress: Progress = None,
    **options: Any,
) -> Result:
    """Finds and describes the stable regions of a body that is given as voxels.

    Parameters
    ----------
    volume : array
        Indexed [x, y, z]: a mask of 0 and one other value, a label map with ``label``, or grey values with ``threshold``. A
        fourth axis holds several volumes.
    volume_number : int
        Which of several volumes, from 0.
    affine : array
        Index to world, 4 x 4: the centre of voxel (i, j, k) is ``affine @ (i, j, k, 1)``, as in nibabel. Default: voxels of
        size 1. In its place: ``spacing`` and ``origin``.
    labels : dict or path
        Names of labels, so that ``label`` can be one.
    progress : callable or "tqdm"
        Called with (stage, share of the stage, share of all) now and then.

    Returns
    -------
    Result
        Its surface is that of the voxels; see ``voxel_labels`` and ``volume_of``.

    Raises
    ------
    ValueError
        Wrong input, in the words of the command line.
    MemoryError
        For work that would not fit into memory.
    """
    dims, channels, numbers = _arrays.volume("volume", volume)
    given = {"affine": affine, "labels": labels, "volume": volume_number, **options}
    weight, affine_array, names = _taken(given)
    with listening(progress) as hear:
        native = _native.detect_volume(dims, channels, numbers, given, weight, affine_array, names, hear)
    return _result(native)


@with_options("detect", leave_out=("parts",), reliability=0)
def parts(mesh: Any, faces: Any = None, *, n: int | str = "auto", progress: Progress = None, **options: Any) -> Result:
    """Divides a shape into parts: limbs and trunk, each vertex and voxel in exactly one.

    As `detect`, without measuring how surely regions are found again, which parts do not need.

    Parameters
    ----------
    mesh, faces
        As of `detect`; a mask, indexed [x, y, z], serves too.
    n : int or "auto"
        How many parts.

    Returns
    -------
    Result
        See ``parts``, ``vertex_parts`` and ``voxel_parts``.
    """
    options = {"reliability": 0, **options, "parts": n}
    if faces is None and isinstance(mesh, np.ndarray) and mesh.ndim == 3:
        return detect_volume(mesh, progress=progress, **options)
    return detect(mesh, faces, progress=progress, **options)


def _taken(options: dict[str, Any]) -> tuple[Any, np.ndarray | None, list[tuple[int, str]]]:
    """Takes what is given as arrays or a dict out of the options."""
    weight = affine = None
    names: list[tuple[int, str]] = []
    given = options.get("weight")
    if given is not None and not isinstance(given, (str, os.PathLike)):
        weight = _arrays.weight(given)
        # The parser knows a weight of its own by the ending.
        options["weight"] = "array.npy"
    given = options.get("affine")
    if given is not None and not isinstance(given, (str, os.PathLike)):
        affine = _arrays.affine("affine", options.pop("affine"))
    if isinstance(options.get("labels"), Mapping):
        try:
            names = [(int(value), str(name)) for value, name in options.pop("labels").items()]
        except (TypeError, ValueError) as error:
            raise ValueError(f"labels: must be a dict from whole numbers to names: {error}") from None
    return weight, affine, names


def _result(native: _native.Result) -> Result:
    result = Result(native)
    warn_all(result.warnings, result.record["input"]["path"])
    return result
