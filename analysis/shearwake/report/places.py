# SPDX-License-Identifier: BSD-3-Clause
"""States in sentences which cases are meant, by the swept keys that a user of a display can choose."""
from __future__ import annotations

from ..case import Case
from . import labels, layout
from .load import Selection
from .numerical_error import choices
from .words import listed

NAMED = 3  # largest number of cases that are named


def keys_of(selection: Selection) -> list[str]:
    """The swept keys that can be chosen for a display."""
    chosen = choices(selection)
    return [k for k in [chosen.x, *layout.group_keys(chosen)] if k]


def where(selection: Selection, case: Case, keys: list[str] | None = None) -> str:
    return labels.place_text(selection, case.settings, keys_of(selection) if keys is None else keys)


def places(selection: Selection, cases: list[Case]) -> list[str]:
    """Where the cases are, each once. A single numeric key is named once: 'AM frequency 300 Hz', '400 Hz'."""
    found = list(dict.fromkeys(where(selection, c) for c in cases))
    keys = [k for k in keys_of(selection) if k in cases[0].settings]
    if len(keys) == 1 and not labels.is_nominal(selection, keys[0], cases[0].settings[keys[0]]):
        amounts = dict.fromkeys(labels.amount_text(selection, keys[0], c.settings[keys[0]]) for c in cases)
        return [found[0], *list(amounts)[1:]]
    return found


def named(selection: Selection, cases: list[Case]) -> str:
    """'AM frequency 300 Hz and 400 Hz'; only the first ones of many, and their number."""
    found = places(selection, cases)
    if len(found) > NAMED:
        found = [*found[:NAMED - 1], f"{len(found) - NAMED + 1} further cases"]
    return listed(found)


def placed(selection: Selection, cases: list[Case]) -> str:
    return labels.placed(selection, cases[0].settings, keys_of(selection), named(selection, cases))


def capital(text: str) -> str:
    return text[:1].upper() + text[1:]
