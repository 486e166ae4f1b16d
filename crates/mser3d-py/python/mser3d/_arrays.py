"""What callers give, as the arrays that the native half takes. Errors name the argument."""

from __future__ import annotations

from typing import Any

import numpy as np


def array(name: str, value: Any) -> np.ndarray:
    """The value as an array of numbers."""
    try:
        found = np.asarray(value)
    except Exception as error:  # What objects raise when they are asked for their numbers is theirs.
        raise ValueError(f"{name}: cannot be made an array of numbers: {error}") from error
    if found.dtype == object or found.dtype.kind not in "biuf":
        what = f"type {found.dtype}"
        if found.dtype == object:
            what = "objects; are its lists of one length, and its numbers within 64 bits?"
        raise ValueError(f"{name}: must be an array of real numbers, not of {what}")
    return found


def numbers(name: str, value: Any, shape: tuple[int | None, ...] | None = None) -> np.ndarray:
    """As contiguous float64, with this shape; None stands for any length."""
    found = array(name, value)
    if shape is not None:
        check_shape(name, found, shape)
    # Not ascontiguousarray, which makes an axis of a single number.
    return np.asarray(found, dtype=np.float64, order="C")


def functions(name: str, value: Any) -> np.ndarray:
    """As contiguous rows of float32 where they are float32, else of float64."""
    found = array(name, value)
    check_shape(name, found, (None, None))
    return np.asarray(found, dtype=np.float32 if found.dtype == np.float32 else np.float64, order="C")


def indices(name: str, value: Any, shape: tuple[int | None, ...]) -> np.ndarray:
    """As contiguous int64, with this shape."""
    found = array(name, value)
    if found.size == 0 and found.ndim == 1 and len(shape) == 2:
        found = found.reshape(0, shape[1] or 0)
    check_shape(name, found, shape)
    if found.dtype.kind not in "iu" and found.size > 0:
        raise ValueError(f"{name}: must be an array of integers, not of type {found.dtype}")
    if found.dtype == np.uint64 and found.size > 0 and found.max() > np.iinfo(np.int64).max:
        raise ValueError(f"{name}: holds numbers beyond 2^63")
    return np.ascontiguousarray(found, dtype=np.int64)


def check_shape(name: str, found: np.ndarray, shape: tuple[int | None, ...]) -> None:
    """Refuses another number of axes, or other lengths."""
    if found.ndim == len(shape) and all(n is None or n == m for n, m in zip(shape, found.shape)):
        return
    letters = iter("nmk")
    wanted = ", ".join(next(letters) if n is None else str(n) for n in shape)
    comma = "," if len(shape) == 1 else ""
    raise ValueError(f"{name}: must have the shape ({wanted}{comma}), not {found.shape}")


def finite(name: str, found: np.ndarray) -> np.ndarray:
    """Refuses NaN and infinite values."""
    bad = ~np.isfinite(found)
    if bad.any():
        place = tuple(int(i) for i in np.argwhere(bad)[0])
        raise ValueError(f"{name}: the value at {place} is {found[place]}; it must be finite")
    return found


def plain(found: np.ndarray) -> np.ndarray:
    """The same numbers in a type that the native half knows: in native byte order, halves as float32."""
    if found.dtype.kind == "f" and found.dtype.itemsize not in (4, 8):
        kind = np.float32 if found.dtype.itemsize < 4 else np.float64
        return found.astype(kind)
    return found.astype(found.dtype.newbyteorder("="), copy=False)


def volume(name: str, value: Any) -> tuple[tuple[int, int, int], int, np.ndarray]:
    """An array indexed [x, y], [x, y, z] or [x, y, z, channel]: its lengths, channels, and its numbers x fastest."""
    found = array(name, value)
    if found.ndim not in (2, 3, 4):
        raise ValueError(
            f"{name}: must be indexed [x, y], [x, y, z] or [x, y, z, channel], but has {found.ndim} axes"
        )
    if found.size == 0:
        raise ValueError(f"{name}: is empty, of shape {found.shape}")
    channels = found.shape[3] if found.ndim == 4 else 1
    dims = (*found.shape[:3], 1) if found.ndim == 2 else found.shape[:3]
    ordered = np.moveaxis(found, 3, 0) if found.ndim == 4 else found
    flat = plain(ordered).ravel(order="F")
    return (int(dims[0]), int(dims[1]), int(dims[2])), channels, np.ascontiguousarray(flat)


def affine(name: str, value: Any) -> np.ndarray:
    """A map from voxels to the world, 4 x 4."""
    return finite(name, numbers(name, value, (4, 4)))


def weight(value: Any) -> tuple[list[int], np.ndarray]:
    """A weight: its shape, and its values in C order."""
    found = numbers("weight", value)
    if found.ndim == 0:
        raise ValueError("weight: must be a name, a path, or an array with a value for each vertex or voxel")
    return [int(n) for n in found.shape], found.ravel()
