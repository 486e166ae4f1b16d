"""Masks and label maps that nibabel writes, searched by mser3d, and what nibabel and VTK read of the results:
`python label_maps.py PROGRAM FOLDER [LABEL_MAP]`.

Places and volumes are compared with NumPy's sums and nibabel's affine. A failed check raises.
"""

import csv
import itertools
import json
import subprocess
import sys
from pathlib import Path

import nibabel as nib
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLImageDataReader

# A tenth of a voxel.
NEAR = 0.1


def figure():
    """A trunk with an arm along x, a shorter one along y: no symmetry."""
    mask = np.zeros((40, 24, 18), np.uint8)
    mask[2:16, 2:14, 2:14] = 1
    mask[16:36, 5:9, 4:8] = 1
    mask[4:8, 14:21, 8:12] = 1
    return mask


def reordered(mask, affine, axes, signs):
    """The same figure in the same place, its array in another order of axes and other directions."""
    flips = tuple(slice(None, None, int(s)) for s in signs)
    array = mask.transpose(axes)[flips]
    to_old = np.zeros((4, 4))
    to_old[3, 3] = 1
    for new, old in enumerate(axes):
        to_old[old, new] = signs[new]
        if signs[new] < 0:
            to_old[old, 3] = mask.shape[old] - 1
    return np.ascontiguousarray(array), affine @ to_old


def detect(program, path, out, *options):
    subprocess.run([program, "detect", path, "-o", out, "--quiet", "--eigenpairs", "40", *options], check=True)
    return json.loads((out / "regions.json").read_text())


def check_orientations(program, folder):
    mask = figure()
    plain = np.array([[1, 0, 0, -90], [0, 1.5, 0, -126], [0, 0, 0.75, 72], [0, 0, 0, 1]])
    cases = [(plain, axes, signs) for axes in itertools.permutations(range(3)) for signs in itertools.product([1, -1], repeat=3)]
    random = np.random.default_rng(7)
    for _ in range(4):
        turn, _ = np.linalg.qr(random.normal(size=(3, 3)))
        oblique = np.eye(4)
        oblique[:3, :3] = turn * [1, 1.5, 0.75]
        oblique[:3, 3] = random.uniform(-300, 300, 3)
        cases.append((oblique, (0, 1, 2), (1, 1, 1)))
    first = None
    for number, (affine, axes, signs) in enumerate(cases):
        array, placed = reordered(mask, affine, axes, signs)
        image = nib.Nifti1Image(array, placed)
        image.header.set_xyzt_units("mm")
        nib.save(image, folder / "mask.nii.gz")
        placed = nib.load(folder / "mask.nii.gz").affine
        record = detect(program, folder / "mask.nii.gz", folder / "mask")
        arrays = np.load(folder / "mask" / "features.npz")
        assert (arrays["grid_affine"] == placed).all(), number
        sizes = []
        for region in record["regions"]:
            start = arrays["region_voxels_start"]
            index = arrays["voxel_index"][arrays["region_voxels"][start[region["id"]] : start[region["id"] + 1]]]
            assert array[tuple(index.T)].all()
            centre = nib.affines.apply_affine(placed, index.mean(0))
            assert np.abs(centre - region["centroid"]).max() < NEAR * 0.75, (number, centre, region["centroid"])
            # Back to the figure itself, so that all cases compare.
            old = np.linalg.inv(affine) @ np.append(region["centroid"], 1)
            sizes.append((region["voxels"], *np.round(old[:3], 2)))
        sizes.sort()
        first = first or sizes
        assert [s[0] for s in sizes] == [s[0] for s in first], (number, sizes, first)
        assert np.allclose(sizes, first, atol=0.02), (number, sizes, first)
    return f"{len(cases)} orientations, {len(first)} regions in each"


def check_label_map(program, folder, path):
    image = nib.load(path)
    data, affine = np.asarray(image.dataobj), image.affine
    out = folder / "labels"
    command = [program, "detect", path, "--label", "all", "-o", out, "--quiet", "--write", "nifti,landmarks"]
    subprocess.run(command, check=True)
    cell = abs(np.linalg.det(affine[:3, :3]))
    edge = np.linalg.norm(affine[:3, :3], axis=0).min()
    with open(out / "labels.csv", newline="") as file:
        labels = {int(row["label"]): row for row in csv.DictReader(file)}
    with open(out / "regions.csv", newline="") as file:
        regions = list(csv.DictReader(file))
    present = [int(v) for v in np.unique(data) if v != 0]
    assert sorted(labels) == present, (sorted(labels), present)
    for value in present:
        index, row = np.argwhere(data == value), labels[value]
        assert int(row["voxels"]) == len(index), row
        if len(index) < 64:
            assert row["status"] == "too small", row
            continue
        assert row["status"] == "searched" and np.isclose(float(row["volume"]), len(index) * cell, rtol=1e-9), row
        centre = nib.affines.apply_affine(affine, index.mean(0))
        assert np.abs(centre - [float(row[a]) for a in "xyz"]).max() < NEAR * edge, row
    written = nib.load(out / "regions.nii.gz")
    assert (written.affine == affine).all() and written.shape == data.shape
    numbers = np.asarray(written.dataobj)
    assert (data[numbers > 0] != 0).all()
    landmarks = json.loads((out / "landmarks.mrk.json").read_text())["markups"]
    assert [(m["type"], m["coordinateSystem"], len(m["controlPoints"])) for m in landmarks] == [("Fiducial", "LPS", len(regions))] * 2
    for number, row in enumerate(regions):
        shape = out / row["shape"]
        arrays = np.load(shape / "features.npz")
        start, region = arrays["region_voxels_start"], int(row["region"])
        index = arrays["voxel_index"][arrays["region_voxels"][start[region] : start[region + 1]]]
        assert (data[tuple(index.T)] == int(row["label"])).all()
        centre = nib.affines.apply_affine(affine, index.mean(0))
        found = np.array([float(row[a]) for a in "xyz"])
        assert np.abs(centre - found).max() < NEAR * edge, row
        assert np.isclose(float(row["volume"]), len(index) * cell, rtol=1e-9)
        assert int(row["map_value"]) == number + 1
        point = landmarks[0]["controlPoints"][number]["position"]
        assert np.allclose(np.array(point) * [-1, -1, 1], found), row
        # The box holds the centres of all voxels.
        box = np.array([float(row[f"box_{a}"]) for a in "xyz"])
        axes = np.array([[float(row[f"axis_{n}_{a}"]) for a in "xyz"] for n in [1, 2, 3]])
        size = np.array([float(row[f"box_size_{n}"]) for n in [1, 2, 3]])
        along = (nib.affines.apply_affine(affine, index) - box) @ axes.T
        assert (np.abs(along) <= size / 2).all() and np.allclose(axes @ axes.T, np.eye(3), atol=1e-9), row
    for shape in sorted({row["shape"] for row in regions}):
        reader = vtkXMLImageDataReader()
        reader.SetFileName(str(out / shape / "volume.vti"))
        reader.Update()
        grid, arrays = reader.GetOutput(), np.load(out / shape / "features.npz")
        extent = np.array(grid.GetExtent()).reshape(3, 2)
        inside = vtk_to_numpy(grid.GetCellData().GetArray("inside")).reshape(np.diff(extent)[::-1, 0])
        index = np.argwhere(inside)[:, ::-1] + extent[:, 0]
        assert {tuple(v) for v in index} == {tuple(v) for v in arrays["voxel_index"]}
        corner = [0.0, 0.0, 0.0]
        for voxel in index[:: max(1, len(index) // 50)]:
            # The middle of a cell is the voxel's centre.
            grid.TransformContinuousIndexToPhysicalPoint(*(voxel + 0.5), corner)
            assert np.abs(np.array(corner) - nib.affines.apply_affine(affine, voxel)).max() < 1e-6 * edge
    return f"{len(present)} labels, {len(regions)} regions"


def small_label_map(path):
    data = np.zeros((60, 50, 40), np.int16)
    data[5:45, 2:26, 3:21] = figure() * 4
    data[10:50, 26:50, 20:38] += figure() * 117
    # A second piece, and a speck.
    data[55:60, 0:8, 0:8], data[58, 40, 2] = 4, 9
    turn, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))
    affine = np.eye(4)
    affine[:3, :3], affine[:3, 3] = turn * [0.9, 1.2, 2.5], [-120, 33, 500]
    nib.save(nib.Nifti1Image(data, affine), path)


if __name__ == "__main__":
    program, folder = Path(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    said = [check_orientations(program, folder)]
    small_label_map(folder / "small.nii.gz")
    for path in [folder / "small.nii.gz", *map(Path, sys.argv[3:])]:
        said.append(check_label_map(program, folder / path.name.split(".")[0], path))
    print("; ".join(said))
