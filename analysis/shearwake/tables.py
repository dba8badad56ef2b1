# SPDX-License-Identifier: BSD-3-Clause
"""The tables that the program writes in addition to that of the cases: statistics, sensitivity, adaptive axes and optima."""
from __future__ import annotations

import csv
import io
import json
import math
from pathlib import Path
from typing import Any, Callable

from .inputs import text_of

ESTIMATES = ("value", "low_95", "high_95", "samples", "without_value")
INTERVALS = ("from", "to", "location", "value", "estimated_error")

Row = dict[str, Any]


def _rows(path: Path, is_number: Callable[[str], bool]) -> list[Row]:
    """The rows of a CSV file, with the cells of columns of numbers as float; NaN: empty. Without a file it is empty."""
    if not path.exists():
        return []
    return [{name: (float(cell) if cell else math.nan) if is_number(name) else cell for name, cell in row.items()}
            for row in csv.DictReader(io.StringIO(text_of(path), newline=""))]


def read_statistics(folder: Path, name: str) -> list[Row]:
    """The rows of tables/NAME.statistics.csv, without a file none. Raises OSError and ValueError."""
    return _rows(folder / "tables" / f"{name}.statistics.csv", ESTIMATES.__contains__)


def read_sensitivity(folder: Path, name: str) -> list[Row]:
    """The rows of tables/NAME.sensitivity.csv, without a file none. Raises OSError and ValueError."""
    return _rows(folder / "tables" / f"{name}.sensitivity.csv", ESTIMATES.__contains__)


def read_adaptive(folder: Path, name: str) -> list[Row]:
    """The rows of tables/NAME.adaptive.csv, without a file none. Raises OSError and ValueError."""
    return _rows(folder / "tables" / f"{name}.adaptive.csv", INTERVALS.__contains__)


class Optima:
    """What `shearwake optimise` wrote to the folder `optimise` of a sweep."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder / "optimise"

    @property
    def exists(self) -> bool:
        return (self.folder / "table.csv").is_file()

    @property
    def rows(self) -> list[Row]:
        """One row per case and strength; columns that end in _1 are dimensionless numbers. Raises OSError, ValueError."""
        return _rows(self.folder / "table.csv", lambda name: name.endswith("_1"))

    @property
    def maximised(self) -> str:
        """The column that was maximised. Raises OSError and IndexError."""
        return text_of(self.folder / "study.txt").splitlines()[0].partition(" = ")[2]

    @property
    def uniformity(self) -> float:
        """The required uniformity along the path; 0 without one. Raises OSError."""
        lines = text_of(self.folder / "study.txt").splitlines()
        return next((float(line.partition(" = ")[2]) for line in lines if line.startswith("uniformity = ")), 0.0)

    def optimum(self, case_id: str, strength: float) -> dict[str, Any]:
        """The optimum of a case at a strength, as in its JSON file. Raises OSError and ValueError."""
        return self._json(f"{case_id}.strength-{strength:g}.json")

    def forms(self, case_id: str) -> dict[str, Any]:
        """The quadratic forms of a case, as in their JSON file. Raises OSError and ValueError."""
        return self._json(f"{case_id}.forms.json")

    def _json(self, name: str) -> dict[str, Any]:
        return json.loads(text_of(self.folder / name))
