# SPDX-License-Identifier: BSD-3-Clause
"""A scan of a laser vibrometer: velocities of points of the skin along a line of sight. Units are SI."""
import math
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from ..inputs import shown

LEAST_DIGITS = 4
MOST_POINTS, MOST_VALUES = 1_000_000, 500_000_000


class BadScan(Exception):
    """A file is not a usable scan; the text states why."""

    def __init__(self, text: str) -> None:
        super().__init__(shown(text))


def half_unit(text: str) -> float:
    """Half a unit of the last digit of a printed number: its largest error by rounding."""
    mantissa, _, exponent = text.strip().lower().replace("d", "e").partition("e")
    digits = len(mantissa.partition(".")[2])
    return 0.5 * 10.0 ** (int(exponent or 0) - digits)


def rounding_of(words: Iterable[str]) -> float:
    """The largest error of printed numbers by rounding. Numbers of fewer than four digits are not taken as rounded."""
    largest, most = 0.0, 0
    for word in words:
        mantissa = word.strip().lower().partition("e")[0].lstrip("+-")
        most = max(most, len(mantissa.replace(".", "").lstrip("0")))
        largest = max(largest, abs(float(word)))
    return 0.5 * 10.0 ** (math.floor(math.log10(largest)) - most + 1) if most >= LEAST_DIGITS and 0.0 < largest < math.inf else 0.0


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
    rate_rounding: float = 0.0  # the largest relative error of the rate by rounding of the printed or stored times

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

    def with_rate_of(self, period_s: float) -> "Scan":
        """With the rate that has a whole number of samples in a period, if the printed times allow it; otherwise unchanged."""
        samples = period_s * self.rate_Hz
        count = round(samples)
        if count < 2 or abs(samples - count) > 1.00001 * self.rate_rounding * samples:  # a step may be rounded by exactly half a unit
            return self
        return replace(self, time_s=self.time_s[0] + np.arange(len(self.time_s)) * (period_s / count))

    @property
    def rate_Hz(self) -> float:
        return (len(self.time_s) - 1) / (self.time_s[-1] - self.time_s[0])
