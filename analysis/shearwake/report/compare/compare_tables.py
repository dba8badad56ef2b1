# SPDX-License-Identifier: BSD-3-Clause
"""Compares two tables cell by cell, with tolerances."""
from __future__ import annotations

import csv
import io
import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...case import Case
from ...inputs import text_of
from .tolerances import Tolerances

NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)


class NotATable(ValueError):
    """A file is not a table; the text states the line and the reason."""


@dataclass
class Table:
    """Cells as text by the names of their columns, and the units of the columns that are known."""
    columns: list[str]
    rows: list[dict[str, str]]
    units: dict[str, str] = field(default_factory=dict)


def read_table(path: Path) -> Table:
    """A table (CSV), as `reduce` or a spreadsheet writes it. Raises NotATable, and OSError if it cannot be read."""
    lines, number = [], 1
    try:
        text = text_of(path, "utf-8-sig")
        start = text.partition("\n")[0]
        separator = next((c for c in ";\t" if c in start and "," not in start), ",")
        reader = csv.reader(io.StringIO(text, newline=""), delimiter=separator, strict=True)
        for cells in reader:
            lines.append((number, [cell.strip() for cell in cells]))
            number = reader.line_num + 1
    except (csv.Error, ValueError) as error:
        raise NotATable(f"{path}:{number}: this is not a valid table: {error}") from error
    lines = [(line, cells) for line, cells in lines if any(cells)]
    if not lines:
        raise NotATable(f"{path}:1: this is not a valid table: the file is empty")
    columns = lines[0][1]
    if twice := [name for name in columns if columns.count(name) > 1]:
        raise NotATable(f"{path}:1: this is not a valid table: two columns are named \"{twice[0]}\"")
    for line, cells in lines[1:]:
        if len(cells) != len(columns):
            raise NotATable(f"{path}:{line}: this is not a valid table: {len(cells)} cells for {len(columns)} columns")
    return Table(columns, [dict(zip(columns, cells)) for _, cells in lines[1:]])


def text_of_value(value: Any) -> str:
    """A value as a cell; NaN: an empty one."""
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else repr(float(value))


def table_of_case(case: Case) -> Table:
    """A table with the case as its only row."""
    row: dict[str, Any] = {"id": case.id, "reference": "yes" if case.is_reference else "", **case.settings,
           "valid": "yes" if case.is_valid else "no", **case.values}
    return Table(list(row), [{name: text_of_value(value) for name, value in row.items()}],
                 {column.name: column.unit for column in case.columns})


def number_of(text: str) -> float | None:
    """A finite number; None: anything else."""
    value = float(text) if NUMBER.fullmatch(text) else math.nan
    return value if math.isfinite(value) else None


def swept_columns(table: Table) -> list[str]:
    """The columns directly after `id` and `reference` whose names contain a dot."""
    found = []
    for name in table.columns:
        if name in ("id", "reference"):
            continue
        if "." not in name:
            break
        found.append(name)
    return found


def row_name(table: Table, row: dict[str, str]) -> str:
    """'load.peak_Pa=200, load.modulation.speed_m_s=7', 'the reference', or otherwise the id."""
    parts = ["the reference"] if row.get("reference") == "yes" else []
    parts += [f"{name}={row[name]}" for name in swept_columns(table) if row[name]]
    return ", ".join(parts) or row.get("id", "")


@dataclass
class Matched:
    """Pairs of rows in the order of the second table, and the rows without a partner."""
    pairs: list[tuple[dict[str, str], dict[str, str]]]
    extra: list[dict[str, str]]
    missing: list[dict[str, str]]
    by_settings: int = 0  # pairs whose ids differ


def match_rows(first: Table, second: Table) -> Matched:
    """Matches rows by id, and the remaining ones by the values of the swept keys that both tables have, if these are
    unique in both tables."""
    keys = [name for name in swept_columns(second) if name in first.columns]

    def settings(row: dict[str, str]) -> tuple[Any, ...]:
        return row.get("reference", ""), *(row[k] if number_of(row[k]) is None else number_of(row[k]) for k in keys)

    partner: dict[int, int] = {}  # row of the second table -> row of the first
    for by_id, key in ((True, lambda row: row.get("id", "")), (False, settings)):
        groups: list[dict[Any, list[int]]] = [{}, {}]
        for table, taken, group in ((first, set(partner.values()), groups[0]), (second, set(partner), groups[1])):
            for n, row in enumerate(table.rows):
                if n not in taken and (key(row) or not by_id):
                    group.setdefault(key(row), []).append(n)
        for value, rows in groups[1].items():
            if len(rows) == len(groups[0].get(value, [])) == 1:
                partner[rows[0]] = groups[0][value][0]
    taken = set(partner.values())
    pairs = [(first.rows[partner[n]], second.rows[n]) for n in sorted(partner)]
    return Matched(pairs, [row for n, row in enumerate(first.rows) if n not in taken],
                   [row for n, row in enumerate(second.rows) if n not in partner],
                   sum(a.get("id") != b.get("id") for a, b in pairs))


def change_words(change: float, over: float, tolerance: float) -> str:
    """'+2.3 %, 2.3e+05 times its tolerance (1e-07)'"""
    parts = [f"{100.0 * change:+.3g} %"] if math.isfinite(change) else []
    parts += [f"{over:.2g} times its tolerance ({tolerance:g})"] if math.isfinite(over) else []
    return ", ".join(parts) or "changed"


def text_cell(now: str, reference: str) -> dict[str, Any]:
    """A difference of texts, which no tolerance covers."""
    words = "became empty" if not now else "was empty" if not reference else "other"
    return {"now": now, "reference": reference, "change": math.nan, "over_tolerance": math.inf, "words": words}


def compare_cell(column: str, now: str, reference: str, largest: float, tolerance: float) -> tuple[float, dict[str, Any] | None]:
    """The relative change, and the difference if it exceeds the tolerance. `largest` is the largest magnitude of the reference
    column. Levels in dB: a change is that of the amplitude, wherever 0 dB is."""
    a, b, is_level = number_of(now), number_of(reference), column.endswith("_dB")
    if a is None or b is None:
        return math.nan, None if now == reference else text_cell(now, reference)
    scale = 20.0 / math.log(10.0) if is_level else abs(b) or largest
    allowed = tolerance * scale
    try:
        change = math.nan if scale == 0.0 else math.expm1((a - b) / scale) if is_level else (a - b) / scale
    except OverflowError:
        change = math.inf
    if a == b:
        return 0.0, None
    if abs(a - b) <= allowed:
        return change, None
    over = abs(a - b) / allowed if allowed > 0.0 else math.inf
    return change, {"now": now, "reference": reference, "change": change, "over_tolerance": over,
                    "words": change_words(change, over, tolerance)}


def severity(cell: dict[str, Any]) -> tuple[float, float]:
    """The order of differences; those without a tolerance are ordered by their change."""
    change = abs(cell["change"])
    return -cell["over_tolerance"], -math.inf if math.isnan(change) else -change


@dataclass
class Comparison:
    """The differences of two tables, to which those of records are added."""
    matched: Matched
    cells: dict[str, list[dict[str, Any]]]      # column -> differences
    changes: list[list[dict[str, Any]]]         # of each pair, the compared numbers
    tolerances: dict[str, float]                # relative ones of all compared columns
    not_compared: list[str]
    missing_columns: list[str]
    extra_columns: list[str]

    def add(self, column: str, tolerance: float, case: str, cell: dict[str, Any] | None) -> None:
        self.tolerances[column] = tolerance
        if cell is not None:
            self.cells.setdefault(column, []).append({"case": case, **cell})

    def moved(self) -> list[dict[str, Any]]:
        """The columns with differences, and the differences of each, largest first."""
        ordered = [(name, sorted(cells, key=severity)) for name, cells in self.cells.items()]
        return [{"column": name, "cells": cells} for name, cells in sorted(ordered, key=lambda item: severity(item[1][0]))]


def compare_tables(first: Table, second: Table, matched: Matched, tolerances: Tolerances,
                   skipped: Callable[[int, str], bool] = lambda pair, column: False) -> Comparison:
    """Compares numbers within their tolerance and texts exactly. `skipped` states whether the values of a column cannot be
    compared for a pair of rows."""
    both = [name for name in second.columns if name in first.columns and name != "id"]
    ignored = [name for name in dict.fromkeys([*second.columns, *first.columns]) if tolerances.ignores(name)]
    found = Comparison(matched, {}, [[] for _ in matched.pairs], {}, ignored,
                       [n for n in second.columns if n not in first.columns and n not in ignored],
                       [n for n in first.columns if n not in second.columns and n not in ignored])
    for name in both:
        if name in ignored:
            continue
        tolerance = tolerances.for_column(name)
        units = first.units.get(name), second.units.get(name)
        if None not in units and units[0] != units[1]:
            found.add(name, tolerance, "every case", {**text_cell(*map(str, units)), "words": "other unit"})
            continue
        largest = max((abs(number_of(row[name]) or 0.0) for row in second.rows), default=0.0)
        found.tolerances[name] = tolerance
        compared = [n for n in range(len(matched.pairs)) if not skipped(n, name)]
        if len(compared) < len(matched.pairs):
            found.not_compared.append(name)
        for n in compared:
            a, b = matched.pairs[n]
            change, cell = compare_cell(name, a[name], b[name], largest, tolerance)
            found.add(name, tolerance, row_name(second, b), cell)
            x, y = number_of(a[name]), number_of(b[name])
            if (x is not None or y is not None) and name not in swept_columns(second):
                found.changes[n].append({"column": name, "first": x, "second": y, "change": change})
    return found
