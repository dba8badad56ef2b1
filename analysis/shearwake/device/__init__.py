# SPDX-License-Identifier: BSD-3-Clause
"""Files of ultrasonic devices: what they play, and loads for them (docs/how-to/devices.md)."""
from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


class BadFile(ValueError):
    """What is wrong with a file, and where."""


@dataclass
class Played:
    """A list of points (`points_mm`), an envelope, or frames of phases (`phases_rad`: frame by frame). `dwells_s` and `levels`, factors
    of the force, belong to the points or samples."""

    kind: str
    dwells_s: np.ndarray = field(default_factory=lambda: np.empty(0))
    levels: np.ndarray = field(default_factory=lambda: np.empty(0))
    points_mm: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))
    phases_rad: np.ndarray = field(default_factory=lambda: np.empty((0, 0)))
    warnings: list[str] = field(default_factory=list)
