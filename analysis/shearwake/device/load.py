# SPDX-License-Identifier: BSD-3-Clause
"""The load of a case, as the program computes it, and what becomes of the case when a device plays it."""
from __future__ import annotations

import math
import tempfile
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
from .read import READERS, Signal, text_for_program

READINGS = ("eta_period_1", "eta_at_1", "felt_peak_dB", "focal_rms_um")
NEGLIGIBLE_DEPTH = 1e-12  # of a gain that states the period of the measures
FASTEST_Hz, MOST_CYCLES, WHOLE = 1e6, 25, 1e-6  # samples per second of `show`; cycles; a part of a sample that is none
PROBE_Hz = 1000.0  # for what does not depend on the rate
USUAL_DISTANCE_m = 0.2  # of the skin, unless the case has an array


class BadExport(ShearwakeError):
    """What prevents an export."""

    exit_code = 2


def value_of(text: Any) -> Any:
    """A value of the command line or of a swept key, with its type in a job."""
    return job_tables(f"value = {text}").get("value", text) if isinstance(text, str) else text


def single_case(source: Path, overrides: list[str]) -> Job:
    """A job with the case of a case file, or the first case of a job. Files that the job of a case file names are relative to the
    current folder, since the case file does not state where the job was. Raises ProgramError, OSError and BadExport."""
    if source.suffix == ".toml":
        job, changes = Job(source), overrides
        plan = program.call_json(["plan", str(source), *(word for text in overrides for word in ("-S", text))])
        settings = next(case["settings"] for case in plan["cases"] if not case["is_reference"])
    else:
        found = facts(source)
        if overrides:
            raise BadExport("-S applies only with a job, since a case is computed already")
        if any(key.startswith("optimise.") for key in found["settings"]):
            raise BadExport(f"is a case of optimise; export the optima from the jobs {source.parent.parent / 'optimise'}/*.job.toml")
        text = found["job"] if job_tables(found["job"]) else (source.parent.parent / "job.toml").read_text(encoding="utf-8-sig")
        job, changes, settings = Job(text + "\n"), found["overrides"].splitlines(), found["settings"]
        if found["is_reference"] == "yes":
            reference = job.tables.get("table", {}).get("reference", {})
            settings = {**settings, **{f"load.modulation.{key}": value for key, value in reference.items()}}
    tables = job.tables
    for key, _, text in (change.partition("=") for change in changes):
        put(tables, key.strip(), value_of(text.strip()))
    for name in ("sweep", "uncertain", "table", "optimise"):
        tables.pop(name, None)
    tables["sweep"] = {key: [value_of(value)] for key, value in settings.items() if not key.startswith("load.")}
    for key in [key for key in settings if key.startswith("load.")]:
        put(tables, key, value_of(settings[key]))
    if "modulation" in tables["load"]:  # with a swept kind, keys of other kinds are ignored
        tables["sweep"]["load.modulation.kind"] = [tables["load"]["modulation"].get("kind", "")]
    made = job.with_tables(tables)
    if source.suffix != ".toml" and (case_id := made.plan().document["cases"][0]["id"]) != found["case_id"]:
        raise BadExport(f"its job and settings give the case {case_id} with this version of the program and the files of the current folder")
    return made


class Load:
    """The load of the only case of a job. `cycle_s` is the period, 0: none; foci in mm relative to the position, the centre of the array
    on the skin and its distance. Raises ProgramError, as all members do."""

    def __init__(self, job: Job, distance_mm: float | None = None) -> None:
        self.job = job
        found = self.show(PROBE_Hz)
        self.cycle_s, self.frequency_Hz = found["cycle_s"], found["frequency_Hz"]
        self.distance_mm = distance_mm or 1e3 * found.get("distance_m", USUAL_DISTANCE_m)
        self.run_s = len(found["run"]["gain"]) / PROBE_Hz
        self.foci_mm = 1e3 * np.column_stack((found["foci_x_m"] or [0.0], found["foci_y_m"] or [0.0]))
        self.center_mm = np.array(job.tables["load"].get("footprint", {}).get("center_mm", (0.0, 0.0)), float)

    def show(self, rate_Hz: float, phases: bool = False) -> dict[str, Any]:
        with self.job.file() as path:
            return program.call_json(["show", "--modulation", str(path), f"--rate={rate_Hz:.17g}", *(["--phases"] if phases else [])])

    def cycles(self, rate_Hz: float) -> int:
        """The number of cycles that take a whole number of samples, or 1."""
        samples = self.cycle_s * rate_Hz
        return next((n for n in range(1, 1 + min(MOST_CYCLES, int(FASTEST_Hz / rate_Hz))) if abs(n * samples - round(n * samples)) < WHOLE), 1)

    def sample(self, rate_Hz: float, cycles: int = 0, phases: bool = False) -> Signal:
        """Some cycles of the load, by default those that take a whole number of samples, or the run."""
        cycles = cycles or self.cycles(rate_Hz)
        found = self.show(cycles * rate_Hz, phases)
        run, phase = found["run"], np.array(found.get("phases_rad", []))
        count = max(2, min(len(run["gain"]), round((self.cycle_s or run["t_s"][-1]) * cycles * rate_Hz)))
        order = np.arange(count) * cycles % count  # a sample of a later cycle is one between those of the first
        return Signal("list", np.full(count, 1 / rate_Hz), np.array(run["gain"])[order], 1e3 * np.column_stack((run["x_m"], run["y_m"]))[order],
                      phase.reshape(count, -1)[order] if phase.size else phase)


@dataclass
class Export:
    """The samples that are asked for, files by their suffix, what the device cannot do, and what it plays."""

    load: Load
    asked: Signal
    notes: list[str] = field(default_factory=list)
    files: dict[str, str | bytes] = field(default_factory=dict)
    played: Signal = field(default_factory=lambda: Signal("list"))

    def add(self, suffix: str, content: str | bytes) -> Signal:
        """Adds a file that load.modulation reads, and returns what it contains."""
        self.files[suffix] = content
        return READERS[suffix[suffix.rindex("."):]](content if isinstance(content, bytes) else content.encode())

    @property
    def stretch(self) -> float:
        """By which factor cycles of a whole number of samples take longer than those that are asked for."""
        duration_s, cycle_s = float(self.asked.dwells_s.sum()), self.load.cycle_s
        return duration_s / (cycle_s * round(duration_s / cycle_s)) if cycle_s else 1.0

    def table(self, file: Path) -> dict[str, Any]:
        """[load.modulation] that reads a file back."""
        keys = {"position_mm": self.asked.points_mm[0].tolist()} if file.suffix in (".wav", ".hjif") else {}
        foci = {"foci_mm": self.load.foci_mm.tolist()} if len(self.load.foci_mm) > 1 and self.played.kind != "phases" else {}
        return {"kind": "file", "file": str(file), "at_end": "repeat" if self.load.cycle_s else "off", **keys, **foci}


def played_job(made: Export, folder: Path) -> Job:
    """The case with the load that the device plays. The measures keep the period of the case."""
    tables, of = made.load.job.tables, made.load
    file, load = folder / "played.csv", tables["load"]
    file.write_text(frames_text(made.played.phases_rad) if made.played.kind == "phases" else text_for_program(made.played), encoding="utf-8")
    load["modulation"] = made.table(file)
    tables["sweep"]["load.modulation.kind"] = ["file"]
    load["footprint"].pop("update_rate_kHz", None)  # each point is an update
    if made.played.kind == "phases":
        load["footprint"]["update_rate_kHz"] = round(1e-3 / made.asked.dwells_s[0], 9)
    if of.frequency_Hz:
        load["modulation"]["envelope"] = [{"shape": "sine", "frequency_Hz": of.frequency_Hz / made.stretch, "depth": NEGLIGIBLE_DEPTH}]
    return of.job.with_tables(tables)


def frames_text(phases_rad: np.ndarray) -> str:
    """OpenMPD's CSV of phases: frame by piston."""
    return "{},{}\n".format(*phases_rad.shape) + "".join(",".join(f"{phase:.9g}" for phase in frame) + "\n" for frame in phases_rad)


def readings_of(job: Job) -> dict[str, float]:
    """The readings of a case that has to be computed. Raises ShearwakeError."""
    with tempfile.TemporaryDirectory(prefix="shearwake-device-") as out, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        case = job.run(out=out).every_case[0]
        return {name: case.values[name] for name in READINGS if not math.isnan(case.values.get(name, math.nan))}


def effect_of(made: Export) -> list[str]:
    """Lines that compare a case as asked with the same case as played, or state why not."""
    try:
        with tempfile.TemporaryDirectory(prefix="shearwake-device-") as folder:
            jobs = made.load.job, played_job(made, Path(folder))
            try:
                asked, played = (readings_of(each.change({"measure.sensation": True})) for each in jobs)
            except ShearwakeError:  # the run is periodic, or too short for a level
                asked, played = map(readings_of, jobs)
    except ShearwakeError as error:
        return [f"effect: not computed, since {str(error).splitlines()[0]}"]
    lines = []
    for name in READINGS:
        if name in asked and name in played and not (name == "eta_at_1" and "eta_period_1" in asked):
            by = f"{played[name] - asked[name]:+.3g} dB" if name.endswith("_dB") else f"{100 * (played[name] / asked[name] - 1):+.3g} %"
            lines.append(f"effect: {name}: {asked[name]:.6g} as asked, {played[name]:.6g} as played ({by})")
    return lines or ["effect: not computed, since the case has no reading at measure.at_ms or over periods of the modulation"]
