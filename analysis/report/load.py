# SPDX-License-Identifier: BSD-3-Clause
"""Reads an output folder: the plan, the table that `shearwake reduce` wrote, and the series, spectra and
surfaces of all complete case files.

All measures, their ratios, units and the reasons for empty cells are read from the table and not computed
again. A case without a complete file has a status and a reason, but no numbers; the figures omit it.
"""
import json
import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from checksum import open_case, read_json

class NoPlan(Exception):
    """The folder is not an output folder of shearwake."""


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

    @property
    def whole(self):
        return self.status == "complete"

    def value(self, name):
        return self.scalars.get(name, math.nan)

    def setting(self, *keys, default=math.nan):
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
    label_keys: list = None  # keys that distinguish curves; None: those that vary among these cases
    uncertain: dict = None  # the design of [uncertain]; None: the job has none

    def __post_init__(self):
        self.index = {c.id: c for c in self.cases}

    def ratio_of(self, column):
        """The column with a measure over that of the reference."""
        return next(c["name"] for c in self.columns if c["over_reference_of"] == column)

    def is_ratio(self, column):
        return any(c["name"] == column and c["over_reference_of"] for c in self.columns)

    def by_id(self, case_id):
        return self.index.get(case_id)

    def reference_of(self, case):
        """The whole reference of a case, or None."""
        found = self.by_id(case.reference_id) if case.reference_id else None
        return found if found and found.whole else None


def text(value):
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def plain(value):
    """An HDF5 attribute as text or number."""
    value = text(value)
    return value.item() if hasattr(value, "item") and np.size(value) == 1 else value


def read_trace(file, case):
    group = file.get("traces")
    if group is None:
        return
    x, y = group["x"][()], group["y"][()]
    nearest = int(np.argmin(np.hypot(x, y)))
    case.trace_at_m = (float(x[nearest]), float(y[nearest]))
    case.spectrum = (group["frequency"][()], group["amplitude"][nearest])
    case.trace_amplitudes = list(group["amplitude"][()])
    case.traces = [((float(a), float(b)), u) for a, b, u in zip(x, y, group["u_z"][()])]


def read_case(case):
    """Reads the series of the case from its file. Raises OSError, KeyError or ValueError if the file is damaged."""
    with open_case(case.path) as file:
        case.attributes = {name: plain(value) for name, value in file.attrs.items()}
        if case.attributes["case_id"] != case.id:
            raise ValueError("it contains another case")
        case.physics = tomllib.loads(case.attributes["case"])
        for name, item in file.items():
            if not isinstance(item, h5py.Dataset):
                continue
            if item.shape != () and name != "depth":
                values = item[()]
                case.series[name] = values[0] if values.ndim == 2 else values
        frames = len(case.series["time"])
        if any(len(values) != frames for values in case.series.values()):
            raise ValueError("its series have different lengths")
        read_trace(file, case)


def single_case(path):
    """The case of a file outside of a sweep, with its scalars as columns. Raises OSError, RuntimeError, KeyError,
    ValueError or TypeError if it is not a valid case file."""
    with open_case(path) as file:
        case = Case(text(file.attrs["case_id"]), json.loads(text(file.attrs["settings"])),
                    text(file.attrs["is_reference"]) == "yes", "", path, status="complete")
        case.warnings = json.loads(text(file.attrs.get("warnings", "[]")))
        case.scalars = {name: float(plain(item[()])) for name, item in file.items()
                        if getattr(item, "shape", None) == ()}
    read_case(case)
    return case


def surface(case, time=-1):
    """Snapshot number `time` of the surface: t_s, x_m, y_m, u_z_m(x, y); None if there is none."""
    try:
        with h5py.File(case.path, "r") as file:
            group = file.get("surface")
            if group is None or len(group["time"]) == 0:
                return None
            return (float(group["time"][time]), group["x"][()], group["y"][()],
                    group["u_z"][time, 0])
    except (OSError, KeyError, ValueError, IndexError):
        return None


def surface_times(case):
    """The times of the recorded surfaces; empty if there are none."""
    try:
        with h5py.File(case.path, "r") as file:
            return file["surface/time"][()]
    except (OSError, KeyError, ValueError):
        return np.empty(0)


def mean_square(case):
    """Mean of u_z^2 over complete periods and the drawn shape: x_m, y_m, m2(x, y) and a list of lines
    (point, xy) in m; None if no mean was recorded."""
    try:
        with h5py.File(case.path, "r") as file:
            group = file["mean"]
            number = group["drawn_line"][()]
            points = np.column_stack([group["drawn_x"][()], group["drawn_y"][()]])
            lines = [points[number == n] for n in np.unique(number)]
            return group["x"][()], group["y"][()], group["u_z_squared"][()], lines
    except (OSError, KeyError, ValueError):
        return None


def first_line(error):
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def read_plan(folder):
    """The plan and the text of the job, from plan.json and job.toml or, without them, from from_cases.py."""
    path, job = folder / "plan.json", folder / "job.toml"
    if path.exists():
        plan = read_json(path.read_text(encoding="utf-8"), lambda old: old["schema"] == 1)
    else:
        plan = json.loads((folder / "tables" / "plan.json").read_text(encoding="utf-8"))
    if job.exists():
        return plan, job.read_text(encoding="utf-8", errors="replace")
    return plan, plan.get("job", "")


def read_table(folder, name):
    """The columns of the table of `shearwake reduce`, and its rows by case id."""
    path = folder / "tables" / (name + ".json")
    if not path.exists():
        raise NoPlan(f"{folder} has no table: shearwake reduce {folder}")
    table = json.loads(path.read_text(encoding="utf-8"))
    return table["columns"], {row["id"]: row for row in table["cases"]}


def fill(case, row):
    """Copies the row of the table to the case."""
    def number(value):
        return math.nan if value is None else value
    case.status, case.reason = row["status"], row["note"]
    case.wall_s = number(row["wall_s"])
    case.scalars = {name: number(value) for name, value in row["values"].items()}
    case.notes = row["notes"]
    case.warnings = row["warnings"]


def load(folder, report=lambda text: None):
    """The sweep of an output folder. `report` receives a text about the progress. Raises NoPlan."""
    folder = Path(folder)
    try:
        plan, job_text = read_plan(folder)
        table = plan["table"]
        columns, rows = read_table(folder, plan["name"])
        cases = [Case(c["id"], c["settings"], c["is_reference"], c["reference_id"],
                      folder / "cases" / (c["id"] + ".h5")) for c in plan["cases"]]
        sweep = Sweep(folder, plan["name"], plan["title"], plan["swept_keys"], table["x"],
                      table["series"], cases, job_text, columns, uncertain=plan.get("uncertain"))
    except FileNotFoundError as error:
        raise NoPlan(f"{folder} is not an output folder, since it contains no plan.json; run the job first"
                     if folder.is_dir() else f"{folder}: no such output folder; run the job first") from error
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NoPlan(f"{folder} is not an output folder of shearwake: {first_line(error)}") from error
    for n, case in enumerate(cases):
        report(f"reading case {n + 1} of {len(cases)}")
        if case.id in rows:
            fill(case, rows[case.id])
        if not case.whole:
            case.scalars = {}
            continue
        try:
            read_case(case)
        except (OSError, KeyError, ValueError, IndexError, TypeError, RuntimeError) as error:
            case.status, case.reason = "damaged", first_line(error)
            case.scalars, case.series, case.spectrum = {}, {}, ()
    return sweep
