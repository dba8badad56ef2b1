# SPDX-License-Identifier: BSD-3-Clause
"""Maps that a case refers to. Case files contain only the hash of these files."""
from __future__ import annotations

from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np

from ..case import Case
from ..inputs import MaterialMap
from ..keys import job_tables

LATE_s = 2.0  # between writing a file and the start of a case, whose time is stored in whole seconds


def speed(found: MaterialMap, x: Any, y: Any, z: Any) -> Any:
    """The speed on a plane, of which x and y are a row and a number, or a number and a row, and z a column in m.
    Linear between nodes; NaN farther outside than half a spacing."""
    along = [weights(np.ravel(at), nodes) for at, nodes in ((x, found.x_m), (y, found.y_m), (z, found.z_m))]
    values = np.einsum("xi,yj,zk,ijk->zxy", *along, found.c_s_m_s, optimize=True)
    return values.reshape(np.broadcast(x, y, z).shape)


def weights(at: Any, nodes: Any) -> Any:
    """The matrix of linear interpolation from the nodes to the points `at`; rows of NaN outside."""
    if len(nodes) == 1:
        return np.ones((len(at), 1))
    spacing = nodes[1] - nodes[0]
    place = (at - nodes[0]) / spacing
    outside = (place < -0.5 - 1e-9) | (place > len(nodes) - 0.5 + 1e-9)
    place = np.clip(place, 0.0, len(nodes) - 1.0)
    first = np.minimum(place.astype(int), len(nodes) - 2)
    matrix = np.zeros((len(at), len(nodes)))
    rows = np.arange(len(at))
    matrix[rows, first], matrix[rows, first + 1] = 1.0 - (place - first), place - first
    matrix[outside] = np.nan
    return matrix


def job_value(job: str, case: Case, key: str) -> str | None:
    """The value of a key of the job, given as text, for this case: swept, overridden on the command line, or in the job file."""
    found: Any = case.settings.get(key)
    for text in [*str(case.attributes.get("overrides", "")).splitlines()[::-1], job]:
        if found is not None:
            break
        found = job_tables(text)
        for part in key.split("."):
            found = found.get(part) if isinstance(found, dict) else None
    return found


def file_of(folder: Path, job: str, case: Case, key: str) -> Path | None:
    """The path of the file that a key of the job names, if the file is found and was not changed after the start of
    the case; else None. `job` is the text of the job. Paths in jobs are relative to the job, which usually lies near the
    output folder."""
    name = job_value(job, case, key)
    if not isinstance(name, str):
        return None
    above = folder.resolve().parents
    for near in [*above[:3], *(parent / "jobs" for parent in above[:3]), Path.cwd()]:
        path = near / name
        if path.is_file() and path.stat().st_mtime < started(case) + LATE_s:
            return path
    return None


def started(case: Case) -> float:
    """The start of a case in seconds since 1970."""
    try:
        moment = datetime.strptime(case.attributes.get("started", ""), "%Y-%m-%dT%H:%M:%SZ")
    except ValueError:
        return 0.0
    return moment.replace(tzinfo=timezone.utc).timestamp()
