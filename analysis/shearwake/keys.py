# SPDX-License-Identifier: BSD-3-Clause
"""Keys of a job and columns of a table: their labels, units and short forms, and access to keys in nested tables."""
from __future__ import annotations

import contextlib
import csv
import functools
import re
import tomllib
from pathlib import Path
from typing import Any, Iterable, Mapping, Sequence

with (Path(__file__).parent / "labels.csv").open(encoding="utf-8", newline="") as _file:  # which the program contains too
    _ROWS = list(csv.reader(_file))
UNITS = {name: (shown, cf) for kind, name, shown, *rest in _ROWS if kind == "unit" for cf in rest}
LABELS = {name: label for kind, name, label, *_ in _ROWS if kind == "name"}
PATTERNS = [(re.compile(re.sub(r"\{(\w+)\}", r"(?P<\1>.+?)", name)), label) for name, label in LABELS.items() if "{" in name]


def split_unit(key: str) -> tuple[str, str]:
    """The last part of a key without its unit, and the unit as it is written in the key; empty without one."""
    word = key.split(".")[-1]
    found = max((unit for unit in UNITS if word.endswith("_" + unit) and len(word) > len(unit) + 1), key=len, default="")
    return (word[: -len(found) - 1], found) if found else (word, "")


def follows(settings: Iterable[Mapping[str, Any]], key: str, other: str) -> bool:
    """Whether the value of `key` is determined by that of `other` in all settings."""
    pairs = {(str(values.get(other)), str(values.get(key))) for values in settings}
    return len(pairs) == len({value for value, _ in pairs})


@functools.cache
def label(name: str) -> str:
    """The label of a key, a column or a quantity over time, without its unit: "medium.layer[1].c_s_m_s" -> "shear-wave speed, layer 1",
    "eta_period_1" -> "efficiency η". Words of a name without a label are those of the name."""
    last = re.sub(r".*\.(?=[A-Za-z])", "", name)  # not the point of a depth, as in "eta_at_1_z1.5mm"
    for end, extended in ((r"_error", "{}, error"), (r"_z([-+\d.e]+)mm", r"{}, z = \1 mm")):
        if found := re.fullmatch("(.+)" + end, last):
            return extended.replace(r"\1", found[found.lastindex or 1]).format(label(found[1]))
    word = split_unit(last)[0]
    text = LABELS.get(last) or LABELS.get(word)
    if text is None:
        matches = ((pattern.fullmatch(last), shown) for pattern, shown in PATTERNS)
        text = next((shown.format(**match.groupdict()) for match, shown in matches if match), word.replace("_", " "))
    place = re.search(r"\b(layer|body)\W*(\d+)", name)
    return f"{text}, {place[1]} {place[2]}" if place else text


def shown_unit(name: str) -> str:
    """The unit of a key or of a column as in figures: "µm" of "peak_um", empty for a number."""
    last = re.sub(r"_error$|_z[-+\d.e]+mm$", "", name)
    return UNITS.get(split_unit(last)[1], ("",))[0]


def axis_label(name: str) -> str:
    """The label with its unit: "AM frequency (Hz)"."""
    unit = shown_unit(name)
    return f"{label(name)} ({unit})" if unit else label(name)


def is_at_instant(column: str) -> bool:
    """Whether a column is read at one instant. Its values depend on the phase of the modulation: they follow those over periods, and
    figures do not join them."""
    return "_at_" in column


def described(name: str, unit: str, meaning: str) -> dict[str, str]:
    """The attributes of a variable of xarray: a short `long_name`, a sentence as `description`, and `units`."""
    found = {"long_name": label(name), "description": meaning, "units": cf_unit(unit)}
    return {attribute: text for attribute, text in found.items() if text}


def cf_unit(unit: str) -> str:
    """A unit of a key, a column or a case file in a notation that UDUNITS and pint read: "mm2" -> "mm^2", "kg_m3" -> "kg/m^3". UDUNITS
    has no decibel."""
    return UNITS[unit][1] if unit in UNITS else re.sub(r"(?<=[A-Za-z])(?=-?\d)", "^", unit)


def short_keys(keys: Sequence[str]) -> dict[str, str]:
    """The name of each key as a dimension: its last part, or the whole key with underscores if several keys end in the same
    part."""
    last = [key.split(".")[-1] for key in keys]
    return {key: word if last.count(word) == 1 else re.sub(r"\W+", "_", key).strip("_") for key, word in zip(keys, last)}


def by_short_key(keys: Sequence[str], short: Mapping[str, Any]) -> dict[str, Any]:
    """Replaces short forms by the keys. Raises KeyError for a word that is not the short form of a key."""
    full = {word: key for key, word in short_keys(keys).items()}
    for word in short:
        if word not in full:
            raise KeyError(f"{word} is not swept; the swept keys are {', '.join(full) or 'none'}")
    return {full[word]: value for word, value in short.items()}


def typed(value: Any) -> Any:
    """A swept value with its type in the job: true and false, which settings contain as text, as bool, and lists as tuples."""
    if isinstance(value, str) and (value in ("true", "false") or value.startswith("[")):
        with contextlib.suppress(tomllib.TOMLDecodeError):
            value = tomllib.loads(f"value = {value}")["value"]
    return tuple(map(typed, value)) if isinstance(value, (list, tuple)) else value


@functools.cache
def job_tables(text: str) -> dict[str, Any]:
    """A job, or one override, as nested tables, which callers must not change; empty if the text is truncated or not TOML."""
    try:
        return tomllib.loads(text.removeprefix("\ufeff"))  # a byte order mark
    except tomllib.TOMLDecodeError:
        return {}


def parts_of(key: str) -> list[str | int]:
    """The parts of a key, with positions in lists counted from 0: "medium.layer[1].c_s_m_s" -> medium, layer, 0, c_s_m_s."""
    found: list[str | int] = []
    for part in key.split("."):
        match = re.fullmatch(r"([^\[\]]+)(?:\[(\d+)\])?", part)
        if match is None or match[2] == "0":
            raise KeyError(f"{key}: a key has the form table.key or table.list[1].key, where lists are counted from 1")
        found.append(match[1])
        if match[2]:
            found.append(int(match[2]) - 1)
    return found


def put(tables: dict[str, Any], key: str, value: Any) -> None:
    """Sets a key of nested tables, and adds missing tables. Raises KeyError for a missing element of a list."""
    *path, last = parts_of(key)
    node: Any = tables
    try:
        for part, following in zip(path, [*path[1:], last]):
            if isinstance(part, str) and part not in node:
                node[part] = [] if isinstance(following, int) else {}
            node = node[part]
        node[last] = value
    except (IndexError, TypeError):
        raise KeyError(f"{key} does not exist in the job") from None
