"""Shapes for the tests, and the command line beside them."""

from __future__ import annotations

import json
import pathlib
import subprocess
import sys

import numpy as np
import pytest

ROOT = pathlib.Path(__file__).resolve().parents[3]
FIXTURES = ROOT / "fixtures"
#: Few voxels, so that the tests take seconds.
SMALL = {"voxels": 4000, "reliability": 0}


def cli(*arguments):
    """Runs the command that came with the package."""
    return subprocess.run(
        [sys.executable, "-m", "mser3d", *map(str, arguments)], capture_output=True, text=True, check=False
    )


def box(low=(0, 0, 0), high=(1, 1, 1)):
    """Vertices and faces of a box."""
    corners = np.array([[(low, high)[i >> a & 1][a] for a in range(3)] for i in range(8)], dtype=float)
    quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
    return corners, np.array([t for a, b, c, d in quads for t in ([a, b, c], [a, c, d])])


def read_off(path):
    """Vertices and faces of an OFF file."""
    words = pathlib.Path(path).read_text().split()
    n, m = int(words[1]), int(words[2])
    vertices = np.array(words[4 : 4 + 3 * n], dtype=float).reshape(n, 3)
    return vertices, np.array(words[4 + 3 * n : 4 + 3 * n + 4 * m], dtype=int).reshape(m, 4)[:, 1:]


@pytest.fixture(scope="session")
def human():
    return FIXTURES / "human_rest.off"


@pytest.fixture(scope="session")
def result(human):
    import mser3d

    return mser3d.detect(human, **SMALL)


def without_times(record):
    """What is the same from run to run, and from file to array."""
    return json.loads(json.dumps({name: value for name, value in record.items() if name != "run"}))
