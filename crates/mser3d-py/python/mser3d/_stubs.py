"""Writes ``__init__.pyi`` from the code and the command line's definitions: ``python -m mser3d._stubs``.

Type checkers and editors cannot see signatures that are completed at run time; they read this file.
"""

from __future__ import annotations

import inspect
import os
from typing import Any

import mser3d

PATH = os.path.join(os.path.dirname(__file__), "__init__.pyi")

HEAD = '''"""Written by `python -m mser3d._stubs`; what is changed here is lost."""

import os
from collections.abc import Mapping, Sequence
from typing import Any, Literal, Union

from ._match import ResultOrFolder
from ._progress import Progress
from ._track import Path
'''


def stubs() -> str:
    """The text of the file."""
    imports, functions = [], []
    for name in mser3d.__all__:
        value = getattr(mser3d, name)
        if inspect.isfunction(value) and hasattr(value, "__signature__"):
            functions.append(_function(name, value))
        elif name == "__version__":
            imports.append("from ._native import __version__ as __version__")
        else:
            module = value.__module__.removeprefix("mser3d.")
            imports.append(f"from .{module} import {name} as {name}")
    names = "\n".join(f'    "{name}",' for name in mser3d.__all__)
    return HEAD + "\n".join(sorted(imports)) + f"\n\n__all__ = [\n{names}\n]\n\n" + "\n".join(functions)


def _function(name: str, function: Any) -> str:
    lines = [f"def {name}("]
    keyword_only = False
    signature = inspect.signature(function)
    for parameter in signature.parameters.values():
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY and not keyword_only:
            keyword_only = True
            lines.append("    *,")
        default = "" if parameter.default is inspect.Parameter.empty else f" = {parameter.default!r}"
        lines.append(f"    {parameter.name}: {parameter.annotation}{default},")
    text = inspect.getdoc(function) or ""
    body = "\n".join(f"    {line}".rstrip() for line in text.splitlines())
    lines.append(f') -> {signature.return_annotation}:\n    """{body.strip()}\n    """\n    ...\n')
    return "\n".join(lines)


if __name__ == "__main__":
    with open(PATH, "w", encoding="utf-8", newline="\n") as file:
        file.write(stubs())
