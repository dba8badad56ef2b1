# SPDX-License-Identifier: BSD-3-Clause
"""The load of a case, as the program computes it, and what becomes of the case when a device plays it."""
from __future__ import annotations

import math
import tempfile
import tomllib
import warnings
from dataclasses import dataclass, field
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
FASTEST_Hz, MOST_CYCLES, WHOLE = 1e6, 25, 1e-6  # samples per second of `show`; cycles; a part of a sample that is none


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
        if any(key.startswith("optimise.") for key in found["settings"]):
            raise BadExport(f"is a case of optimise; export the optima from the jobs {source.parent.parent / 'optimise'}/*.job.toml")
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
    tables["sweep"] = {key: [value_of(value)] for key, value in settings.items() if not key.startswith("load.")}
    for key in [key for key in settings if key.startswith("load.")]:
        put(tables, key, value_of(settings[key]))
    if "modulation" in tables["load"]:  # with a swept kind, keys of other kinds are ignored
        tables["sweep"]["load.modulation.kind"] = [tables["load"]["modulation"].get("kind", "")]
    made = Job(tables)
    made.folder = job.folder
    if source.suffix != ".toml" and (case_id := made.plan().document["cases"][0]["id"]) != found["case_id"]:
        raise BadExport(f"its job and settings give the case {case_id} with this version of the program and the files of the current folder")
    return made


@dataclass
class Trace:
    """The load at regular times: positions in mm, gains on the force. `cycle_s` is the period, 0: none, of which a device repeats `cycles`."""

    rate_Hz: float
    xy_mm: np.ndarray
    gain: np.ndarray
    foci_mm: np.ndarray
    cycle_s: float
    cycles: int
    frequency_Hz: float
    distance_mm: float
    center_mm: tuple[float, float]
    phases_rad: np.ndarray

    @property
    def times_s(self) -> np.ndarray:
        return np.arange(len(self.gain)) / self.rate_Hz


def cycles_of(cycle_s: float, rate_Hz: float) -> int:
    """The number of cycles that take a whole number of samples, or 1."""
    return next((n for n in range(1, 1 + min(MOST_CYCLES, int(FASTEST_Hz / rate_Hz)))
                 if abs(n * cycle_s * rate_Hz - round(n * cycle_s * rate_Hz)) < WHOLE), 1)


def shown(job: Job, rate_Hz: float, phases: bool) -> dict[str, Any]:
    with job._file() as path:
        return program.call_json(["show", "--modulation", str(path), f"--rate={rate_Hz:.17g}", *(["--phases"] if phases else [])])


def trace_of(job: Job, rate_Hz: float, phases: bool = False) -> Trace:
    """Cycles of the load, or the run, from the program. Raises ProgramError."""
    found = shown(job, rate_Hz, phases)
    cycle_s, cycles = found["cycle_s"], cycles_of(found["cycle_s"], rate_Hz)
    if cycles > 1:  # a sample of a later cycle is one between those of the first
        found = shown(job, cycles * rate_Hz, phases)
    run = found["run"]
    count = max(2, min(len(run["gain"]), round((cycle_s or run["t_s"][-1]) * cycles * rate_Hz)))
    order = np.arange(count) * cycles % count
    foci = np.array([found["foci_x_m"], found["foci_y_m"]], float).T * 1e3
    phase = np.array(found.get("phases_rad", []))
    center = job.tables["load"].get("footprint", {}).get("center_mm", (0.0, 0.0))
    return Trace(rate_Hz, np.column_stack((run["x_m"], run["y_m"]))[order] * 1e3, np.array(run["gain"])[order],
                 foci if len(foci) else np.zeros((1, 2)), cycle_s, cycles, found["frequency_Hz"], 1e3 * found.get("distance_m", 0.0),
                 (float(center[0]), float(center[1])), phase.reshape(count, -1)[order] if phase.size else phase)


@dataclass
class Export:
    """Files by their suffix, what the device cannot do, and what it plays, as a file of load.modulation.kind = "file", or as factors
    of the force along the motion of the case."""

    trace: Trace
    played_s: float
    notes: list[str] = field(default_factory=list)
    files: dict[str, str | bytes] = field(default_factory=dict)
    played: tuple[str, str | bytes] | np.ndarray = ("", "")
    keys: dict[str, Any] = field(default_factory=dict)  # of [load.modulation] with this file


def table_of(made: Export, file: Path) -> dict[str, Any]:
    """[load.modulation] that reads a file back."""
    foci = {"foci_mm": made.trace.foci_mm.tolist()} if len(made.trace.foci_mm) > 1 and not made.trace.phases_rad.size else {}
    return {"kind": "file", "file": str(file), "at_end": "repeat" if made.trace.cycle_s else "off", **made.keys, **foci}


def played_job(job: Job, made: Export, folder: Path) -> Job:
    """The case with the load that the device plays. The measures keep the period of the case. Raises BadExport."""
    tables, trace = job.tables, made.trace
    load = tables["load"]
    if isinstance(made.played, tuple):
        suffix, content = made.played
        file = folder / ("played" + suffix)
        file.write_bytes(content if isinstance(content, bytes) else content.encode())
        load["modulation"] = table_of(made, file)
        tables["sweep"]["load.modulation.kind"] = ["file"]
        load["footprint"].pop("update_rate_kHz", None)  # each point is an update
        if trace.phases_rad.size:
            load["footprint"]["update_rate_kHz"] = 1e-3 * trace.rate_Hz
        if trace.frequency_Hz:
            stretched = trace.frequency_Hz * (trace.cycle_s * trace.cycles / made.played_s if trace.cycle_s else 1.0)
            load["modulation"]["envelope"] = [{"shape": "sine", "frequency_Hz": stretched, "depth": NEGLIGIBLE_DEPTH}]
    else:
        own = {key: value for key, value in load["modulation"].items()
               if key not in ("envelope", "ramp_ms") and (not key.startswith("am_") or key == "am_frequency_Hz")}
        own |= {"am_depth": NEGLIGIBLE_DEPTH} if "am_frequency_Hz" in own else {}
        load["modulation"] = own
        if np.ptp(trace_of(job._copy(tables), 1000.0).gain) > 1e-9:
            raise BadExport("the path of the case states strengths of its own")
        own["envelope"] = [{"shape": "samples", "interval_us": 1e6 / trace.rate_Hz, "values": made.played.tolist(), "repeat": bool(trace.cycle_s)}]
    return job._copy(tables)


def readings_of(job: Job) -> dict[str, float]:
    """The readings of a case that has to be computed. Raises ShearwakeError."""
    with tempfile.TemporaryDirectory(prefix="shearwake-device-") as out, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = job.run(out=out).every_case[0]
        return {name: case.values[name] for name in READINGS if not math.isnan(case.values.get(name, math.nan))}


def effect_of(job: Job, made: Export) -> list[str]:
    """Lines that compare a case as asked with the same case as played, or state why not."""
    felt = {} if job.tables.get("time", {}).get("regime") == "periodic" else {"measure.sensation": True}
    try:
        with tempfile.TemporaryDirectory(prefix="shearwake-device-") as folder:
            quantised = played_job(job, made, Path(folder))
            try:
                asked, played = (readings_of(each.change(felt)) for each in (job, quantised))
            except ShearwakeError:  # the run is too short for a level
                asked, played = readings_of(job), readings_of(quantised)
    except (BadExport, ShearwakeError) as error:
        return [f"not computed, since {str(error).splitlines()[0]}"]
    lines = []
    for name in READINGS:
        if name in asked and name in played and not (name == "eta_at_1" and "eta_period_1" in asked):
            by = f"{played[name] - asked[name]:+.3g} dB" if name.endswith("_dB") else f"{100 * (played[name] / asked[name] - 1):+.3g} %"
            lines.append(f"{name}: {asked[name]:.6g} as asked, {played[name]:.6g} as played ({by})")
    return lines or ["not computed, since the case has no reading at measure.at_ms or over periods of the modulation"]
