# SPDX-License-Identifier: BSD-3-Clause
"""Tolerances of a comparison, by column."""
from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ...errors import suggestion
from ...inputs import text_of

# Columns that depend on the machine and not on the physics, and `note`, whose causes are compared themselves.
NEVER_COMPARED = ("wall_s", "host", "hosts", "note")
# Tables have nine digits, so two rounded numbers may differ by 1e-8; the factor of 10 allows for values that are fits to or
# ratios of other values.
ROUNDED = 1e-7
CANCELLED_SUMS = 1e-4  # small differences of large numbers
CANCELLED = re.compile(r"ipr_(at|period)_(1|mm2)(_z.*)?")


class BadTolerance(Exception):
    """A tolerance is not valid."""


def default_tolerance(column: str) -> float:
    return CANCELLED_SUMS if CANCELLED.fullmatch(column) else ROUNDED


@dataclass
class Tolerances:
    """The relative tolerances of columns; "*" is that of columns that are not named, and inf excludes a column."""

    named: dict[str, float] = field(default_factory=dict)

    def for_column(self, column: str, default: float | None = None) -> float:
        return self.named.get(column, self.named.get("*", default_tolerance(column) if default is None else default))

    def ignores(self, column: str) -> bool:
        return column in NEVER_COMPARED or self.named.get(column) == math.inf

    def require_columns(self, known: Collection[str]) -> None:
        """Raises BadTolerance for a column that neither side has."""
        for column in self.named:
            if column != "*" and column not in known:
                raise BadTolerance(f"tolerances: neither side has a column {column}{suggestion(column, list(known))}")


def amount(name: str, value: Any) -> float:
    """A number of at least 0, also inf. Raises BadTolerance."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not value >= 0.0:
        raise BadTolerance(f"{name} must be a number of at least 0, but is {value!r}")
    return float(value)


def read_file(path: Path) -> dict[str, float]:
    """The tolerances of a file such as

        [tolerance]
        eta_at_1 = 1e-5
        mach_angle_deg = inf    # not compared
        "*" = 1e-6              # every column that is not named

    Raises BadTolerance, and OSError if it cannot be read."""
    try:
        content = tomllib.loads(text_of(path))
    except ValueError as error:
        raise BadTolerance(f"{path}: it is not valid TOML: {error}") from error
    if list(content) != ["tolerance"] or not isinstance(content["tolerance"], dict):
        raise BadTolerance(f"{path}: a file of tolerances contains the table [tolerance] alone")
    return {column: amount(f"{path}: {column}", value) for column, value in content["tolerance"].items()}


def read_tolerances(arguments: Iterable[str]) -> Tolerances:
    """The tolerances of the option --tolerance: COLUMN=RELATIVE, or files that end in .toml. Raises BadTolerance and OSError."""
    files: dict[str, float] = {}
    columns: dict[str, float] = {}  # they precede those of files
    for text in arguments:
        if text.endswith(".toml"):
            files |= read_file(Path(text))
            continue
        column, _, relative = text.rpartition("=")
        try:
            columns[column] = amount(column, float(relative))
        except (ValueError, BadTolerance):
            column = ""
        if not column:
            raise BadTolerance("--tolerance requires COLUMN=RELATIVE, as in --tolerance eta_at_1=1e-5, or a file that ends in "
                               f".toml, but got \"{text}\"")
    return Tolerances(files | columns)
