"""Laplacians as sparse matrices, and eigenpairs of them."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np

from . import _arrays, _native
from ._mesh import source
from ._progress import Progress, listening
from ._voxels import Voxels, solid


class Laplacian(tuple):
    """The pair (L, M) of sparse matrices: L phi = lambda M phi. `eigs` solves one of a grid without using the matrix."""

    _operator: _native.Operator

    def __new__(cls, native: _native.Operator) -> Laplacian:
        sparse = _scipy_sparse("a Laplacian is")
        data, indices, indptr, mass = native.arrays()
        n = len(mass)
        pair = super().__new__(cls, (sparse.csc_matrix((data, indices, indptr), shape=(n, n)), sparse.diags(mass, format="csc")))
        pair._operator = native
        return pair

    @property
    def L(self) -> Any:
        """The stiffness: symmetric, positive semidefinite; units L^(d-2)."""
        return self[0]

    @property
    def M(self) -> Any:
        """The mass: diagonal; units L^d, d = 3 for a volume and 2 for a surface."""
        return self[1]


def grid_laplacian(voxels: Any, *, affine: Any = None, spacing: Any = 1.0) -> Laplacian:
    """The Laplacian of a solid: 6 neighbours, Neumann boundary; L is positive semidefinite, its rows sum to zero.

    Parameters
    ----------
    voxels : Voxels or array
        What `mser3d.voxelize` made, whose cut links it knows; or a mask, indexed [x, y] or [x, y, z].
    affine, spacing
        Of a mask: index to world, 4 x 4, or the lengths of a voxel along the axes, in L.

    Returns
    -------
    L, M : scipy.sparse.csc_matrix
        A row for each voxel, x fastest: ``np.argwhere(mask.T)[:, ::-1]``. L has the unit L, M is the volume of a voxel, L^3.
    """
    if not isinstance(voxels, Voxels):
        voxels = solid(voxels, affine=affine, spacing=spacing)
    return Laplacian(_native.grid_laplacian(voxels._native))


def cotangent_laplacian(mesh: Any, faces: Any = None) -> Laplacian:
    """The cotangent Laplacian of a mesh with lumped masses (a third of the triangles around a vertex).

    Parameters
    ----------
    mesh, faces
        As of `mser3d.detect`, but no path. Vertices at equal positions are not welded.

    Returns
    -------
    L, M : scipy.sparse.csc_matrix
        As robust_laplacian gives them: L is positive semidefinite, M the area of each vertex, L^2.
    """
    found = source(mesh, faces)
    if isinstance(found, str):
        raise ValueError("mesh: must be vertices and faces here; trimesh.load reads a file")
    return Laplacian(_native.cotangent_laplacian(*found))


def eigs(
    operator: Any,
    k: int = 100,
    *,
    mass: Any = None,
    tol: float = 1e-9,
    solver: Literal["auto", "shift-invert", "filter", "multigrid"] = "auto",
    memory_limit: float | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> tuple[np.ndarray, np.ndarray]:
    """The k smallest eigenpairs of a symmetric operator, complete with multiplicities.

    As ``scipy.sparse.linalg.eigsh(L, k, M, sigma=-1e-8, which="LM")`` on Laplacians, and several times faster on those of grids.

    Parameters
    ----------
    operator : Laplacian, pair, or sparse matrix
        What `grid_laplacian` or `cotangent_laplacian` gave; a pair (L, M); or any real symmetric sparse matrix, (n, n).
    k : int
        How many.
    mass : array or sparse diagonal matrix
        Of a matrix alone: its mass, (n,). Default: ones.
    tol : float
        Largest relative residual ``|L v - lambda M v| / (lambda |v|)`` in the norms of M^-1 and M.
    solver : str
        How eigenpairs are found; "filter" and "multigrid" are for Laplacians of grids.
    memory_limit : float
        Refuse to start when more memory is needed, in MB.
    threads, progress
        As of `mser3d.detect`.

    Returns
    -------
    evals : (k,) array, ascending
    evecs : (n, k) array, columns orthonormal under the mass

    Raises
    ------
    ValueError
        For a matrix that is not symmetric, fewer than k eigenpairs, or a tolerance that cannot be reached.
    MemoryError
        For more memory than the limit.
    """
    native = operator._operator if isinstance(operator, Laplacian) and mass is None else _operator(operator, mass)
    if isinstance(k, bool) or not isinstance(k, (int, np.integer)) or k < 1:
        raise ValueError(f"k: must be a whole number of at least 1, not {k!r}")
    limit = None if memory_limit is None else int(memory_limit * 1e6)
    with listening(progress) as hear:
        return _native.eigs(native, int(k), float(tol), solver, limit, threads, hear)


def _operator(operator: Any, mass: Any) -> _native.Operator:
    sparse = _scipy_sparse("a matrix is")
    if isinstance(operator, (tuple, list)) and len(operator) == 2:
        if mass is not None:
            raise ValueError("mass: given twice, in the pair and beside it")
        operator, mass = operator
    if not sparse.issparse(operator):
        operator = sparse.csc_matrix(_arrays.numbers("operator", operator, (None, None)))
    if operator.dtype.kind not in "biuf":
        raise ValueError(f"operator: must be of real numbers, not {operator.dtype}")
    rows, columns = operator.shape
    if rows != columns:
        raise ValueError(f"operator: must be square, not {rows} x {columns}")
    if rows == 0:
        raise ValueError("operator: is empty")
    matrix = sparse.csc_matrix(operator, dtype=np.float64)
    _arrays.finite("operator", matrix.data)
    difference = abs(matrix - matrix.T)
    if difference.nnz and difference.max() > 0:
        if difference.max() > 1e-10 * abs(matrix).max():
            raise ValueError(f"operator: is not symmetric; entries differ by up to {difference.max():.3g}")
        # Rounding of whoever made it.
        matrix = (matrix + matrix.T) * 0.5
    matrix = sparse.csc_matrix(matrix)
    matrix.sum_duplicates()
    matrix.sort_indices()
    if mass is None:
        masses = np.ones(rows)
    elif sparse.issparse(mass):
        masses = mass.diagonal()
        if abs(mass - sparse.diags(masses)).sum() != 0:
            raise ValueError("mass: must be diagonal; lump it, as by np.asarray(M.sum(axis=1)).ravel()")
    else:
        masses = _arrays.array("mass", mass)
        masses = np.diagonal(masses) if masses.ndim == 2 else masses
    masses = _arrays.finite("mass", _arrays.numbers("mass", masses, (rows,)))
    return _native.Operator(matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64), matrix.data, masses)


def _scipy_sparse(what: str) -> Any:
    try:
        import scipy.sparse
    except ImportError as error:
        raise ImportError(f"{what} one of scipy.sparse: pip install scipy") from error
    return scipy.sparse
