"""detect beside the command line."""

import json
import subprocess
import sys

import mser3d
import numpy as np
import pytest
from conftest import FIXTURES, SMALL, box, cli, read_off, without_times


def options(keywords):
    return [f"--{name.replace('_', '-')}={value}" for name, value in keywords.items()]


@pytest.mark.parametrize("keywords", [{}, {"surface": True}, {"weight": "commute", "parts": "none", "connectivity": 6}])
def test_the_command_line_finds_the_same_to_the_bit(human, tmp_path, keywords):
    flags = ["--surface"] if keywords.get("surface") else options(keywords)
    size = {} if "surface" in keywords else {"voxels": 4000}
    made = cli("detect", human, "-o", tmp_path / "cli", *flags, *options(size), "--reliability=0", "-q")
    assert made.returncode == 0, made.stderr
    result = mser3d.detect(human, reliability=0, **size, **keywords)
    result.save(tmp_path / "python")
    ours, theirs = (json.loads((tmp_path / name / "regions.json").read_text()) for name in ("python", "cli"))
    assert without_times(ours) == without_times(theirs)
    for name in ("features.npz", "surface.ply", *(() if "surface" in keywords else ("volume.vti",))):
        assert (tmp_path / "python" / name).read_bytes() == (tmp_path / "cli" / name).read_bytes(), name


def test_arrays_are_the_same_shape_as_their_file(human, result):
    vertices, faces = read_off(human)
    own = mser3d.detect(vertices, faces, **SMALL)
    assert own.record["regions"] == result.record["regions"]
    assert own.record["input"]["mesh_sha256"] == result.record["input"]["mesh_sha256"]
    assert own.record["input"]["sha256"] is None and own.name == "array"
    np.testing.assert_array_equal(own.vertex_labels, result.vertex_labels)
    np.testing.assert_array_equal(own.descriptors, result.descriptors)
    np.testing.assert_array_equal(own.vertices, vertices)
    # Other layouts and types of the same numbers.
    strided = np.asfortranarray(np.hstack([vertices, vertices]))[:, :3]
    strided.flags.writeable = False
    same = mser3d.detect((strided, faces.astype(np.uint16).tolist()), **SMALL)
    np.testing.assert_array_equal(same.vertex_labels, result.vertex_labels)


def test_the_result_fits_together(result):
    assert len(result.vertex_labels) == len(result.vertices)
    assert result.vertex_labels.dtype == np.int32 and result.vertex_labels.max() < len(result.regions)
    assert result.descriptors.shape[0] == len(result.regions) > 5
    assert result.voxel_index.shape == (len(result.voxel_labels), 3)
    n, k = result.evecs.shape
    assert n == len(result.voxel_labels) and k == len(result.evals) == 100
    gram = result.evecs.T * result.mass @ result.evecs
    np.testing.assert_allclose(gram, np.eye(k), atol=1e-9)
    for number, region in enumerate(result.regions):
        assert region.id == number
        assert region.volume_fraction == pytest.approx(len(region.voxels) / n, abs=1e-12)
    # The smallest region that has a voxel is its label.
    label = np.full(n, -1)
    for number, region in enumerate(result.regions):
        label[region.voxels] = number
    np.testing.assert_array_equal(label, result.voxel_labels)
    volume = result.volume_of(result.voxel_labels)
    assert volume.shape == result.grid_shape and (volume != -1).sum() == (result.voxel_labels != -1).sum()
    low, high = result.voxel_centres.min(axis=0), result.voxel_centres.max(axis=0)
    assert (low > result.vertices.min(axis=0)).all() and (high < result.vertices.max(axis=0)).all()


def test_parts_are_limbs_and_trunk(result, human):
    assert len(result.parts) >= 6 and sum(part.trunk for part in result.parts) == 1
    assert set(result.vertex_parts) == set(range(len(result.parts)))
    few = mser3d.parts(human, n=3, voxels=4000)
    assert 1 < len(few.parts) <= 3 and len(np.unique(few.voxel_parts)) == len(few.parts)
    of_mask = mser3d.parts(result.volume_of(np.ones(len(result.voxel_index)), fill=0), affine=result.affine)
    assert len(of_mask.parts) >= 6


def test_each_body_has_its_eigenpairs():
    low, high = box((0, 0, 0), (3, 1, 1)), box((0, 5, 0), (2, 6, 1))
    both = np.vstack([low[0], high[0]]), np.vstack([low[1], high[1] + 8])
    result = mser3d.detect(*both, bodies="all", voxels=1000, eigenpairs=8, reliability=0)
    assert len(result.record["bodies"]) == 2
    for body, measure in enumerate((3.0, 2.0)):
        evals, evecs, mass, voxels = result.eigenpairs(body)
        assert evecs.shape == (len(voxels), 8) and mass.sum() == pytest.approx(measure, rel=0.05)
        np.testing.assert_allclose(evecs.T * mass @ evecs, np.eye(8), atol=1e-9)
        assert evals[0] == 0.0 < evals[1]
    with pytest.raises(IndexError, match="body 2"):
        result.eigenpairs(2)


def test_a_folder_is_read_back(result, tmp_path):
    result.save(tmp_path / "out", write=["eigenfunctions", "nifti"])
    read = mser3d.load(tmp_path / "out")
    assert read.record == result.record
    np.testing.assert_array_equal(read.vertex_labels, result.vertex_labels)
    np.testing.assert_array_equal(read.evals, result.evals)
    assert read.evecs.dtype == np.float32
    np.testing.assert_array_equal(read.evecs, result.evecs.astype(np.float32))
    assert (tmp_path / "out/regions.nii.gz").stat().st_size > 100
    result.save(tmp_path / "plain")
    with pytest.raises(ValueError, match="eigenfunctions were not kept"):
        mser3d.load(tmp_path / "plain").evecs


def test_a_mask_is_the_solid_of_the_command_line(result, tmp_path):
    mask = result.volume_of(np.ones(len(result.voxel_index), dtype=np.uint8), fill=0)
    np.save(tmp_path / "mask.npy", mask)
    np.savetxt(tmp_path / "affine.txt", result.affine)
    flags = ["--affine", tmp_path / "affine.txt", "--reliability=0", "-q"]
    made = cli("detect", tmp_path / "mask.npy", "-o", tmp_path / "cli", *flags)
    assert made.returncode == 0, made.stderr
    own = mser3d.detect_volume(mask, affine=result.affine, reliability=0)
    theirs = mser3d.load(tmp_path / "cli")
    assert own.record["regions"] == theirs.record["regions"]
    np.testing.assert_array_equal(own.voxel_labels, theirs.voxel_labels)
    np.testing.assert_array_equal(own.descriptors, theirs.descriptors)
    np.testing.assert_allclose(own.affine, result.affine, rtol=1e-12)
    assert own.record["input"]["volume"]["body"]["voxels"] == mask.sum()


def test_labels_have_names_and_grey_values_thresholds():
    volume = np.zeros((30, 12, 10), dtype=np.int16)
    volume[2:12, 2:10, 2:8], volume[12:28, 4:7, 3:6], volume[0, 0, 0] = 3, 3, 7
    named = mser3d.detect_volume(volume, label="liver", labels={3: "liver", 7: "spot"}, eigenpairs=20, reliability=0)
    body = named.record["input"]["volume"]["body"]
    assert (body["label"], body["name"], body["voxels"]) == (3, "liver", int((volume == 3).sum()))
    numbered = mser3d.detect_volume(volume, label=3, eigenpairs=20, reliability=0)
    np.testing.assert_array_equal(numbered.voxel_labels, named.voxel_labels)
    grey = mser3d.detect_volume(volume.astype(np.float16) / 2, threshold=1.0, eigenpairs=20, reliability=0, spacing=(1, 2, 3))
    np.testing.assert_allclose(np.diag(grey.affine), [1, 2, 3, 1])
    with pytest.raises(ValueError, match="--label"):
        mser3d.detect_volume(volume)


def test_a_weight_is_an_array(human, tmp_path):
    vertices, _ = read_off(human)
    height = vertices[:, 1]
    own = mser3d.detect(human, weight=height, **SMALL)
    np.save(tmp_path / "height.npy", height)
    theirs = mser3d.detect(human, weight=tmp_path / "height.npy", **SMALL)
    assert own.record["regions"] == theirs.record["regions"] and len(own.regions) > 0
    assert own.record["field"]["sha256"] == theirs.record["field"]["sha256"]
    with pytest.raises(ValueError, match=r"\(3,\)"):
        mser3d.detect(human, weight=[1.0, 2.0, 3.0], **SMALL)


def test_results_are_the_same_for_any_number_of_threads(human, result):
    one = mser3d.detect(human, threads=1, **SMALL)
    assert without_times(one.record) == without_times(result.record)
    np.testing.assert_array_equal(one.evecs, result.evecs)


def test_objects_of_other_packages_are_meshes(human, result):
    trimesh, meshio = pytest.importorskip("trimesh"), pytest.importorskip("meshio")
    vertices, faces = read_off(human)
    for mesh in (
        trimesh.Trimesh(vertices, faces, process=False),
        meshio.Mesh(vertices, [("triangle", faces)]),
    ):
        found = mser3d.detect(mesh, **SMALL)
        np.testing.assert_array_equal(found.vertex_labels, result.vertex_labels)


def test_warnings_are_pythons(tmp_path):
    vertices, faces = box()
    far, more = box((5, 5, 5), (5.5, 5.5, 5.5))
    both = np.vstack([vertices, far]), np.vstack([faces, more + 8])
    with pytest.warns(mser3d.Mser3dWarning) as caught:
        result = mser3d.detect(*both, voxels=1000, eigenpairs=20, reliability=0)
    assert {str(w.message) for w in caught} == {f"array: {text}" for text in result.warnings}
    assert all(w.filename == __file__ for w in caught)


def test_pictures_and_pages(result, tmp_path):
    pixels = result.render(height=120, views=["front", "back"])
    assert pixels.dtype == np.uint8 and pixels.ndim == 3 and pixels.shape[2] == 3
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 50
    result.render(tmp_path / "out.png", height=120)
    assert (tmp_path / "out.png").read_bytes().startswith(b"\x89PNG")
    assert result.page().startswith("<!DOCTYPE html>")
    assert result._repr_html_().startswith("<iframe srcdoc=")


def test_tables(result):
    pandas = pytest.importorskip("pandas")
    table = result.regions.to_pandas()
    assert isinstance(table, pandas.DataFrame) and len(table) == len(result.regions)
    np.testing.assert_array_equal(table["centroid_x"], [region.centroid[0] for region in result.regions])


def test_matches_are_those_of_the_command_line(result, tmp_path):
    other = mser3d.detect(FIXTURES / "human_walk.off", **SMALL)
    matching = mser3d.match(result, other)
    result.save(tmp_path / "a"), other.save(tmp_path / "b")
    printed = cli("match", tmp_path / "a", tmp_path / "b", "--json")
    assert json.loads(printed.stdout)["result"]["matches"] == [dict(m) for m in matching.matches]
    assert len(matching) > 4 and matching.pairs.shape == (len(matching), 2)
    assert mser3d.match(str(tmp_path / "a"), other).record == matching.record
    judged = mser3d.match(result, other, same_vertices=True, min_overlap=0.5)
    assert 0.5 < judged.record["precision"]["precision"] <= 1.0


def test_a_collection_is_queried(tmp_path):
    files = [FIXTURES / f"human_{pose}.off" for pose in ("rest", "walk", "sit")]
    made = cli("batch", *files, "-o", tmp_path / "all", "--voxels=3000", "--reliability=0", "-q")
    assert made.returncode == 0, made.stderr
    collection = mser3d.Collection(tmp_path / "all")
    found = mser3d.query(collection, "human_rest", k=3)
    printed = json.loads(cli("query", tmp_path / "all", "human_rest", "-k", "3", "--json").stdout)
    assert [dict(hit) for hit in found[0]] == printed["regions"][0]["closest"]
    assert len(found) == len(printed["regions"]) and all(hit.shape != "human_rest" for hit in found[0])
    itself = mser3d.query(tmp_path / "all", mser3d.load(tmp_path / "all/human_rest"), k=1, region=2)
    assert list(itself) == [2] and itself[2][0].distance == 0.0


def test_a_sequence_is_tracked(tmp_path):
    files = [FIXTURES / f"human_{pose}.off" for pose in ("rest", "walk")]
    heard = []
    tracks = mser3d.track(
        files, tmp_path / "moving", voxels=3000, reliability=0, progress=lambda *told: heard.append(told)
    )
    assert len(tracks.frames) == 2 and len(tracks.tracks) > 3
    assert json.loads((tmp_path / "moving/tracks.json").read_text()) == tracks.record
    assert heard and heard == sorted(heard, key=lambda told: told[2])


def test_a_detector_is_an_estimator(human, result):
    detector = mser3d.Detector(**SMALL)
    assert detector.get_params() == SMALL
    fitted = detector.fit(human)
    assert fitted is detector
    np.testing.assert_array_equal(fitted.labels_, result.vertex_labels)
    np.testing.assert_array_equal(detector.transform(human), result.descriptors)
    base = pytest.importorskip("sklearn.base")
    assert base.clone(detector).get_params() == SMALL
    with pytest.raises(TypeError, match="voxel"):
        detector.set_params(voxel=3)


def test_signatures_and_fields_are_written(result, tmp_path):
    result.save(tmp_path / "out", write=["signatures", "fields"])
    with np.load(tmp_path / "out/signatures.npz") as arrays:
        np.testing.assert_array_equal(arrays["signature"], mser3d.si_vhks(result.evals, result.evecs, result.mass))
        np.testing.assert_array_equal(arrays["voxels"], result.evec_elements)
    assert b'Name="signature_5"' in (tmp_path / "out/fields.vti").read_bytes()


def test_pyvista_has_surface_and_voxels(result, human):
    pyvista = pytest.importorskip("pyvista")
    surface = result.to_pyvista()
    np.testing.assert_array_equal(surface.point_data["region"], result.vertex_labels)
    volume = result.to_pyvista("volume")
    assert volume.n_cells == len(result.voxel_labels)
    assert volume.volume == pytest.approx(result.record["bodies"][0]["measure"], rel=1e-9)
    np.testing.assert_allclose(volume.cell_centers().points, result.voxel_centres, atol=1e-6)
    again = mser3d.detect(surface, **SMALL)
    np.testing.assert_array_equal(again.vertex_labels, result.vertex_labels)


def test_polyscope_shows_regions_and_parts(human, tmp_path):
    pytest.importorskip("polyscope")
    script = (
        "import sys, mser3d, polyscope\n"
        "polyscope.init('openGL_mock')\n"
        "result = mser3d.detect(sys.argv[1], voxels=2000, reliability=0)\n"
        "mesh = result.to_polyscope()\n"
        "assert mesh.get_name() == result.name == polyscope.get_surface_mesh(result.name).get_name()\n"
        "assert (mesh.n_vertices(), mesh.n_faces()) == (len(result.vertices), len(result.faces))\n"
    )
    # At its end Polyscope keeps its settings in the current folder.
    run = [sys.executable, "-W", "ignore", "-c", script, str(human)]
    assert subprocess.run(run, cwd=tmp_path, timeout=120).returncode == 0
