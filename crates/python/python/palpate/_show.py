"""Results as a person reads them: text in a terminal, a table with a figure in a notebook."""

from __future__ import annotations

import html as _html
from typing import Any

import numpy as np

_LONG = 6


def number(value: float, digits: int = 4) -> str:
    """Number with few digits."""
    return f"{value:.{digits}g}"


def _measured(table: dict[str, Any]) -> str | None:
    """Value with its standard deviation, interval and unit, if the table is one."""
    if "value" not in table:
        return None
    value, unit = table["value"], table.get("unit", "")
    if isinstance(value, np.ndarray):
        return f"array of {value.size} {unit}".rstrip()
    text = "-" if value is None else number(value)
    if table.get("std") is not None:
        text += f" ± {number(table['std'], 2)}"
    if unit not in ("", "1", "unit"):
        text += f" {unit}"
    if "interval95" in table:
        low, high = ("∞" if end is None else number(end) for end in table["interval95"])
        text += f", 95 %: {low if low != '∞' else '-∞'} to {high}"
    return text


def _words(value: Any) -> str | None:
    """One line for a field; None where it has nothing to say."""
    if value is None or value == [] or value == {}:
        return None
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value)
    if isinstance(value, np.ndarray):
        return f"array {value.shape}"
    if isinstance(value, dict):
        measured = _measured(value)
        if measured is not None:
            return measured
        parts = ((key, _words(part)) for key, part in value.items())
        said = [f"{key} {part}" for key, part in parts if part is not None]
        return ", ".join(said[:_LONG]) + (", …" if len(said) > _LONG else "")
    if isinstance(value, list):
        if all(isinstance(item, (int, float)) or item is None for item in value):
            ends = ("-" if item is None else number(item) for item in value)
            return "(" + ", ".join(ends) + ")"
        return f"{len(value)}"
    return str(value)


def _rows(record: Any) -> list[tuple[str, str]]:
    fields = record.to_dict(arrays=False)
    rows = []
    for key, value in fields.items():
        if key in ("format_version", "warnings"):
            continue
        words = _words(value)
        if words is not None:
            rows.append((key, words))
    rows.extend(("warning", warning) for warning in fields.get("warnings", []))
    return rows


def text(record: Any) -> str:
    """Record in lines, one per field; in one line where it is a single value."""
    measured = _measured(record.to_dict())
    if measured is not None:
        return measured
    rows = _rows(record)
    width = max((len(key) for key, _ in rows), default=0)
    lines = (f"  {key:{width}}  {words}" for key, words in rows)
    return "\n".join([type(record).__name__, *lines])


def html(record: Any) -> str:
    """Record as a table, with its figure below it where it has one."""
    rows = "".join(
        f'<tr><th style="text-align:left">{_html.escape(key)}</th>'
        f'<td style="text-align:left">{_html.escape(words)}</td></tr>'
        for key, words in _rows(record)
    )
    figure = getattr(record, "svg", "")
    name = type(record).__name__
    return f"<table><caption>{name}</caption>{rows}</table>{figure}"


def table(header: list[str], rows: list[list[str]], height: int) -> str:
    """First rows of a table, as HTML."""

    def row(cells: list[str], tag: str) -> str:
        inner = "".join(f"<{tag}>{_html.escape(cell)}</{tag}>" for cell in cells)
        return f"<tr>{inner}</tr>"

    body = "".join(row(cells, "td") for cells in rows)
    more = f"<caption>first {len(rows)} of {height} rows</caption>" if height > len(rows) else ""
    return f"<table>{more}{row(header, 'th')}{body}</table>"


def results(made: Any) -> str:
    """Results as HTML: their table, and the first figure that the config asks for."""
    figure = made.plot().svg if made.plots else ""
    return f"{made.cells._repr_html_()}{figure}"
