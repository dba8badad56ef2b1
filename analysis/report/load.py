"""Reads an output folder: plan, journal, job text and every case file that is whole. The case files
alone will do.

A case without a whole file keeps its place with a status and a reason, as `shearwake reduce`
gives them; it has no numbers, and the figures pass over it.
"""
import json
import math
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np

from from_cases import plan_of_cases


class NoPlan(Exception):
    """The folder is no output folder of shearwake."""


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
    scalars: dict = field(default_factory=dict)
    notes: dict = field(default_factory=dict)  # column -> why it is empty
    series: dict = field(default_factory=dict)  # name -> values over time, at the surface
    spectrum: tuple = ()  # frequency_Hz, amplitude_m at the trace nearest to the centre
    trace_at_m: tuple = (math.nan, math.nan)
    traces: list = field(default_factory=list)  # ((x_m, y_m), u_z_m over time), as recorded

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
    told: list = None  # keys that tell curves apart; None: those that vary among these cases

    def __post_init__(self):
        self.index = {c.id: c for c in self.cases}

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
    case.traces = [((float(a), float(b)), u) for a, b, u in zip(x, y, group["u_z"][()])]


def read_case(case):
    """Fills `case` from its file. Raises OSError, KeyError or ValueError when that is damaged."""
    with h5py.File(case.path, "r") as file:
        case.attributes = {name: plain(value) for name, value in file.attrs.items()}
        if case.attributes["case_id"] != case.id:
            raise ValueError("it holds another case")
        case.physics = tomllib.loads(case.attributes["case"])
        for name, item in file.items():
            if not isinstance(item, h5py.Dataset):
                continue
            if item.shape == ():
                case.scalars[name] = float(item[()])
                if "note" in item.attrs:
                    case.notes[name] = text(item.attrs["note"])
            elif name != "depth":
                values = item[()]
                case.series[name] = values[0] if values.ndim == 2 else values
        frames = len(case.series["time"])
        if any(len(values) != frames for values in case.series.values()):
            raise ValueError("its series differ in length")
        read_trace(file, case)
        case.status = str(case.attributes["status"])
        case.reason = "" if case.whole else "its file is not complete"


def surface(case, time=-1):
    """Snapshot number `time` at the surface: t_s, x_m, y_m, u_z_m(x, y); None without one."""
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
    """When the kept surfaces are; empty without any."""
    try:
        with h5py.File(case.path, "r") as file:
            return file["surface/time"][()]
    except (OSError, KeyError, ValueError):
        return np.empty(0)


def mean_square(case):
    """Time-averaged u_z^2 over whole periods and what was drawn: x_m, y_m, m2(x, y) and a list of
    lines (point, xy) in m; None where no mean was kept."""
    try:
        with h5py.File(case.path, "r") as file:
            group = file["mean"]
            number = group["drawn_line"][()]
            points = np.column_stack([group["drawn_x"][()], group["drawn_y"][()]])
            lines = [points[number == n] for n in np.unique(number)]
            return group["x"][()], group["y"][()], group["u_z_squared"][()], lines
    except (OSError, KeyError, ValueError):
        return None


def read_events(folder):
    """What all journals tell, in the order of time. Lines that were cut short are passed over."""
    events = []
    for path in sorted(folder.glob("journal*.jsonl")):
        time_s = 0.0
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            try:
                event = json.loads(line)
                kind, case_id = event["event"], event.get("id")
                time_s = float(event.get("unix_s", time_s))
            except (ValueError, KeyError, TypeError, AttributeError):
                continue
            events.append((time_s, kind, case_id, event))
    return sorted(events, key=lambda entry: entry[0])


def read_failures(folder):
    """Reason of the last failure by case id."""
    reasons = {}
    for _, kind, case_id, event in read_events(folder):
        if kind == "failed":
            reasons[case_id] = str(event.get("reason", "no reason given"))
        elif kind in ("started", "finished"):
            reasons.pop(case_id, None)
    return reasons


def first_line(error):
    lines = str(error).strip().splitlines()
    return lines[0] if lines else type(error).__name__


def read_plan(folder):
    """plan.json and job.toml, or what the case files tell of them."""
    path, job = folder / "plan.json", folder / "job.toml"
    if path.exists():
        plan, job_text = json.loads(path.read_text(encoding="utf-8")), ""
    else:
        plan, job_text = plan_of_cases(folder)
    if job.exists():
        job_text = job.read_text(encoding="utf-8", errors="replace")
    return plan, job_text


def load(folder):
    folder = Path(folder)
    try:
        plan, job_text = read_plan(folder)
        table = plan["table"]
        cases = [Case(c["id"], c["settings"], c["is_reference"], c["reference_id"],
                      folder / "cases" / (c["id"] + ".h5")) for c in plan["cases"]]
        sweep = Sweep(folder, plan["name"], plan["title"], plan["swept_keys"], table["x"],
                      table["series"], cases, job_text)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise NoPlan(f"{folder} holds no plan of shearwake: {first_line(error)}") from error
    failures = read_failures(folder)
    for case in cases:
        if case.path.exists():
            try:
                read_case(case)
            except (OSError, KeyError, ValueError, IndexError, TypeError, RuntimeError) as error:
                case.status, case.reason = "damaged", first_line(error)
                case.scalars, case.series, case.spectrum = {}, {}, ()
        elif case.id in failures:
            case.status, case.reason = "failed", failures[case.id]
    return sweep
