"""Which regions of two shapes are the same."""

from __future__ import annotations

import json
import os
from typing import Any, Union

import numpy as np

from . import _native
from ._options import with_options
from ._records import Record, Records
from ._result import Result, load
from ._warnings import warn_all

ResultOrFolder = Union[Result, str, "os.PathLike[str]"]


class Matching:
    """The regions of a second shape, each with its partner on the first."""

    def __init__(self, record: dict[str, Any]) -> None:
        #: What ``matches.json`` says under "result".
        self.record = record

    def __repr__(self) -> str:
        return f"<mser3d.Matching: {len(self.matches)} matched, {len(self.unmatched)} not>"

    def __len__(self) -> int:
        return len(self.record["matches"])

    @property
    def matches(self) -> Records:
        """A record for each match: ``region`` of the second shape, ``partner`` on the first, ``distance``, ``ambiguous``, ..."""
        return Records(Record(match) for match in self.record["matches"])

    @property
    def pairs(self) -> np.ndarray:
        """(m, 2) int64: the region of the second shape and its partner on the first."""
        return np.array([(m["region"], m["partner"]) for m in self.record["matches"]], dtype=np.int64).reshape(-1, 2)

    @property
    def distances(self) -> np.ndarray:
        """The distance of each pair: (m,)."""
        return np.array([m["distance"] for m in self.record["matches"]], dtype=float)

    @property
    def unmatched(self) -> list[int]:
        """Regions of the second shape without a partner."""
        return self.record["unmatched"]

    @property
    def mirrored(self) -> bool:
        """Whether the second shape was matched as a mirror image."""
        return self.record["mirrored"]

    def to_pandas(self) -> Any:
        """The matches as a pandas DataFrame, a row each."""
        return self.matches.to_pandas()


@with_options("match", leave_out=("up",))
def match(first: ResultOrFolder, second: ResultOrFolder, **options: Any) -> Matching:
    """Finds out which regions of two shapes are the same: a partner on the first for each region of the second.

    Parameters
    ----------
    first, second : Result or path
        What `mser3d.detect` gave, or a folder with it.

    Returns
    -------
    Matching
    """
    found = _native.match_results(native(first, "first"), native(second, "second"), options)
    matching = Matching(json.loads(found))
    warn_all(matching.record["warnings"])
    return matching


def native(result: ResultOrFolder, name: str) -> _native.Result:
    """The native half of a result, which is read where it is a folder."""
    if isinstance(result, (str, os.PathLike)):
        result = load(result)
    if not isinstance(result, Result):
        raise TypeError(f"{name}: must be a mser3d.Result or a folder, not {type(result).__name__}")
    return result._native
