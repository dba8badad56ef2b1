# SPDX-License-Identifier: BSD-3-Clause
"""Opens an output folder for figures: verifies the file of each complete case, and reads its traces and surfaces.

All measures, their ratios, units and the reasons for empty cells are those of the table that `shearwake reduce` wrote. A case
without a complete file has a status and a reason, but no numbers; the figures omit it.
"""
import contextlib
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..case import Case
from ..checksum import Damaged, verify_case
from ..errors import NotAnOutputFolder, NotRecorded
from ..plan import first_line
from ..sweep import Sweep, case_of_file
from .progress import parallel_map


@dataclass
class Selection:
    """Cases of a sweep with their references, which figures draw over the key x."""
    sweep: Sweep
    cases: list[Case]
    x: str
    label_keys: list[str] | None = None  # keys that distinguish curves; None: those that vary among these cases

    @functools.cached_property
    def by_id(self) -> dict[str, Case]:
        return {case.id: case for case in self.cases}

    def reference_of(self, case: Case) -> Case | None:
        """The complete reference of a case, or None."""
        found = self.by_id.get(case.reference_id)
        return found if found and found.is_complete else None

    def added_reference_of(self, case: Case) -> Case | None:
        """The reference of a case unless it is a case of the sweep itself, which figures draw anyway."""
        found = self.reference_of(case)
        return found if found and found.is_reference else None

    def ratio_of(self, column: str) -> str:
        """The column with a measure over that of the reference; '' if there is none."""
        return next((c.name for c in self.sweep.columns if c.over_reference_of == column), "")

    @functools.cached_property
    def ratios(self) -> set[str]:
        """The columns with measures over those of the reference."""
        return {c.name for c in self.sweep.columns if c.over_reference_of}

    def is_ratio(self, column: str) -> bool:
        return column in self.ratios


def remembered(function: Any) -> Any:
    """The function of a selection or a case and hashable arguments, called once for the same ones and stored there, since each label
    asks for it. Callers must not change the results."""
    @functools.wraps(function)
    def first_time(owner: Any, *arguments: Any) -> Any:
        known = vars(owner).setdefault("_remembered", {})
        place = (function.__module__, function.__name__, *arguments)
        if place not in known:
            known[place] = function(owner, *arguments)
        return known[place]
    return first_time


SPECTRUM_Hz = 2000.0  # upper end of spectra
PARTS = 32  # into which the cases are divided for two processes
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


@dataclass
class Traces:
    """The displacement at the trace points of a case, and its spectra."""
    points_m: list[tuple[float, float]]
    u_z_m: np.ndarray  # (point, time)
    frequency_Hz: np.ndarray
    amplitude_m: np.ndarray  # (point, frequency)

    def __len__(self) -> int:
        return len(self.points_m)

    @property
    def measured(self) -> int:
        """The index of the point whose signal the columns of the table describe: that in the centre, else the first one."""
        return self.points_m.index((0.0, 0.0)) if (0.0, 0.0) in self.points_m else 0

    @property
    def measured_m(self) -> tuple[float, float]:
        """That point; NaN without points."""
        return self.points_m[self.measured] if self.points_m else (math.nan, math.nan)


@remembered
def traces(case: Case) -> Traces:
    """The traces of a case; none if it has not recorded any. Raises Damaged and OSError."""
    try:
        found = case.arrays("traces")
    except NotRecorded:
        return Traces([], np.empty((0, 0)), np.empty(0), np.empty((0, 0)))
    frequency, amplitude = found["frequency"], found["amplitude"]  # the lines of a period have no leakage
    if case.setting("time", "regime", default="") != "periodic" and len(found["time"]) > 1:
        interval_s = float(found["time"][1] - found["time"][0])
        if not interval_s > 0.0:
            raise ValueError("the times of the traces do not increase")
        frequency, amplitude = amplitude_spectrum(found["u_z"], interval_s)
    return Traces([(float(x), float(y)) for x, y in zip(found["x"], found["y"])], found["u_z"], frequency, amplitude)


def single_case(path: Path) -> Case:
    """The case of a file outside of a sweep. Raises OSError, RuntimeError, KeyError, ValueError and TypeError if it is not a case file."""
    verify_case(path)  # before HDF5 reads it
    case = case_of_file(path)
    case.verify()
    return case


@remembered
def surface_times(case: Case) -> np.ndarray:
    """The times of the recorded surfaces; empty if there are none."""
    try:
        return case.array("surface/time")
    except NotRecorded:
        return np.empty(0)


def mean_square(case: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray, list[np.ndarray]] | None:
    """Mean of u_z^2 over complete periods and the drawn shape: x_m, y_m, m2(x, y) and a list of lines
    (point, xy) in m; None if no mean was recorded."""
    try:
        found = case.arrays("mean")
        points = np.column_stack([found["drawn_x"], found["drawn_y"]])
        lines = [points[found["drawn_line"] == n] for n in np.unique(found["drawn_line"])]
        return found["x"], found["y"], found["u_z_squared"], lines
    except NotRecorded:
        return None


def bilinear(x: np.ndarray, y: np.ndarray, values: np.ndarray, at_x: np.ndarray, at_y: np.ndarray) -> np.ndarray:
    """values(x, y) between equidistant nodes at points; beyond the nodes, those at the edge."""
    at = [np.interp(points, nodes, np.arange(len(nodes))) for points, nodes in ((at_x, x), (at_y, y))]
    i, j = (np.minimum(a.astype(int), len(nodes) - 2) for a, nodes in zip(at, (x, y)))
    s, t = at[0] - i, at[1] - j
    return ((1 - s) * (1 - t) * values[i, j] + s * (1 - t) * values[i + 1, j]
            + (1 - s) * t * values[i, j + 1] + s * t * values[i + 1, j + 1])


def levels(case: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """The level of sensation in the measured region: x_m, y_m, level_dB(x, y); None if it was not computed."""
    try:
        found = case.arrays("sensation")
        return found["x"], found["y"], found["level"]
    except NotRecorded:
        return None


def load(folder: str | Path, report: Callable[[str], None] = lambda text: None) -> Selection:
    """All cases of an output folder, of which those with a damaged file have the status "damaged". `report` receives a text about
    the progress. Raises NotAnOutputFolder, also if the folder has no table."""
    sweep = Sweep(folder)
    table = sweep.reduced
    if table is None:
        raise NotAnOutputFolder(f"{folder} has no table: shearwake reduce {folder}")
    stored = [case for case in sweep.every_case
              if case.is_complete or table.rows.get(case.id, {}).get("status") == "complete"]  # also without its file
    read_all(stored, verify, report)
    return Selection(sweep, sweep.every_case, sweep.x)


def read_all(cases: list[Case], read: Callable[[Case], Any], report: Callable[[str], None] = lambda text: None) -> None:
    """Calls `read` for each case in two processes; what it stores in a case is then in the case of this process."""
    parts = [cases[n::PARTS] for n in range(min(PARTS, len(cases)))]
    found = parallel_map([functools.partial(contents, part, read) for part in parts],
                         lambda n: report(f"{n} of {len(parts)} parts of the cases read"))
    for part, of_cases in zip(parts, found):
        for case, of_case in zip(part, of_cases):
            vars(case).update(of_case)


def contents(cases: list[Case], read: Callable[[Case], Any]) -> list[dict[str, Any]]:
    """What `read` has stored in the cases."""
    for case in cases:
        read(case)
    return [{name: value for name, value in vars(case).items() if name != "sweep"} for case in cases]


def verify(case: Case) -> None:
    """States in the case what is wrong with its file."""
    try:
        case.verify()
    except (OSError, Damaged, NotRecorded) as error:
        case.damage = first_line(error)


def read_motion(case: Case) -> None:
    """Reads the traces and the path of the focus. Without them, the figures that need them fail alone."""
    with contextlib.suppress(Exception):
        traces(case)
        _ = case.focus
