# SPDX-License-Identifier: BSD-3-Clause
"""The numerical error of results or the uncertainty of a measurement, and the keys that affect only this error."""
from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from ..case import Case
from ..keys import label
from . import layout, warnings_of
from .load import Selection
from .words import listed


def is_numerical(key: str) -> bool:
    """Whether the key is a choice of the simulation, not of a display or of a user of one."""
    return key.startswith(("solver.", "domain.", "time.", "measure.", "record."))


def is_measurement(selection: Selection) -> bool:
    """Whether `shearwake measure` has written the case, so that its errors are those of a scan."""
    return (selection.sweep.folder / "uncertainty.json").is_file()


def choices(selection: Selection) -> Selection:
    """The selection with only those keys in its labels that can be chosen for a display."""
    keys = [k for k in [selection.x, *layout.group_keys(selection)] if k and not is_numerical(k)]
    return replace(selection, x=keys[0] if keys else "", label_keys=keys[1:])


def valid(selection: Selection, column: str) -> list[Case]:
    """The complete cases with a valid value in this column, without references."""
    return [c for c in layout.ordinary(selection) if not math.isnan(c.value(column, math.nan))
            and warnings_of.is_valid_value(selection, c, column, warnings_of.figure_of(column))]


def relative_error(selection: Selection, case: Case, column: str) -> tuple[Any, ...]:
    """The estimated error of a value relative to it, and the case for which `shearwake converge` has estimated it: this
    case, or else the valid case with the largest relative error. (NaN, None) if no valid case was studied."""
    def ratio(one: Case) -> float:
        value = one.value(column, math.nan)
        return abs(one.value(column + "_error", math.nan) / value) if value else math.nan
    if not math.isnan(ratio(case)):
        return ratio(case), case
    found = {c.id: ratio(c) for c in selection.cases if not math.isnan(ratio(c)) and warnings_of.is_valid_value(selection, c, column)}
    if not found:
        return math.nan, None
    source = selection.by_id[max(found, key=lambda name: found[name])]
    return found[source.id], source


def estimated_at(selection: Selection, case: Case, column: str) -> str:
    """' (error estimated at AM frequency 100 Hz)' if the error of a value is that of another case, else ''."""
    source = relative_error(selection, case, column)[1]
    return "" if source in (case, None) else f" (error estimated at {layout.case_label(selection, source)})"


def numerical_variants(selection: Selection, case: Case, column: str) -> list[Case]:
    """The valid cases that differ from a case only in numerical parameters, itself included."""
    own = {k: v for k, v in case.settings.items() if not is_numerical(k)}
    return [c for c in valid(selection, column) if {k: v for k, v in c.settings.items() if not is_numerical(k)} == own]


def spread_of(cases: list[Case], column: str) -> Any:
    """The range of a column, and this range relative to its mean."""
    values = [c.value(column, math.nan) for c in cases]
    return max(values) - min(values), (max(values) - min(values)) / abs(sum(values) / len(values))


def settings_that_differ(cases: list[Case]) -> Any:
    """What distinguishes numerical variants: 'the two engines', 'the 3 settings of grid spacing'."""
    keys = [k for k in dict.fromkeys(k for c in cases for k in c.settings)
            if len({str(c.settings.get(k)) for c in cases}) > 1]
    count = {2: "two"}.get(len(cases), str(len(cases)))
    if keys == ["solver.engine"]:
        return f"the {count} engines"
    return f"the {count} settings of {listed(map(label, keys))}" if keys else f"the {count} cases"


def sweeps_numbers_only(selection: Selection) -> bool:
    """Whether all swept keys are numerical settings, of which none is the best."""
    keys = layout.axes(selection)
    return bool(keys) and all(is_numerical(key) for key in keys)
