"""Regions followed through a sequence."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Sequence
from typing import Any, Union

from . import _native
from ._options import with_options
from ._progress import Progress, listening
from ._records import Record, Records
from ._warnings import warn_all

Path = Union[str, "os.PathLike[str]"]


class Tracks:
    """The regions of a sequence, each followed from frame to frame."""

    def __init__(self, record: dict[str, Any], folder: str | None) -> None:
        #: What ``tracks.json`` says.
        self.record = record
        #: Where the frames' results are; None where they were not kept.
        self.folder = folder

    def __repr__(self) -> str:
        return f"<mser3d.Tracks: {len(self.tracks)} through {len(self.frames)} frames>"

    @property
    def tracks(self) -> Records:
        """A record for each track: ``id``, ``first_frame``, ``last_frame``, ``sightings``, ..."""
        return Records(Record(track) for track in self.record["tracks"])

    @property
    def frames(self) -> Records:
        """A record for each frame."""
        return Records(Record(frame) for frame in self.record["frames"])


@with_options("track", leave_out=("glb", "pictures", "height", "up"))
def track(
    frames: Path | Sequence[Path],
    folder: Path | None = None,
    *,
    write: Sequence[str] = (),
    progress: Progress = None,
    **options: Any,
) -> Tracks:
    """Follows the regions of a body through a sequence.

    Parameters
    ----------
    frames : path or list of paths
        An animated glTF file; or the frames in their order: files, folders or patterns.
    folder : path
        Where the results of the frames go, and ``tracks.json``: what is there is not computed again. Default: not kept.
    write : list of str
        Files besides, for each frame, as of ``mser3d track --write``.
    progress : callable or "tqdm"
        Called with ("frames", share, share) now and then.

    Returns
    -------
    Tracks

    Raises
    ------
    ValueError
        Wrong input; also where frames have failed and none is left.
    """
    inputs = [frames] if isinstance(frames, (str, os.PathLike)) else list(frames)
    if not inputs:
        raise ValueError("frames: there are none")
    with listening(progress) as hear, tempfile.TemporaryDirectory() as own:
        target = os.path.join(own, "sequence") if folder is None else os.fspath(folder)
        found, failed, warnings = _native.track(inputs, target, options, list(write), hear)
    tracks = Tracks(json.loads(found), None if folder is None else target)
    warn_all([*warnings, *tracks.record["warnings"], *(f"{name} failed: {why}" for name, why in failed)])
    return tracks
