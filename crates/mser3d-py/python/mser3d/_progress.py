"""Progress: a function of (stage, done, overall), or a bar of tqdm."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from typing import Literal, Union

ProgressFunction = Callable[[str, float, float], object]
Progress = Union[ProgressFunction, Literal["tqdm"], None]


@contextlib.contextmanager
def listening(progress: Progress) -> Iterator[ProgressFunction | None]:
    """What the native half calls now and then: from the thread that called, at most twenty times a second."""
    if progress is None or callable(progress):
        yield progress
        return
    if progress != "tqdm":
        raise ValueError(f"progress: must be a function of (stage, done, overall), or 'tqdm', not {progress!r}")
    try:
        from tqdm.auto import tqdm
    except ImportError as error:
        raise ImportError("progress='tqdm' needs tqdm: pip install tqdm") from error
    with tqdm(total=100, unit="%", bar_format="{desc} {percentage:3.0f} %|{bar}| {elapsed}") as bar:

        def hear(stage: str, _done: float, overall: float) -> None:
            bar.set_description_str(stage, refresh=False)
            bar.update(100.0 * overall - bar.n)

        yield hear
        bar.update(100.0 - bar.n)
