# SPDX-License-Identifier: BSD-3-Clause
"""Reconstructs the plan of a folder without plan.json from its case files.

Cases that were never computed have no file and are missing from the plan. A damaged file remains in the plan
without settings.

Usage: python3 -m shearwake.from_cases DIR    writes DIR/tables/plan.json, which `shearwake reduce` and `shearwake report` then read
"""
from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

from .checksum import open_case, sealed
from .inputs import case_files
from .keys import follows, job_tables

ATTRIBUTES = ("case_id", "settings", "is_reference", "reference_id", "job", "title")


def facts(path: Path) -> dict[str, Any]:
    """The attributes of a case file that describe its place in the sweep. Raises OSError, KeyError,
    ValueError."""
    with open_case(path) as file:
        values = {name: file.attrs[name] for name in ATTRIBUTES}
        values["overrides"] = file.attrs.get("overrides", "")
    values = {name: v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v)
              for name, v in values.items()}
    values["settings"] = json.loads(values["settings"])
    return values


def attempt(path: Path) -> dict[str, Any]:
    """The attributes, or empty values for a damaged file."""
    nothing = {"case_id": path.stem, "settings": {}, "is_reference": "no", "reference_id": "",
               "job": "", "title": "", "overrides": ""}
    try:
        return {**facts(path), "case_id": path.stem}  # a reader detects a file of another case
    except (OSError, KeyError, ValueError, RuntimeError):
        return nothing


def job_options(found: dict[str, Any]) -> dict[str, Any]:
    """[job] and [table] of the job with the overrides of the command line."""
    job = job_tables(found["job"])
    options: dict[str, Any] = {}
    for section in ("job", "table"):
        merged = dict(job.get(section, {}))
        for line in found["overrides"].splitlines():
            merged.update(job_tables(line).get(section, {}))
        options[section] = merged
    return options


def place(found: dict[str, Any], keys: list[str], job: str) -> list[Any]:
    """The sorting key of a case: numbers ascending, strings in the order of the job text, references last."""
    order: list[Any] = [found["is_reference"] == "yes"]
    for key in keys:
        value = found["settings"].get(key, "")
        if isinstance(value, str):
            at = job.find(f'"{value}"')
            order.append((1, at if at >= 0 else len(job), value))
        else:
            order.append((0, value, ""))
    return order


def plan_of_cases(folder: Path) -> dict[str, Any]:
    """The plan in the format of plan.json with the text of the job. Raises OSError if there is no case file."""
    cases = [attempt(path) for path in case_files(folder / "cases")]
    if not cases:
        raise FileNotFoundError(f"{folder} contains neither plan.json nor a case file")
    first = next((c for c in cases if c["job"]), cases[0])
    options = job_options(first)
    ordinary = [c for c in cases if c["is_reference"] != "yes"]
    keys = list(dict.fromkeys(key for c in ordinary for key in c["settings"]))
    cases.sort(key=lambda c: place(c, keys, first["job"]))
    x = options["table"].get("x")
    x = x if x in keys else keys[0] if keys else ""
    name = options["job"].get("name", folder.resolve().name)
    entries = [{"id": c["case_id"], "settings": c["settings"],
                "is_reference": c["is_reference"] == "yes", "reference_id": c["reference_id"]}
               for c in cases]
    series = [key for key in keys if key != x and not follows((c["settings"] for c in ordinary), key, x)]
    return {"schema": 2, "name": name, "job": first["job"], "title": first["title"] or options["job"].get("title", name),
            "swept_keys": keys, "cases": entries,
            "table": {"x": x, "series": options["table"].get("series", series)}}


def main(folder: Path) -> None:
    plan = plan_of_cases(folder)
    (folder / "tables").mkdir(exist_ok=True)
    (folder / "tables" / "plan.json").write_text(sealed(plan), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
