# SPDX-License-Identifier: BSD-3-Clause
"""Reads the plan and the table of an output folder, without opening a case file."""
from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .checksum import read_json
from .errors import NotAnOutputFolder
from .inputs import text_of
from .keys import job_tables


@dataclass(frozen=True)
class Column:
    """A column of the table. `shown` is where the page of the report shows it, `over_reference_of` the measure that a ratio
    divides by that of the reference, and `counts_samples` whether the value depends on the spacing of the grid."""

    name: str
    unit: str
    meaning: str
    shown: str = ""
    over_reference_of: str = ""
    counts_samples: bool = False


@dataclass
class Table:
    """The table that `shearwake reduce` wrote, and its rows by case id as in its JSON file, with NaN for empty values."""

    columns: list[Column]
    rows: dict[str, dict[str, Any]]


def first_line(error: object) -> str:
    """The first line of the text of an error, or its type."""
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def plan_object(folder: Path) -> dict[str, Any]:
    """The object of plan.json. Without this file it is that of tables/plan.json, which `reduce` writes, or follows from
    the case files."""
    path, reduced = folder / "plan.json", folder / "tables" / "plan.json"
    for file in (path, reduced):
        if file.exists():
            return read_json(text_of(file))
    from .from_cases import plan_of_cases  # here, since the program runs this module
    return plan_of_cases(folder)


def read_plan(folder: Path) -> tuple[dict[str, Any], str]:
    """The plan and the text of the job. Raises NotAnOutputFolder."""
    try:
        plan = plan_object(folder)
        for key in ("name", "title", "swept_keys", "cases", "table"):
            plan[key]
        job = folder / "job.toml"
        if job.exists():
            return plan, text_of(job, "utf-8-sig", "replace")
        return plan, plan.get("job", "").removeprefix("\ufeff")  # a byte order mark
    except FileNotFoundError as error:
        raise NotAnOutputFolder(f"{folder} is not an output folder, since it contains no plan.json; run the job first"
                                if folder.is_dir() else f"{folder}: no such output folder; run the job first") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NotAnOutputFolder(f"{folder} is not an output folder of shearwake: {first_line(error)}") from error


def swept_values(table: Any, key: str) -> list[Any]:
    """The list of a swept key in the table [sweep], whose keys may be quoted or nested; empty if it is not a list."""
    if isinstance(table, list):
        return next((found for part in table if (found := swept_values(part, key))), [])
    if not isinstance(table, dict):
        return []
    for name, value in table.items():
        if name == key and isinstance(value, list):
            return value
        if name == "zip" or key.startswith(name + "."):
            if found := swept_values(value, key if name == "zip" else key[len(name) + 1:]):
                return found
    return []


def labels_of(job: str, cases: list[dict[str, Any]]) -> dict[tuple[str, Any], str]:
    """The labels of [table]: {(swept key, value): text}. They are in the order of the values in [sweep] or, for a range or a CSV
    file, in that of the cases."""
    tables = job_tables(job)
    labels = tables.get("table", {}).get("labels", {})
    found: dict[tuple[str, Any], str] = {}
    for key, texts in labels.items() if isinstance(labels, dict) else ():
        if not isinstance(texts, list):
            continue
        listed = swept_values(tables.get("sweep", {}), key) or [
            c["settings"][key] for c in cases if key in c["settings"] and not c["is_reference"]]
        # settings have floating-point numbers
        values = list(dict.fromkeys(float(v) if isinstance(v, int) and not isinstance(v, bool) else str(v)
                                    if isinstance(v, (bool, dict)) else v for v in listed))
        if len(values) == len(texts):
            found |= {(key, value): str(text) for value, text in zip(values, texts)}
    return found


def read_table(folder: Path, name: str) -> Table | None:
    """The table of `shearwake reduce`; None if there is none. Raises ValueError or KeyError if it is damaged."""
    path = folder / "tables" / (name + ".json")
    if not path.exists():
        return None
    table = json.loads(text_of(path))
    for row in table["cases"]: # texts that cases have in common are stored once, and numbered from 1
        row["note"] = "; ".join(table["notes"][int(n) - 1] for n in row["note"].split(", ") if n)
        row["notes"] = {column: table["reasons"][n - 1] for column, n in row["notes"].items()}
        row["warnings"] = [table["warnings"][n - 1] for n in row["warnings"]]
        row["values"] = {name: math.nan if value is None else value for name, value in row["values"].items()}
    return Table([Column(**column) for column in table["columns"]], {row["id"]: row for row in table["cases"]})
