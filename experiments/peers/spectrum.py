"""Eigenpairs by Python peers, for `cargo xtask bench spectrum`.

    spectrum.py probe                                   what is installed, as JSON
    spectrum.py METHOD FOLDER EIGENPAIRS TOLERANCE OUT  solves the problem in FOLDER

METHOD: scipy-cholmod, scipy-superlu or lapy. The last line on stdout is JSON: CPU and wall seconds of
factorization and iteration (reading, assembly and imports apart), and the process's peak memory. OUT gets
the eigenvalues, then the M-orthonormal eigenvectors row by row, all little-endian f64.
"""

import json
import resource
import sys
import time
from pathlib import Path


def probe():
    found = {}
    for key, modules in {
        "scipy-cholmod": ["scipy", "sksparse.cholmod"],
        "scipy-superlu": ["scipy"],
        "lapy": ["lapy", "scipy"],
    }.items():
        try:
            versions = []
            for module in modules:
                __import__(module)
                package = module.split(".")[0]
                version = getattr(sys.modules[package], "__version__", "?")
                versions.append(f"{ {'sksparse': 'scikit-sparse'}.get(package, package) } {version}")
            found[key] = ", ".join(versions)
        except Exception:  # a broken installation is no installation
            pass
    print(json.dumps(found))


def read_operator(folder):
    import numpy as np
    import scipy.sparse as sp

    raw = (folder / "operator.bin").read_bytes()
    n, nonzeros = np.frombuffer(raw, "<u8", 2)
    n, nonzeros, at = int(n), int(nonzeros), 16
    parts = []
    for dtype, count in [("<i4", n + 1), ("<i4", nonzeros), ("<f8", nonzeros), ("<f8", n)]:
        parts.append(np.frombuffer(raw, dtype, count, at))
        at += parts[-1].nbytes
    starts, rows, values, mass = parts
    return sp.csc_matrix((values, rows, starts), shape=(n, n)), mass


def read_mesh(folder):
    import numpy as np

    raw = (folder / "mesh.bin").read_bytes()
    n, m = (int(x) for x in np.frombuffer(raw, "<u8", 2))
    vertices = np.frombuffer(raw, "<f8", 3 * n, 16).reshape(n, 3)
    return vertices.copy(), np.frombuffer(raw, "<i4", 3 * m, 16 + 24 * n).reshape(m, 3).astype(np.int64)


def prepare(method, folder, k, tolerance):
    """Reads the problem; returns a function that solves it."""
    import numpy as np
    import scipy.sparse as sp
    from scipy.sparse.linalg import LinearOperator, eigsh

    if method == "lapy":
        from lapy import Solver, TriaMesh

        try:
            import cholespy  # noqa: F401

            cholmod = True
        except Exception:
            cholmod = False
        solver = Solver(TriaMesh(*read_mesh(folder)), lump=True, use_cholmod=cholmod)
        return lambda: solver.eigs(k=k)

    stiffness, mass = read_operator(folder)
    scale = sp.diags(1.0 / np.sqrt(mass))
    matrix = (scale @ stiffness @ scale).tocsc()
    # A small negative shift keeps the matrix definite: a tenth of 1/A of a surface, V^(-2/3) of a volume.
    dimension = 2.0 if (folder / "mesh.bin").exists() else 3.0
    sigma = -0.1 * mass.sum() ** (-2.0 / dimension)

    def solve():
        if method == "scipy-superlu":
            values, vectors = eigsh(matrix, k, sigma=sigma, tol=0.1 * tolerance)
        else:
            from sksparse.cholmod import cholesky

            shifted = matrix - sigma * sp.identity(matrix.shape[0], format="csc")
            ordering = "amd" if dimension == 2.0 else "metis"
            factor = cholesky(shifted, mode="supernodal", ordering_method=ordering)
            inverse = LinearOperator(matrix.shape, matvec=factor, dtype=np.float64)
            values, vectors = eigsh(matrix, k, sigma=sigma, OPinv=inverse, tol=0.1 * tolerance)
        order = np.argsort(values)
        return values[order], vectors[:, order] / np.sqrt(mass)[:, None]

    return solve


def main():
    if sys.argv[1] == "probe":
        return probe()
    method, folder, k, tolerance, out = sys.argv[1:]
    solve = prepare(method, Path(folder), int(k), float(tolerance))

    def cpu():
        usage = resource.getrusage(resource.RUSAGE_SELF)
        return usage.ru_utime + usage.ru_stime

    wall, used = time.perf_counter(), cpu()
    values, vectors = solve()
    wall, used = time.perf_counter() - wall, cpu() - used
    # Not ru_maxrss: that of a process started by a larger one is the larger one's.
    status = Path("/proc/self/status").read_text()
    peak = 1024 * next(int(line.split()[1]) for line in status.splitlines() if line.startswith("VmHWM:"))
    with open(out, "wb") as file:
        file.write(values.astype("<f8").tobytes())
        file.write(vectors.astype("<f8").tobytes(order="C"))
    print(json.dumps({"cpu": used, "wall": wall, "peak": peak}))


main()
