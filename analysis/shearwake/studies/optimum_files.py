# SPDX-License-Identifier: BSD-3-Clause
"""The files that `shearwake optimise` writes for its results: tables, waveforms for displays, and jobs."""
from __future__ import annotations

import csv
import io
import math
import tomllib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..job import Job
from ..keys import job_tables, put
from .optimum import MotionChange, envelope_of

# The table on the terminal.
MOST_SHOWN = 20  # rows
SHOWN = {"strength_at_least_1": "strength at least", "eta_unmodulated_1": "no modulation", "eta_am_1": "best AM-STM",
         "eta_sm_1": "best SM-STM", "eta_optimum_1": "optimum", "eta_ceiling_1": "upper bound"}
OF_POLYGONS = ("corners_mm", "sides", "side_mm", "radius_mm", "center_mm", "start_deg", "file")
TIMES = ("time.duration_ms", "time.output_interval_us", "measure.at_ms", "measure.settled_after_ms", "record.snapshots_ms")


@dataclass(frozen=True)
class Row:
    """A row of a table about a case: its swept values, and cells by column. NaN: empty."""

    id: str
    settings: Sequence[tuple[str, Any]]
    cells: dict[str, Any]

    def texts(self, digits: int) -> list[str]:
        """Spreadsheets interpret text that begins with = + - @ as a formula, unless an apostrophe precedes it."""
        values = [self.id, *(value for _, value in self.settings), *self.cells.values()]
        return ["'" * value.startswith(("=", "+", "-", "@")) + value if isinstance(value, str) else
                "" if math.isnan(value) else f"{value:.{digits}g}" for value in values]

    @property
    def columns(self) -> list[str]:
        return ["case", *(key for key, _ in self.settings), *self.cells]


def write_atomically(path: Path, text: str) -> None:
    part = path.with_name(path.name + ".part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)


def write_table(stem: Path, rows: Sequence[Row]) -> None:
    """As CSV with nine digits and as Markdown with four."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0].columns)
    writer.writerows(row.texts(9) for row in rows)
    write_atomically(stem.with_suffix(".csv"), text.getvalue())
    lines = [rows[0].columns, ["---"] * len(rows[0].columns), *(row.texts(4) for row in rows)]
    write_atomically(stem.with_suffix(".md"), "".join(f"| {' | '.join(line)} |\n" for line in lines))


def table_for_terminal(rows: Sequence[Row]) -> str:
    """The maximised measure of the modulations, one table per case with at most six columns."""
    lines: list[str] = []
    case = ""
    for row in rows[:MOST_SHOWN]:
        if row.id != case:
            case = row.id
            settings = ", ".join(f"{key} = {value}" if isinstance(value, str) else f"{key} = {value:g}" for key, value in row.settings)
            lines += [*([""] if lines else []), f"case {case}" + (f": {settings}" if settings else ""), " | ".join(SHOWN.values())]
        cells = [row.cells[name] for name in SHOWN]
        lines.append(" | ".join(("" if math.isnan(cell) else f"{cell:.4g}").rjust(len(label))
                                for cell, label in zip(cells, SHOWN.values())))
    if len(rows) > MOST_SHOWN:
        lines.append(f"... and {len(rows) - MOST_SHOWN} more rows")
    return "\n".join(lines) + "\n"


@dataclass(frozen=True)
class Waveform:
    """An envelope as a display accepts it: levels of the sound pressure amplitude from 0 to 2^bits - 1, at equal intervals. The force
    is proportional to the square of the level, and linear between the updates."""

    interval_s: float
    bits: int
    repeat: bool
    levels: list[int]

    @property
    def pressures(self) -> list[float]:
        """Relative to the greatest."""
        return [level / ((1 << self.bits) - 1) for level in self.levels]

    @property
    def envelope(self) -> dict[str, Any]:
        return envelope_of([pressure * pressure for pressure in self.pressures], self.interval_s, self.repeat)

    @property
    def times_s(self) -> list[float]:
        return [self.interval_s * n for n in range(len(self.levels))]

    def csv_text(self, places_m: Sequence[Sequence[float]]) -> str:
        """One row per update; `places_m` is where the focus is."""
        return "t_us,x_mm,y_mm,level,pressure_1,force_1\n" + "".join(
            f"{1e6 * t:.9g},{1e3 * x:.9g},{1e3 * y:.9g},{level},{pressure:.9g},{pressure * pressure:.9g}\n"
            for t, (x, y), level, pressure in zip(self.times_s, places_m, self.levels, self.pressures))

    def toml_text(self) -> str:
        """[[load.modulation.envelope]] of a job that reproduces the waveform."""
        repeat = "repeat = true\n" if self.repeat else ""
        return (f'[[load.modulation.envelope]]\nshape = "samples"\ninterval_us = {1e6 * self.interval_s!r}\n{repeat}'
                f"values = {self.envelope['values']}\n")


def waveform_of(values: np.ndarray, interval_s: float, repeat: bool, update_rate_Hz: float, bits: int) -> Waveform:
    """The envelope of the force at exactly this update rate, rounded to the nearest level; the last update of a single pass is at or
    after its end. The program has checked that a repeated envelope has a whole number of updates."""
    until_s = interval_s * (len(values) if repeat else len(values) - 1)
    exact = until_s * update_rate_Hz
    updates = round(exact) if abs(exact - round(exact)) <= 1e-9 * exact else math.ceil(exact)  # rounding
    knots = np.append(values, values[0]) if repeat else values
    force = np.interp(np.arange(updates + (0 if repeat else 1)) / update_rate_Hz, interval_s * np.arange(len(knots)), knots)
    levels = np.floor(np.sqrt(force) * ((1 << bits) - 1) + 0.5)
    return Waveform(1.0 / update_rate_Hz, bits, repeat, [int(level) for level in levels])


def job_of_optimum(job: str, name: str, settings: Sequence[tuple[str, Any]], change: MotionChange, moved: dict[str, Any],
                   envelope: dict[str, Any]) -> str:
    """A job whose only case has the motion of an optimum and this envelope: the job of the study with the swept values of the case,
    without [sweep], [table], [uncertain] and [optimise]. `moved` is the answer of the program about the motion."""
    tables = tomllib.loads(job)
    for table in ("sweep", "table", "uncertain", "optimise"):
        tables.pop(table, None)
    for key, value in settings:
        if isinstance(value, str):
            value = job_tables(f"value = {value}").get("value", value)
        put(tables, key, int(value) if isinstance(value, float) and value.is_integer() else value)
    put(tables, "job.name", name + "-optimum")
    if change != MotionChange():
        set_motion(tables, change, moved)
    put(tables, "load.modulation.envelope", [{"shape": "samples", "interval_us": 1e6 * envelope["interval_s"],
                                              "repeat": envelope["repeat"], "values": envelope["values"]}])
    return "# Written by `shearwake optimise`; `shearwake run` reproduces the case.\n" + Job(tables).text


def set_motion(tables: dict[str, Any], change: MotionChange, moved: dict[str, Any]) -> None:
    modulation = tables["load"]["modulation"]
    modulation.pop("draw_frequency_Hz", None)
    if change.size != 1.0:
        path = modulation["path"]
        if "closed" in moved["path"]:  # a polygon or a file of points as well
            for key in OF_POLYGONS:
                path.pop(key, None)
            path["shape"] = "polyline"
        path.update(moved["path"])
    keys = ("speed_m_s", "speed_deviation_m_s", "sm_frequency_Hz", "sm_phase_deg")
    modulation.update({key: moved[key] for key in keys if key in moved})
    if "sm_frequency_Hz" in moved:
        modulation["kind"] = "SM-STM"
    for key in TIMES:
        table, _, last = key.partition(".")
        if last in tables.get(table, {}):
            value = tables[table][last]
            factor = change.size / change.speed
            tables[table][last] = [factor * v for v in value] if isinstance(value, list) else factor * value
