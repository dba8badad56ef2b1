# SPDX-License-Identifier: BSD-3-Clause
"""Compares cases with a body with those that differ only by its absence. A label "without ..." names the value of a swept key
that stands for the absence: of [table] labels, or of a body with the material of its surroundings."""
from __future__ import annotations

from ..case import Case
from ..keys import follows
from . import labels, layout
from .load import Selection, remembered

ABSENT = "without "


@remembered
def absent(selection: Selection) -> tuple[str, str]:
    """The first swept key with a value labelled "without ...", and this label; two empty texts without such a key."""
    return next(((key, text) for (key, _), text in labels.labels(selection).items() if text.startswith(ABSENT)), ("", ""))


def present(selection: Selection) -> str:
    """'with bone' for the label 'without bone'."""
    return absent(selection)[1].replace(ABSENT, "with ", 1)


@remembered
def counterpart(selection: Selection, case: Case) -> Case | None:
    """The complete case without the body that otherwise equals a case; None for a case without the body. The settings of the body
    and of the keys that change with it may differ, for example a depth that was swept with the body only."""
    key, text = absent(selection)
    names = labels.labels(selection)
    if not key or case.is_reference or names.get((key, case.settings.get(key))) == text:
        return None
    follow = {other for other in case.settings if follows((c.settings for c in labels.swept_cases(selection)), other, key)}
    body = labels.BODY.match(key)

    def differing(one: Case) -> list[str]:
        return [k for k, v in case.settings.items() if k not in follow and one.settings.get(k) != v]
    found = [c for c in layout.ordinary(selection) if names.get((key, c.settings.get(key))) == text
             and all(body and k.startswith(body[1] + ".") for k in differing(c))]
    return min(found, key=lambda c: len(differing(c))) if found else None
