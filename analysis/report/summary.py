"""What the sweep says, in a sentence or two, from the numbers alone."""
import math

import layout
from words import key_name, number, value_text


def known(sweep, column):
    return [c for c in layout.ordinary(sweep) if not math.isnan(c.value(column))]


def where(sweep, case):
    keys = [k for k in [sweep.x, *layout.group_keys(sweep)] if k and k in case.settings]
    return ", ".join(f"{key_name(k)} {value_text(k, case.settings[k])}" for k in keys)


def of_reference(sweep, case):
    """'6.5 % above plain STM (0.179)'."""
    reference = sweep.reference_of(case)
    if not reference or reference is case or math.isnan(reference.value("eta_period_1")):
        return ""
    name = layout.reference_name([reference])
    change = case.value("eta_period_1") / reference.value("eta_period_1") - 1.0
    shown = f"{number(100 * abs(change), 2)} % {'above' if change > 0 else 'below'}"
    return f", {shown} {name} ({number(reference.value('eta_period_1'), 3)})"


def efficiency(sweep):
    cases = known(sweep, "eta_period_1")
    if not cases:
        return "No case has a period reading of η."
    if len(cases) == 1 or not sweep.x:
        return (f"η over whole periods is {number(cases[0].value('eta_period_1'), 3)}"
                f"{of_reference(sweep, cases[0])}.")
    best = max(cases, key=lambda c: c.value("eta_period_1"))
    return (f"η over whole periods is highest, {number(best.value('eta_period_1'), 3)}, at "
            f"{where(sweep, best)}{of_reference(sweep, best)}.")


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
    return (f" The focal rms lies between {number(low, 2)} ({where(sweep, lowest)}) and "
            f"{number(high, 2)} ({where(sweep, highest)}) times that of {name}.")


def span(low, high):
    low, high = number(low, 3), number(high, 3)
    return low if low == high else f"{low} to {high}"


def summary(sweep):
    if not layout.ordinary(sweep):
        return "No case is whole yet: there is nothing to draw."
    return efficiency(sweep) + strength(sweep)
