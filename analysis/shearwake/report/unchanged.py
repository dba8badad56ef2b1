# SPDX-License-Identifier: BSD-3-Clause
"""Reuses figures of the previous report whose code and data have not changed.

DIR/report/figures.json maps the name of a group of figures to a hash of everything that the group depends on, and
to what its drawing returned. The pictures lie next to it.
"""
from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

from .. import inputs
from . import layout, medium_files
from .figure import Figure, small_picture
from .load import Selection, remembered
from .page.chart import Chart, chart_data

NAME = "figures.json"
MEDIUM_FILES = ("medium.map", "solver.pstd.study")
HERE = Path(__file__).resolve().parent


def code_hash() -> str:
    """Of all modules of the report and of the package, and of the version of matplotlib."""
    parts = [matplotlib.__version__.encode()]
    parts += [path.read_bytes() for path in sorted([*HERE.rglob("*.py"), *HERE.parent.glob("*.py")])]
    return hashlib.sha256(b"\0".join(parts)).hexdigest()


def stamp(path: Any) -> list[int | str] | None:
    """Size and time of the last change of a file, None without one. A case that is computed again is a new file."""
    try:
        found = path.stat()
        return [str(path), found.st_size, found.st_mtime_ns]
    except (AttributeError, OSError):
        return None


@remembered
def facts(selection: Selection) -> list[Any]:
    """Everything that figures read from a selection, apart from the contents of the case files."""
    sweep = selection.sweep
    return [sweep.name, sweep.title, sweep.swept_keys, selection.x, sweep.series_keys, sweep.columns, selection.label_keys,
            sorted(map(str, layout.labels(selection).items())),
            sweep.uncertain, sweep.adaptive_axes, stamp(sweep.folder / "optimise" / "table.csv"),
            [[c.id, c.settings, c.is_reference, c.reference_id, c.status, c.reason, c.note, c.values] for c in selection.cases],
            [[c.warnings, stamp(c.path), [stamp(medium_files.file_of(sweep.folder, sweep.job_text, c, key)) for key in MEDIUM_FILES]]
             for c in selection.cases if c.is_complete]]


def plain(value: Any) -> Any:
    """Values of the JSON file: figures as dictionaries, charts with few digits, numpy values as numbers and lists."""
    if isinstance(value, Figure):
        return vars(value)
    if isinstance(value, Chart):
        return chart_data(value)
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} cannot be stored")


class Drawn:
    """The figures of the previous report, and those of the new one in the folder `part`."""

    def __init__(self, folder: Path, part: Path) -> None:
        self.folder, self.part, self.code, self.reused = folder, part, code_hash(), 0
        self.new: dict[str, Any] = {}
        try:
            self.old = json.loads(inputs.text_of(folder / NAME))
        except (OSError, ValueError):
            self.old = {}

    def key(self, name: str, selection: Selection) -> str:
        text = json.dumps([self.code, name, facts(selection)], default=str, sort_keys=True)
        return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()

    def draw(self, name: str, draw: Callable[..., Any], selection: Selection, *arguments: Path) -> list[Figure] | str:
        """The result of draw(selection, *arguments): figures with charts as JSON objects, or a text. If nothing has
        changed it is that of the previous report."""
        key, before = self.key(name, selection), self.old.get(name, {})
        if before.get("key") == key and self.reuse(before["files"]):
            self.new[name] = before
            self.reused += 1
        else:
            result = draw(selection, *arguments)
            made = [] if isinstance(result, str) else result
            for figure in made:
                figure.still = small_picture(self.part / f"{figure.name}.png", 2 if figure.charts else 1)
            files = sorted(path.name for figure in made for suffix in (".png", ".pdf")
                           if (path := self.part / (figure.name + suffix)).exists())
            self.new[name] = {"key": key, "files": files,
                              "result": json.loads(json.dumps(result, default=plain))}
        result = self.new[name]["result"]
        return result if isinstance(result, str) else [Figure(**figure) for figure in result]

    def reuse(self, files: list[str]) -> bool:
        """Copies the pictures of the previous report. Returns whether all of them exist."""
        if not all((self.folder / name).is_file() for name in files):
            return False
        for name in files:
            try:
                os.link(self.folder / name, self.part / name)
            except OSError:
                shutil.copyfile(self.folder / name, self.part / name)
        return True

    def save(self) -> None:
        (self.part / NAME).write_text(json.dumps(self.new), encoding="utf-8")
