"""How much slower a call from Python is than the Rust libraries inside it: `python bench/ratios.py`.

Each line has the seconds of the call, those of the libraries in the same call, and the ratio of both: the smallest of several
runs. What is above 1 is arrays that are checked and copied, and the thread. (Eigenfunctions are not copied; that they are finite is
checked beside the sums, block by block, within the time of the libraries.)
"""

from __future__ import annotations

import pathlib
import time

import mser3d
import numpy as np
from mser3d import _native

FIXTURES = pathlib.Path(__file__).resolve().parents[3] / "fixtures"
#: At most this much slower.
ALLOWED = 1.05


def measure(name, call, allowed=ALLOWED, runs=7):
    best = (np.inf, np.inf, np.inf)
    for _ in range(runs):
        start = time.perf_counter()
        # Kept until the clock has stopped: giving memory back is the caller's.
        kept = call()
        whole = time.perf_counter() - start
        inside = _native.last_seconds()
        del kept
        best = min(best, (whole / inside, whole, inside))
    ratio, whole, inside = best
    print(f"{name:34} {whole:9.4f} s {inside:9.4f} s  {ratio:6.3f}{'' if ratio <= allowed else '  more than allowed'}")
    return ratio <= allowed


def main():
    rest, other = FIXTURES / "human_rest.off", FIXTURES / "human_walk.off"
    first = mser3d.detect(rest, reliability=0)
    second = mser3d.detect(other, reliability=0)
    vertices, faces = first.vertices, first.faces
    voxels = mser3d.voxelize(rest, voxels=45000)
    fine = dict(voxels=2_000_000)
    grid = mser3d.grid_laplacian(voxels)
    mesh = mser3d.cotangent_laplacian(vertices, faces)
    evals, evecs = mser3d.eigs(grid, 100)
    volume = np.random.default_rng(1).integers(0, 256, (200, 200, 200)).astype(np.uint8)
    x, y, z = np.mgrid[:160, :160, :160] / 160.0
    waves = (127 + 60 * np.sin(19 * x) * np.cos(17 * y) + 60 * np.sin(23 * z)).astype(np.uint8)
    mask = first.volume_of(np.ones(len(first.voxel_index), dtype=np.uint8), fill=0)
    calls = {
        "detect, 45,000 voxels": lambda: mser3d.detect(vertices, faces, reliability=0),
        "detect_volume": lambda: mser3d.detect_volume(mask, reliability=0),
        "voxelize, 2 million voxels": lambda: mser3d.voxelize(vertices, faces, **fine),
        "eigs of a grid": lambda: mser3d.eigs(grid, 100),
        "eigs of a mesh": lambda: mser3d.eigs(mesh, 50),
        "component_tree, 8 million voxels": lambda: mser3d.component_tree(volume),
        "msv, 4 million voxels": lambda: mser3d.msv(waves),
        "si_vhks": lambda: mser3d.si_vhks(evals, evecs, grid.M),
    }
    # Over at once.
    others = {
        "heat_kernel": lambda: mser3d.heat_kernel(evals, evecs, 0.01),
        "match": lambda: mser3d.match(first, second),
    }
    print(f"{'call':34} {'Python':>11} {'Rust':>11}  ratio")
    good = [measure(name, call) for name, call in calls.items()]
    print("over in milliseconds:")
    for name, call in others.items():
        measure(name, call, allowed=np.inf)
    return all(good)


if __name__ == "__main__":
    raise SystemExit(0 if main() else 1)
