"""Volumes by each format's own library, through mser3d-volumeio and back: `python volumes.py CONVERT FOLDER [COUNT]`.

CONVERT is the example `convert` of mser3d-volumeio. COUNT random volumes of seeded types, orders of bytes,
compressions and affines are written by nibabel, pynrrd, tifffile, SimpleITK and NumPy, read and written by CONVERT, and
reopened by nibabel or NumPy. Values and types must be the same, affines too: exactly, or to what the format stores.
Then all 48 axis orders and flips of one mask, and oblique ones: each voxel must stay at its place.
"""

import itertools
import json
import subprocess
import sys
from pathlib import Path

import nibabel
import nrrd
import numpy as np
import SimpleITK
import tifffile

TYPES = ["u1", "i1", "u2", "i2", "u4", "i4", "u8", "i8", "f4", "f8"]
LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


class Case:
    """A file, and what must be read of it: `values[x, y, z, channel]` and the affine within `rounding` voxels."""

    def __init__(self, path, values, affine, rounding=0.0):
        self.path, self.values, self.affine, self.rounding = path, values, affine, rounding


def random_values(rng, kind, shape):
    dtype = np.dtype(kind)
    if dtype.kind == "b":
        return rng.integers(0, 2, shape).astype(bool)
    if dtype.kind == "f":
        return rng.normal(0, 1000, shape).astype(dtype)
    bounds = np.iinfo(dtype)
    return rng.integers(bounds.min, bounds.max, shape, dtype=dtype, endpoint=True)


def random_affine(rng, shear=False):
    """Turned, stretched, of either hand; some along the axes, some far from the origin."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    if rng.random() < 0.4:
        turn = np.eye(3)[rng.permutation(3)] * rng.choice([-1, 1], 3)
    if shear:
        turn = turn @ (np.eye(3) + np.triu(rng.uniform(-0.3, 0.3, (3, 3)), 1))
    affine = np.eye(4)
    affine[:3, :3] = turn * rng.uniform(0.2, 4, 3)
    affine[:3, 3] = rng.normal(0, rng.choice([1, 100, 1e6]), 3)
    return affine


def single(affine):
    return affine.astype("f4").astype("f8")


def shape_of(rng, channels=1):
    return (*rng.integers(1, 9, 3), channels)


def by_nibabel(rng, path):
    kind, big = rng.choice(TYPES), rng.random() < 0.5
    two = rng.random() < 0.4
    values = random_values(rng, kind, shape_of(rng, rng.choice([1, 1, 1, 3])))
    affine = random_affine(rng, shear=rng.random() < 0.2)
    pair = rng.random() < 0.2
    image = {
        (False, False): nibabel.Nifti1Image,
        (False, True): nibabel.Nifti1Pair,
        (True, False): nibabel.Nifti2Image,
        (True, True): nibabel.Nifti2Pair,
    }[two, pair]
    header = image.header_class(endianness=">" if big else "<")
    header.set_data_dtype(np.dtype(kind).newbyteorder(">" if big else "<"))
    array = values[..., 0] if values.shape[3] == 1 else values
    image = image(array, affine, header, dtype=kind)
    codes = rng.choice(["both", "sform", "qform", "none"], p=[0.4, 0.3, 0.2, 0.1])
    rounding = 0.0 if two else 1e-5
    if codes in ("qform", "none"):
        image.set_sform(affine, 0)
        affine = random_affine(rng)
        image.set_qform(affine, int(rng.integers(1, 5)) if codes == "qform" else 0, strip_shears=True)
        rounding = 1e-3
    else:
        image.set_sform(affine, int(rng.integers(1, 5)))
        image.set_qform(affine, 1 if codes == "both" else 0, strip_shears=True)
    if rng.random() < 0.2:
        image.header.extensions.append(nibabel.nifti1.Nifti1Extension("comment", b"something between"))
    path = path.with_suffix((".hdr" if pair else ".nii") + rng.choice(["", ".gz"]))
    nibabel.save(image, path)
    found = nibabel.load(path)
    wanted = found.affine if codes != "none" else np.diag([*found.header.get_zooms()[:3], 1.0]).astype("f8")
    if path.suffix == ".nii" and values.dtype.kind != "f" and rng.random() < 0.5:
        at, number = ((176, "f8") if two else (112, "f4"))
        scaling = np.array([0.25, -3.5], np.dtype(number).newbyteorder(">" if big else "<")).tobytes()
        stored = path.read_bytes()
        path.write_bytes(stored[:at] + scaling + stored[at + len(scaling) :])
        values = nibabel.load(path).get_fdata().reshape(values.shape)
    if pair and rng.random() < 0.5:
        path = path.with_name(path.name.replace(".hdr", ".img"))
    return Case(path, values, wanted, 0.0 if codes != "qform" else rounding)


def by_freesurfer(rng, path):
    values = random_values(rng, rng.choice(["u1", "i2", "i4", "f4"]), shape_of(rng, rng.choice([1, 1, 2])))
    affine = random_affine(rng)
    path = path.with_suffix(rng.choice([".mgh", ".mgz"]))
    array = values[..., 0] if values.shape[3] == 1 else values
    nibabel.save(nibabel.MGHImage(array, affine), path)
    return Case(path, values, nibabel.load(path).affine, 1e-3 if np.abs(affine[:3, 3]).max() < 1e4 else 1.0)


def by_pynrrd(rng, path):
    kind = np.dtype(rng.choice(TYPES)).newbyteorder(rng.choice(["<", ">"]))
    values = random_values(rng, kind.newbyteorder("="), shape_of(rng, rng.choice([1, 1, 2])))
    affine = random_affine(rng, shear=rng.random() < 0.2)
    space, turn = [
        ("left-posterior-superior", LPS),
        ("LPS", LPS),
        ("right-anterior-superior", np.eye(4)),
        ("LAS", np.diag([-1.0, 1, 1, 1])),
    ][rng.integers(4)]
    stored = turn @ affine
    directions = stored[:3, :3].T
    kinds = ["domain"] * 3
    array = values[..., 0]
    if values.shape[3] > 1:
        axis = int(rng.integers(4))
        array = np.moveaxis(values, 3, axis)
        directions = np.insert(directions, axis, np.nan, axis=0)
        kinds.insert(axis, "list")
    # As text pynrrd writes 17 digits.
    encoding = str(rng.choice(["raw", "gzip", "bzip2", "ascii"][: 3 if kind.itemsize == 8 and kind.kind != "f" else 4]))
    header = {
        "space": space,
        "space directions": directions,
        "space origin": stored[:3, 3],
        "kinds": kinds,
        "encoding": encoding,
    }
    detached = rng.random() < 0.3
    path = path.with_suffix(".nhdr" if detached else ".nrrd")
    nrrd.write(str(path), np.asfortranarray(array.astype(kind)), header, detached_header=detached, index_order="F")
    return Case(path, values, affine, 1e-12)


def by_simpleitk(rng, path):
    kind, channels = rng.choice(TYPES), rng.choice([1, 1, 3])
    values = random_values(rng, kind, shape_of(rng, channels))
    array = values.transpose(2, 1, 0, 3)
    image = SimpleITK.GetImageFromArray(array[..., 0] if channels == 1 else array, isVector=bool(channels > 1))
    affine = random_affine(rng)
    stored = LPS @ affine
    spacing = np.linalg.norm(stored[:3, :3], axis=0)
    image.SetSpacing(spacing.tolist())
    image.SetDirection((stored[:3, :3] / spacing).ravel().tolist())
    image.SetOrigin(stored[:3, 3].tolist())
    path = path.with_suffix(rng.choice([".mha", ".mhd", ".nrrd", ".nii.gz"], p=[0.5, 0.3, 0.1, 0.1]))
    SimpleITK.WriteImage(image, str(path), useCompression=bool(rng.random() < 0.5))
    return Case(path, values, affine, 1e-9 if path.suffix != ".gz" else 0.01 * max(1, np.abs(affine[:3, 3]).max()))


def by_tifffile(rng, path):
    layout = rng.choice(["plain", "imagej", "ome", "rgb"])
    if layout == "rgb":
        return colours(rng, path)
    kinds = {"imagej": ["u1", "u2", "f4"], "ome": [t for t in TYPES if t[1] != "8" or t == "f8"], "plain": [*TYPES, "f2", "?"]}
    kind = rng.choice(kinds[layout])
    nx, ny, nz, _ = shape_of(rng)
    nx, ny, nz = nx + 1, ny + 1, nz + 1
    volumes = int(rng.choice([1, 1, 2])) if layout != "plain" else 1
    values = random_values(rng, kind, (nx, ny, nz, volumes))
    pages = values.transpose(3, 2, 1, 0) if volumes > 1 else values[..., 0].transpose(2, 1, 0)
    x, y, z = (int(n) for n in rng.integers(1, 9, 3))
    spacing = [1.0, 1.0, 1.0]
    options = {"bigtiff": bool(rng.random() < 0.3), "byteorder": rng.choice(["<", ">"])}
    compression = rng.choice(["none", "zlib", "lzw", "packbits"]) if layout != "imagej" and kind != "?" else "none"
    if compression != "none":
        options["compression"] = str(compression)
        options["predictor"] = bool(compression != "packbits" and kind not in ("f2", "u8", "i8") and rng.random() < 0.5)
    if layout != "imagej":
        if rng.random() < 0.3 and kind != "?":
            options["tile"] = (16, 32)
        else:
            options["rowsperstrip"] = int(rng.integers(1, ny + 1))
    name = "TZYX" if volumes > 1 else "ZYX"
    if layout == "imagej":
        options = {"imagej": True, "resolution": (x, y), "metadata": {"axes": name, "spacing": z / 2, "unit": "um"}}
        pages = values.transpose(3, 2, 1, 0)[:, :, None] if volumes > 1 else pages
        options["metadata"]["axes"] = "TZCYX" if volumes > 1 else "ZYX"
        spacing = [1 / x, 1 / y, z / 2]
    elif layout == "ome":
        options["ome"] = True
        sizes = {f"PhysicalSize{axis}": n / 4 for axis, n in zip("XYZ", (x, y, z))}
        options["metadata"] = {"axes": "CZYX" if volumes > 1 else "ZYX", **sizes}
        spacing = [x / 4, y / 4, z / 4]
    path = path.with_suffix(".tif")
    tifffile.imwrite(path, pages, photometric="minisblack", **options)
    if kind == "?":
        values = values.astype("u1")
    return Case(path, values.astype("f4") if kind == "f2" else values, np.diag([*spacing, 1.0]), 1e-12)


def colours(rng, path):
    """Colours side by side or in planes, in strips or tiles."""
    kind = rng.choice(["u1", "u2"])
    values = random_values(rng, kind, [*rng.integers(2, 40, 2), rng.integers(2, 9), 3])
    pages = values.transpose(2, 1, 0, 3)
    options = {"compression": str(rng.choice(["zlib", "lzw"])), "predictor": bool(rng.random() < 0.5)}
    if rng.random() < 0.5:
        options["tile"] = (16, 16)
    planar = rng.random() < 0.5
    pages = pages.transpose(0, 3, 1, 2) if planar else pages
    path = path.with_suffix(".tif")
    layout = "separate" if planar else "contig"
    tifffile.imwrite(path, pages, photometric="rgb", planarconfig=layout, byteorder=rng.choice(["<", ">"]), **options)
    return Case(path, values, np.eye(4))


def by_numpy(rng, path):
    kind = rng.choice([*TYPES, "f2", "?"])
    values = random_values(rng, kind, shape_of(rng, rng.choice([1, 2])))
    array = (values[..., 0] if values.shape[3] == 1 else values).astype(np.dtype(kind).newbyteorder(rng.choice(["<", ">"])))
    path = path.with_suffix(".npy")
    np.save(path, np.asfortranarray(array) if rng.random() < 0.5 else np.ascontiguousarray(array))
    return Case(path, values.astype({"f2": "f4", "?": "u1"}.get(kind, kind)), np.eye(4))


def orientations(folder):
    """All axis orders and flips of one mask, and oblique ones: what is read must be where nibabel has it."""
    rng = np.random.default_rng(48)
    mask = (rng.random((5, 6, 7)) < 0.4).astype("u1")
    affine = np.array([[0.9, 0, 0, -20], [0, 1.1, 0, 30], [0, 0, 2.5, -70], [0, 0, 0, 1]])
    turns = []
    for order, flips in itertools.product(itertools.permutations(range(3)), itertools.product([1, -1], repeat=3)):
        turns.append((order, flips, affine))
    for _ in range(4):
        turns.append(((0, 1, 2), (1, 1, 1), random_affine(rng)))
    cases = []
    for number, (order, flips, affine) in enumerate(turns):
        turned = nibabel.Nifti1Image(mask, affine).as_reoriented(np.stack([order, flips], axis=1))
        for name, save in [("nii.gz", lambda p: nibabel.save(turned, p)), ("nrrd", lambda p: save_lps(turned, p))]:
            path = folder / f"turn{number}.{name}"
            save(path)
            wanted = single(turned.affine) if name == "nii.gz" else turned.affine
            cases.append(Case(path, np.asarray(turned.dataobj)[..., None], wanted, 1e-12))
    return cases


def save_lps(image, path):
    stored = LPS @ image.affine
    header = {"space": "LPS", "space directions": stored[:3, :3].T, "space origin": stored[:3, 3]}
    nrrd.write(str(path), np.asarray(image.dataobj), header, index_order="F")


def main(convert, folder, count):
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(2012)
    writers = [by_nibabel, by_pynrrd, by_tifffile, by_simpleitk, by_freesurfer, by_numpy]
    cases = []
    for number in range(count):
        writer = writers[number % len(writers)]
        cases.append(writer(rng, folder / f"{number}_{writer.__name__[3:]}"))
    cases += orientations(folder)
    outputs = [folder / "out" / f"{i}{rng.choice(['.nii', '.nii.gz', '.npy'])}" for i in range(len(cases))]
    (folder / "out").mkdir(exist_ok=True)
    pairs = [str(path) for case, out in zip(cases, outputs) for path in (case.path, out)]
    lines = []
    for start in range(0, len(pairs), 400):
        run = subprocess.run([convert, *pairs[start : start + 400]], capture_output=True, text=True)
        lines += [json.loads(line) for line in run.stdout.splitlines()]
    faults = []
    for case, out, said in zip(cases, outputs, lines, strict=True):
        try:
            check(case, out, said)
        except Exception as fault:
            faults.append(f"{case.path.name} -> {out.name}: {type(fault).__name__}: {fault}")
    if faults:
        raise AssertionError(f"{len(faults)} of {len(cases)} files differ:\n" + "\n".join(faults[:20]))
    return f"{count} random volumes, {len(cases) - count} turned masks"


def check(case, out, said):
    if "error" in said:
        raise AssertionError(said["error"])
    affine, (nx, ny, nz, channels) = np.array(said["affine"]), case.values.shape
    near("affine as read", affine, case.affine, case.rounding, (nx, ny, nz))
    if out.suffix == ".npy":
        found = np.load(out)
    else:
        image = nibabel.load(out)
        found = np.asarray(image.dataobj)
        exact = isinstance(image, nibabel.Nifti2Image)
        same("affine as written", image.affine, affine if exact else single(affine))
        if not exact:
            near("affine in single precision", image.affine, affine, 1e-3, (nx, ny, nz))
        qform, code = image.get_qform(coded=True)
        if code:
            near("qform", qform, affine, 0.02, (nx, ny, nz))
        elif shear(affine) < 1e-6:
            raise AssertionError("no qform, though there is no shear")
    if found.dtype.newbyteorder("=") != case.values.dtype.newbyteorder("="):
        raise AssertionError(f"type {found.dtype}, not {case.values.dtype}")
    same("values", found.reshape(nx, ny, nz, channels), case.values)


def shear(affine):
    """The largest cosine between two axes."""
    steps = affine[:3, :3] / np.linalg.norm(affine[:3, :3], axis=0)
    return np.abs(steps.T @ steps - np.eye(3)).max()


def near(what, found, wanted, voxels, dims):
    """No voxel is further from its place than so many voxels, beside the rounding of double precision."""
    corners = np.array([[*c, 1] for c in itertools.product(*[(0, n - 1) for n in dims])]).T
    apart = np.abs((found - wanted) @ corners)[:3].max()
    voxel = np.linalg.norm(wanted[:3, :3], axis=0).min()
    if apart > voxels * voxel + 1e-13 * np.abs(wanted).max():
        raise AssertionError(f"{what}: {apart / voxel} voxels away:\n{found}\n{wanted}")


def same(what, found, wanted):
    found, wanted = np.asarray(found), np.asarray(wanted)
    if found.shape != wanted.shape or not np.array_equal(found, wanted, equal_nan=found.dtype.kind == "f"):
        raise AssertionError(f"{what}: {found.ravel()[:4]} {found.shape}, not {wanted.ravel()[:4]} {wanted.shape}")


if __name__ == "__main__":
    count = int(sys.argv[3]) if len(sys.argv) > 3 else 1000
    print(main(sys.argv[1], Path(sys.argv[2]), count))
