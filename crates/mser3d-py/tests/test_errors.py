"""Wrong input ends in one clear exception that names the argument; nothing ends the interpreter."""

import os
import pathlib

import mser3d
import numpy as np
import pytest
from conftest import FIXTURES, box

VERTICES, FACES = box()
BAD_FACES = FACES.copy()
BAD_FACES[3, 1] = 99
NAN = VERTICES.copy()
NAN[2, 1] = np.nan


@pytest.mark.parametrize(
    ("vertices", "faces", "words"),
    [
        (VERTICES[:, :2], FACES, ["vertices", "(n, 3)", "(8, 2)"]),
        (VERTICES, FACES[:, :2], ["faces", "(n, 3)", "(12, 2)"]),
        (VERTICES, FACES + 0.5, ["faces", "integers", "float64"]),
        (VERTICES, BAD_FACES, ["faces", "row 3", "99", "there are 8"]),
        (VERTICES, -FACES, ["faces", "-", "there are 8"]),
        (VERTICES, FACES.astype(np.uint64) + np.uint64(2**63), ["faces", "2^63"]),
        (NAN, FACES, ["vertices", "row 2", "finite"]),
        (VERTICES.astype(complex), FACES, ["vertices", "complex"]),
        (VERTICES.astype(str), FACES, ["vertices", "real numbers"]),
        ([[0, 0, 0], [1, 2]], FACES, ["vertices"]),
        (np.empty((0, 3)), FACES, ["vertices", "none"]),
        (VERTICES, [], ["faces", "none"]),
        (VERTICES, None, ["faces", "missing"]),
        (object(), None, ["mesh", "object"]),
        (VERTICES * np.nan, FACES, ["vertices", "row 0"]),
    ],
)
@pytest.mark.parametrize("function", [mser3d.detect, mser3d.voxelize, mser3d.cotangent_laplacian])
def test_wrong_meshes_are_named(function, vertices, faces, words):
    with pytest.raises(ValueError) as caught:
        function(vertices, faces)
    for word in words:
        assert word in str(caught.value), str(caught.value)


@pytest.mark.parametrize(
    ("volume", "words"),
    [
        (np.ones(5), ["volume", "1 axes"]),
        (np.ones((2, 2, 2, 2, 2)), ["volume", "5 axes"]),
        (np.empty((3, 0, 2)), ["volume", "empty"]),
        (np.zeros((3, 3, 3)), ["zero everywhere"]),
        (np.full((3, 3, 3), np.nan), ["NaN"]),
        (np.array([[["a"]]]), ["volume", "real numbers"]),
        (np.random.default_rng(1).normal(size=(4, 4, 4)), ["threshold"]),
    ],
)
def test_wrong_volumes_are_named(volume, words):
    with pytest.raises(ValueError) as caught:
        mser3d.detect_volume(volume)
    for word in words:
        assert word in str(caught.value), str(caught.value)


@pytest.mark.parametrize(
    ("call", "error", "words"),
    [
        (lambda: mser3d.detect("no/such.off"), FileNotFoundError, ["no/such.off", "cannot be read"]),
        (lambda: mser3d.detect("shape.xyz123"), (ValueError, OSError), ["shape.xyz123"]),
        (lambda: mser3d.detect(VERTICES, FACES, voxels=0), ValueError, ["--voxels", "at least 1"]),
        (lambda: mser3d.detect(VERTICES, FACES, voxels=1.5), ValueError, ["--voxels", "1.5"]),
        (lambda: mser3d.detect(VERTICES, FACES, voxel=1), TypeError, ["voxel", "did you mean 'voxels'"]),
        (lambda: mser3d.detect(VERTICES, FACES, voxels=[1, 2]), TypeError, ["voxels"]),
        (lambda: mser3d.detect(VERTICES, FACES, surface="yes"), TypeError, ["surface", "True or False"]),
        (lambda: mser3d.detect(VERTICES, FACES, weight="warm"), ValueError, ["warm", "heat"]),
        (lambda: mser3d.detect(VERTICES, FACES, voxels=9, pitch=1.0), ValueError, ["--pitch", "--voxels"]),
        (lambda: mser3d.detect(VERTICES, FACES, max_box_voxels=10), MemoryError, ["max_box_voxels"]),
        (lambda: mser3d.detect(VERTICES, FACES, memory_limit=0), MemoryError, ["memory"]),
        (lambda: mser3d.detect(VERTICES, FACES, time_limit=1e-6), TimeoutError, ["time limit", "--time-limit"]),
        (lambda: mser3d.detect(VERTICES, FACES, label=3), ValueError, ["--label", "volume"]),
        (lambda: mser3d.detect(VERTICES, FACES, animation="run"), ValueError, ["animation"]),
        (lambda: mser3d.detect(VERTICES, FACES, progress="bar"), ValueError, ["progress", "tqdm"]),
        (lambda: mser3d.detect("a.off", FACES), ValueError, ["faces", "file"]),
        (lambda: mser3d.detect_volume(np.ones((2, 2, 2)), affine=np.eye(3)), ValueError, ["affine", "(4, 4)"]),
        (lambda: mser3d.detect_volume(np.ones((2, 2, 2)), affine=np.zeros((4, 4))), ValueError, ["affine"]),
        (lambda: mser3d.detect_volume(np.ones((2, 2, 2)), label="all"), ValueError, ["label"]),
        (lambda: mser3d.load("no/such"), ValueError, ["no/such", "regions.json"]),
        (lambda: mser3d.match("no/such", "no/such"), ValueError, ["no/such"]),
        (lambda: mser3d.match(3, 4), TypeError, ["first", "int"]),
        (lambda: mser3d.query("no/such", "x"), ValueError, ["no/such"]),
        (lambda: mser3d.track([]), ValueError, ["frames"]),
        (lambda: mser3d.eigs(np.ones((3, 2))), ValueError, ["operator", "square"]),
        (lambda: mser3d.eigs(np.array([[1.0, 2], [0, 1]])), ValueError, ["operator", "symmetric"]),
        (lambda: mser3d.eigs(np.full((2, 2), np.nan)), ValueError, ["operator", "finite"]),
        (lambda: mser3d.eigs(np.eye(3), 9), ValueError, ["3", "9"]),
        (lambda: mser3d.eigs(np.eye(3), 0), ValueError, ["k"]),
        (lambda: mser3d.eigs(np.eye(3), 1, mass=[1, 2]), ValueError, ["mass", "(3,)"]),
        (lambda: mser3d.eigs(np.eye(3), 1, mass=[1, -2, 1]), ValueError, ["mass", "negative"]),
        (lambda: mser3d.eigs(np.eye(3), 1, tol=2.0), ValueError, ["tolerance"]),
        (lambda: mser3d.eigs(np.eye(3), 1, solver="fast"), ValueError, ["solver", "fast"]),
        (lambda: mser3d.grid_laplacian(np.zeros((2, 2, 2))), ValueError, ["mask", "inside"]),
        (lambda: mser3d.grid_laplacian(np.ones((2, 2)), spacing=-1), ValueError, ["spacing", "positive"]),
        (lambda: mser3d.component_tree(), ValueError, ["values", "missing"]),
        (lambda: mser3d.component_tree(np.array([1.0, np.nan])), ValueError, ["NaN"]),
        (lambda: mser3d.component_tree(np.empty((0, 3))), ValueError, ["values", "empty"]),
        (lambda: mser3d.component_tree([1, 2], [[0, 5]]), ValueError, ["graph", "5", "there are 2"]),
        (lambda: mser3d.component_tree([1, 2], polarity="up"), ValueError, ["polarity", "up"]),
        (lambda: mser3d.component_tree([[1]], connectivity=8), ValueError, ["connectivity", "8"]),
        (lambda: mser3d.component_tree([1, 2], volumes=[1]), ValueError, ["volumes", "(2,)"]),
        (lambda: mser3d.component_tree([2**60, 1]), ValueError, ["values", "2^53"]),
        (lambda: mser3d.heat_kernel([0, 1], np.ones((3, 1)), 1), ValueError, ["evals", "(1,)"]),
        (lambda: mser3d.heat_kernel([0], np.ones((3, 1)), -1), ValueError, ["t", "positive"]),
        (lambda: mser3d.heat_kernel([1, 0], np.ones((3, 2)), 1), ValueError, ["ascending"]),
        (lambda: mser3d.heat_kernel([0], np.ones((3, 1)), 1, pairs=[[0, 3]]), ValueError, ["pairs", "3"]),
        (lambda: mser3d.si_vhks([0], np.ones((3, 1)), [1, 1]), ValueError, ["mass", "(3,)"]),
        (lambda: mser3d.si_vhks([0], np.ones((3, 1)), [1, 1, 1], octaves=3), TypeError, ["octaves"]),
        (lambda: mser3d.msv(np.ones(3)), ValueError, ["volume", "1 axes"]),
        (lambda: mser3d.msv("no/such.npy"), FileNotFoundError, ["no/such.npy"]),
        (lambda: mser3d.Detector(voxel=3), TypeError, ["voxel"]),
    ],
)
def test_wrong_arguments_are_named(call, error, words):
    with pytest.raises(error) as caught:
        call()
    for word in words:
        assert word in str(caught.value), str(caught.value)


def test_damaged_files_are_refused_in_the_words_of_the_command_line():
    files = [path for path in sorted((FIXTURES / "bad").iterdir()) if path.suffix in (".off", ".obj", ".ply", ".npy")]
    assert len(files) > 5
    for path in files:
        with pytest.raises((ValueError, OSError)) as caught:
            mser3d.detect(path, voxels=500, eigenpairs=5, reliability=0)
        assert path.name in str(caught.value), str(caught.value)


def test_a_folder_that_cannot_be_written_to_is_an_os_error(result, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        result.save(tmp_path / "file" / "inside")
    with pytest.raises(ValueError, match="write"):
        result.save(tmp_path / "x", write=["pictures"])
