# SPDX-License-Identifier: BSD-3-Clause
"""Units that files of scans state as text."""
import re
from typing import Any

from .scan import BadScan

LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
UNLABELLED = ("", "none", "unknown")
# Other spellings of units in lower case, as regular expressions, and what replaces them. Micro may be UTF-8 that was read as Latin-1.
SPELLINGS = ((r"[\s.\u00b7*_()\[\]]", ""), ("\u00e2?\u00b5|\u00ee\u00bc|\u03bc", "u"), ("per", "/"), ("\\^?-1|\u207b\u00b9", "-1"), ("(.*)s-1", r"\1/s"),
             ("met(?:er|re)s?", "m"), ("milli", "m"), ("micro(?=[ms])", "u"), ("microns?", "um"), ("centi", "c"),
             ("nano", "n"), ("sec(?:ond)?s?$", "s"))
UNIT = ("unit", "units")
QUANTITIES = ("velocity", "velocities", "speed", "vel", "v", "x", "y", "xy", "time", "times", "t", "coordinate", "coordinates", "position",
              "positions")
OF_ALL = ("of", "in", "the", "all", "data", "values", "length", "lengths", "distance", "label", "name", "symbol", "string")
IMPERIAL = ("in", "inch", "inches", "ft", "foot", "feet")


def metres(per_metre: float) -> str:
    """The unit of length, as text."""
    return next((name for name, size in LENGTHS.items() if abs(size * per_metre - 1.0) < 1e-9), f"{1.0 / per_metre:.6g} m")


def plain_unit(text: str) -> str:
    """A unit in lower case, with abbreviations of ASCII and "/" for divisions: "Millimetres per second" is "mm/s"."""
    text = text.lower()
    for spelling, plain in SPELLINGS:
        text = re.sub(spelling, plain, text)
    return text


def unit_label(line: str) -> str | None:
    """The unit of a record, None if there is none."""
    text = plain_unit(line[47:67])
    return None if text in UNLABELLED else text


def speed_of(label: str) -> float | None:
    length, _, time = label.partition("/")
    return LENGTHS.get(length) if TIMES.get(time) == 1.0 else None


def words_of(name: str) -> set[str]:
    """The words of a name in lower case: velocityUnit, velocity_unit and velocityunit have two."""
    spaced = re.sub(r"(?i)(?<=[a-z])units?$", r"_\g<0>", name)
    return {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", spaced)}


def is_unit_name(name: str) -> bool:
    """Whether a name is that of the unit of what is read: of velocities, coordinates, times or all values."""
    words = words_of(name)
    return not words.isdisjoint(UNIT) and (words <= {*UNIT, *OF_ALL} or not words.isdisjoint(QUANTITIES))


def is_foreign(unit: str) -> bool:
    """Whether a plain unit is one of length, time or speed, but not one of SI."""
    return (unit.partition("/")[0] in (*LENGTHS, *IMPERIAL, "km") or unit in TIMES) and unit not in ("m", "s", "m/s")


def text_of(value: Any) -> str:
    if getattr(value, "size", 0) == 1 and hasattr(value, "item"):
        value = value.item()
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def check_unit(name: str, value: Any) -> None:
    """Rejects a stated unit of length, time or speed that is not one of SI: it would be ignored."""
    if is_unit_name(name):
        refuse_foreign(name, value)


def refuse_foreign(name: str, value: Any) -> None:
    text = text_of(value)
    words = [plain_unit(word) for word in re.split(r"[,;:\s()]+", text)]
    if any(map(is_foreign, (plain_unit(text), *(word for word in words if word != "in" or len(words) == 1)))):  # "velocity in m/s"
        raise BadScan(f"{name} is \"{text.strip()[:20]}\", but values are read in m, s and m/s; convert them and remove it")
