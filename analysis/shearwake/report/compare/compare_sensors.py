# SPDX-License-Identifier: BSD-3-Clause
"""Differences of the sensors of two imported k-Wave studies, at nodes of the same position."""
from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ... import inputs
from ...case import Case
from ..load import UNREADABLE
from ..medium_files import file_of
from .compare_fields import SAME_m, common_times, relative_l2

VELOCITIES = ("ux", "uy", "uz")


@dataclass
class Sensor:
    time_s: np.ndarray
    nodes: list   # (i, j, k) from 0, one per row of the fields; not integers at Cartesian points
    fields: dict  # name -> (unit, values of nodes and times)
    step_s: float


@dataclass
class Places:
    """The positions of a sensor's nodes relative to the middle node of the grid, as in kgrid.x_vec of k-Wave."""
    spacing_m: np.ndarray
    at_m: np.ndarray  # (n, 3)


def sensor(case: Case) -> Sensor | None:
    """The sensor of a case; None without one."""
    try:
        found, units = case.arrays("sensor"), case.units("sensor")
        nodes = [tuple(round(float(index), 9) for index in node) for node in zip(*(found[axis] for axis in "ijk"))]
        fields = {name: (units[name], values) for name, values in found.items() if values.ndim == 2}
        time_s = found["time"]
        return Sensor(time_s, nodes, fields, float(time_s[1] - time_s[0]) if len(time_s) > 1 else math.nan)
    except UNREADABLE:
        return None


def places(case: Case, nodes: Any) -> Places | None:
    """The positions of these nodes, from the study file; None if it is not found or was changed after the run."""
    folder = case.path.resolve().parent.parent
    job = folder / "job.toml"
    text = job.read_text(encoding="utf-8", errors="replace") if job.is_file() else str(case.attributes.get("job", ""))
    path = file_of(folder, text, case, "solver.pstd.study")
    try:
        points, spacing_m = inputs.study_grid(path or Path())
    except (OSError, KeyError, ValueError):
        return None
    return Places(spacing_m, (np.array(nodes, dtype=float).reshape(-1, 3) - points // 2) * spacing_m)


def same_grid(first: Any, second: Any) -> bool:
    keys = ("nx", "ny", "spacing_m")
    return [first.setting("domain", key, default=None) for key in keys] == [
        second.setting("domain", key, default=None) for key in keys]


def common_nodes(ours: Any, theirs: Any) -> Any:
    """Pairs of rows whose keys are equal."""
    rows = {key: n for n, key in enumerate(theirs)}
    return [(n, rows[key]) for n, key in enumerate(ours) if key in rows]


def rounded(at_m: Any) -> Any:
    return [tuple(row) for row in np.rint(at_m / SAME_m).astype(np.int64).tolist()]


def nearest_mm(ours: Any, theirs: Any) -> Any:
    """The smallest distance of a node of one sensor from a node of the other, without large matrices."""
    return 1e3 * min(float(np.min(np.linalg.norm(theirs - at, axis=1))) for at in ours)


def matched(first: Any, second: Any, ours: Any, theirs: Any) -> Any:
    """Pairs of rows, and a note: why there are none, or what is to be observed."""
    here, there = places(first, ours.nodes), places(second, theirs.nodes)
    if here is None or there is None:
        if not same_grid(first, second):
            missing = " and ".join(str(case.path) for case, found in ((first, here), (second, there)) if found is None)
            return [], ("the grids differ, and the positions of the nodes are unknown, because the study file of "
                        f"{missing} was not found or was changed after the run")
        pairs = common_nodes(ours.nodes, theirs.nodes)
        return pairs, "" if pairs else "the sensors have no node in common"
    pairs = common_nodes(rounded(here.at_m), rounded(there.at_m))
    if not pairs:
        return [], ("no nodes have the same position relative to the middle of the grid; the nearest are "
                    f"{nearest_mm(here.at_m, there.at_m):.3g} mm apart")
    shift_mm = 500.0 * float(np.abs(here.spacing_m - there.spacing_m).max())
    return pairs, f"up to {shift_mm:.3g} mm apart" if shift_mm > 1e3 * SAME_m else ""


def staggered(note: str, ours: Any, theirs: Any, names: Any) -> Any:
    """What differs between the velocities of two grids: their places and times lie between nodes and steps."""
    lag_us = 0.5e6 * abs(ours.step_s - theirs.step_s)
    apart = [note] if note else []
    if lag_us > 1e-3:
        apart.append(f"{lag_us:.3g} us apart")
    if not apart or not any(name in VELOCITIES for name in names):
        return ""
    return (f"velocities, which k-Wave stores between nodes and steps, are {' and '.join(apart)} at equal nodes and "
            "times")


def compare_sensors(first: Case, second: Case) -> tuple[list[Any], str]:
    """One entry for each field that both sensors recorded, over their common nodes and times, and a note: why the
    sensors are not compared, or in what the compared values differ; empty without a sensor."""
    ours, theirs = sensor(first), sensor(second)
    if not ours or not theirs:
        return [], "" if not ours and not theirs else f"only the {'first' if ours else 'second'} has a sensor"
    if not ours.nodes or not theirs.nodes:
        return [], "a sensor has no nodes"
    names = [name for name in ours.fields if name in theirs.fields]
    if not names:
        return [], f"the first recorded {', '.join(ours.fields)}, the second {', '.join(theirs.fields)}"
    times = common_times(ours.time_s, theirs.time_s)
    if not times:
        return [], "the sensors have no time in common"
    nodes, note = matched(first, second, ours, theirs)
    if not nodes:
        return [], note
    found = []
    for name in names:
        a, b = (side.fields[name][1][np.ix_([pair[n] for pair in nodes], [pair[n] for pair in times])]
                for n, side in enumerate((ours, theirs)))
        node, time = np.unravel_index(int(np.argmax(np.abs(a - b))), a.shape)
        found.append({"field": name, "unit": ours.fields[name][0], "nodes": len(nodes), "times": len(times),
                      "relative_l2": relative_l2(a, b), "largest": float(np.abs(a - b)[node, time]),
                      "peak": float(np.abs(b).max()),
                      "at_node": list(ours.nodes[nodes[node][0]]),
                      "time_ms": 1e3 * float(ours.time_s[times[time][0]])})
    return found, staggered(note, ours, theirs, names)
