# SPDX-License-Identifier: BSD-3-Clause
"""Which cases of a large sweep the page lists one by one: in its table, its notes and its player."""
from __future__ import annotations

import random

from ..case import Case
from . import layout
from .answer import column
from .load import Selection, remembered
from .ranking import rank
from .words import counted

MOST = 1000  # cases of a page, each with a row of about a kilobyte


def best(selection: Selection) -> list[Case]:
    """The best cases of the answer, at most an eighth of MOST, and their references."""
    found = rank(selection, column(selection)).equal[:MOST // 8]
    return [*found, *(r for c in found if (r := selection.reference_of(c)))]


@remembered
def listed(selection: Selection) -> list[Case]:
    """All cases, or of more than MOST the best ones, those without a result and others that are drawn at random."""
    if len(selection.cases) <= MOST:
        return selection.cases
    ids = {case.id for case in [*best(selection), *missing(selection), *random.Random(0).sample(selection.cases, MOST // 2)]}
    return [case for case in selection.cases if case.id in ids]


@remembered
def missing(selection: Selection) -> list[Case]:
    """The cases without a result; in a sweep of more than MOST cases at most a quarter of MOST."""
    found = [case for case in selection.cases if not case.is_complete]
    return found if len(selection.cases) <= MOST else found[:MOST // 4]


@remembered
def with_surfaces(selection: Selection) -> Selection:
    """The selection whose surfaces the player shows: all cases, or of more than MOST those of other figures and the best ones."""
    if len(selection.cases) <= MOST:
        return selection
    return layout.only(selection, [case.id for case in [*layout.ordinary(layout.few(selection)), *best(selection)]])


def sentence(selection: Selection) -> str:
    """States which cases are listed, unless all are."""
    shown = listed(selection)
    if len(shown) == len(selection.cases):
        return ""
    return (f"{len(shown)} of {counted(len(selection.cases), 'case')} are listed: the best ones, at most {MOST // 4} without a result, and "
            "others that are drawn at random. ")
