"""Records: what was found as objects with attributes, and lists of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any


class Record(Mapping[str, Any]):
    """Named values: ``region.volume`` and ``region["volume"]`` are the same; ``dict(region)`` has all."""

    def __init__(self, fields: dict[str, Any]) -> None:
        self._fields = fields

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_fields"][name]
        except KeyError:
            raise AttributeError(f"{type(self).__name__} has no {name!r}; it has {', '.join(self.__dict__.get('_fields', ()))}") from None

    def __getitem__(self, name: str) -> Any:
        return self._fields[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._fields)

    def __len__(self) -> int:
        return len(self._fields)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._fields]

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={_short(value)}" for name, value in self._fields.items())
        return f"{type(self).__name__}({fields})"


class Records(tuple):
    """A list of records that does not change."""

    def __new__(cls, records: Iterable[Record] = ()) -> Records:
        return super().__new__(cls, records)

    def to_pandas(self) -> Any:
        """As a pandas DataFrame, a row each; numbers that belong together (x, y, z) get a column each."""
        try:
            import pandas
        except ImportError as error:
            raise ImportError("to_pandas needs pandas: pip install pandas") from error
        return pandas.DataFrame([_flat(record) for record in self])


def _flat(record: Mapping[str, Any]) -> dict[str, Any]:
    """A record with one level: ``centroid`` becomes ``centroid_x`` and so on, ``merge.growth`` becomes ``merge_growth``."""
    row: dict[str, Any] = {}
    for name, value in record.items():
        if isinstance(value, dict):
            row.update({f"{name}_{inner}": deeper for inner, deeper in _flat(value).items()})
        elif isinstance(value, list) and len(value) == 3 and all(isinstance(x, float) for x in value):
            row.update({f"{name}_{axis}": x for axis, x in zip("xyz", value)})
        else:
            row[name] = value
    return row


def _short(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, (list, dict)) and len(value) > 3:
        return f"<{len(value)} values>"
    if isinstance(value, list):
        return "[" + ", ".join(_short(item) for item in value) + "]"
    return repr(value)
