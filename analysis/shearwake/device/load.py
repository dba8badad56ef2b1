# SPDX-License-Identifier: BSD-3-Clause
"""The load of a case, as the program computes it, and what becomes of the case when a device plays it."""
from __future__ import annotations

import math
import tempfile
import tomllib
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from .. import program
from ..errors import ShearwakeError
from ..from_cases import facts
from ..job import Job
from ..keys import job_tables, put

READINGS = ("eta_period_1", "eta_at_1", "felt_peak_dB", "focal_rms_um")
NEGLIGIBLE_DEPTH = 1e-12  # of a gain that states the period of the measures


class BadExport(ValueError):
    """What prevents an export."""


def value_of(text: Any) -> Any:
    """A value of the command line or of a swept key, with its type in a job."""
    try:
        return tomllib.loads(f"value = {text}")["value"] if isinstance(text, str) else text
    except tomllib.TOMLDecodeError:
        return text


def single_case(source: Path, overrides: list[str]) -> Job:
    """A job with the case of a case file, or the first case of a job. Files that the job of a case file names are relative to the
    current folder, since the case file does not state where the job was. Raises ProgramError, OSError and BadExport."""
    if source.suffix == ".toml":
        job = Job(source)
        changes = overrides
        plan = program.call_json(["plan", str(source), *(word for text in overrides for word in ("-S", text))])
        settings = next(case["settings"] for case in plan["cases"] if not case["is_reference"])
    else:
        found = facts(source)
        if overrides:
            raise BadExport("-S applies only with a job, since a case is computed already")
        if not job_tables(found["job"]):
            found["job"] = (source.parent.parent / "job.toml").read_text(encoding="utf-8-sig")
        job, changes, settings = Job(found["job"] + "\n"), found["overrides"].splitlines(), found["settings"]
        if found["is_reference"] == "yes":
            reference = job.tables.get("table", {}).get("reference", {})
            settings = {**settings, **{f"load.modulation.{key}": value for key, value in reference.items()}}
    tables = job.tables
    for change in changes:
        key, _, text = change.partition("=")
        put(tables, key.strip(), value_of(text.strip()))
    for name in ("sweep", "uncertain", "table", "optimise"):
        tables.pop(name, None)
    tables["sweep"] = {key: [value_of(value)] for key, value in settings.items()}
    made = Job(tables)
    made.folder = job.folder
    return made


@dataclass
class Trace:
    """The load at regular times: positions in mm, gains on the force. `cycle_s` is the period that a device repeats; 0: none."""

    rate_Hz: float
    xy_mm: np.ndarray
    gain: np.ndarray
    foci_mm: np.ndarray
    cycle_s: float
    frequency_Hz: float
    distance_mm: float
    center_mm: tuple[float, float]
    phases_rad: np.ndarray

    @property
    def times_s(self) -> np.ndarray:
        return np.arange(len(self.gain)) / self.rate_Hz


def trace_of(job: Job, rate_Hz: float, phases: bool = False) -> Trace:
    """One cycle of the load, or the run, from the program. Raises ProgramError."""
    with job._file() as path:
        found = program.call_json(["show", "--modulation", str(path), f"--rate={rate_Hz:.17g}", *(["--phases"] if phases else [])])
    run, cycle_s = found["run"], found["cycle_s"]
    count = max(2, round((cycle_s or run["t_s"][-1]) * rate_Hz))
    if len(run["gain"]) < count:  # a cycle is not longer than the run
        count = len(run["gain"])
    foci = np.array([found["foci_x_m"], found["foci_y_m"]], float).T * 1e3
    phase = np.array(found.get("phases_rad", []))
    center = job.tables["load"].get("footprint", {}).get("center_mm", (0.0, 0.0))
    return Trace(rate_Hz, np.column_stack((run["x_m"], run["y_m"]))[:count] * 1e3, np.array(run["gain"])[:count],
                 foci if len(foci) else np.zeros((1, 2)), cycle_s, found["frequency_Hz"], 1e3 * found.get("distance_m", 0.0),
                 (float(center[0]), float(center[1])), phase.reshape(count, -1) if phase.size else phase)


def played_job(job: Job, file: Path, trace: Trace, played_s: float) -> Job:
    """The case with a list of points as its load. The measures keep the period of the case."""
    tables = job.tables
    table: dict[str, Any] = {"kind": "file", "file": str(file.resolve()), "at_end": "repeat" if trace.cycle_s else "off"}
    if len(trace.foci_mm) > 1:
        table["foci_mm"] = trace.foci_mm.tolist()
    if trace.frequency_Hz:
        stretched = trace.frequency_Hz * (trace.cycle_s / played_s if trace.cycle_s else 1.0)
        table["envelope"] = [{"shape": "sine", "frequency_Hz": stretched, "depth": NEGLIGIBLE_DEPTH}]
    tables["load"]["modulation"] = table
    tables["sweep"] = {key: value for key, value in tables["sweep"].items() if not key.startswith("load.modulation")}
    made = Job(tables)
    made.folder = job.folder
    return made


def readings_of(job: Job) -> dict[str, float]:
    """The readings of a case that has to be computed. Raises ShearwakeError."""
    with tempfile.TemporaryDirectory(prefix="shearwake-device-") as out, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = job.run(out=out).every_case[0]
        return {name: case.values[name] for name in READINGS if not math.isnan(case.values.get(name, math.nan))}


def effect_of(job: Job, quantised: Job) -> list[str]:
    """Lines that compare a case as asked with the same case as played. Raises ShearwakeError."""
    felt = {} if job.tables.get("time", {}).get("regime") == "periodic" else {"measure.sensation": True}
    try:
        asked, played = (readings_of(each.change(felt)) for each in (job, quantised))
    except ShearwakeError:  # the run is too short for a level
        asked, played = readings_of(job), readings_of(quantised)
    lines = []
    for name in READINGS:
        if name in asked and name in played and not (name == "eta_at_1" and "eta_period_1" in asked):
            by = f"{played[name] - asked[name]:+.3g} dB" if name.endswith("_dB") else f"{100 * (played[name] / asked[name] - 1):+.3g} %"
            lines.append(f"{name}: {asked[name]:.6g} as asked, {played[name]:.6g} as played ({by})")
    return lines
