"""What in a collection is like the regions of a shape."""

from __future__ import annotations

import json
import os
from typing import Any, Union

from . import _native
from ._match import ResultOrFolder, native
from ._options import with_options
from ._records import Record, Records


class Collection:
    """All regions of the folder that ``mser3d batch`` wrote, in memory, to be queried many times."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        self.folder = os.fspath(folder)
        self._native = _native.Index(self.folder)

    def __len__(self) -> int:
        return len(self._native)

    @property
    def shapes(self) -> list[str]:
        """The names of the shapes that have regions to be found."""
        return self._native.shapes

    def __repr__(self) -> str:
        return f"<mser3d.Collection {self.folder}: {len(self)} regions>"


@with_options("query", leave_out=("up",))
def query(collection: Union[Collection, str, os.PathLike[str]], shape: ResultOrFolder, **options: Any) -> dict[int, Records]:
    """Finds the regions of a collection that are most like those of a shape.

    Parameters
    ----------
    collection : Collection or path
        A folder that ``mser3d batch`` wrote. For many queries make a `mser3d.Collection` of it, which is read once.
    shape : Result or path
        What `mser3d.detect` gave, a folder with it, or the name of a shape of the collection.

    Returns
    -------
    dict
        For each region of the shape, the nearest regions, nearest first: records of ``shape``, ``region``, ``distance``, ...
    """
    if not isinstance(collection, Collection):
        collection = Collection(collection)
    itself = None
    if isinstance(shape, (str, os.PathLike)):
        member = os.path.join(collection.folder, os.fspath(shape))
        if not os.path.isdir(shape) and os.path.isdir(member):
            shape = member
        inside = os.path.dirname(os.path.realpath(shape)) == os.path.realpath(collection.folder)
        itself = os.path.basename(os.path.realpath(shape)) if inside else None
    found = json.loads(collection._native.query(native(shape, "shape"), options, itself))
    return {hits["region"]: Records(Record(hit) for hit in hits["closest"]) for hits in found}
