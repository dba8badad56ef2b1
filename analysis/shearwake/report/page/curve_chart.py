# SPDX-License-Identifier: BSD-3-Clause
"""Charts of curves against the swept key, with their error bars."""
from __future__ import annotations

import math

import numpy as np

from ...case import Case
from ...keys import is_at_instant
from .. import answer, labels, layout, style
from ..load import Selection
from ..numerical_error import valid
from ..validity import split
from .chart import Chart, Line


def errors(cases: list[Case], column: str) -> np.ndarray:
    """Half the lengths of the error bars, which `reduce` adds as columns; NaN without."""
    return np.array([case.value(column + "_error", math.nan) for case in cases])


def have_errors(selection: Selection, column: str) -> bool:
    """Whether a valid case has an error; values that are not valid have no error bars."""
    return bool(np.isfinite(errors(valid(selection, column), column)).any())


def error_caption(selection: Selection, *columns: str) -> str:
    if any(have_errors(selection, column) for column in columns):
        return " Error bars: the estimated numerical error."
    return ""


def is_joined(selection: Selection, column: str) -> bool:
    """Whether lines join the values: categories have no order, and a reading at one instant depends on the phase."""
    return layout.is_numeric(selection) and not is_at_instant(column)


def reference_lines(selection: Selection, figure: str, group: layout.Group, column: str, label: str,
                    colour: str) -> list[Line]:
    """The values of the reference at each x of a curve, and crosses where they are not valid."""
    pairs = [(layout.x_position(selection, c), r) for c in group.cases if (r := selection.added_reference_of(c))]
    values = np.array([r.value(column, math.nan) for _, r in pairs])
    if not pairs or not np.isfinite(values).any():
        return []
    joined = is_joined(selection, column) or len(set(values[np.isfinite(values)])) < 2
    return with_crosses(Line(label, [x for x, _ in pairs], values, colour, dashed=joined, dots=not joined),
                        split(selection, [r for _, r in pairs], column, figure, values))


def with_crosses(line: Line, parts: tuple[np.ndarray, np.ndarray]) -> list[Line]:
    """A line of the valid values and one of grey crosses; one of them alone if the other has no values."""
    line.y, invalid = parts
    crosses = Line(f"{line.label}, not valid", line.x, invalid, style.GREY, points=True, crossed=True)
    if not np.isfinite(invalid).any():
        return [line]
    return [line, crosses] if np.isfinite(line.y).any() else [crosses]


def empty_chart(selection: Selection, column: str, title: str = "", y_log: bool = False) -> Chart:
    """The axes of curves of a column."""
    values = layout.x_values(selection)
    names = None if layout.is_numeric(selection) else [labels.value_text(selection, selection.x, v) for v in values]
    return Chart(labels.axis_label(selection, selection.x), answer.column_label(selection, column), [], title, names,
                 names is None and bool(layout.is_logarithmic(values)), y_log)


def curve_chart(selection: Selection, figure: str, column: str, title: str = "", y_log: bool = False) -> Chart:
    """One line per curve of the figure of this name, and dashed lines of the references; a ratio to the reference has no
    references."""
    chart, found = empty_chart(selection, column, title, y_log), layout.groups(selection)
    name = layout.reference_name(layout.all_references(selection))
    lines, colours = [], {}
    for group, colour in zip(found, style.distinct(len(found))):
        x = [layout.x_position(selection, c) for c in group.cases]
        y = [layout.curve_value(selection, c, column) for c in group.cases]
        if all(map(math.isnan, y)) and selection.is_ratio(column):
            continue  # the references themselves
        line = Line(group.label or "all cases" if len(found) > 1 else layout.modulation(selection) or chart.y_label, x, y, colour,
                    error=errors(group.cases, column), points=True, dots=not is_joined(selection, column))
        lines += with_crosses(line, split(selection, group.cases, column, figure, y))
        colours[group.label] = colour
    sets = [] if selection.is_ratio(column) else layout.by_reference(selection, found, column)
    for same in sets:
        label = name if len(sets) == 1 else layout.references_label(selection, same)
        colour = style.INK if len(sets) == 1 else colours[same[0].label]
        lines += reference_lines(selection, figure, same[0], column, label, colour)
    chart.lines = sorted(lines, key=lambda line: (line.dashed, line.crossed))
    return chart
