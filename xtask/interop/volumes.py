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
from volume_writers import LPS, WRITERS, Case, random_affine, single


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
    cases = []
    for number in range(count):
        writer = WRITERS[number % len(WRITERS)]
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
