# SPDX-License-Identifier: BSD-3-Clause
"""Trigger delay and direction of a scan, by the names that files use."""
import difflib
from collections.abc import Callable
from typing import Any

from .scan import BadScan

NOT_A_SCAN = "it is not a scan: "
SETTINGS = ("trigger_delay", "direction_x", "direction_y", "direction_z")
DELAYS = {f"trigger_delay{unit}": to_s for unit, to_s in (("", 1.0), ("_s", 1.0), ("_ms", 1e-3), ("_us", 1e-6))}

RESEMBLING = {**{name: name for name in (*DELAYS, *SETTINGS)}, "direction": "direction_z",
              **{name.removeprefix("trigger_"): name for name in DELAYS}}


def settings(given: dict[str, Any], one: Callable[[Any, str], float], notes: list) -> dict[str, Any]:
    """Trigger delay and direction as arguments of Scan. `given`: all names of a file with their values; one(value, name) converts
    one number. A name that resembles a setting is an error, since its value would be ignored."""
    delays = [name for name in DELAYS if name in given]
    if len(delays) > 1:
        raise BadScan(f"it contains both {delays[0]} and {delays[1]}")
    for name in given:
        if name not in DELAYS and name not in SETTINGS:
            near = difflib.get_close_matches(name.lower(), RESEMBLING, n=1, cutoff=0.8)
            if near:
                raise BadScan(f"{name} is unknown; did you mean {RESEMBLING[near[0]]}?")
    delay_s = DELAYS[delays[0]] * one(given[delays[0]], delays[0]) if delays else 0.0
    direction = tuple(one(given[name], name) if name in given else fallback
                      for name, fallback in (("direction_x", 0.0), ("direction_y", 0.0), ("direction_z", 1.0)))
    return {"trigger_delay_s": delay_s, "direction": direction, "notes": notes,
            "states_direction": any(name in given for name in SETTINGS[1:])}
