# SPDX-License-Identifier: BSD-3-Clause
"""A scan of a laser vibrometer: velocities of points of the skin along a line of sight. Units are SI."""
from dataclasses import dataclass, field, replace
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
    direction: tuple = (0.0, 0.0, 1.0)  # of positive velocities, with z into the skin; read_scan makes its z positive
    notes: list = field(default_factory=list)  # how a file was read
    states_direction: bool = False  # the file contains the direction

    def __post_init__(self) -> None:
        if self.quality is None:
            self.quality = np.where(np.all(np.isfinite(self.velocity_m_s), axis=1), 1.0, 0.0)

    def along_z(self, z_outwards: bool = False) -> "Scan":
        """The same motion with a direction that points into the skin. `z_outwards`: z of this scan points out of the skin, so
        that positive velocities do, too, unless the direction states otherwise."""
        x, y, z = self.direction
        z = -z if z_outwards else z
        if z >= 0.0 and not z_outwards:
            return self
        sign = -1.0 if z < 0.0 else 1.0
        return replace(self, velocity_m_s=sign * self.velocity_m_s, direction=(sign * x, sign * y, sign * z))

    @property
    def rate_Hz(self) -> float:
        return (len(self.time_s) - 1) / (self.time_s[-1] - self.time_s[0])
