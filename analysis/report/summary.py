# SPDX-License-Identifier: BSD-3-Clause
"""Summarises the result of a sweep in one or two sentences."""
import math

import layout
from words import number


def known(sweep, column):
    return [c for c in layout.ordinary(sweep) if not math.isnan(c.value(column))]


def where(sweep, case):
    keys = [k for k in [sweep.x, *layout.group_keys(sweep)] if k and k in case.settings]
    return ", ".join(layout.setting_text(sweep, k, case.settings[k]) for k in keys)


def subject(sweep, case):
    """For example 'AM-STM at AM frequency 400 Hz'."""
    kind = case.setting("load", "modulation", "kind", default="")
    place = where(sweep, case)
    if "load.modulation.kind" in case.settings or not kind:
        return place or "the case"
    return f"{kind} at {place}" if place else kind


def gain(sweep, case):
    """eta relative to that of the reference of the case; NaN for a reference."""
    reference = sweep.reference_of(case)
    below = reference.value("eta_period_1") if reference and reference is not case else math.nan
    return case.value("eta_period_1") / below if below else math.nan


def comparison(value, reference, name):
    """For example '1.8 times the 0.28 of plain STM' or '13 % more than the 0.24 of plain STM'."""
    factor = value / reference
    if factor >= 1.5:
        return f"{number(factor, 2)} times the {number(reference, 3)} of {name}"
    percent = f"{number(100 * abs(factor - 1.0), 2)} % {'more' if factor >= 1.0 else 'less'}"
    return f"{percent} than the {number(reference, 3)} of {name}"


def efficiency(sweep):
    """The case that keeps the vibration best at the focus, and its advantage over its reference."""
    cases = known(sweep, "eta_period_1")
    if not cases:
        return "No case has an efficiency η over complete periods (eta_period_1)."
    compared = [c for c in cases if not math.isnan(gain(sweep, c))]
    if not compared:
        best = max(cases, key=lambda c: c.value("eta_period_1"))
        value = number(best.value("eta_period_1"), 3)
        if not sweep.x:
            return f"The efficiency η (eta_period_1) is {value}."
        return f"The efficiency η (eta_period_1) is highest, {value}, at {where(sweep, best)}."
    best = max(compared, key=lambda c: gain(sweep, c))
    value = best.value("eta_period_1")
    reference = sweep.reference_of(best).value("eta_period_1")
    name = layout.reference_name(layout.all_references(sweep))
    versus = f"its efficiency η (eta_period_1) is {number(value, 3)}, {comparison(value, reference, name)}."
    if not sweep.x:
        return f"{subject(sweep, best)}: {versus}"
    if value < reference:
        return f"No case focuses better than {name}. The best is {subject(sweep, best)}: {versus}"
    if len(layout.all_references(sweep)) > 1:
        return f"{subject(sweep, best)} improves most on {name} under the same conditions: {versus}"
    return f"{subject(sweep, best)} focuses best: {versus}"


def strength(sweep):
    ratio = {}
    for case in known(sweep, "focal_rms_um"):
        reference = sweep.reference_of(case)
        if reference and reference is not case and reference.value("focal_rms_um"):
            ratio[case.id] = case.value("focal_rms_um") / reference.value("focal_rms_um")
    ratio = {k: v for k, v in ratio.items() if not math.isnan(v)}
    if not ratio:
        cases = known(sweep, "focal_rms_um")
        if not cases:
            return ""
        low, high = (f(c.value("focal_rms_um") for c in cases) for f in (min, max))
        return f" The focal rms is {span(low, high)} µm."
    name = layout.reference_name(layout.all_references(sweep))
    lowest, highest = (sweep.by_id(f(ratio, key=ratio.get)) for f in (min, max))
    low, high = ratio[lowest.id], ratio[highest.id]
    if len(ratio) == 1 or high - low < 0.005 * high:
        return f" The focal rms is {number(high, 2)} times that of {name}."
    return (f" The focal rms is {number(low, 2)} ({where(sweep, lowest)}) to "
            f"{number(high, 2)} ({where(sweep, highest)}) times that of {name}.")


def span(low, high):
    low, high = number(low, 3), number(high, 3)
    return low if low == high else f"{low} to {high}"


def summary(sweep):
    if not layout.ordinary(sweep):
        return "No case is complete yet, so there is nothing to draw."
    return efficiency(sweep) + strength(sweep)
