# SPDX-License-Identifier: BSD-3-Clause
"""Compares two tables, cases or sweeps: columns, surfaces on their common grid, and traces.

Usage: python3 -m shearwake.report.compare A B [--tolerance COLUMN=RELATIVE|FILE.toml] [--json] [--page FILE]
A and B are tables (CSV), case files or reduced output folders; B is the reference. Exit 0: no difference; 1: a difference;
2: an argument is not valid; 6: a file cannot be read or written.
"""
from __future__ import annotations

import argparse
import json
import math
import sys
import traceback
from pathlib import Path
from typing import Any

import numpy as np

from ...case import Case
from ...checksum import Damaged
from ...errors import NotAnOutputFolder
from ...plan import first_line
from ..load import load, single_case
from ..progress import print_result
from .compare_fields import compare_surfaces, compare_traces
from .compare_tables import (Comparison, Matched, NotATable, compare_tables, match_rows, read_table, row_name,
                             table_of_case)
from .compare_words import printable, words
from .records import compare_records
from .tolerances import BadTolerance, Tolerances, read_tolerances

DIFFERS, USAGE, ENVIRONMENT = 1, 2, 6
SCHEMA = 2
DIRECTION = "first minus second, relative to the second"
HDF5 = b"\x89HDF\r\n\x1a\n"


class Incomparable(Exception):
    """A side has nothing that could be compared."""


class NotACase(Exception):
    """A file is not a case file; the text states which and why."""


class Side:
    """The table of one argument, its complete cases by id, and the columns that count samples. A table (CSV) has no cases."""

    def __init__(self, path: str) -> None:
        self.path = Path(path)
        self.cases: dict[str, Case] = {}
        self.counting: set[str] = set()
        self.is_case = not self.path.is_dir() and is_case_file(self.path)
        if self.path.is_dir():
            sweep = load(self.path).sweep
            self.table = read_table(self.path / "tables" / f"{sweep.name}.csv")
            self.table.units = {column.name: column.unit for column in sweep.columns}
            self.cases = {case.id: case for case in sweep.every_case if case.is_complete}
            self.counting = {column.name for column in sweep.columns if column.counts_samples}
        elif self.is_case:
            case = case_of_argument(self.path)
            self.table, self.cases = table_of_case(case), {case.id: case}
            self.counting = set(case.attributes.get("columns_in_samples", "").split())
        else:
            self.table = read_table(self.path)


def is_case_file(path: Path) -> bool:
    """Whether a file is to be read as a case file, by its extension or its first bytes."""
    if path.suffix.lower() == ".h5":
        return True
    with open(path, "rb") as file:
        return file.read(len(HDF5)) == HDF5


def case_of_argument(path: Path) -> Case:
    """The case of a file. Raises NotACase."""
    try:
        return single_case(path)
    except FileNotFoundError as error:
        raise NotACase(f"{path} is neither a case file, a table (CSV) nor an output folder; run the job first") from error
    except (KeyError, ValueError, TypeError) as error:
        raise NotACase(f"{path} is not a case file of shearwake, or is incomplete ({first_line(error)}); arguments are "
                       "files in the folder `cases` of an output folder, tables (CSV) or output folders") from error
    except (OSError, RuntimeError) as error:
        raise NotACase(f"{path} cannot be read as a case file: {first_line(error)}") from error


def grid_of(case: Case) -> dict[str, Any]:
    d = case.parameters["domain"]
    return {"points": [d["nx"], d["ny"]], "spacing_mm": round(1e3 * d["spacing_m"], 9)}


def depths_mm(case: Case) -> list[float]:
    """The measured depths, of which the first is that of the surface and the traces."""
    return [round(1e3 * z, 9) for z in case.setting("measure", "depths_m", default=[0.0])]


def compare_cases(a: Case, b: Case) -> dict[str, Any]:
    return {"first": a.id, "second": b.id, "settings": [a.settings, b.settings],
            "is_reference": [a.is_reference, b.is_reference], "warnings": [a.warnings, b.warnings],
            "engines": [c.setting("solver", "engine", default="") for c in (a, b)],
            "grids": [grid_of(a), grid_of(b)], "depths_mm": [depths_mm(a), depths_mm(b)], "fields": compare_surfaces(a, b),
            "traces": compare_traces(a, b)}


def matched_rows(first: Side, second: Side) -> Matched:
    """The rows of the tables that are compared. Two case files are always compared. Raises Incomparable."""
    for side in (first, second):
        if not side.table.rows:
            raise Incomparable(f"{side.path} has no cases")
    if first.is_case and second.is_case:
        a, b = first.table.rows[0], second.table.rows[0]
        return Matched([(a, b)], [], [], int(a["id"] != b["id"]))
    return match_rows(first.table, second.table)


def compare(first: Side, second: Side, tolerances: Tolerances) -> tuple[dict[str, Any], list[tuple[Case, Case]]]:
    """The result as a dictionary, and the compared pairs of cases. Raises Incomparable and BadTolerance."""
    matched = matched_rows(first, second)
    both = {n: (first.cases[a["id"]], second.cases[b["id"]]) for n, (a, b) in enumerate(matched.pairs)
            if a.get("id") in first.cases and b.get("id") in second.cases}
    counting = first.counting | second.counting
    regridded = {n for n, (a, b) in both.items() if grid_of(a) != grid_of(b)}
    found = compare_tables(first.table, second.table, matched, tolerances,
                           lambda pair, column: column in counting and pair in regridded)
    pairs = []
    for n, (a, b) in both.items():
        pairs.append({**compare_cases(a, b), "columns": found.changes[n]})
        compare_records(a, b, pairs[-1], row_name(second.table, matched.pairs[n][1]), tolerances, found)
    tolerances.require_columns([*dict.fromkeys([*second.table.columns, *first.table.columns, *found.tolerances,
                                                *found.not_compared])])
    result = document(first, second, found, pairs)
    if result["equal"] and not found.tolerances:
        raise Incomparable(f"{first.path} and {second.path} have no column in common that is compared")
    return result, list(both.values())


def document(first: Side, second: Side, found: Comparison, pairs: list[dict[str, Any]]) -> dict[str, Any]:
    moved = found.moved()
    extra, missing = ([row_name(side.table, row) for row in rows] for side, rows in ((first, found.matched.extra),
                                                                                     (second, found.matched.missing)))
    result = {"schema": SCHEMA, "command": "compare", "first": str(first.path), "second": str(second.path),
              "direction": DIRECTION,
              "equal": not (moved or extra or missing or found.missing_columns or found.extra_columns), "text": "",
              "moved": moved, "missing_columns": found.missing_columns, "extra_columns": found.extra_columns,
              "missing_cases": missing, "extra_cases": extra, "tolerances": found.tolerances,
              "not_compared": found.not_compared, "cases": len(found.matched.pairs),
              "cases_of_other_id": found.matched.by_settings, "pairs": pairs}
    result["text"] = words(result)
    return result


def without_nan(value: Any) -> Any:
    """JSON has no NaN: null."""
    if isinstance(value, dict):
        return {k: without_nan(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return value


def options(arguments: list[str]) -> Any:
    parser = argparse.ArgumentParser(prog="shearwake compare")
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--tolerance", default="")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--page", type=Path)
    return parser.parse_args(arguments)


def main(arguments: list[str]) -> int:
    given = options(arguments)
    try:
        tolerances = read_tolerances(text for text in given.tolerance.split(",") if text)
        result, pairs = compare(Side(given.first), Side(given.second), tolerances)
        if given.page:
            from .compare_page import write_page  # needs Matplotlib
            write_page(result, pairs, given.page)
    except (Incomparable, BadTolerance) as error:
        print(f"error: {printable(str(error))}", file=sys.stderr)
        return USAGE
    except (NotAnOutputFolder, NotACase, NotATable, OSError, Damaged) as error:
        print(f"error: {printable(str(error))}", file=sys.stderr)
        return ENVIRONMENT
    except (KeyError, IndexError, TypeError, ValueError, ArithmeticError) as error:  # for other contents, numpy and xarray raise many types
        print(f"error: one of the files has other contents than a case file: {printable(repr(error))}", file=sys.stderr)
        return ENVIRONMENT
    except Exception:  # noqa: BLE001 - Python would exit with the code of a difference
        traceback.print_exc()
        return ENVIRONMENT
    text = json.dumps(without_nan(result), indent=1) if given.json else result["text"]
    return ENVIRONMENT if not print_result(text, "error") else 0 if result["equal"] else DIFFERS


def command() -> None:
    sys.stdout.reconfigure(errors="replace")  # type: ignore[attr-defined]
    sys.exit(main(sys.argv[1:]))


if __name__ == "__main__":
    command()
