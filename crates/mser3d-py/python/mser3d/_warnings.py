"""What the user should know, as Python's warnings."""

from __future__ import annotations

import os
import sys
import warnings
from collections.abc import Iterable

_HERE = os.path.dirname(os.path.abspath(__file__))


class Mser3dWarning(UserWarning):
    """Something was guessed, left out or found wrong; the text says what."""


def warn_all(texts: Iterable[str], name: str | None = None) -> None:
    """Warns of each text, as of the line outside this package that called."""
    level, frame = 2, sys._getframe(1)
    while frame.f_back is not None and os.path.abspath(frame.f_code.co_filename).startswith(_HERE):
        frame, level = frame.f_back, level + 1
    for text in texts:
        warnings.warn(f"{name}: {text}" if name else text, Mser3dWarning, stacklevel=level)
