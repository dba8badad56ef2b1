# SPDX-License-Identifier: BSD-3-Clause
"""Trigger delay and direction of a scan, and names that state what would be ignored."""
import difflib
import re
from collections.abc import Callable
from typing import Any

import numpy as np

from .scan import BadScan
from .units import QUANTITIES, is_unit_name, text_of, words_of

NOT_A_SCAN = "it is not a scan: "
SETTINGS = ("trigger_delay", "direction_x", "direction_y", "direction_z")
DELAYS = {f"trigger_delay{unit}": to_s for unit, to_s in (("", 1.0), ("_s", 1.0), ("_ms", 1e-3), ("_us", 1e-6))}

# Words of names that state how values are meant, and the numbers that change nothing.
UNCHANGED: dict[str, Any] = {"direction": (0.0, 0.0, 1.0), **dict.fromkeys(("delay", "pretrigger", "offset"), 0.0),
                             **dict.fromkeys(("scale", "scaling", "factor", "sign", "polarity", "positive"), 1.0)}
# Words next to them; others make another quantity of them: crest factor.
BESIDE = {*QUANTITIES, "z", "of", "the", "add", "trigger", "s", "ms", "us", "ns", "min"}
AGAINST = r"\s*-|.*\b(neg|inv|rev|flip|oppos|outward|out of the|up\b|upward|[xy]\b)"  # texts about directions


def resembled(name: str) -> str | None:
    """The setting that a misspelt name resembles."""
    near = difflib.get_close_matches(name.lower(), (*DELAYS, *SETTINGS), n=1, cutoff=0.905)
    return near[0] if near else None


def has_meaning(name: str) -> bool:
    """Whether a name is that of a setting or a unit, or may state how values are meant."""
    return is_unit_name(name) or not words_of(name).isdisjoint(UNCHANGED) or resembled(name) is not None


def is_ignored(name: str, value: Any, of: str = "") -> bool:
    """Whether a name states how values are meant, without effect. A scale, an offset or a direction of what is read is an error.
    `of`: the data set of an attribute."""
    words = words_of(name)
    kind = next((word for word in UNCHANGED if word in words), None)
    if kind is None or (not of and name in (*DELAYS, *SETTINGS)):
        return False
    try:
        differs = not np.allclose(np.ravel(np.asarray(value, dtype=float)), UNCHANGED[kind], rtol=0.0, atol=0.0)
    except (TypeError, ValueError):  # a text, or another number of components
        differs = re.match(AGAINST if UNCHANGED[kind] else ".*[1-9]", text_of(value).lower()) is not None  # "5 ms"
        if not differs:
            return True
    if differs and words <= {*UNCHANGED, *BESIDE}:
        setting = {"direction": "direction_z", "delay": "trigger_delay"}.get(kind)
        raise BadScan(f"{name}{of} would be ignored; "
                      + (f"state it as {setting} of the file" if setting else "apply it to the values, and remove it"))
    return differs


def settings(given: dict[str, Any], one: Callable[[Any, str], float], notes: list) -> dict[str, Any]:
    """Trigger delay and direction as arguments of Scan. `given`: all names of a file with their values; one(value, name) converts
    one number. A name that resembles a setting is an error, since it would be ignored."""
    delays = [name for name in DELAYS if name in given]
    if len(delays) > 1:
        raise BadScan(f"it contains both {delays[0]} and {delays[1]}")
    for name in given:
        if name not in DELAYS and name not in SETTINGS and (near := resembled(name)):
            raise BadScan(f"{name} is unknown; did you mean {near}?")
    delay_s = DELAYS[delays[0]] * one(given[delays[0]], delays[0]) if delays else 0.0
    direction = tuple(one(given[name], name) if name in given else fallback
                      for name, fallback in (("direction_x", 0.0), ("direction_y", 0.0), ("direction_z", 1.0)))
    return {"trigger_delay_s": delay_s, "direction": direction, "notes": notes,
            "states_direction": any(name in given for name in SETTINGS[1:])}
