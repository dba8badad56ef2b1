# SPDX-License-Identifier: BSD-3-Clause
"""Trigger delay and direction of a scan, by the names that files use."""
import difflib
import math
from collections.abc import Callable
from typing import Any

from .scan import BadScan
from .units import is_unit_name, words_of

NOT_A_SCAN = "it is not a scan: "
SETTINGS = ("trigger_delay", "direction_x", "direction_y", "direction_z")
DELAYS = {f"trigger_delay{unit}": to_s for unit, to_s in (("", 1.0), ("_s", 1.0), ("_ms", 1e-3), ("_us", 1e-6))}

RESEMBLING = {**{name: name for name in (*DELAYS, *SETTINGS)}, "direction": "direction_z",
              **{name.removeprefix("trigger_"): name for name in DELAYS}}

# Words of names that change the meaning of values.
MEANINGFUL = {"dimension", "dimensions", "scale", "scaling", "factor", "offset", "direction", "sign", "polarity", "delay", "pretrigger", "fill"}


def resembled(name: str) -> str | None:
    """The setting that a name resembles."""
    near = difflib.get_close_matches(name.lower(), RESEMBLING, n=1, cutoff=0.8)
    return RESEMBLING[near[0]] if near else None


def has_meaning(name: str) -> bool:
    """Whether a name is that of a setting or a unit, or changes the meaning of values."""
    return name in DELAYS or name in SETTINGS or is_unit_name(name) or bool(words_of(name) & MEANINGFUL) or resembled(name) is not None


def settings(given: dict[str, Any], one: Callable[[Any, str], float], notes: list) -> dict[str, Any]:
    """Trigger delay and direction as arguments of Scan. `given`: all names of a file with their values; one(value, name) converts
    one number. A name that resembles a setting, or that changes the meaning of values, is an error, since it would be ignored."""
    delays = [name for name in DELAYS if name in given]
    if len(delays) > 1:
        raise BadScan(f"it contains both {delays[0]} and {delays[1]}")
    for name, value in given.items():
        if name not in DELAYS and name not in SETTINGS:
            if near := resembled(name):
                raise BadScan(f"{name} is unknown; did you mean {near}?")
            if words_of(name) & MEANINGFUL and not (isinstance(value, float) and math.isnan(value)):  # NaN: text of a CSV file
                raise BadScan(f"{name} would be ignored; apply it to the values, and remove it")
    delay_s = DELAYS[delays[0]] * one(given[delays[0]], delays[0]) if delays else 0.0
    direction = tuple(one(given[name], name) if name in given else fallback
                      for name, fallback in (("direction_x", 0.0), ("direction_y", 0.0), ("direction_z", 1.0)))
    return {"trigger_delay_s": delay_s, "direction": direction, "notes": notes,
            "states_direction": any(name in given for name in SETTINGS[1:])}
