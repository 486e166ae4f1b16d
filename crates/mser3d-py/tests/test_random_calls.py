"""Random wrong arrays: always an exception that Python can catch, or an answer."""

import os

import mser3d
import numpy as np
import pytest

hypothesis = pytest.importorskip("hypothesis")
st = hypothesis.strategies
arrays = pytest.importorskip("hypothesis.extra.numpy")

#: Many more with RANDOM_CALLS=100000.
EXAMPLES = int(os.environ.get("RANDOM_CALLS", "1500")) // 5
SETTINGS = hypothesis.settings(max_examples=EXAMPLES, deadline=None, database=None, derandomize=True)

anything = st.one_of(
    arrays.arrays(
        st.sampled_from([np.float64, np.float32, np.float16, np.int8, np.int64, np.uint64, np.bool_, np.complex64]),
        arrays.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5),
    ),
    arrays.arrays(np.dtype(">i4"), (4, 3), elements=st.integers(-2, 9)),
    arrays.arrays(np.float64, (5, 3), elements=st.floats(-2, 2)),
    arrays.arrays(np.int64, (4, 3), elements=st.integers(0, 4)),
    st.lists(st.one_of(st.integers(-9, 9), st.floats(), st.text(max_size=2), st.none()), max_size=4),
    st.text(max_size=3).map(lambda text: text.replace("/", "_").replace("\0", "_")),
    st.none(),
    st.integers(-(2**70), 2**70),
)


def answers(call, *arguments, **keywords):
    try:
        call(*arguments, **keywords)
    except (ValueError, TypeError, MemoryError, OSError, OverflowError) as error:
        assert str(error)


@SETTINGS
@hypothesis.given(anything, anything)
def test_meshes(vertices, faces):
    answers(mser3d.voxelize, vertices, faces, voxels=200, max_box_voxels=100_000)
    answers(mser3d.cotangent_laplacian, vertices, faces)


@SETTINGS
@hypothesis.given(anything, anything, st.sampled_from(["sublevel", "superlevel", "up"]), anything)
def test_trees(values, graph, polarity, volumes):
    answers(mser3d.component_tree, values, graph, polarity=polarity, volumes=volumes)


@SETTINGS
@hypothesis.given(anything, anything, anything)
def test_eigenpairs(operator, k, mass):
    answers(mser3d.eigs, operator, k, mass=mass)
    answers(mser3d.heat_kernel, operator, k, mass)
    answers(mser3d.si_vhks, operator, k, mass)


@SETTINGS
@hypothesis.given(anything, anything)
def test_volumes(volume, affine):
    answers(mser3d.solid, volume, affine=affine)
    answers(mser3d.msv, volume, affine=affine)


@SETTINGS
@hypothesis.given(anything, anything, st.dictionaries(st.sampled_from(["voxels", "pitch", "surface", "weight", "x"]), anything))
def test_detections(mesh, faces, options):
    answers(mser3d.detect, mesh, faces, **{"eigenpairs": 5, "reliability": 0, "max_box_voxels": 50_000, **options})
