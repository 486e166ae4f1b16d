"""Many small shapes: blocks with a handle, each of other lengths."""

import pathlib

import numpy as np
from conftest import box

#: Fast, for a few thousand voxels.
QUICK = {"voxels": 2000, "eigenpairs": 30, "reliability": 0}
#: The same on the command line.
QUICK_WORDS = ["--voxels=2000", "--eigenpairs=30", "--reliability=0"]


def write_off(path, vertices, faces):
    """Writes a mesh."""
    lines = [f"OFF\n{len(vertices)} {len(faces)} 0"]
    lines += [" ".join(repr(float(x)) for x in vertex) for vertex in vertices]
    lines += ["3 " + " ".join(map(str, face)) for face in faces]
    pathlib.Path(path).write_text("\n".join(lines) + "\n")


def write_shapes(folder, count, seed=1):
    """Writes so many shapes into a folder that is made: their paths."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(seed)
    paths = []
    for number in range(count):
        x, y, z = random.uniform(1.5, 2.5, 3)
        width, length = random.uniform(0.5, 0.8), random.uniform(4.0, 7.0)
        block, faces = box((-x, -y, -z), (x, y, z))
        handle, _ = box((-width, -width, 0.9 * z), (width, width, z + length))
        paths.append(folder / f"shape{number:05}.off")
        write_off(paths[-1], np.vstack([block, handle]), np.vstack([faces, faces + 8]))
    return paths
