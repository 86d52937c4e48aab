"""Results in words: text in a terminal, a table with a figure in a notebook."""

from __future__ import annotations

import html as _html
from typing import Any

import numpy as np

_LONG = 6
_FEW = 3


def number(value: float, digits: int = 4) -> str:
    """A number as text, with few digits."""
    return f"{value:.{digits}g}"


def _measured(table: dict[str, Any]) -> str | None:
    """A value as text, with its standard deviation, interval and unit; None for a table without a value."""
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
    if table.get("interval95") is not None:
        low, high = ("∞" if end is None else number(end) for end in table["interval95"])
        text += f", 95 %: {low if low != '∞' else '-∞'} to {high}"
    return text


def _words(value: Any) -> str | None:
    """A field as one line of text; None for an empty field."""
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
        shown = [f"{key} {part}" for key, part in parts if part is not None]
        return ", ".join(shown[:_LONG]) + (", …" if len(shown) > _LONG else "")
    if isinstance(value, list):
        if all(isinstance(item, (int, float)) or item is None for item in value):
            ends = ("-" if item is None else number(item) for item in value)
            return "(" + ", ".join(ends) + ")"
        if len(value) > _FEW:
            return f"{len(value)}"
        return "; ".join(_words(item) or "-" for item in value)
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
    rows.extend(("warning", warning["text"]) for warning in fields.get("warnings", []))
    return rows


def text(record: Any) -> str:
    """A record as text with one line per field; a single value is one line."""
    name = type(record).__name__
    for field in ("what", "text"):
        if isinstance(words := getattr(record, field, None), str):
            return f"{name}: {words}"
    measured = _measured(record.to_dict())
    if measured is not None:
        return measured
    rows = _rows(record)
    width = max((len(key) for key, _ in rows), default=0)
    lines = (f"  {key:{width}}  {words}" for key, words in rows)
    return "\n".join([name, *lines])


def html(record: Any) -> str:
    """A record as an HTML table, with its figure below it if it has one."""
    rows = "".join(
        f'<tr><th style="text-align:left">{_html.escape(key)}</th>'
        f'<td style="text-align:left">{_html.escape(words)}</td></tr>'
        for key, words in _rows(record)
    )
    figure = _figure(record)
    name = type(record).__name__
    return f"<table><caption>{name}</caption>{rows}</table>{figure}"


def _figure(record: Any) -> str:
    """Figure of a record as SVG: its own, a map of its mean curvature, or its curvatures with their intervals."""
    for drawing in (getattr(record, "figure", None), record):
        svg = getattr(drawing, "svg", None)
        if svg is not None:
            return str(svg)
    curvature = getattr(getattr(record, "map", None), "mean_curvature", None)
    if curvature is not None and curvature.ndim == 2:
        return _heat(curvature, f"mean curvature, {record.mean_curvature.unit}")
    return _intervals(record)


def _svg(width: float, height: float, parts: list[str]) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" '
        f'height="{height:g}" font-family="sans-serif" font-size="12">{"".join(parts)}</svg>'
    )


def _heat(values: np.ndarray[Any, Any], title: str) -> str:
    """A map of squares: the first axis points to the right, the second upwards. Larger values are darker."""
    low, high = float(np.min(values)), float(np.max(values))
    columns, rows = values.shape
    side = 240 / max(columns, rows)
    shade = (values - low) / ((high - low) or 1.0)
    parts = [
        f'<rect x="{side * i:.2f}" y="{20 + side * (rows - 1 - j):.2f}" width="{side + 0.1:.2f}" '
        f'height="{side + 0.1:.2f}" fill="rgb({245 - 225 * s:.0f},{245 - 165 * s:.0f},{250 - 110 * s:.0f})"/>'
        for (i, j), s in np.ndenumerate(shade)
    ]
    text = f"{title}: {number(low)} (light) to {number(high)} (dark)"
    return _svg(420, 25 + side * rows, [f'<text x="0" y="13">{_html.escape(text)}</text>', *parts])


def _intervals(record: Any) -> str:
    """A figure of curvatures with the same unit: points with 95 % intervals. Empty if there are no curvatures."""
    lines: list[tuple[str, float, float, float]] = []
    for name, value in record.to_dict().items():
        if not isinstance(value, dict) or not str(value.get("unit", "")).startswith("1/"):
            continue
        if str(value["unit"]).endswith("^2") or not isinstance(value.get("value"), float):
            continue
        middle = float(value["value"])
        spread = 1.96 * (value.get("std") or 0.0)
        low, high = value.get("interval95") or (middle - spread, middle + spread)
        lines.append((name, middle if low is None else float(low), middle, middle if high is None else float(high)))
    if not lines:
        return ""
    ends = [end for _, *all_ends in lines for end in all_ends] + [0.0]
    least, most = min(ends), max(ends)
    scale = 250 / ((most - least) or 1.0)

    def at(value: float) -> str:
        return f"{160 + scale * (value - least):.1f}"

    parts = [f'<line x1="{at(0)}" x2="{at(0)}" y1="4" y2="{18 * len(lines) + 6}" stroke="#999"/>']
    for row, (name, low, middle, high) in enumerate(lines):
        y = 18 * row + 14
        parts.append(
            f'<text x="0" y="{y + 4}">{_html.escape(name.replace("_", " "))}</text>'
            f'<line x1="{at(low)}" x2="{at(high)}" y1="{y}" y2="{y}" stroke="#1a5fa8" stroke-width="2"/>'
            f'<circle cx="{at(middle)}" cy="{y}" r="4" fill="#1a5fa8"/>'
        )
    y = 18 * len(lines) + 20
    parts.append(f'<text x="{at(0)}" y="{y}" text-anchor="middle">flat</text>')
    return _svg(430, y + 6, parts)


def table(header: list[str], rows: list[list[str]], height: int) -> str:
    """First rows of a table, as HTML."""

    def row(cells: list[str], tag: str) -> str:
        inner = "".join(f"<{tag}>{_html.escape(cell)}</{tag}>" for cell in cells)
        return f"<tr>{inner}</tr>"

    body = "".join(row(cells, "td") for cells in rows)
    more = f"<caption>first {len(rows)} of {height} rows</caption>" if height > len(rows) else ""
    return f"<table>{more}{row(header, 'th')}{body}</table>"


def results(made: Any) -> str:
    """Results as HTML: their table, and the first figure of the config."""
    figure = made.plot().svg if made.plots else ""
    return f"{made.cells._repr_html_()}{figure}"
