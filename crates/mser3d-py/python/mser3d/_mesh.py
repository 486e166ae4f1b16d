"""Whatever is a mesh: paths, arrays, and the objects of trimesh, meshio, PyVista and others, by what they look like."""

from __future__ import annotations

import os
from typing import Any, Union

import numpy as np

from ._arrays import indices, numbers

Source = Union[str, tuple[np.ndarray, np.ndarray]]


def source(mesh: Any, faces: Any = None) -> Source:
    """A path, or the vertices (n, 3) and triangles (m, 3) of a mesh.

    Taken are a path; vertices and faces; a pair of both; and objects with ``vertices`` and ``faces`` (trimesh, potpourri3d,
    LaPy's ``v`` and ``t``), ``points`` and ``cells`` (meshio), or ``points`` and ``regular_faces`` (PyVista).
    """
    if isinstance(mesh, (str, os.PathLike)):
        if faces is not None:
            raise ValueError("faces: given beside a file, which has its own")
        return os.fspath(mesh)
    if faces is None:
        mesh, faces = _arrays_of(mesh)
    vertices = numbers("vertices", mesh, (None, 3))
    triangles = indices("faces", faces, (None, 3))
    if len(vertices) == 0:
        raise ValueError("vertices: there are none")
    if len(triangles) == 0:
        raise ValueError("faces: there are none; a mesh needs triangles")
    return vertices, triangles


def _arrays_of(mesh: Any) -> tuple[Any, Any]:
    if isinstance(mesh, (tuple, list)) and len(mesh) == 2:
        return mesh[0], mesh[1]
    for vertices, faces in (("vertices", "faces"), ("vertices", "triangles"), ("v", "t")):
        if hasattr(mesh, vertices) and hasattr(mesh, faces):
            return getattr(mesh, vertices), getattr(mesh, faces)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        return mesh.points, _triangles_of(mesh.cells_dict)
    if hasattr(mesh, "extract_surface") and not hasattr(mesh, "regular_faces"):
        mesh = mesh.extract_surface()
    if hasattr(mesh, "points") and hasattr(mesh, "regular_faces"):
        if not mesh.is_all_triangles:
            mesh = mesh.triangulate()
        return mesh.points, mesh.regular_faces
    if isinstance(mesh, np.ndarray):
        raise ValueError("faces: missing; vertices alone are no mesh (for voxels call detect_volume)")
    kind = type(mesh).__name__
    raise ValueError(
        f"mesh: {kind} is none that is known; give a path, vertices and faces, or an object of trimesh, meshio or PyVista"
    )


def _triangles_of(cells: Any) -> np.ndarray:
    """The triangles of meshio's blocks; quadrilaterals are cut along their first diagonal."""
    blocks = [np.asarray(cells["triangle"])] if "triangle" in cells else []
    if "quad" in cells:
        quads = np.asarray(cells["quad"])
        blocks.append(np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]], axis=1).reshape(-1, 3))
    if not blocks:
        found = ", ".join(sorted(cells)) or "none"
        raise ValueError(f"mesh: needs cells of type triangle or quad; there are {found}. Give a path to read other cells")
    return np.concatenate(blocks)
