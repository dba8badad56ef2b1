# SPDX-License-Identifier: BSD-3-Clause
"""Compares two cases or two sweeps: surfaces on their common grid, traces and columns.

Usage: python3 -m shearwake.report.compare A B [--json] [--all] [--picture FILE]
A and B are case files or reduced output folders; B is the reference. Exit 0: compared; 2: nothing in common;
6: a file cannot be read or written.
"""
from __future__ import annotations

import argparse
import json
import math
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from ...case import Case
from ...checksum import Damaged
from ...errors import NotAnOutputFolder
from ...plan import first_line
from ..load import load, single_case
from . import compare_fields, compare_words
from .compare_fields import compare_surfaces, compare_traces
from .compare_sensors import compare_sensors

USAGE, ENVIRONMENT = 2, 6
SCHEMA = 1
DIRECTION = "first minus second, relative to the second"


class Incomparable(Exception):
    """The two have nothing in common."""


class NotACase(Exception):
    """A file is not a case file; the text states which and why."""


class Side:
    """The complete cases of one argument and the columns that count samples."""

    def __init__(self, path: str) -> None:
        self.path = Path(path)
        if self.path.is_dir():
            selection = load(self.path)
            self.cases = [c for c in selection.cases if c.is_complete]
            self.counting = {c.name for c in selection.sweep.columns if c.counts_samples}
        else:
            self.cases = [one_case(self.path)]
            self.counting = counting_columns(self.cases[0])

    @property
    def is_case(self) -> bool:
        return not self.path.is_dir()


def one_case(path: Path) -> Case:
    """The case of a file. Raises NotACase."""
    try:
        return single_case(path)
    except FileNotFoundError as error:
        raise NotACase(f"{path} is neither a case file nor an output folder; run the job first") from error
    except (KeyError, ValueError, TypeError) as error:
        raise NotACase(f"{path} is not a case file of shearwake, or is incomplete ({first_line(error)}); arguments are "
                       "files in the folder `cases` of an output folder, or output folders") from error
    except (OSError, RuntimeError) as error:
        raise NotACase(f"{path} cannot be read as a case file: {first_line(error)}") from error


def counting_columns(case: Case) -> set[str]:
    return set(case.attributes.get("columns_in_samples", "").split())


def key_of(case: Case, keys: Any) -> Any:
    return (case.is_reference, *(str(case.settings.get(k)) for k in keys))


def pairs_of(first: Side, second: Side) -> tuple[list[tuple[Case, Case]], list[Any], list[Any]]:
    """Pairs of cases with the same id or, if that is unique, the same values of the swept keys that both have;
    and the cases of each side without a partner."""
    if first.is_case and second.is_case:
        return [(first.cases[0], second.cases[0])], [], []
    by_id = {c.id: c for c in second.cases}
    pairs = [(c, by_id[c.id]) for c in first.cases if c.id in by_id]
    taken = {c.id for pair in pairs for c in pair}
    left = [[c for c in side.cases if c.id not in taken] for side in (first, second)]
    keys = sorted(set.intersection(*({k for c in side.cases for k in c.settings} for side in (first, second))))
    found: list[dict[Any, list[Case]]] = [{}, {}]
    for cases, groups in zip(left, found):
        for case in cases:
            groups.setdefault(key_of(case, keys), []).append(case)
    for key, ours in found[0].items():
        theirs = found[1].get(key, [])
        if len(ours) == len(theirs) == 1:
            pairs.append((ours[0], theirs[0]))
    matched = {id(c) for pair in pairs for c in pair}
    order = {id(c): i for i, c in enumerate(first.cases)}
    pairs.sort(key=lambda pair: order[id(pair[0])])
    alone = [[c for c in side.cases if id(c) not in matched] for side in (first, second)]
    return pairs, alone[0], alone[1]


def grid_of(case: Case) -> dict[str, Any]:
    d = case.parameters["domain"]
    return {"points": [d["nx"], d["ny"]], "spacing_mm": round(1e3 * d["spacing_m"], 9)}


def same_value(a: float, b: float) -> bool:
    return a == b or (math.isnan(a) and math.isnan(b))


def compare_columns(a: Case, b: Case, counting: set[str]) -> tuple[list[dict[str, Any]], list[str]]:
    """The columns that both have, and the names of those that are not compared because they count samples of
    different grids."""
    names = [n for n in a.values if n in b.values and not n.endswith("_error")]
    excluded = [n for n in names if n in counting] if grid_of(a) != grid_of(b) else []
    rows: list[dict[str, Any]] = []
    for name in names:
        x, y = a.value(name), b.value(name)
        if name in excluded or (math.isnan(x) and math.isnan(y)):
            continue
        if name.endswith("_dB"):  # the change of the amplitude
            change = math.expm1((x - y) * math.log(10.0) / 20.0)
        else:
            change = (x - y) / abs(y) if y else (0.0 if same_value(x, y) else math.nan)
        rows.append({"column": name, "first": x, "second": y, "change": change})
    rows.sort(key=lambda row: -abs(row["change"]) if math.isfinite(row["change"]) else -math.inf)
    return rows, excluded


def depths_mm(case: Case) -> list[float]:
    """The measured depths, of which the first is that of the surface and the traces."""
    return [round(1e3 * z, 9) for z in case.setting("measure", "depths_m", default=[0.0])]


def compare_pair(a: Case, b: Case, counting: set[str]) -> dict[str, Any]:
    columns, excluded = compare_columns(a, b, counting)
    sensors, note = compare_sensors(a, b)
    return {"first": a.id, "second": b.id, "settings": [a.settings, b.settings],
            "is_reference": [a.is_reference, b.is_reference], "warnings": [a.warnings, b.warnings],
            "engines": [c.setting("solver", "engine", default="") for c in (a, b)],
            "grids": [grid_of(a), grid_of(b)], "depths_mm": [depths_mm(a), depths_mm(b)], "fields": compare_surfaces(a, b),
            "traces": compare_traces(a, b), "sensors": sensors, "sensors_note": note, "columns": columns,
            "columns_not_compared": excluded}


def without_nan(value: Any) -> Any:
    """JSON has no NaN: null."""
    if isinstance(value, dict):
        return {k: without_nan(v) for k, v in value.items()}
    if isinstance(value, (list, tuple)):
        return [without_nan(v) for v in value]
    if isinstance(value, (float, np.floating)):
        return float(value) if math.isfinite(value) else None
    return value


def compare(first: Side, second: Side) -> tuple[Any, ...]:
    """The result as a dictionary, and the compared pairs of cases. Raises Incomparable."""
    pairs, only_first, only_second = pairs_of(first, second)
    if not pairs:
        raise Incomparable(f"{first.path} and {second.path} have no complete case in common: neither ids nor "
                           "the values of the swept keys that both have")
    counting = first.counting | second.counting
    result = {"schema": SCHEMA, "command": "compare", "first": str(first.path), "second": str(second.path),
              "direction": DIRECTION, "pairs": [compare_pair(a, b, counting) for a, b in pairs],
              "only_in_first": [c.id for c in only_first], "only_in_second": [c.id for c in only_second]}
    return result, pairs


def options(arguments: list[str]) -> Any:
    parser = argparse.ArgumentParser(prog="shearwake compare")
    parser.add_argument("first")
    parser.add_argument("second")
    parser.add_argument("--json", action="store_true")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--picture", type=Path)
    return parser.parse_args(arguments)


def draw(result: dict[str, Any], pairs: list[tuple[Case, Case]], path: Path) -> str:
    """Draws the picture. The line that reports it, or why there is none."""
    from . import compare_picture  # needs Matplotlib
    try:
        compare_picture.draw(result, pairs, path)
    except compare_fields.NothingToDraw as reason:
        return f"no picture: {reason}"
    return f"picture: {path}"


def write(text: str) -> int:
    """Prints the text and returns the exit code. A reader that closes the pipe, such as head, has read enough."""
    try:
        print(text, flush=True)
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # discards what is not flushed yet
        if not isinstance(error, BrokenPipeError):
            print(f"error: the output cannot be written: {error.strerror}", file=sys.stderr)
            return ENVIRONMENT
    return 0


def main(arguments: list[str]) -> int:
    given = options(arguments)
    try:
        result, pairs = compare(Side(given.first), Side(given.second))
        picture = draw(result, pairs, given.picture) if given.picture else ""
    except Incomparable as error:
        print(f"error: {error}", file=sys.stderr)
        return USAGE
    except (NotAnOutputFolder, NotACase, OSError, Damaged) as error:
        print(f"error: {error}", file=sys.stderr)
        return ENVIRONMENT
    except (KeyError, IndexError, TypeError, ValueError, ArithmeticError) as error:  # for other contents, numpy and xarray raise many types
        print(f"error: one of the files has other contents than a case file: {error!r}", file=sys.stderr)
        return ENVIRONMENT
    if given.json:
        if picture.startswith("no "):
            print(picture, file=sys.stderr)
        return write(json.dumps(without_nan(result), indent=1))
    return write("\n".join(filter(None, [compare_words.words(result, given.all), picture])))


def command() -> None:
    sys.stdout.reconfigure(errors="replace")  # type: ignore[attr-defined]
    sys.exit(main(sys.argv[1:]))


if __name__ == "__main__":
    command()
