"""Writes docs/python_api.md from the docstrings: `python crates/mser3d-py/api_page.py`, where the package is installed."""

from __future__ import annotations

import importlib.util
import inspect
import pathlib
import re

import mser3d

PATH = pathlib.Path(__file__).resolve().parents[2] / "docs/python_api.md"

HEAD = """# Python: all functions

Written by `python crates/mser3d-py/api_page.py` from the docstrings; what is changed here is lost. How to use them is in
[Python](python.md), many shapes in [Dask](dask.md). Options of the command line, which many functions take as keyword
arguments, are in [parameters](parameters.md): here only their names and defaults.
"""


def page() -> str:
    """The text of the page."""
    text = [HEAD]
    for name in mser3d.__all__:
        if name != "__version__":
            text += _entry(f"mser3d.{name}", getattr(mser3d, name))
    if importlib.util.find_spec("distributed") is not None:
        from mser3d import dask

        for name in dask.__all__:
            text += _entry(f"mser3d.dask.{name}", getattr(dask, name))
    joined = re.sub(r"\n(?=###)", "\n\n", "\n".join(text))
    return re.sub(r"\n{3,}", "\n\n", joined).rstrip() + "\n"


def _entry(name: str, value: object) -> list[str]:
    text = [f"## {name}\n"]
    if not inspect.isclass(value):
        return text + _function(name, value)
    text.append(_prose(value))
    members = vars(value).items() if value.__module__.startswith("mser3d") else ()
    for member, attribute in members:
        if member.startswith("_"):
            continue
        about = inspect.getdoc(attribute)
        if callable(attribute):
            text.append(f"### {value.__name__}.{member}\n")
            text += _function(f"{value.__name__}.{member}", attribute)
        elif about:
            text.append(f"* `{member}`: {' '.join(about.split())}")
    return [*text, ""]


def _function(name: str, function: object) -> list[str]:
    parameters = []
    star = False
    for parameter in inspect.signature(function).parameters.values():
        if parameter.name == "self":
            continue
        if parameter.kind is inspect.Parameter.KEYWORD_ONLY and not star:
            parameters.append("*")
            star = True
        sign = {inspect.Parameter.VAR_KEYWORD: "**", inspect.Parameter.VAR_POSITIONAL: "*"}.get(parameter.kind, "")
        default = "" if parameter.default is inspect.Parameter.empty else f"={parameter.default!r}"
        parameters.append(f"{sign}{parameter.name}{default}")
    lines = []
    for parameter in parameters:
        if lines and len(lines[-1]) + len(parameter) < 100:
            lines[-1] += f" {parameter},"
        else:
            lines.append(f"    {parameter},")
    inside = "\n" + "\n".join(lines) + "\n" if lines else ""
    return [f"```text\n{name}({inside})\n```\n", _prose(function)]


def _prose(value: object) -> str:
    """The docstring as Markdown: titles with a line below in bold, names of parameters as items; options left out."""
    lines = (inspect.getdoc(value) or "").split("Other Parameters\n---")[0].splitlines()
    text: list[str] = []
    section = ""
    for number, line in enumerate(lines):
        following = lines[number + 1] if number + 1 < len(lines) else ""
        if set(line) == {"-"}:
            continue
        if line and set(following) == {"-"}:
            section = line
            text += ["", f"**{line}**", ""]
        elif section in ("Parameters", "Returns", "Raises") and line and not line.startswith(" "):
            text.append(f"* `{line}`")
        elif line.startswith("    ") and section in ("Parameters", "Returns", "Raises"):
            text.append("  " + line.strip())
        else:
            text.append(line)
    joined = "\n".join(text).replace("``", "`")
    return joined.strip() + "\n"


if __name__ == "__main__":
    PATH.write_text(page(), encoding="utf-8", newline="\n")
