# SPDX-License-Identifier: BSD-3-Clause
"""A scan of a laser vibrometer: velocities of points of the skin along a line of sight. Units are SI."""
from dataclasses import dataclass, field
from typing import Any

import numpy as np

MOST_POINTS, MOST_VALUES = 1_000_000, 500_000_000


class BadScan(Exception):
    """A file is not a usable scan; the text states why."""


@dataclass
class Scan:
    time_s: np.ndarray  # (time,), uniform
    x_m: np.ndarray  # (point,)
    y_m: np.ndarray  # (point,)
    velocity_m_s: np.ndarray  # (point, time); NaN: no signal
    quality: Any = None  # np.ndarray (point,), 0 to 1; 0: no signal
    trigger_delay_s: float = 0.0  # from the start of the load to time 0
    direction: tuple = (0.0, 0.0, 1.0)  # line of sight, into the skin
    notes: list = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.quality is None:
            self.quality = np.where(np.all(np.isfinite(self.velocity_m_s), axis=1), 1.0, 0.0)

    @property
    def rate_Hz(self) -> float:
        return (len(self.time_s) - 1) / (self.time_s[-1] - self.time_s[0])
