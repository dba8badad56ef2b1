"""What the sweep says, in a sentence or two, from the numbers alone."""
import math

import layout
from words import number, value_text


def known(sweep, column):
    return [c for c in layout.ordinary(sweep) if not math.isnan(c.value(column))]


def where(sweep, case):
    keys = [k for k in [sweep.x, *layout.group_keys(sweep)] if k and k in case.settings]
    return ", ".join(f"{layout.name(sweep, k)} {value_text(k, case.settings[k])}" for k in keys)


def gain(sweep, case):
    """eta over that of the case's reference; NaN for the reference itself."""
    reference = sweep.reference_of(case)
    below = reference.value("eta_period_1") if reference and reference is not case else math.nan
    return case.value("eta_period_1") / below if below else math.nan


def efficiency(sweep):
    cases = known(sweep, "eta_period_1")
    if not cases:
        return "No case has a period reading of η."
    compared = [c for c in cases if not math.isnan(gain(sweep, c))]
    if not compared:
        best = max(cases, key=lambda c: c.value("eta_period_1"))
        value = number(best.value("eta_period_1"), 3)
        if not sweep.x:
            return f"η over whole periods is {value}."
        return f"η over whole periods is highest, {value}, at {where(sweep, best)}."
    best = max(compared, key=lambda c: gain(sweep, c))
    reference = sweep.reference_of(best)
    name = layout.reference_name(layout.all_references(sweep))
    change = gain(sweep, best) - 1.0
    at = f"is highest at {where(sweep, best)}" if sweep.x else "stands"
    values = (f"{number(best.value('eta_period_1'), 3)} against "
              f"{number(reference.value('eta_period_1'), 3)}")
    return (f"Relative to {name}, η over whole periods {at}: {values}, "
            f"{number(100 * abs(change), 2)} % {'more' if change >= 0 else 'less'}.")


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
        return "No case is whole yet: there is nothing to draw."
    return efficiency(sweep) + strength(sweep)
