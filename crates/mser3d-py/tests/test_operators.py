"""Laplacians and eigenpairs beside SciPy and robust_laplacian; voxels beside trimesh."""

import mser3d
import numpy as np
import pytest
from conftest import FIXTURES, box, read_off

sparse = pytest.importorskip("scipy.sparse")
linalg = pytest.importorskip("scipy.sparse.linalg")


def test_the_grid_laplacian_is_the_seven_point_stencil():
    mask = np.zeros((4, 3, 2), dtype=bool)
    mask[:, 0, 0] = mask[1, :, 0] = True
    L, M = mser3d.grid_laplacian(mask, spacing=(0.5, 1.0, 2.0))
    places = np.argwhere(mask.T)[:, ::-1]
    steps = places[:, None] - places[None]
    neighbours = np.abs(steps).sum(axis=2) == 1
    weights = (1.0 / np.array([0.25, 1.0, 4.0]))[np.abs(steps).argmax(axis=2)]
    expected = -np.where(neighbours, weights, 0.0)
    np.fill_diagonal(expected, -expected.sum(axis=1))
    np.testing.assert_allclose(L.toarray(), expected * 1.0)
    np.testing.assert_allclose(M.diagonal(), 1.0)
    assert sparse.issparse(L) and L.has_sorted_indices


def test_the_cotangent_laplacian_is_positive_and_weighs_areas():
    vertices, faces = read_off(FIXTURES / "human_rest.off")
    L, M = mser3d.cotangent_laplacian(vertices, faces)
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    assert M.diagonal().sum() == pytest.approx(area.sum(), rel=1e-12)
    np.testing.assert_allclose(np.asarray(L.sum(axis=1)).ravel(), 0.0, atol=1e-9)
    assert (L - L.T).nnz == 0
    # Dirichlet's energy of a coordinate is never negative: the sign is robust_laplacian's.
    assert vertices[:, 0] @ L @ vertices[:, 0] > 0


def test_the_cotangent_laplacian_is_robust_laplacians_where_triangles_are_delaunay():
    robust = pytest.importorskip("robust_laplacian")
    golden = (1 + 5**0.5) / 2
    sphere = pytest.importorskip("trimesh").creation.icosphere(subdivisions=3, radius=golden)
    L, M = mser3d.cotangent_laplacian(sphere)
    theirs_l, theirs_m = robust.mesh_laplacian(np.asarray(sphere.vertices), np.asarray(sphere.faces), mollify_factor=0.0)
    assert abs(L - theirs_l).max() < 1e-9
    np.testing.assert_allclose(M.diagonal(), theirs_m.diagonal(), rtol=1e-9)


@pytest.fixture(scope="module")
def solid():
    return mser3d.voxelize(FIXTURES / "human_rest.off", voxels=3000)


def check_pairs(L, M, evals, evecs, k):
    theirs = np.sort(linalg.eigsh(L.tocsc(), k, M.tocsc(), sigma=-1e-2, which="LM", return_eigenvectors=False))
    np.testing.assert_allclose(evals, theirs, rtol=1e-8, atol=1e-8 * abs(theirs).max())
    gram = evecs.T @ (M @ evecs)
    np.testing.assert_allclose(gram, np.eye(k), atol=1e-8)
    residual = L @ evecs - (M @ evecs) * evals
    assert np.abs(residual).max() < 1e-6 * abs(L).max()


def test_eigenpairs_are_scipys(solid):
    laplacian = mser3d.grid_laplacian(solid)
    L, M = laplacian
    evals, evecs = mser3d.eigs(laplacian, 30)
    assert evecs.shape == (len(solid), 30) and evals[0] == 0.0
    check_pairs(L, M, evals, evecs, 30)
    # Without a matrix and with one: the same.
    again, _ = mser3d.eigs((L, M), 30)
    np.testing.assert_allclose(again, evals, rtol=1e-9, atol=1e-12)
    beside, _ = mser3d.eigs(L, 30, mass=M)
    np.testing.assert_array_equal(beside, again)
    surface = mser3d.cotangent_laplacian(*read_off(FIXTURES / "human_rest.off"))
    check_pairs(*surface, *mser3d.eigs(surface, 20), 20)


def test_any_symmetric_matrix_has_eigenpairs():
    rng = np.random.default_rng(5)
    random = sparse.random(200, 200, density=0.05, random_state=3, format="csr")
    indefinite = random + random.T - 3 * sparse.eye(200)
    mass = rng.uniform(0.5, 2.0, 200)
    evals, evecs = mser3d.eigs(indefinite, 6, mass=mass)
    dense = np.linalg.eigvalsh(np.diag(mass**-0.5) @ indefinite.toarray() @ np.diag(mass**-0.5))
    np.testing.assert_allclose(evals, dense[:6], rtol=1e-8)
    assert evals[0] < 0
    np.testing.assert_allclose(indefinite @ evecs, mass[:, None] * evecs * evals, atol=1e-6)


def test_heat_kernels_are_sums_over_eigenpairs(solid):
    laplacian = mser3d.grid_laplacian(solid)
    evals, evecs = mser3d.eigs(laplacian, 25)
    times = np.array([0.001, 0.01])
    expected = (evecs**2) @ np.exp(-np.outer(evals, times))
    np.testing.assert_allclose(mser3d.heat_kernel(evals, evecs, times), expected, rtol=1e-10)
    pairs = np.array([[0, 5], [7, 7]])
    between = mser3d.heat_kernel(evals, evecs, 0.01, pairs=pairs)
    kernel = evecs * np.exp(-evals * 0.01) @ evecs.T
    np.testing.assert_allclose(between, kernel[pairs[:, 0], pairs[:, 1]], rtol=1e-9)
    mass = laplacian.M
    signature = mser3d.si_vhks(evals, evecs, mass)
    assert signature.shape == (len(solid), 6) and np.isfinite(signature).all()
    np.testing.assert_array_equal(mser3d.si_vhks(evals, evecs, mass, rows=[3, 1]), signature[[3, 1]])
    # Eigenfunctions in single precision: their rounding is all that differs.
    single = evecs.astype(np.float32)
    widened = single.astype(float)
    np.testing.assert_array_equal(mser3d.heat_kernel(evals, single, times), mser3d.heat_kernel(evals, widened, times))
    np.testing.assert_array_equal(mser3d.si_vhks(evals, single, mass), mser3d.si_vhks(evals, widened, mass))
    np.testing.assert_allclose(mser3d.si_vhks(evals, single, mass), signature, rtol=0, atol=1e-6 * signature.max())
    single[2, 3] = np.nan
    with pytest.raises(ValueError, match="evecs: row 2"):
        mser3d.heat_kernel(evals, single, 0.01)
    # The same at any scale: lengths times 2.
    larger = mser3d.si_vhks(evals / 4, evecs / 8**0.5, mass.diagonal() * 8)
    np.testing.assert_allclose(larger, signature, rtol=1e-9)
    assert mser3d.si_vhks(evals, evecs, mass, frequencies=3).shape == (len(solid), 3)


def test_region_descriptors_are_means_of_signatures(human):
    result = mser3d.detect(human, descriptor="si-hks", voxels=3000, reliability=0)
    signature = mser3d.si_vhks(result.evals, result.evecs, result.mass)
    for region, row in zip(result.regions, result.descriptors):
        np.testing.assert_allclose(signature[region.voxels].mean(axis=0), row, rtol=1e-9)


def test_voxels_are_trimeshs():
    trimesh = pytest.importorskip("trimesh")
    pytest.importorskip("rtree")
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
    voxels = mser3d.voxelize(sphere, pitch=0.17)
    grid = np.argwhere(np.ones(voxels.shape)) @ voxels.affine[:3, :3].T + voxels.affine[:3, 3]
    inside = trimesh.Trimesh(sphere.vertices, sphere.faces).contains(grid)
    np.testing.assert_array_equal(voxels.mask.ravel(), inside)


def test_voxels_of_a_box():
    voxels = mser3d.voxelize(*box((0, 0, 0), (4, 3, 2)), pitch=1.0, origin=(0, 0, 0))
    assert len(voxels) == voxels.mask.sum() == 24
    np.testing.assert_allclose(np.sort(voxels.centres, axis=0)[[0, -1]], [[0.5, 0.5, 0.5], [3.5, 2.5, 1.5]])
    assert (voxels.index[1] - voxels.index[0]).tolist() == [1, 0, 0]
    assert voxels.volume_of(np.arange(24)).max() == 23
    assert voxels.report["inside"] in ("auto", "surface", "parity", "winding", "vote") or voxels.report
