# SPDX-License-Identifier: BSD-3-Clause
"""The structures of a k-Wave simulation, with the values of their fields in the order of indices of MATLAB."""
from __future__ import annotations

from typing import Any, NoReturn

import numpy as np


class BadInput(Exception):
    """An error that the user can correct."""


class Unreadable:
    """A value that cannot be used, such as an object or a complex number. It causes an error only if the field is
    needed."""

    def __init__(self, reason: str) -> None:
        self.reason = reason


def kind_of(value: Any) -> str:
    """The type of a value in the words of MATLAB."""
    if isinstance(value, dict):
        return "a struct"
    if isinstance(value, list):
        return "a cell array of " + " and ".join(sorted({kind_of(item) for item in value}))
    if isinstance(value, str):
        return f"the text \"{value:.20}\""
    return "numbers" if isinstance(value, np.ndarray) else "nothing" if value is None else value.reason


class Structure:
    """A struct. The values of `fields` are arrays of float64 (a scalar has the shape ()), texts, lists of values for
    cell arrays, dictionaries for structs, or Unreadable."""

    def __init__(self, fields: dict[str, Any], name: str) -> None:
        self.values, self.name = fields, name

    def __contains__(self, field: str) -> bool:
        return self.values.get(field) is not None

    def fields(self) -> list[str]:
        return sorted(field for field in self.values if field in self)

    def _refuse(self, field: str, wanted: str) -> NoReturn:
        value = self.values[field]
        reason = f": {value.reason}" if isinstance(value, Unreadable) else f" but {kind_of(value)}"
        raise BadInput(f"{self.name}.{field} does not contain {wanted}{reason}")

    def array(self, field: str) -> np.ndarray:
        """The array with the order of indices of MATLAB; the shape of a scalar is ()."""
        value = self.values[field]
        while isinstance(value, list) and len(value) == 1:
            value = value[0]
        if not isinstance(value, np.ndarray):
            self._refuse(field, "numbers")
        if not np.all(np.isfinite(value)):
            raise BadInput(f"{self.name}.{field} contains a number that is not finite")
        return value.reshape(()) if value.size == 1 else value

    def number(self, field: str, default: float | None = None) -> float:
        if field not in self:
            if default is None:
                raise BadInput(f"{self.name}.{field} is missing")
            return default
        values = self.array(field)
        if values.shape != ():
            raise BadInput(f"{self.name}.{field} has the shape {values.shape}; it must be one number")
        return float(values)

    def text(self, field: str, default: str) -> str:
        found = self.texts(field, [default])
        if len(found) != 1:
            raise BadInput(f"{self.name}.{field} contains {len(found)} texts; it must be one")
        return found[0]

    def texts(self, field: str, default: list[str]) -> list[str]:
        """The texts of a cell array, or a single text."""
        if field not in self:
            return default
        value = self.values[field]
        items = value if isinstance(value, list) else [value]
        found = [text for item in items if (text := text_of(item)) is not None]
        if len(found) < len(items):
            self._refuse(field, "text")
        return found


def text_of(value: Any) -> str | None:
    """The text of a value; nothing if it is not a text."""
    while isinstance(value, list) and len(value) == 1:
        value = value[0]
    if isinstance(value, str):
        return value
    # Codes of characters that were stored as numbers.
    if isinstance(value, np.ndarray) and value.size and np.all((value == np.floor(value)) & (value > 0) &
                                                               (value < 0xd800)):
        return "".join(chr(int(code)) for code in value.ravel())
    return None


class Simulation:
    """Grid, absorbing layer, medium, sources and sensor of a simulation, in SI units."""

    points: np.ndarray
    spacing_m: np.ndarray
    first: np.ndarray  # index of the first point of kgrid in the enlarged grid
    layer_points: np.ndarray
    layer_strength: np.ndarray
    layer_ratio: float
    reference_speed_m_s: float  # of the layer
    medium: dict[str, np.ndarray]
    time_step_s: float
    steps: int
    sources: list[dict[str, Any]]
    p0_Pa: np.ndarray | None  # smoothed, on the enlarged grid
    sensor_fields: list[str]
    sensor_nodes: np.ndarray
    sensor_weights: np.ndarray | None  # (point, 8) of Cartesian points
    sensor_start: int
    cuboids: np.ndarray | None  # (cuboid, 6), counted from 0
    options: Structure
    notes: list[str]
    warnings: list[str]

    @property
    def dimensions(self) -> int:
        """Two for a plane, whose grid has one node along z."""
        return 2 if self.points[2] == 1 else 3
