"""Tables of results."""

from __future__ import annotations

import typing

if typing.TYPE_CHECKING:
    from typing import Any

    from numpy.typing import NDArray


class Table(dict[str, "NDArray[Any]"]):
    """Table of results: a dictionary from the name of each column to an array with its values.

    Numbers are float64, with NaN for an empty field. ``pandas.DataFrame(table)`` and ``polars.DataFrame(table)`` make data
    frames. Names do not contain the unit of length: ``units`` has the unit of each column, or None if the column has no
    unit or a unit per row.
    """

    def __init__(self, arrays: dict[str, NDArray[Any]], units: dict[str, str | None], text: str) -> None:
        super().__init__(arrays)
        self.units = units
        self._text = text

    @property
    def height(self) -> int:
        """Number of rows."""
        return len(next(iter(self.values())))

    def to_csv(self) -> str:
        """The table as CSV, with units in the names of columns: the same bytes that the command line writes."""
        return self._text

    def __missing__(self, name: str) -> NDArray[Any]:
        raise KeyError(f"no column {name!r}; there are {', '.join(self)}")

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Table) and self._text == other._text

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None

    def __repr__(self) -> str:
        return f"<Table of {self.height} rows: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        # Import these modules only when they are needed, so that importing palpate is fast.
        import csv
        import io

        from . import _show

        header, *rows = csv.reader(io.StringIO(self._text))
        return _show.table(header, rows[:20], len(rows))
