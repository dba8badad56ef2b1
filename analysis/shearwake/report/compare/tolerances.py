# SPDX-License-Identifier: BSD-3-Clause
"""Tolerances of a comparison, by column."""
from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
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


@dataclass(frozen=True)
class Tolerance:
    """`relative` to the reference. `absolute` applies where the reference is 0; without it, `relative` times the largest
    reference of the column does."""
    relative: float
    absolute: float | None = None


def default_tolerance(column: str) -> Tolerance:
    return Tolerance(CANCELLED_SUMS if CANCELLED.fullmatch(column) else ROUNDED)


@dataclass
class Tolerances:
    """The tolerances of columns; "*" is that of columns that are not named."""
    named: dict[str, Tolerance] = field(default_factory=dict)
    ignored: list[str] = field(default_factory=list)

    def for_column(self, column: str, default: Tolerance | None = None) -> Tolerance:
        return self.named.get(column) or self.named.get("*") or default or default_tolerance(column)

    def ignores(self, column: str) -> bool:
        return column in NEVER_COMPARED or column in self.ignored

    def require_columns(self, known: Collection[str]) -> None:
        """Raises BadTolerance for a column that neither side has."""
        for column in (*self.named, *self.ignored):
            if column != "*" and column not in known:
                raise BadTolerance(f"tolerances: neither side has a column {column}{suggestion(column, list(known))}")


def amount(name: str, value: Any) -> float:
    """A number of at least 0. Raises BadTolerance."""
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not 0.0 <= value < math.inf:
        raise BadTolerance(f"{name} must be a number of at least 0, but is {value!r}")
    return float(value)


def read_entry(tolerances: Tolerances, column: str, value: Any) -> None:
    """COLUMN = RELATIVE or COLUMN = { relative = ..., absolute = ... }"""
    if not isinstance(value, dict):
        tolerances.named[column] = Tolerance(amount(column, value))
        return
    tolerance = tolerances.for_column(column)
    for key, part in value.items():
        if key not in ("relative", "absolute"):
            raise BadTolerance(f"{column}.{key} is unknown; the keys are relative and absolute")
        tolerance = replace(tolerance, **{key: amount(f"{column}.{key}", part)})
    tolerances.named[column] = tolerance


def read_file(tolerances: Tolerances, path: Path) -> None:
    """Reads a file such as
        ignore = ["mach_angle_deg"]
        [tolerance]
        eta_at_1 = 1e-5                                   # relative
        peak_um = { relative = 1e-5, absolute = 1e-9 }
        "*" = 1e-6                                        # every column that is not named
    Raises BadTolerance, and OSError if it cannot be read."""
    try:
        content = tomllib.loads(text_of(path))
    except ValueError as error:
        raise BadTolerance(f"it is not valid TOML: {error}") from error
    for key, value in content.items():
        if key == "ignore" and isinstance(value, list) and all(isinstance(name, str) for name in value):
            tolerances.ignored += value
        elif key == "ignore":
            raise BadTolerance('ignore must be a list of columns: ignore = ["peak_um"]')
        elif key == "tolerance" and isinstance(value, dict):
            for column, entry in value.items():
                read_entry(tolerances, column, entry)
        else:
            raise BadTolerance(f"{key} is not valid; a file of tolerances contains the table [tolerance] and, above it, "
                               "ignore = [...]")


def read_tolerances(arguments: Iterable[str]) -> Tolerances:
    """The tolerances of the option --tolerance: COLUMN=RELATIVE, or files that end in .toml. Raises BadTolerance and OSError."""
    tolerances, columns = Tolerances(), []
    for text in arguments:
        if text.endswith(".toml"):
            try:
                read_file(tolerances, Path(text))
            except BadTolerance as error:
                raise BadTolerance(f"{text}: {error}") from error
        else:
            columns.append(text)
    for text in columns:  # they precede those of files
        column, equals, relative = text.rpartition("=")
        try:
            value = amount(column, float(relative))
        except (ValueError, BadTolerance):
            value = math.nan
        if not (column and equals) or math.isnan(value):
            raise BadTolerance("--tolerance requires COLUMN=RELATIVE, as in --tolerance eta_at_1=1e-5, or a file that ends in "
                               f".toml, but got \"{text}\"")
        tolerances.named[column] = replace(tolerances.for_column(column), relative=value)
    return tolerances
