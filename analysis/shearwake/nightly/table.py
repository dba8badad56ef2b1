# SPDX-License-Identifier: BSD-3-Clause
"""Reads tables that `shearwake reduce` wrote: their watched numbers and the names of their cases."""
import csv
import io
import math
import statistics
from pathlib import Path
from typing import Any

from ..inputs import text_of

# Columns that depend on the machine, not on the physics; as in src/reduce/diff.cpp.
NOT_COMPARED = ("wall_s", "host", "hosts", "note")


def read_rows(path: Path) -> tuple[list[str], list[dict[str, str]]]:
    """The columns and the rows of a table. Raises ValueError."""
    try:
        text = text_of(path, "utf-8-sig")
        first = text.partition("\n")[0]
        separator = next((c for c in ";\t" if c in first and "," not in first), ",")  # as src/base/csv.cpp
        reader = csv.DictReader(io.StringIO(text, newline=""), restkey="", restval="", delimiter=separator)
        columns, rows = list(reader.fieldnames or []), list(reader)
    except (csv.Error, UnicodeDecodeError) as error:
        raise ValueError(f"{path} is not a table: {error}") from error
    if not {"id", "status"} <= set(columns) or any(any(row.get("", "")) for row in rows):
        raise ValueError(f"{path} is not a table: its columns must be named, and contain id and status")
    return columns, rows


def swept_columns(columns: list[str]) -> list[str]:
    """The columns directly after `id` and `reference` whose names contain a dot."""
    swept = []
    for column in columns:
        if column in ("id", "reference"):
            continue
        if "." not in column:
            break
        swept.append(column)
    return swept


def case_name(row: dict[str, str], swept: list[str]) -> str:
    """The name of the case, as in the output of `shearwake diff`."""
    parts = ["the reference"] if row.get("reference") == "yes" else []
    parts += [f"{column}={row[column]}" for column in swept if row[column]]
    return ", ".join(parts) or row.get("id", "")


def number(text: Any) -> float | None:
    try:
        value = float(text)
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) else None


def readings(path: Path) -> list[tuple[str, str, float]]:
    """(case, column, value) of every watched number. If two cases have the same name, the first counts."""
    columns, rows = read_rows(path)
    swept = swept_columns(columns)
    watched = [c for c in columns if c not in (*swept, *NOT_COMPARED, "id", "reference", "status")]
    found: dict[tuple[str, str], float] = {}
    for row in rows:
        for column in watched:
            value = number(row[column])
            if value is not None:
                found.setdefault((case_name(row, swept), column), value)
    return [(case, column, value) for (case, column), value in found.items()]


def median_seconds(path: Path) -> float | None:
    """Median of the cases' times, or None. The median is robust against the first case of a medium, which
    takes longer, and against other processes on the machine."""
    _, rows = read_rows(path)
    each = [value for value in (number(row.get("wall_s")) for row in rows) if value is not None]
    return statistics.median(each) if each else None
