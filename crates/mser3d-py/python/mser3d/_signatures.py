"""Heat kernels and their signatures, from eigenpairs."""

from __future__ import annotations

import json
from typing import Any, Literal

import numpy as np

from . import _arrays, _native


def heat_kernel(evals: Any, evecs: Any, t: Any, *, pairs: Any = None) -> np.ndarray:
    """The heat kernel ``H_t(u, v) = sum_i exp(-lambda_i t) phi_i(u) phi_i(v)``.

    Parameters
    ----------
    evals : (k,) array
        Eigenvalues, ascending, in L^-2.
    evecs : (n, k) array
        Eigenfunctions in columns, orthonormal under the mass. Those of float32 are taken as they are; sums are in float64.
    t : float or array
        Time, in L^2; several give a column each.
    pairs : (m, 2) array
        Pairs (u, v). Default: each u with itself, the auto-diffusivity.

    Returns
    -------
    (n,) or (m,) array, with several times (n, t) or (m, t); in L^-3 of a volume, L^-2 of a surface
    """
    values, functions = _pairs(evals, evecs)
    times = _arrays.numbers("t", t)
    if times.ndim > 1 or times.size == 0 or not (np.isfinite(times).all() and (times > 0).all()):
        raise ValueError("t: must be a positive time, or a list of them")
    chosen = None if pairs is None else _arrays.indices("pairs", pairs, (None, 2))
    found = _native.heat_kernel(values, functions, np.atleast_1d(times).tolist(), chosen)
    return found if times.ndim == 0 else np.ascontiguousarray(found.reshape(len(times), -1).T)


def si_vhks(
    evals: Any,
    evecs: Any,
    mass: Any,
    *,
    domain: Literal["volume", "surface"] = "volume",
    rows: Any = None,
    **parameters: float,
) -> np.ndarray:
    """The scale-invariant heat kernel signature (eq. 9), of a volume (SI-vHKS) or a surface (SI-HKS).

    Parameters
    ----------
    evals, evecs
        As of `heat_kernel`.
    mass : (n,) array or sparse diagonal matrix
        Volume or area of each row.
    domain : str
        What the eigenpairs are of.
    rows : (m,) array
        Rows that are described. Default: all.
    **parameters
        ``reference_volume``, ``reference_area``, ``unit``, ``tau_start``, ``tau_end``, ``samples_per_octave``,
        ``frequencies``: as of ``SiHksParameters`` in the Rust library, with the same defaults.

    Returns
    -------
    (n, frequencies) array, or (m, frequencies)
    """
    values, functions = _pairs(evals, evecs)
    masses = mass.diagonal() if hasattr(mass, "diagonal") and not isinstance(mass, np.ndarray) else mass
    masses = _arrays.finite("mass", _arrays.numbers("mass", masses, (len(functions),)))
    if not masses.any():
        raise ValueError("mass: is 0 everywhere")
    known = ("reference_volume", "reference_area", "unit", "tau_start", "tau_end", "samples_per_octave", "frequencies")
    for name in parameters:
        if name not in known:
            raise TypeError(f"si_vhks: there is no keyword argument {name!r}; there are {', '.join(known)}")
    chosen = None
    if rows is not None:
        chosen = _arrays.indices("rows", rows, (None,)).reshape(-1, 1)
    return _native.si_hks(domain, masses, values, functions, json.dumps(parameters), chosen)


def _pairs(evals: Any, evecs: Any) -> tuple[np.ndarray, np.ndarray]:
    functions = _arrays.functions("evecs", evecs)
    values = _arrays.finite("evals", _arrays.numbers("evals", evals, (functions.shape[1],)))
    if functions.size == 0:
        raise ValueError(f"evecs: is empty, of shape {functions.shape}")
    return values, functions
