"""Component trees beside Higra and a plain flood; MSV beside VLFeat."""

import pathlib

import mser3d
import numpy as np
import pytest
from conftest import FIXTURES, ROOT, cli, read_off

sparse = pytest.importorskip("scipy.sparse")
ndimage = pytest.importorskip("scipy.ndimage")
RNG = np.random.default_rng(7)


def levels_of(values, polarity, structure):
    """The sizes of all components of all level sets, by level."""
    found = set()
    for level in np.unique(values):
        inside = values <= level if polarity == "sublevel" else values >= level
        labels, count = ndimage.label(inside, structure)
        for label in range(1, count + 1):
            member = labels == label
            if (values[member] == level).any():
                found.add((float(level), int(member.sum()), int(np.flatnonzero(member)[0])))
    return found


@pytest.mark.parametrize("polarity", ["sublevel", "superlevel"])
@pytest.mark.parametrize(
    "values",
    [
        RNG.integers(0, 6, (7, 9)).astype(np.uint8),
        RNG.integers(-3, 3, (4, 5, 6)).astype(np.int64),
        RNG.normal(size=(5, 6)).astype(np.float32),
        np.asfortranarray(RNG.integers(0, 4, (3, 8)))[::-1],
        RNG.integers(0, 2, (4, 4, 4)).astype(bool),
        RNG.integers(0, 5, 30).astype(">i2"),
    ],
)
def test_nodes_are_the_components_of_level_sets(values, polarity):
    tree = mser3d.component_tree(values, polarity=polarity)
    nodes = {
        (tree.altitudes[n], int(tree.volumes[n]), int(tree.elements(n).min())) for n in range(len(tree))
    }
    structure = ndimage.generate_binary_structure(values.ndim, 1)
    assert nodes == levels_of(values.astype(float), polarity, structure)
    assert tree.node_of.shape == values.shape
    np.testing.assert_array_equal(tree.altitudes[tree.node_of], values.astype(float))
    children = np.flatnonzero(tree.parents >= 0)
    assert (tree.parents[children] > children).all()


def test_neighbours_can_be_twenty_six():
    values = RNG.integers(0, 5, (6, 7))
    tree = mser3d.component_tree(values, connectivity=26)
    nodes = {(tree.altitudes[n], int(tree.volumes[n]), int(tree.elements(n).min())) for n in range(len(tree))}
    assert nodes == levels_of(values.astype(float), "sublevel", np.ones((3, 3)))


def test_trees_are_higras():
    higra = pytest.importorskip("higra")
    image = RNG.integers(0, 20, (40, 50)).astype(float)
    tree = mser3d.component_tree(image, polarity="superlevel")
    theirs, altitudes = higra.component_tree_max_tree(higra.get_4_adjacency_graph(image.shape), image)
    leaves = theirs.num_leaves()
    assert len(tree) == theirs.num_vertices() - leaves
    area = higra.attribute_area(theirs)[leaves:]
    pairs = sorted(zip(tree.altitudes.tolist(), tree.volumes.tolist()))
    assert pairs == sorted(zip(altitudes[leaves:].tolist(), area.tolist()))
    # Each pixel's smallest component has the same size.
    np.testing.assert_array_equal(
        tree.volumes[tree.node_of].ravel(), higra.attribute_area(theirs)[theirs.parents()[:leaves]]
    )


def test_edges_of_graphs_have_trees():
    higra = pytest.importorskip("higra")
    n = 60
    upper = sparse.triu(sparse.random(n, n, density=0.15, random_state=2), k=1)
    ring = sparse.csr_matrix((np.linspace(2, 3, n - 1), (np.arange(n - 1), np.arange(1, n))), shape=(n, n))
    upper = sparse.csr_matrix(upper + ring)
    graph = upper + upper.T
    tree = mser3d.component_tree(graph=graph)
    edges = sparse.triu(graph, k=1).tocoo()
    theirs = higra.UndirectedGraph(n)
    theirs.add_edges(edges.row, edges.col)
    hierarchy, altitudes = higra.quasi_flat_zone_hierarchy(theirs, edges.data)
    inner = hierarchy.num_leaves()
    area = higra.attribute_area(hierarchy)[inner:]
    ours = sorted(zip(tree.altitudes.tolist(), tree.volumes.tolist()))
    assert ours == sorted(zip(altitudes[inner:].tolist(), area.tolist()))
    listed = mser3d.component_tree(graph=np.stack([edges.row, edges.col], axis=1), edge_values=edges.data)
    np.testing.assert_array_equal(listed.parents, tree.parents)


def test_meshes_solids_and_graphs_agree():
    vertices, faces = read_off(FIXTURES / "human_rest.off")
    height = vertices[:, 1]
    of_faces = mser3d.component_tree(height, faces, polarity="superlevel")
    n = len(vertices)
    sides = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    matrix = sparse.coo_matrix((np.ones(len(sides)), sides.T), shape=(n, n)).tocsr()
    of_matrix = mser3d.component_tree(height, matrix + matrix.T, polarity="superlevel")
    np.testing.assert_array_equal(of_faces.parents, of_matrix.parents)
    # Head and two hands or feet: several maxima of height that merge.
    assert (of_faces.parents == -1).sum() == 1 and len(of_faces.persistence) == len(of_faces)
    mask = RNG.random((5, 6, 7)) > 0.3
    solid = mser3d.solid(mask)
    values = RNG.normal(size=mask.shape)
    inside = values[tuple(solid.index.T)]
    tree = mser3d.component_tree(inside, solid)
    outside = np.where(mask, values, values.max() + 1)
    whole = mser3d.component_tree(outside)
    kept = whole.altitudes <= values.max()
    assert sorted(tree.volumes) == sorted(whole.volumes[kept])
    half = mser3d.component_tree(inside, solid, volumes=np.full(len(solid), 0.5))
    np.testing.assert_allclose(half.volumes, tree.volumes / 2)


def vlfeat_volume():
    """The volume of crates/comptree/tests/it/vlfeat.rs."""
    nx, ny, nz = 20, 18, 14
    values, state = np.zeros((nx, ny, nz), dtype=np.uint8), 1
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                state = (state * 1_664_525 + 1_013_904_223) % 2**32
                ball = (x - 5) ** 2 + (y - 5) ** 2 + (z - 6) ** 2
                lens = (x - 14) ** 2 + (y - 12) ** 2 + 2 * (z - 7) ** 2
                bright = (x - 14) ** 2 + (y - 4) ** 2 + (z - 5) ** 2
                value = 150 + 2 * x - y
                value = 40 + ball if ball < 16 else value
                value = 60 + 2 * lens if lens < 20 else value
                value = 20 if lens < 6 else value
                value = 230 - bright if bright < 12 else value
                values[x, y, z] = (value + (state >> 30)) % 256
    return values


def test_stable_volumes_are_vlfeats():
    values = vlfeat_volume()
    text = (ROOT / "crates/comptree/tests/it/data/vlfeat.txt").read_text()
    searches = text.split("search ")[1:]
    assert len(searches) == 8
    for search in searches:
        heading, *lines = search.strip().split("\n")
        delta, min_area, max_area, max_variation, min_diversity, kind = heading.split()
        found = mser3d.msv(
            values,
            regions=kind,
            delta=float(delta),
            min_area=float(min_area),
            max_area=float(max_area),
            max_variation=float(max_variation),
            min_diversity=float(min_diversity),
        )
        ours = sorted((int(region.grey), region.voxels) for region in found.regions[kind])
        assert ours == sorted(tuple(map(int, line.split())) for line in lines if line), heading
        labels = found.labels[kind]
        assert labels.shape == values.shape
        for region in found.regions[kind]:
            inside = {r.region for r in found.regions[kind] if r.region == region.region or r.parent == region.region}
            assert np.isin(labels, list(inside)).sum() <= region.voxels


def test_msv_writes_what_the_command_line_writes(tmp_path):
    values = vlfeat_volume()
    np.save(tmp_path / "v.npy", values)
    made = cli("msv", tmp_path / "v.npy", "-o", tmp_path / "cli", "-q")
    assert made.returncode == 0, made.stderr
    mser3d.msv(tmp_path / "v.npy", save=tmp_path / "python")
    for name in ("msv.json", "regions.csv", "labels.npy"):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "cli" / name).read_bytes(), name
    with pytest.raises(ValueError, match="regions"):
        mser3d.msv(values, regions="grey")
