# SPDX-License-Identifier: BSD-3-Clause
"""How figures show readings that are not valid: grey crosses, without a line and outside of colour scales."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..case import Case
from . import layout, style, warnings_of
from .load import Selection

CROSSES: dict[str, Any] = {"linestyle": "none", "marker": "x", "color": style.GREY, "markersize": 6, "markeredgewidth": 1.6, "zorder": 2.8}


def split(selection: Selection, cases: list[Case], column: str, figure: str,
          values: list[float] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The values of a column as two arrays: those that are valid in a figure, and those that are not; NaN elsewhere."""
    valid = np.array([warnings_of.is_valid_value(selection, c, column, figure) for c in cases], bool)
    values = np.asarray(values, dtype=float)
    return np.where(valid, values, np.nan), np.where(valid, np.nan, values)


def invalid_cases(selection: Selection, figure: str, *columns: str) -> list[Case]:
    """The cases with a value in one of the columns that is not valid; references only unless all columns are ratios."""
    of_ratios = all(map(selection.is_ratio, columns))
    shown = [*layout.ordinary(selection), *(r for r in layout.all_references(selection) if r.is_reference and not of_ratios)]
    return [c for c in shown if any(np.isfinite(c.value(column, math.nan)) and not warnings_of.is_valid_value(selection, c, column, figure)
                                    for column in columns)]


def invalid_caption(selection: Selection, figure: str, *columns: str) -> str:
    """The sentence of a caption about grey crosses; '' if all readings are valid."""
    found = invalid_cases(selection, figure, *columns)
    return f" Grey crosses, not valid: {layout.count_of(found)}." if found else ""
