# SPDX-License-Identifier: BSD-3-Clause
"""Runs the sweeps that the page starts, one at a time."""
import asyncio
import itertools
import math
import os
import re
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import shearwake

MOST_VALUES = 60
LARGEST = 1e300  # integers of JSON may exceed every floating-point number
KIND, KINDS = "load.modulation.kind", ("STM", "AM-STM", "SM-STM", "LM", "AM")
KEY = re.compile(r"[a-z]+(\.[A-Za-z_]+(\[\d\])?){1,4}")
OTHER_CASES = ("sweep", "table", "uncertain", "optimise")  # tables that would add cases to those of the page
COLUMNS = ("eta_at_1", "eta_period_1", "peak_um", "focal_rms_um")


Report = Callable[[dict], None]


class NotASweep(Exception):
    """The request of a sweep is not valid."""


class StopRequested(Exception):
    """Ends a run from its report of progress."""


def is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= LARGEST


def is_key(key: Any) -> bool:
    return isinstance(key, str) and len(key) <= 80 and KEY.fullmatch(key) is not None


def checked(key: Any, values: Any, more: Any) -> tuple[str, list, dict[str, float]]:
    """The axis of a request, and the numbers of further keys. Raises NotASweep."""
    if not is_key(key) or not isinstance(more, dict) or len(more) > MOST_VALUES or not all(map(is_key, more)):
        raise NotASweep("a key of the sweep is not valid")
    is_value = (lambda value: value in KINDS) if key == KIND else is_number
    if not isinstance(values, list) or not 2 <= len(values) <= MOST_VALUES or not all(map(is_value, values)):
        raise NotASweep(f"a sweep needs 2 to {MOST_VALUES} finite numbers, or kinds of modulation")
    if not all(map(is_number, more.values())):
        raise NotASweep("a value of the sweep is not a finite number")
    return key, values if key == KIND else [float(v) for v in values], {name: float(v) for name, v in more.items()}


def clean(value: Any) -> float | None:
    """The number, or None for a cell without a value, which JSON cannot express."""
    number = float(value)
    return number if math.isfinite(number) else None


def unused(folder: Path, name: str) -> str:
    """The name, followed by a number if this folder contains it: two sweeps can start within a second."""
    names = itertools.chain([name], (f"{name}-{number}" for number in itertools.count(2)))
    return next(new for new in names if not (Path(folder) / new).exists())


class Sweeps:
    def __init__(self, folder: str) -> None:
        self.folder = Path(folder)
        self.finished: list[Path] = []  # output folders of complete sweeps; their places are the numbers of their reports
        self.task: asyncio.Task | None = None
        self.is_stopping = False

    @property
    def is_running(self) -> bool:
        return self.task is not None and not self.task.done()

    def start(self, job: str, key: Any, values: Any, more: Any, report: Report) -> None:
        """Starts a sweep of a job, in which the keys of `more` are set; `report` gets messages about its progress. Raises NotASweep."""
        key, values, more = checked(key, values, more)
        if self.is_running:
            raise NotASweep("a sweep is running; stop it or wait for its end")
        self.is_stopping = False
        self.task = asyncio.create_task(self.work(job, key, values, more, report))

    def stop(self) -> None:
        self.is_stopping = True

    async def close(self) -> None:
        self.stop()
        if self.task is not None and not self.task.done():
            await self.task

    async def work(self, job: str, key: str, values: list, more: dict[str, float], report: Report) -> None:
        loop = asyncio.get_running_loop()

        def progress(found: shearwake.Progress) -> None:
            if self.is_stopping:
                raise StopRequested
            loop.call_soon_threadsafe(report, {"state": "running", "done": found.done, "total": found.total,
                                               **points(self.folder / name, key)})

        name = unused(self.folder, time.strftime("explore-%Y%m%d-%H%M%S"))

        try:
            report(await asyncio.to_thread(self.run, job, key, values, more, name, progress))
        except StopRequested:
            report({"state": "stopped"})
        except Exception as error:  # whatever the job contains, the page must show that the sweep has ended
            report({"state": "failed", "message": str(error) or type(error).__name__})

    def run(self, job: str, key: str, values: list, more: dict[str, float], name: str,
            progress: Callable[[shearwake.Progress], None]) -> dict:
        """Runs the sweep in an output folder of its own and returns its table."""
        with tempfile.TemporaryDirectory(prefix="shearwake-explore-") as temporary:
            tables = shearwake.Job(job + "\n").tables
            for other in OTHER_CASES:
                tables.pop(other, None)
            made = shearwake.Job(tables).sweep({key: values}, x=key).change({**more, "job.name": name, "record.frames": False})
            made.folder = Path(temporary)
            sweep = made.run(out=self.folder / name, progress=progress)
        self.finished.append(sweep.folder)
        return {"state": "done", "folder": os.fspath(sweep.folder), "report": len(self.finished) - 1, **points(sweep.folder, key)}

    def report(self, number: int) -> str | None:
        """The page of a complete sweep; None if there is no sweep of this number. Raises shearwake.ProgramError."""
        if not 0 <= number < len(self.finished):
            return None
        return shearwake.open(self.finished[number]).report().read_text(encoding="utf-8")


def points(folder: Path, key: str) -> dict[str, Any]:
    """The columns and the rows of the complete cases of a sweep, also of an active one."""
    try:
        cases = [case for case in shearwake.open(folder).cases if case.is_complete]
        values = [case.values for case in cases]
    except (shearwake.ShearwakeError, OSError, ValueError):
        return {"columns": [key], "rows": []}  # the folder is being made
    shown = [column for column in COLUMNS if any(column in row for row in values)]
    rows = [[case.settings[key], *(clean(row.get(column, math.nan)) for column in shown)] for case, row in zip(cases, values)]
    return {"columns": [key, *shown], "rows": rows}
