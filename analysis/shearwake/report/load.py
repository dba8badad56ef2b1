# SPDX-License-Identifier: BSD-3-Clause
"""Reads an output folder: the plan, the table that `shearwake reduce` wrote, and the series, spectra and
surfaces of all complete case files.

All measures, their ratios, units and the reasons for empty cells are read from the table and not computed
again. A case without a complete file has a status and a reason, but no numbers; the figures omit it.
"""
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ..case import Case as StoredCase
from ..checksum import verify_case
from ..errors import NotAnOutputFolder as NoPlan, NotRecorded
from ..plan import first_line, read_plan, read_table
from ..sweep import case_of_file

# What reading a case raises if it has no file, or if the file is damaged or lacks the data.
UNREADABLE = (OSError, RuntimeError, KeyError, ValueError, IndexError, TypeError, NotRecorded)


@dataclass
class Case:
    id: str
    settings: dict
    is_reference: bool
    reference_id: str
    path: Path
    status: str = "missing"
    reason: str = "not computed"
    attributes: dict = field(default_factory=dict)
    physics: dict = field(default_factory=dict)  # the resolved case, SI
    wall_s: float = math.nan
    scalars: dict = field(default_factory=dict)  # column -> value; NaN: empty
    notes: dict = field(default_factory=dict)  # column -> why it is empty
    warnings: list = field(default_factory=list)  # {severity, key, message}; severity error: not valid
    series: dict = field(default_factory=dict)  # name -> values over time, at the surface
    spectrum: tuple = ()  # frequency_Hz, amplitude_m at the trace nearest to the centre
    trace_at_m: tuple = (math.nan, math.nan)
    traces: list = field(default_factory=list)  # ((x_m, y_m), u_z_m over time), as recorded
    trace_amplitudes: list = field(default_factory=list)  # amplitude_m at the frequencies of `spectrum`, per trace

    @functools.cached_property
    def stored(self) -> StoredCase:
        """The case as the package reads it."""
        return StoredCase(self.path, {"id": self.id, "settings": self.settings, "is_reference": self.is_reference,
                                      "reference_id": self.reference_id})

    @property
    def whole(self) -> bool:
        return self.status == "complete"

    def value(self, name: str) -> float:
        return self.scalars.get(name, math.nan)

    def setting(self, *keys: str, default: Any = math.nan) -> Any:
        """A value of the resolved case: setting('measure', 'at_s')."""
        node = self.physics
        for key in keys:
            if not isinstance(node, dict) or key not in node:
                return default
            node = node[key]
        return node


@dataclass
class Sweep:
    folder: Path
    name: str
    title: str
    swept_keys: list
    x: str
    series_keys: list
    cases: list
    job_text: str
    columns: list  # of the table: name, unit, description, where it is shown, numerator of a ratio
    label_keys: list | None = None  # keys that distinguish curves; None: those that vary among these cases
    uncertain: dict | None = None  # the design of [uncertain]; None: the job has none
    adaptive: list | tuple = ()  # the adaptive axes of the plan

    def __post_init__(self) -> None:
        self.index = {c.id: c for c in self.cases}

    def ratio_of(self, column: str) -> str:
        """The column with a measure over that of the reference."""
        return next(c["name"] for c in self.columns if c["over_reference_of"] == column)

    def is_ratio(self, column: str) -> bool:
        return any(c["name"] == column and c["over_reference_of"] for c in self.columns)

    def by_id(self, case_id: str) -> Any:
        return self.index.get(case_id)

    def reference_of(self, case: Case) -> Case | None:
        """The whole reference of a case, or None."""
        found = self.by_id(case.reference_id) if case.reference_id else None
        return found if found and found.whole else None


SPECTRUM_Hz = 2000.0  # upper end of spectra
FINER = 8  # padding of a spectrum, for a smooth curve


def amplitude_spectrum(values: np.ndarray, interval_s: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies in Hz and the one-sided amplitude spectrum of a signal, along the last axis, without its mean and with a Hann
    window. A tone has its amplitude. Without a window, the mean of a run that holds no whole number of periods leaks into low
    frequencies."""
    count = values.shape[-1]
    window = np.hanning(count + 2)[1:-1]
    windowed = (values - (values @ window / window.sum())[..., None]) * window
    frequency = np.fft.rfftfreq(FINER * count, interval_s)
    shown = frequency <= SPECTRUM_Hz
    return frequency[shown], 2.0 * np.abs(np.fft.rfft(windowed, n=FINER * count))[..., shown] / window.sum()


def read_trace(case: Case) -> None:
    try:
        found = case.stored.arrays("traces")
    except NotRecorded:
        return
    x, y = found["x"], found["y"]
    nearest = int(np.argmin(np.hypot(x, y)))
    case.trace_at_m = (float(x[nearest]), float(y[nearest]))
    frequency, amplitude = found["frequency"], found["amplitude"]  # the lines of a period have no leakage
    if case.setting("time", "regime", default="") != "periodic" and len(found["time"]) > 1:
        frequency, amplitude = amplitude_spectrum(found["u_z"], float(found["time"][1] - found["time"][0]))
    case.spectrum = (frequency, amplitude[nearest])
    case.trace_amplitudes = list(amplitude)
    case.traces = [((float(a), float(b)), u) for a, b, u in zip(x, y, found["u_z"])]


def read_case(case: Case) -> None:
    """Reads the series of the case from its file. Raises UNREADABLE if the file is damaged."""
    case.stored.verify()
    case.attributes = case.stored.attributes
    if case.attributes["case_id"] != case.id:
        raise ValueError("it contains another case")
    case.physics = case.stored.parameters
    case.series = {name: values[0] if values.ndim == 2 else values
                   for name, values in case.stored.arrays().items() if name != "depth"}
    frames = len(case.series["time"])
    if any(len(values) != frames for values in case.series.values()):
        raise ValueError("its series have different lengths")
    read_trace(case)


def single_case(path: Path) -> Case:
    """The case of a file outside of a sweep, with its scalars as columns. Raises OSError, RuntimeError, KeyError,
    ValueError or TypeError if it is not a valid case file."""
    verify_case(path)
    stored = case_of_file(path)
    case = Case(stored.id, stored.settings, stored.is_reference, "", path, status="complete", warnings=stored.warnings,
                scalars=stored.values)
    read_case(case)
    return case


def surface(case: Case, time: int = -1) -> Any:
    """Snapshot number `time` of the surface: t_s, x_m, y_m, u_z_m(x, y); None if there is none."""
    try:
        return case.stored.snapshot(time)
    except UNREADABLE:
        return None


def surface_times(case: Case) -> np.ndarray:
    """The times of the recorded surfaces; empty if there are none."""
    try:
        return case.stored.array("surface/time")
    except UNREADABLE:
        return np.empty(0)


def mean_square(case: Case) -> Any:
    """Mean of u_z^2 over complete periods and the drawn shape: x_m, y_m, m2(x, y) and a list of lines
    (point, xy) in m; None if no mean was recorded."""
    try:
        found = case.stored.arrays("mean")
        points = np.column_stack([found["drawn_x"], found["drawn_y"]])
        lines = [points[found["drawn_line"] == n] for n in np.unique(found["drawn_line"])]
        return found["x"], found["y"], found["u_z_squared"], lines
    except UNREADABLE:
        return None


def fill(case: Case, row: dict) -> None:
    """Copies the row of the table to the case."""
    def number(value):
        return math.nan if value is None else value
    case.status, case.reason = row["status"], row["note"]
    case.wall_s = number(row["wall_s"])
    case.scalars = {name: number(value) for name, value in row["values"].items()}
    case.notes = row["notes"]
    case.warnings = row["warnings"]


def load(folder: str | Path, report: Callable[[str], None] = lambda text: None) -> Sweep:
    """The sweep of an output folder. `report` receives a text about the progress. Raises NoPlan."""
    folder = Path(folder)
    plan, job_text = read_plan(folder)
    try:
        table = read_table(folder, plan["name"])
        if table is None:
            raise NoPlan(f"{folder} has no table: shearwake reduce {folder}")
        cases = [Case(c["id"], c["settings"], c["is_reference"], c["reference_id"],
                      folder / "cases" / (c["id"] + ".h5")) for c in plan["cases"]]
        sweep = Sweep(folder, plan["name"], plan["title"], plan["swept_keys"], plan["table"]["x"],
                      plan["table"]["series"], cases, job_text, table.columns, uncertain=plan.get("uncertain"),
                      adaptive=plan.get("adaptive", ()))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NoPlan(f"{folder} is not an output folder of shearwake: {first_line(error)}") from error
    for n, case in enumerate(cases):
        report(f"reading case {n + 1} of {len(cases)}")
        if case.id in table.rows:
            fill(case, table.rows[case.id])
        if not case.whole:
            case.scalars = {}
            continue
        try:
            read_case(case)
        except UNREADABLE as error:
            case.status, case.reason = "damaged", first_line(error)
            case.scalars, case.series, case.spectrum = {}, {}, ()
    return sweep
