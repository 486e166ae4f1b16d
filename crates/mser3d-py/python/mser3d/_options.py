"""Keyword arguments: those of the command line, from its own definitions.

A function written ``@with_options("detect")`` takes ``**options``; its signature and docstring are completed here, so
that ``help()``, notebooks and editors show every option with its default.
"""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Callable
from typing import Any, TypeVar

from . import _native

Function = TypeVar("Function", bound=Callable[..., Any])


@functools.lru_cache(maxsize=None)
def described(command: str) -> tuple[dict[str, Any], ...]:
    """The options of a command: name, help, kind, many, default, choices and value of each."""
    return tuple(_native.options(command))


def with_options(command: str, leave_out: tuple[str, ...] = (), **defaults: Any) -> Callable[[Function], Function]:
    """Completes a function's signature and docstring by the options of a command."""

    def complete(function: Function) -> Function:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        names = {p.name for p in own} | set(leave_out)
        options = [option for option in described(command) if option["name"] not in names]
        more = [
            inspect.Parameter(
                option["name"],
                inspect.Parameter.KEYWORD_ONLY,
                default=defaults.get(option["name"], default(option)),
                annotation=annotation(option),
            )
            for option in options
        ]
        function.__signature__ = signature.replace(parameters=own + more)  # type: ignore[attr-defined]
        function.__doc__ = inspect.cleandoc(function.__doc__ or "") + "\n\n" + _text(options) + "\n"
        return function

    return complete


def default(option: dict[str, Any]) -> Any:
    """The default of an option as a value of Python."""
    if option["kind"] == "flag":
        return False
    values = [_value(option["kind"], text) for text in option["default"]]
    if not values:
        return None
    return tuple(values) if option["many"] else values[0]


def annotation(option: dict[str, Any]) -> str:
    """The type of an option."""
    if option["kind"] == "flag":
        return "bool"
    base = {"int": "int", "float": "float", "text": "str", "path": "str | os.PathLike[str]"}[option["kind"]]
    names = [name for name, _ in option["choices"]]
    if names:
        numbers = [int(name) for name in names if name.isdigit()]
        base = f"Literal[{', '.join(map(repr, [*names, *numbers]))}]"
    if option["name"] in ("weight", "affine"):
        # An array serves too.
        base = "Any"
    if option["name"] in ("label", "parts"):
        base = "int | str"
    if option["name"] == "labels":
        base = "Mapping[int, str] | str | os.PathLike[str]"
    if option["many"]:
        base = f"{base} | Sequence[{base}]"
    return base if option["default"] or base == "Any" else f"{base} | None"


def _value(kind: str, text: str) -> Any:
    if kind == "int":
        return int(text)
    return float(text) if kind == "float" else text


def _text(options: list[dict[str, Any]]) -> str:
    """The options for a docstring, in NumPy's style."""
    lines = ["Other Parameters", "----------------"]
    for option in options:
        kind = {"flag": "bool", "text": "str", "path": "path"}.get(option["kind"], option["kind"])
        if option["choices"]:
            kind = "{" + ", ".join(repr(name) for name, _ in option["choices"]) + "}"
        if option["many"]:
            kind += " or a list of them"
        lines.append(f"{option['name']} : {kind}, default {default(option)!r}")
        lines.extend(textwrap.wrap(_in_python(option["help"]), 110, initial_indent="    ", subsequent_indent="    "))
        for name, help in option["choices"]:
            about = f"{name!r}: {_in_python(help)}"
            lines.extend(textwrap.wrap(about, 110, initial_indent="    * ", subsequent_indent="      "))
    return "\n".join(lines)


def _in_python(text: str) -> str:
    """Help in one paragraph."""
    return " ".join(text.split())
