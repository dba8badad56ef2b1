# SPDX-License-Identifier: BSD-3-Clause
"""Estimates the numerical errors of cases from cases with half the spacing, half the time step and twice the domain.

The program computes the refined cases (`shearwake converge`) and calls this module to compare them.

Usage: python3 -m shearwake.studies.convergence FOLDER [--quiet]    FOLDER is the output folder of the sweep
"""
from __future__ import annotations

import math
import os
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..checksum import read_json, sealed
from ..inputs import text_of
from ..job import Job
from ..plan import Table, read_table
from ..running import Progress, run_and_watch

SAFETY_FACTOR = 1.5
"""Errors of a single frame vary irregularly with the position of the samples, and changes may be small by chance. Roache's grid
convergence index (1994) has a factor of 1.25 to 3 for this."""


@dataclass(frozen=True)
class Refinement:
    """A refined case: `change` describes it, `ratio` is the factor by which the spacing or the step is smaller, and `order` the order
    of convergence in it; None: unknown."""

    name: str
    change: str
    id: str
    ratio: float
    order: float | None

    def error(self, change: float) -> float:
        """The estimated error of the unrefined value, given its change by the refinement: |change| r^p / (r^p - 1) with the order p
        and the ratio r (Richardson), |change| without order."""
        power = self.ratio**self.order if self.order else math.inf
        return abs(change) * (power / (power - 1.0) if self.order else 1.0)


@dataclass(frozen=True)
class ColumnChange:
    """How a column of a case changes with each refinement (refined minus unrefined; NaN: not computed), and its estimated error."""

    value: float
    changes: dict[str, float]
    error: float

    def relative_error(self, column: str) -> float:
        """Errors of levels are those of the amplitude, which do not depend on where 0 dB is. NaN: unknown."""
        if column.endswith("_dB"):
            return 10.0 ** (self.error / 20.0) - 1.0
        return self.error / abs(self.value) if self.value else math.nan


@dataclass(frozen=True)
class StudiedCase:
    """A studied case. `is_complete`: all refinements have results. `is_valid`: no warning rules the readings out."""

    id: str
    settings: dict[str, Any]
    is_reference: bool
    refinements: list[Refinement]
    is_complete: bool
    is_valid: bool
    columns: dict[str, ColumnChange]


def has_estimate(column: str) -> bool:
    """A peak is the largest of all samples, which both grids may miss by the same amount."""
    return not column.startswith(("peak_um", "felt_peak_"))


def studied_cases(cases: Sequence[dict[str, Any]], table: Table) -> list[StudiedCase]:
    """Compares the refined cases of refinements.json with the unrefined ones. Columns that count samples do not converge: they are
    omitted, as are columns without a value."""
    complete = {id: row for id, row in table.rows.items() if row["status"] == "complete"}
    names = sorted(column.name for column in table.columns if not column.counts_samples and has_estimate(column.name))
    studied = []
    for case in cases:
        refinements = [Refinement(**entry) for entry in case["refinements"]]
        base = complete.get(case["base"], {"values": {}, "valid": ""})
        columns = {}
        for name in names:
            value = base["values"].get(name, math.nan)
            changes = {r.name: complete[r.id]["values"].get(name, math.nan) - value if r.id in complete else math.nan for r in refinements}
            if not math.isnan(value):
                columns[name] = ColumnChange(value, changes, SAFETY_FACTOR * sum(r.error(changes[r.name]) for r in refinements))
        studied.append(StudiedCase(case["id"], case["settings"], case["is_reference"], refinements,
                                   all(id in complete for id in (case["base"], *(r.id for r in refinements))), base["valid"] != "no", columns))
    return studied


def document_of(job: str, cases: Sequence[StudiedCase]) -> dict[str, Any]:
    """The content of converge.json (docs/reference/results.md)."""
    def number(value: float) -> float | None:
        return value if math.isfinite(value) else None

    return {"schema": 1, "job": job, "cases": [
        {"id": case.id, "settings": case.settings, "is_reference": case.is_reference, "complete": case.is_complete, "valid": case.is_valid,
         "refinements": [vars(refinement) for refinement in case.refinements],
         "columns": {name: {"value": column.value, "changes": {key: number(change) for key, change in column.changes.items()},
                            "error": number(column.error)} for name, column in case.columns.items()}} for case in cases]}


def markdown_of(cases: Sequence[StudiedCase], shown: Sequence[str], all_columns: Sequence[str]) -> str:
    """One table per case with the columns of `shown`, and the columns that no table contains."""
    lines = []
    for case in cases:
        settings = ", ".join(f"{key} = {value:g}" if isinstance(value, float) else f"{key} = {value}" for key, value in case.settings.items())
        names = [refinement.name for refinement in case.refinements]
        lines += ["", "## " + case.id + (", reference" if case.is_reference else "") + ("" if case.is_valid else ", not valid")
                  + (": " + settings if settings else ""), ""]
        for r in case.refinements:
            lines.append(f"* {r.name}: {r.change} (" + ("no order: the change is the estimate" if r.order is None else f"order {r.order:g}") + ")")
        lines += ["", "| column | value |" + "".join(f" change: {name} |" for name in names) + " estimated error | relative |",
                  "| --- | ---: |" + " ---: |" * (len(names) + 2)]
        for name, column in ((name, case.columns[name]) for name in shown if name in case.columns):
            relative = 100.0 * column.relative_error(name)
            cells = [f"{column.value:.5g}", *("" if math.isnan(c) else f"{c:+.2g}" for c in column.changes.values()),
                     "" if math.isnan(column.error) else f"{column.error:.2g}", "" if math.isnan(relative) else f"{relative:.2g} %"]
            lines.append(f"| {name} | " + " | ".join(cells) + " |")
    omitted = sorted(set(all_columns).difference(*(case.columns for case in cases)))
    if omitted:
        lines += ["", "columns without an estimate, which are empty, count samples or are the largest of all samples: " + ", ".join(omitted)]
    return "\n".join(lines[1:]) + "\n"


def estimate_errors(folder: Path) -> tuple[list[StudiedCase], str]:
    """Compares the refined cases of a sweep, and writes converge.json and converge.md to its subfolder `converge`. Returns the cases and
    the text of converge.md without its title. Raises OSError, ValueError and KeyError."""
    study = folder / "converge"
    given = read_json(text_of(study / "refinements.json"))
    table = read_table(study, given["job"])
    if table is None:
        raise FileNotFoundError(f"{study} has no table")
    cases = studied_cases(given["cases"], table)
    text = markdown_of(cases, given["headlines"], [column.name for column in table.columns])
    for name, content in (("converge.json", sealed(document_of(given["job"], cases), indent=1)),
                          ("converge.md", f"# {given['title']}\n\n{text}")):
        part = study / (name + ".part")
        part.write_text(content, encoding="utf-8")
        part.replace(study / name)
    return cases, text


def converge(job: Job | str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None, cases: int = 3, only: Sequence[str] = (),
             ranks: int = 1, launch: Sequence[str] | None = None, progress: bool | Callable[[Progress], None] = False,
             options: Sequence[str] = ()) -> list[StudiedCase]:
    """Estimates the numerical errors of `cases` cases of a job, from the first to the last, or of those with the ids in `only`, and
    of their references. `out` is the output folder of the sweep, by default out/NAME, whose complete cases are not computed again; the
    study is in its subfolder `converge`. The other arguments and the exceptions are those of Job.run: if the call is interrupted, the
    same call resumes the study."""
    job = job if isinstance(job, Job) else Job(job)
    folder = Path(out) if out is not None else Path("out") / job.name
    chosen = ["--only", ",".join(only)] if only else ["--cases", str(cases)]
    with job.file() as path:
        run_and_watch(["converge", str(path), "--out", str(folder), *chosen, *options], ranks, launch, progress)
    return estimate_errors(folder)[0]


def main(folder: str, *options: str) -> int:
    try:
        _, text = estimate_errors(Path(folder))
    except (OSError, ValueError, KeyError) as error:
        print(f"{folder}: {error}", file=sys.stderr)
        return 6
    if "--quiet" not in options:
        study = Path(folder) / "converge"
        print(f"\n{text}\nconvergence: {study / 'converge.json'}\n             {study / 'converge.md'}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
