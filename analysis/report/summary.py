# SPDX-License-Identifier: BSD-3-Clause
"""Summarises the result of a sweep in one or two sentences."""
import math

import layout
import sample
from numerical_error import (choices, is_numerical, known, numerical_variants, spread_of, uncertainty,
                             with_error)
from words import counted, number


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


def caveats(sweep):
    """Why no case may be called the best: cases without a result, and readings that are not valid."""
    missing = [c for c in sweep.cases if not c.whole]
    invalid = [c for c in known(sweep, "eta_period_1") if not c.is_valid]
    text = ""
    if missing:
        has = "has" if len(missing) == 1 else "have"
        text += f" {counted(len(missing), 'case')} of {len(sweep.cases)} {has} no result yet."
    if invalid:
        text += (f" The readings of {counted(len(invalid), 'case')} are not valid and are not used: "
                 f"{reason_of(invalid[0])}.")
    return text


def reason_of(case):
    return next(w["message"] for w in case.warnings if w["severity"] == "error")


def only_numerical(cases):
    """For a sweep over numerical parameters alone."""
    low, high = (f(c.value("eta_period_1") for c in cases) for f in (min, max))
    if len(cases) == 1:
        return f"The efficiency η (eta_period_1) is {number(high, 3)}."
    return (f"The efficiency η (eta_period_1) is {span(low, high)}. The cases differ only in numerical parameters, so "
            f"the range of {number(200 * spread_of(cases), 2)} % is a numerical error.")


def without_best(sweep, cases):
    """For a sweep in which no case may be called the best."""
    low, high = (f(c.value("eta_period_1") for c in cases) for f in (min, max))
    return (f"The efficiency η (eta_period_1) of {counted(len(cases), 'complete case')} is {span(low, high)}; no case "
            "is called the best until all are complete.")


def indistinct(sweep, best, cases, column):
    """States the numerical error of a column, and how many cases differ from the best by no more than it."""
    relative = uncertainty(sweep, best, column)
    if math.isnan(relative):
        return " The numerical error has not been estimated: shearwake converge does so."
    variants = numerical_variants(sweep, best)
    near = [c for c in cases if c not in variants
            and abs(c.value(column) - best.value(column)) <= 2 * relative * abs(best.value(column))]
    of_what = "of the ratio" if "over_reference" in column else "of η"
    if not near:
        return f" The numerical error {of_what} is {number(100 * relative, 2)} %."
    differ = "differs" if len(near) == 1 else "differ"
    return (f" {counted(len(near), 'further case')} {differ} from it by no more than the numerical error of both, "
            f"{number(100 * relative, 2)} % {of_what} each.")


def efficiency(sweep):
    """The case that keeps the vibration best at the focus, and its advantage over its reference."""
    every = known(sweep, "eta_period_1")
    cases = [c for c in every if c.is_valid]
    if not every:
        return "No case has an efficiency η over complete periods (eta_period_1)."
    if not cases:
        return f"No efficiency is stated, because no case has valid readings: {reason_of(every[0])}."
    notes = caveats(sweep)
    swept = [k for k in layout.axes(sweep) if not is_numerical(k)]
    if not swept and layout.axes(sweep):
        return only_numerical(cases) + notes
    if sweep.x and any(not c.whole for c in sweep.cases):
        return without_best(sweep, cases) + notes
    compared = [c for c in cases if not math.isnan(gain(sweep, c))]
    if not compared:
        return highest(sweep, cases) + notes
    best = max(compared, key=lambda c: gain(sweep, c))
    text = against_reference(choices(sweep), best)
    if sweep.x:
        text += indistinct(sweep, best, compared, "eta_period_over_reference_1")
    return text + notes


def highest(sweep, cases):
    """The case with the largest efficiency, of cases without references."""
    best = max(cases, key=lambda c: c.value("eta_period_1"))
    value = with_error(sweep, best, "eta_period_1")
    if not sweep.x:
        return f"The efficiency η (eta_period_1) is {value}."
    return (f"The efficiency η (eta_period_1) is highest, {value}, at {where(choices(sweep), best)}."
            + indistinct(sweep, best, cases, "eta_period_1"))


def against_reference(sweep, best):
    """The best case compared with its reference."""
    value = best.value("eta_period_1")
    reference = sweep.reference_of(best).value("eta_period_1")
    name = layout.reference_name(layout.all_references(sweep))
    versus = (f"its efficiency η (eta_period_1) is {with_error(sweep, best, 'eta_period_1')}, "
              f"{comparison(value, reference, name)}.")
    ratio = uncertainty(sweep, best, "eta_period_over_reference_1")
    if abs(value / reference - 1.0) <= ratio:
        versus += f" This difference does not exceed its numerical error of {number(100 * ratio, 2)} %."
    if not sweep.x:
        return f"{subject(sweep, best)}: {versus}"
    if value < reference:
        return f"No case focuses better than {name}. The best is {subject(sweep, best)}: {versus}"
    if len(layout.all_references(sweep)) > 1:
        return f"{subject(sweep, best)} improves most on {name} under the same conditions: {versus}"
    return f"{subject(sweep, best)} focuses best: {versus}"


def valid(sweep, column):
    return [c for c in known(sweep, column) if c.is_valid]


def strength(sweep):
    ratio = {}
    for case in valid(sweep, "focal_rms_um"):
        reference = sweep.reference_of(case)
        if reference and reference is not case and reference.value("focal_rms_um"):
            ratio[case.id] = case.value("focal_rms_um") / reference.value("focal_rms_um")
    ratio = {k: v for k, v in ratio.items() if not math.isnan(v)}
    if not ratio:
        cases = valid(sweep, "focal_rms_um")
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
    if sweep.uncertain:
        return sample.sentence(sweep)
    text = efficiency(sweep) + strength(choices(sweep))
    return text[:1].upper() + text[1:]
