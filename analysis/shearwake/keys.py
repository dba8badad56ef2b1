# SPDX-License-Identifier: BSD-3-Clause
"""Keys of a job: their short forms, their units, and access to them in nested tables."""
from __future__ import annotations

import functools
import re
import tomllib
from typing import Any, Iterable, Mapping, Sequence

UNITS = ("kg_m3", "g_cm3", "m_s", "mm_s", "cm_s", "km_s", "Pa_s", "mPa_s", "kHz", "Hz", "MHz", "kPa", "MPa", "Pa", "mm", "um",
         "nm", "cm", "m", "ms", "us", "ns", "s", "deg", "rad", "mN", "N", "dB")


def split_unit(key: str) -> tuple[str, str]:
    """The last part of a key without its unit, and the unit as it is written in the key; empty without one."""
    word = key.split(".")[-1]
    found = max((unit for unit in UNITS if word.endswith("_" + unit) and len(word) > len(unit) + 1), key=len, default="")
    return (word[: -len(found) - 1], found) if found else (word, "")


def follows(settings: Iterable[Mapping[str, Any]], key: str, other: str) -> bool:
    """Whether the value of `key` is determined by that of `other` in all settings."""
    pairs = {(str(values.get(other)), str(values.get(key))) for values in settings}
    return len(pairs) == len({value for value, _ in pairs})


def cf_unit(unit: str) -> str:
    """A unit of a key or of a table column in the notation of CF and UDUNITS: "m_s" and "m/s" -> "m s-1", "kg_m3" -> "kg m-3"."""
    if unit in ("Pa_s", "mPa_s"):  # the only products among the units of keys
        return unit.replace("_", " ")
    above, _, below = unit.replace("_", "/").partition("/")
    name, power = (below.rstrip("0123456789"), below.lstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ")) if below else ("", "")
    return {"deg": "degree"}.get(above, above) + (f" {name}-{power or 1}" if name else "")


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
