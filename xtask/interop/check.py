"""Opens what mser3d wrote with the library of the format: `python check.py LIBRARY INPUT FOLDER`.

INPUT is the mesh (OFF). FOLDER holds the results `rest` and `kick`, `rest.glb` and `rest.vtp` exported
from the first, `match` of the two, `all`, the collection of both, and `track`, a sequence. Every check compares contents with
`regions.json` or with the input, none only opens a file. A failed check raises.
"""

import csv
import json
import sys
from pathlib import Path


def check_csv(mesh, folder):
    with open(folder / "match" / "matches.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    matches = json.loads((folder / "match" / "matches.json").read_text())["result"]["matches"]
    equal("number of rows", len(rows), len(matches))
    for row, match in zip(rows, matches):
        equal("columns", sorted(row), sorted(set(match) - {"truth"} | {"overlap", "mirrored_overlap", "verdict"}))
        for key in ["region", "partner", "rival", "symmetric_partner"]:
            equal(key, int(row[key]) if row[key] else None, match[key])
        for key in ["distance", "rival_distance"]:
            equal(key, float(row[key]) if row[key] else None, match[key])
        equal("ambiguous", row["ambiguous"], str(match["ambiguous"]).lower())
        # matched with --same-vertices: the truth is known
        equal("overlap", float(row["overlap"]), match["truth"]["overlap"])
    return f"{len(rows)} matches"


def check_numpy(mesh, folder):
    import numpy as np

    record, arrays = result(folder / "rest"), np.load(folder / "rest" / "features.npz", allow_pickle=False)
    regions = record["regions"]
    vertices, voxels = len(mesh[0]), record["voxelization"]["voxels"]
    expected = {
        "vertex_region": ("<i4", (vertices,)),
        "voxel_region": ("<i4", (voxels,)),
        "region_vertices_start": ("<i8", (len(regions) + 1,)),
        "region_voxels_start": ("<i8", (len(regions) + 1,)),
        "voxel_index": ("<u4", (voxels, 3)),
        "grid_affine": ("<f8", (4, 4)),
        "eigenvalues": ("<f8", (record["spectrum"]["eigenpairs"],)),
        "region_descriptor": ("<f8", (len(regions), 48)),
        "region_cosine": ("<f8", (len(regions), len(regions))),
        "region_twin": ("<i4", (len(regions),)),
        "region_side": ("<f8", (len(regions),)),
    }
    for name, (dtype, shape) in expected.items():
        equal(name, (arrays[name].dtype.str, arrays[name].shape), (dtype, shape))
    values = arrays["eigenvalues"]
    true("eigenvalues ascend from 0", values[0] == 0 and (np.diff(values) >= 0).all() and values[1] > 0)
    true("cosines are symmetric, 1 with oneself", (arrays["region_cosine"] == arrays["region_cosine"].T).all() and np.allclose(np.diag(arrays["region_cosine"]), 1))
    for name in ["twin", "side"]:
        missing = -1 if name == "twin" else np.nan
        wanted = [missing if r[name] is None else r[name] for r in regions]
        true(f"{name}s are those of regions.json", np.array_equal(arrays[f"region_{name}"], wanted, equal_nan=name == "side"))
    # Regions, their numbers and centroids against regions.json; the smallest around each element.
    affine = arrays["grid_affine"]
    cell = abs(np.linalg.det(affine[:3, :3]))
    for what in ["vertices", "voxels"]:
        lists = np.split(arrays[f"region_{what}"], arrays[f"region_{what}_start"][1:-1])
        equal(f"number of {what}", [len(x) for x in lists], [r[what] for r in regions])
        label = np.full(vertices if what == "vertices" else voxels, -1, "<i4")
        for number, members in enumerate(lists):
            label[members] = number
        same(f"innermost region of {what}", arrays["vertex_region" if what == "vertices" else "voxel_region"], label)
        if what == "voxels":
            for members, region in zip(lists, regions):
                centres = arrays["voxel_index"][members] @ affine[:3, :3].T + affine[:3, 3]
                true("centroid", np.allclose(centres.mean(0), region["centroid"], rtol=0, atol=1e-9))
                true("volume", np.isclose(len(members) * cell, region["volume"], rtol=1e-12))
    for number, tree in enumerate(record["trees"]):
        parent, volume, entry = (arrays[f"tree{number}_{name}"] for name in ["parent", "volume", "entry"])
        equal("nodes", len(parent), tree["nodes"])
        inner = np.flatnonzero(parent >= 0)
        true("children come before parents and are smaller", (parent[inner] > inner).all() and (volume[parent[inner]] > volume[inner]).all())
        true("the root is everything", np.isclose(volume[parent < 0].sum(), voxels * cell))
        equal("entries", (entry.dtype.str, len(entry), int(entry.max()) < len(parent)), ("<i4", voxels, True))
    return f"{len(arrays.files)} arrays"


def check_plyfile(mesh, folder):
    import numpy as np
    from plyfile import PlyData

    ply = PlyData.read(folder / "rest" / "surface.ply")
    vertex, faces = ply["vertex"], np.stack(ply["face"]["vertex_indices"])
    same("vertices", np.column_stack([vertex[a] for a in "xyz"]), mesh[0])
    same("triangles", faces, mesh[1])
    same("regions", vertex["region"], labels(folder / "rest"))
    check_colours(np.column_stack([vertex[c] for c in ["red", "green", "blue"]]), vertex["region"])
    return f"{len(vertex.data)} vertices, {len(faces)} triangles"


def check_trimesh(mesh, folder):
    import numpy as np
    import trimesh

    ply = trimesh.load(folder / "rest" / "surface.ply", process=False)
    same("vertices (PLY)", ply.vertices, mesh[0])
    same("triangles (PLY)", ply.faces, mesh[1])
    colours = ply.visual.vertex_colors[:, :3]
    check_colours(colours, labels(folder / "rest"))

    (glb,) = trimesh.load(folder / "rest.glb", process=False).geometry.values()
    same("vertices (GLB)", glb.vertices, mesh[0].astype("f4"))
    same("triangles (GLB)", glb.faces, mesh[1])
    same("regions (GLB)", glb.vertex_attributes["_REGION"].ravel(), labels(folder / "rest"))
    # glTF's colours are linear, 16 bits; PLY's are sRGB.
    linear = glb.visual.vertex_attributes["color"]
    equal("type of colours (GLB)", (linear.dtype, linear.shape), (np.uint16, (len(mesh[0]), 4)))
    linear = linear[:, :3] / 65535
    srgb = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    same("colours (GLB)", np.rint(255 * srgb), colours)
    true("closed", ply.is_watertight and glb.is_watertight and np.isclose(ply.volume, glb.volume, rtol=1e-5))

    # Of a sequence the mesh is the first frame.
    (moving,) = trimesh.load(folder / "track" / "tracks.glb", process=False).geometry.values()
    first = trimesh.load(folder / "track" / sequence(folder)[0]["name"] / "surface.ply", process=False)
    same("triangles (moving GLB)", moving.faces, first.faces)
    true("vertices (moving GLB)", np.allclose(moving.vertices, first.vertices, rtol=0, atol=1e-6))
    true("several colours (moving GLB)", len(np.unique(moving.visual.vertex_attributes["color"], axis=0)) >= 4)
    return f"{len(glb.vertices)} vertices, {len(glb.faces)} triangles, volume {ply.volume:.2f}"


def check_vtk(mesh, folder):
    import numpy as np
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersCore import vtkMassProperties
    from vtkmodules.vtkIOPLY import vtkPLYReader
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader, vtkXMLPolyDataReader

    def read(reader, path):
        reader.SetFileName(str(path))
        reader.Update()
        equal(f"error reading {path}", reader.GetErrorCode(), 0)
        return reader.GetOutput()

    def array(data, name):
        return vtk_to_numpy(data.GetArray(name))

    surface = read(vtkXMLPolyDataReader(), folder / "rest.vtp")
    same("vertices (VTP)", vtk_to_numpy(surface.GetPoints().GetData()), mesh[0])
    same("triangles (VTP)", vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3), mesh[1])
    regions = labels(folder / "rest")
    same("regions (VTP)", array(surface.GetPointData(), "region"), regions)
    check_colours(array(surface.GetPointData(), "color"), regions)
    mass = vtkMassProperties()
    mass.SetInputData(surface)
    ply = read(vtkPLYReader(), folder / "rest" / "surface.ply")
    equal("triangles (PLY)", ply.GetNumberOfPolys(), len(mesh[1]))

    grid = read(vtkXMLImageDataReader(), folder / "rest" / "volume.vti")
    arrays = np.load(folder / "rest" / "features.npz")
    affine = arrays["grid_affine"]
    same("spacing", grid.GetSpacing(), np.diag(affine)[:3])
    true("origin", np.allclose(grid.GetOrigin(), affine[:3] @ [-0.5, -0.5, -0.5, 1], rtol=1e-12, atol=0))
    cells = np.array(grid.GetDimensions())[::-1] - 1
    inside, region = (array(grid.GetCellData(), name).reshape(cells) for name in ["inside", "region"])
    # The file holds the part of the grid that its extent says.
    z, y, x = (arrays["voxel_index"] - np.array(grid.GetExtent()[::2])).T[::-1]
    same("regions (VTI)", region[z, y, x], arrays["voxel_region"])
    equal("voxels (VTI)", (int(inside.sum()), int(inside[z, y, x].sum())), (len(x), len(x)))
    same("empty voxels (VTI)", region[inside == 0], -2)
    share = len(x) * np.linalg.det(affine[:3, :3]) / mass.GetVolume()
    true(f"the voxels' volume is that of the surface ({share})", 0.95 < share < 1.05)
    return f"{surface.GetNumberOfPolys()} triangles, {len(x)} voxels"


def check_pyarrow(mesh, folder):
    import numpy as np
    import pyarrow as pa
    import pyarrow.parquet as pq

    shapes, regions = (pq.read_table(folder / "all" / f"{name}.parquet") for name in ["shapes", "regions"])
    names = shapes["shape"].to_pylist()
    equal("shapes", names, sorted(p.parent.name for p in (folder / "all").glob("*/regions.json")))
    equal("type of descriptors", regions.schema.field("descriptor").type.value_type, pa.float64())
    rows = regions.to_pylist()
    for shape in shapes.to_pylist():
        record = result(folder / "all" / shape["shape"])
        for key, wanted in {
            "path": record["input"]["path"],
            "sha256": record["input"]["sha256"],
            "voxels": record["voxelization"]["voxels"],
            "measure": sum(body["measure"] for body in record["bodies"]),
            "regions": len(record["regions"]),
            "version": record["mser3d"],
        }.items():
            equal(f"{key} of {shape['shape']}", shape[key], wanted)
        own = [row for row in rows if row["shape"] == shape["shape"]]
        equal("regions", [row["region"] for row in own], [r["id"] for r in record["regions"]])
        for row, region in zip(own, record["regions"]):
            for key in ["parent", "tree", "altitude", "volume", "volume_fraction", "voxels", "vertices"]:
                equal(key, row[key], region[key])
            equal("centroid", [row[a] for a in "xyz"], region["centroid"])
        arrays = np.load(folder / "all" / shape["shape"] / "features.npz")
        same("descriptors", np.array([row["descriptor"] for row in own]), arrays["region_descriptor"])
    equal("number of regions", len(rows), sum(shapes["regions"].to_pylist()))
    return f"{len(names)} shapes, {len(rows)} regions"


def check_pillow(mesh, folder):
    from PIL import Image

    frames = sequence(folder)
    step = round(1000 * (frames[-1]["time"] - frames[0]["time"]) / (len(frames) - 1))
    # Nothing is shown longer than a second.
    step = min(step, 1000)
    seen = set()
    with Image.open(folder / "track" / "moving.png") as picture:
        equal("frames", picture.n_frames, len(frames))
        equal("plays for ever", picture.info["loop"], 0)
        for number in range(picture.n_frames):
            picture.seek(number)
            equal(f"milliseconds of frame {number}", picture.info["duration"], step)
            seen.add(picture.convert("RGB").tobytes())
        size = picture.size
    equal("different pictures", len(seen), len(frames))
    return f"{len(frames)} pictures of {size[0]} x {size[1]}, {step} ms each"


def sequence(folder):
    return json.loads((folder / "track" / "tracks.json").read_text())["frames"]


def check_colours(colours, regions):
    """Each region has one colour of its neighbours' palette, and there are several."""
    import numpy as np

    equal("type of colours", colours.dtype, np.uint8)
    used = {int(r): np.unique(colours[regions == r], axis=0) for r in np.unique(regions)}
    true("one colour per region", all(len(c) == 1 for c in used.values()))
    true("several colours", len({tuple(c[0]) for c in used.values()}) >= 5)


def result(folder):
    return json.loads((folder / "regions.json").read_text())


def labels(folder):
    import numpy as np

    return np.load(folder / "features.npz")["vertex_region"]


def read_off(path):
    import numpy as np

    words = path.read_text().split()
    assert words[0] == "OFF", path
    vertices, faces = int(words[1]), int(words[2])
    points = np.array(words[4 : 4 + 3 * vertices], float).reshape(-1, 3)
    triangles = np.array(words[4 + 3 * vertices :], int).reshape(faces, 4)
    return points, triangles[:, 1:]


def true(what, holds):
    if not holds:
        raise AssertionError(f"does not hold: {what}")


def equal(what, found, wanted):
    if found != wanted:
        raise AssertionError(f"{what}: {found!r}, not {wanted!r}")


def same(what, found, wanted):
    import numpy as np

    found, wanted = np.asarray(found), np.asarray(wanted)
    if wanted.ndim and found.shape != wanted.shape:
        raise AssertionError(f"{what}: {found.shape} values, not {wanted.shape}")
    if not (found == wanted).all():
        raise AssertionError(f"{what}: {int((found != wanted).sum())} of {found.size} values differ")


if __name__ == "__main__":
    library, mesh, folder = sys.argv[1], Path(sys.argv[2]), Path(sys.argv[3])
    points = None if library in ("csv", "pillow") else read_off(mesh)
    print(globals()[f"check_{library}"](points, folder))
