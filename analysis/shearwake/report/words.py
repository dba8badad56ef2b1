# SPDX-License-Identifier: BSD-3-Clause
"""Formats keys, units and numbers for figures and their captions."""
import math
import tomllib
from collections.abc import Iterable

from ..keys import label, shown_unit, split_unit

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

POLYGONS = {3: "triangle", 4: "square", 5: "pentagon", 6: "hexagon"}


def axis_label(key: str, title: str = "") -> str:
    """'AM frequency (Hz)'; the title replaces the label of the key."""
    name, unit = title or label(key), shown_unit(key)
    name = name[:1].upper() + name[1:]
    return f"{name} ({unit})" if unit else name


def number(value: float | None, digits: int = 4) -> str:
    """The number with `digits` significant digits, a true minus sign, and a power of ten for very small or
    large numbers; '' for NaN."""
    if value is None or not math.isfinite(value):
        return ""
    if value == 0 or 1e-4 <= abs(value) < 1e6:
        rounded = float(f"{value:.{digits}g}") + 0.0  # without the sign of zero
        decimals = 0
        if rounded:
            decimals = max(0, digits - 1 - math.floor(math.log10(abs(rounded))))
        shown = f"{rounded:.{decimals}f}"
        if decimals:
            shown = shown.rstrip("0").rstrip(".")
    else:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        if "." in mantissa:
            mantissa = mantissa.rstrip("0").rstrip(".")
        shown = f"{mantissa}×10{str(int(exponent)).translate(SUPERSCRIPTS)}"
    return shown.replace("-", "\N{MINUS SIGN}")


def millimetres(value: float) -> str:
    """A coordinate in mm, rounded to 1 um: the coordinates of pins have rounding errors."""
    return number(round(float(value), 3))


def amount_text(key: str, value: str | float) -> str:
    """The value with its unit, next to the name of its key: '200 Hz', '3 mm', 'AM-STM'."""
    if isinstance(value, str):
        if split_unit(key)[0] == "foci":
            count = value.count("[") - 1
            return "1 focus" if count == 1 else f"{count} foci"
        return table_text(value) if value.startswith("{") else value
    unit = shown_unit(key)
    gap = "" if unit in ("", "°") else "\u00a0"
    return f"{number(float(value), 6)}{gap}{unit}"


def value_text(key: str, value: str | float) -> str:
    """The value with its unit. "4 m/s" alone could be the speed of the focus: 'cs 4 m/s'."""
    word = split_unit(key)[0]
    return f"{word.replace('_', '')} " * (word in ("c_s", "c_p")) + amount_text(key, value)


def setting_text(name: str, key: str, value: str | float) -> str:
    """Key, value and unit: 'AM frequency 200 Hz', 'metacarpal 8 mm deep', 'shear-wave speed of body 1 = 5 m/s', 'modulation AM-STM',
    'without modulation', '4 foci'. `name` is the label of the key."""
    title, _, place = name.partition(", ")
    amount = amount_text(key, value)
    if split_unit(key)[0] in ("foci", "preset"):
        return f"{amount}, {place}" if place else amount
    if title == "depth" and place:
        return f"{place} at a depth of {amount}" if place.startswith("body ") else f"{place} {amount} deep"
    if value == "unmodulated":
        return "without modulation"
    return f"{title} of {place} = {amount}" if place else f"{title} {amount}"


def table_text(value: str) -> str:
    """'{ shape = "circle", radius_mm = 15 }' -> 'circle, radius 15 mm'."""
    try:
        entries = tomllib.loads("value = " + value)["value"]
    except tomllib.TOMLDecodeError:
        return value
    shape = entries.pop("shape", "")
    if shape == "polygon" and entries.get("sides") in POLYGONS:
        shape = POLYGONS[entries.pop("sides")]
    words = [entries.pop("preset", shape)] if "preset" in entries or shape else []
    for key, entry in entries.items():
        is_number = isinstance(entry, (int, float)) and not isinstance(entry, bool)
        name = {"fwhm": "FWHM"}.get(split_unit(key)[0], label(key))
        words.append(f"{name} {value_text(key, entry) if is_number else entry}")
    return ", ".join(words)


def counted(count: int, noun: str) -> str:
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"


OTHERS = "shearwake report --only ID[,ID] draws others"


def some_of(count: int, every: int, noun: str) -> str:
    """'3 of 8 cases are drawn'; `noun` is in the singular."""
    return f"{count} of {counted(every, noun)} {'is' if count == 1 else 'are'} drawn"


def listed(words: Iterable[str]) -> str:
    words = list(words)
    return words[0] if len(words) == 1 else ", ".join(words[:-1]) + " and " + words[-1]


def strongest_text(several: Iterable[Iterable[float]]) -> str:
    """The end of a caption about the foci that were chosen among simultaneous ones; empty for none."""
    places = dict.fromkeys(f"({millimetres(x)}, {millimetres(y)})" for x, y in several)
    return f" Of several simultaneous foci the one with the largest displacement is taken: {', '.join(places)} mm." if places else ""
